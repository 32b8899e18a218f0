/* apps/run/resume.h: the total (exposure time x gain) at which the last run was at rest, of each camera, in a file, so
 * that the first frames of the next one are right already. The file is that of --resume, or one in the folder where
 * programs of this user keep their state. Of the latter no fault ends a run.
 */
#ifndef PUPIL_APPS_RUN_RESUME_H
#define PUPIL_APPS_RUN_RESUME_H

#include <pthread.h>
#include <stdatomic.h>

#include "live/live.h"
#include "pupil/error.h"

typedef struct run_resume {
    const char *path;                         /* NULL: nothing is read or written, and all calls do nothing */
    int is_asked;                             /* by --resume; else what cannot be written is not kept */
    char usual[512];                          /* the path where it is not */
    char camera[sizeof(pupil_live_identity)]; /* driver, bus and card, as they are in the file */
    uint64_t reopened;                        /* times, when it was that */
    double total_s;                           /* of the last run; 0: none */
    uint32_t left_out;                        /* frames, while that was not in force yet */
    int waits;                                /* ... and it is not */
    double rest_s;                            /* of this run, at rest; 0: not yet */
    double kept_s;                            /* that was written last; 0: none */
    int64_t kept_ns;                          /* when; at first when the run began */
    pthread_t thread;                         /* that writes, for a disk may take long */
    atomic_int is_busy;                       /* it does */
    int has_thread;                           /* to be joined */
    double write_s;                           /* its own */
} run_resume;

/* Before a camera is touched: whether such a file is there or can be. 0, or -1 and a sentence. */
int run_resume_check(const char *path, pupil_why *why);

/* Reads what is kept of this camera. `path` NULL: in the usual file, whose folder is made: cameras in $STATE_DIRECTORY
 * (systemd's), $XDG_STATE_HOME/pupil or ~/.local/state/pupil; where there can be none, nothing is kept. `warning`: a
 * sentence where a part of the file is damaged, or the total is none that this camera could have, else empty. */
void run_resume_begin(run_resume *r, const char *path, const pupil_source *source, pupil_why *warning);

/* Whether the frame is to be left out, for it was taken before what was kept came into force: 30 at most. */
int run_resume_leaves_out(run_resume *r, const pupil_source *source, const pupil_frame_info *info);

/* After each frame: keeps the total where the sensor is at rest. It is written after the first five seconds,
 * and then every minute in which it has changed. */
void run_resume_frame(run_resume *r, const pupil_source *source, const pupil_sensor_setting *setting, int64_t now_ns);

/* Writes it. 0, or -1 and a sentence. */
int run_resume_end(run_resume *r, pupil_why *why);

#endif
