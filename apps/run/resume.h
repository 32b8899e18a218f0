/* apps/run/resume.h: keeps the total (exposure time x gain) at which the last run of each camera was at rest in a file,
 * so that the next run starts with the right exposure. The file is that of --resume, or one in the user's state folder.
 * A fault of the latter never ends a run.
 */
#ifndef PUPIL_APPS_RUN_RESUME_H
#define PUPIL_APPS_RUN_RESUME_H

#include <pthread.h>
#include <stdatomic.h>

#include "live/live.h"
#include "pupil/error.h"

typedef struct run_resume {
    const char *path;                         /* NULL: nothing is read or written, and all calls do nothing */
    int is_asked;                             /* by --resume; else a failed write is ignored */
    char usual[512];                          /* the path if it is not */
    char camera[sizeof(pupil_live_identity)]; /* driver, bus and card, as in the file */
    uint64_t reopened;                        /* reopen count of the source when `camera` was named */
    double total_s;                           /* of the last run; 0: none */
    uint32_t left_out;                        /* frames, while total_s was not in force yet */
    int waits;                                /* it is not in force yet */
    double rest_s;                            /* of this run, at rest; 0: not yet */
    double kept_s;                            /* written last; 0: none */
    int64_t kept_ns;                          /* when kept_s was written; at first when the run began */
    pthread_t thread;                         /* writes, because a disk may be slow */
    atomic_int is_busy;                       /* the thread is writing */
    int has_thread;                           /* to be joined */
    double write_s;                           /* the total that the thread writes */
} run_resume;

/* Before a camera is touched: whether the file exists or can be made. 0, or -1 and a sentence. */
int run_resume_check(const char *path, pupil_why *why);

/* Reads the total of this camera. `path` NULL: from the usual file, whose folder is made: `cameras` in $STATE_DIRECTORY
 * (systemd's), $XDG_STATE_HOME/pupil or ~/.local/state/pupil. If that is impossible, nothing is kept. `warning`: a
 * sentence if a part of the file is damaged, or this camera cannot have that total, else empty. */
void run_resume_begin(run_resume *r, const char *path, const pupil_source *source, pupil_why *warning);

/* Whether the frame is to be left out, because it was taken before the kept total came into force: 30 at most. */
int run_resume_leaves_out(run_resume *r, const pupil_source *source, const pupil_frame_info *info);

/* After each frame: keeps the total if the sensor is at rest. It is written after the first five seconds, and then
 * every minute if it has changed. */
void run_resume_frame(run_resume *r, const pupil_source *source, const pupil_sensor_setting *setting, int64_t now_ns);

/* Writes it. 0, or -1 and a sentence. */
int run_resume_end(run_resume *r, pupil_why *why);

#endif
