/* apps/run/kept.h: the text of --resume's file: a head, then a line for each camera: its total (exposure time x gain in
 * seconds), driver, bus and card, with tabs between them. The file may hold anything: other programs can write it. */
#ifndef PUPIL_APPS_RUN_KEPT_H
#define PUPIL_APPS_RUN_KEPT_H

#include <stdio.h>

#include "pupil/error.h"

typedef struct run_kept {
    double total_s; /* of the camera; 0: there is none */
    int is_damaged; /* a line is unusable (cut off, too long, not by us), or the text is longer than the bound */
} run_kept;

/* Reads the total of a camera ("DRIVER\tBUS\tCARD"; NULL: of none), and copies the lines of the others to `others`
 * (NULL: nowhere). Reads 44 KB at most, and takes 63 other cameras at most. An empty file has no cameras. 0, or -1 and
 * a sentence that begins with the path: it is another file, or cannot be read. */
int run_kept_read(FILE *in, const char *path, const char *camera, FILE *others, run_kept *kept, pupil_why *why);

/* Writes the head, and the line of one camera; the lines of the others follow. */
void run_kept_write(FILE *out, const char *camera, double total_s);

#endif
