/* apps/run/status.h: what a live run tells its user while it goes on, and at its end. */
#ifndef PUPIL_APPS_RUN_STATUS_H
#define PUPIL_APPS_RUN_STATUS_H

#include "options.h"
#include "output/frame_log.h"

typedef struct run_status {
    int quiet, shown; /* shown: a line that is written again and again; stderr is a terminal */
    int line_open;
    double last_s;               /* when it was written last */
    uint64_t frames, since;      /* all, and since then */
    double first_time_s, time_s; /* of the frames */
    uint64_t lost, flagged, late;
    uint64_t stamped;                   /* frames whose latency is known: */
    double latency_us, most_latency_us; /* sum, largest */
} run_status;

void run_status_begin(run_status *s, int quiet, const pupil_source *source, const run_options *options);
void run_status_frame(run_status *s, const frame_log_entry *record); /* written at most five times a second */
void run_status_clear(run_status *s);                                /* leaves the line empty, for a message */
/* The last line; `more`: what else is to be told, which begins with "; ". */
void run_status_end(const run_status *s, const run_options *options, uint64_t reopened, const char *more);

#endif
