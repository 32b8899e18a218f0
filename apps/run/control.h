/* apps/run/control.h: a Unix socket to query and change a running `pupil run`: each line in is answered by a line of
 * JSON, in order. Only its user may connect: mode 0600, and a peer with another user id (root aside) is refused.
 *
 * A client cannot hold up the frames: nothing here waits, at most CONTROL_LINES lines are answered between two frames,
 * and no lines are read from a client that does not read its answers. Lines longer than CONTROL_LINE_BYTES are refused
 * and skipped.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_RUN_CONTROL_H
#define PUPIL_APPS_RUN_CONTROL_H

#include <stddef.h>

#include "pupil/error.h"

enum { CONTROL_CLIENTS = 8, CONTROL_LINES = 32, CONTROL_LINE_BYTES = 512, CONTROL_ANSWER_BYTES = 2048 };

typedef struct run_control run_control;

/* Answers one line; both are without line ends. */
typedef void run_control_answer(void *context, const char *line, char *answer, size_t answer_bytes);

/* An existing socket is replaced if nobody listens to it, as after a kill. 0, or -1 and a sentence. */
int run_control_open(run_control **control, const char *path, run_control_answer *answer, void *context,
                     pupil_why *why);

/* Between frames: answers the lines that have come. */
void run_control_serve(run_control *control);

/* Removes the socket. NULL is allowed. */
void run_control_close(run_control *control);

/* "{"ok":false,"error":"..."}". */
void run_control_refuse(const char *sentence, char *answer, size_t answer_bytes);

/* A text as a JSON string without its quotes: ASCII; other bytes are '?'. */
void run_control_text(const char *text, char *json, size_t json_bytes);

#endif
