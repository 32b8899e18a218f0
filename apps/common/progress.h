/* apps/common/progress.h: one line on a terminal that says how far a run is; nothing in a pipe. */
#ifndef PUPIL_APPS_COMMON_PROGRESS_H
#define PUPIL_APPS_COMMON_PROGRESS_H

#include "output/frame_log.h"

typedef struct progress {
    int shown;      /* stderr is a terminal and --quiet was not given */
    int line_open;  /* something is on the line */
    uint64_t total; /* frames expected; 0: unknown */
    double began_s, last_s;
} progress;

void progress_begin(progress *p, int quiet, uint64_t total);
void progress_step(progress *p, const frame_log_entry *record); /* at most ten times a second */
void progress_clear(progress *p);                               /* leaves the line empty, for a message */

/* Seconds of a clock that only goes forward. */
double progress_now_s(void);

#endif
