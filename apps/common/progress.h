/* apps/common/progress.h: one line on a terminal that says how far a run is; nothing in a pipe. */
#ifndef PUPIL_APPS_COMMON_PROGRESS_H
#define PUPIL_APPS_COMMON_PROGRESS_H

#include <stdint.h>

typedef struct progress {
    int shown;      /* stderr is a terminal and --quiet was not given */
    int line_open;  /* something is on the line */
    uint64_t total; /* frames expected; 0: unknown */
    double began_s, last_s;
    char line[256]; /* its text */
} progress;

void progress_begin(progress *p, int quiet, uint64_t total);

/* 1: `every_s` seconds have passed since the last line; the caller adds to a new one and shows it. 0: not yet, or no
 * line is shown. */
int progress_due(progress *p, double every_s);
void progress_add(progress *p, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Overwrites the last line. Cut to the terminal's width: a wrapped line could not be overwritten. */
void progress_show(progress *p);

void progress_clear(progress *p); /* leaves the line empty, for a message */

/* Seconds of a clock that only goes forward. */
double progress_now_s(void);

#endif
