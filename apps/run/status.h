/* apps/run/status.h: the status line of a live run, and its last line. */
#ifndef PUPIL_APPS_RUN_STATUS_H
#define PUPIL_APPS_RUN_STATUS_H

#include "session/session.h"

typedef struct run_status {
    int quiet;
    progress *line;              /* the session's */
    uint64_t frames, since;      /* all, and since the line was written last */
    double first_time_s, time_s; /* of the frames */
    uint64_t lost, flagged, late;
    const char *day_night;              /* said last */
    uint64_t stamped;                   /* frames with a known latency: */
    double latency_us, most_latency_us; /* sum, largest */
} run_status;

/* `mode`: a run_mode, which is no longer RUN_BEST. `resumes`: the run begins with the exposure of the last one. */
void run_status_begin(run_status *s, session *of, uint32_t mode, int resumes);
void run_status_frame(run_status *s, const frame_log_entry *entry); /* written at most five times a second */

/* The last line. `camera`: the name of one of several, put before the line, or NULL. `more`: further text, which begins
 * with "; ". */
void run_status_end(const run_status *s, const session_outputs *outputs, uint64_t reopened, const char *camera,
                    const char *more);

#endif
