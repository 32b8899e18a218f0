/* apps/run/kept.h: the text of --resume's file: a head, then of each camera a line: its total (exposure time x gain in
 * seconds), driver, bus and card, with tabs between them. Whoever can write the file may have put anything there.
 */
#ifndef PUPIL_APPS_RUN_KEPT_H
#define PUPIL_APPS_RUN_KEPT_H

#include <stdio.h>

#include "pupil/error.h"

typedef struct run_kept {
    double total_s; /* of the camera; 0: there is none */
    int is_damaged; /* a line says nothing (cut off, too long, not by us), or the text goes on past the bound */
} run_kept;

/* The total of a camera ("DRIVER\tBUS\tCARD"; NULL: of none), and the lines of the others into `others` (NULL:
 * nowhere). It reads 44 KB at most, and takes 63 other cameras at most. An empty file has none. 0, or -1 and a sentence
 * that begins with the path: it is another file, or cannot be read. */
int run_kept_read(FILE *in, const char *path, const char *camera, FILE *others, run_kept *kept, pupil_why *why);

/* The head, and the line of one camera; those of the others come behind it. */
void run_kept_write(FILE *out, const char *camera, double total_s);

#endif
