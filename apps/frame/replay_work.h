/* apps/frame/replay_work.h: what does the frames of a replay: the CPU, or the GPU until it cannot, after which the CPU
 * goes on from the same adapted level. */
#ifndef PUPIL_APPS_FRAME_REPLAY_WORK_H
#define PUPIL_APPS_FRAME_REPLAY_WORK_H

#include "frame_work.h"
#include "gles_work.h"
#include "options/frame_options.h"
#include "pupil/error.h"

/* Told of each frame's statistics as soon as they are there; may change the curve that the frame is mapped by (unless
 * config.order is fused: then it was mapped already). */
typedef void replay_judge(void *context, const pupil_stats *stats, const pupil_frame_info *info, pupil_curve *curve);

typedef struct replay_work {
    const frame_options *options; /* its config is that of the pupil_t, and may change between frames */
    replay_judge *judge;          /* NULL: nobody */
    void *context;                /* of judge */
    workers *workers;
    frame_work *cpu;
    gles_work *gpu; /* NULL: the CPU does it */
    int cpu_only;   /* it stays so */
    uint64_t frames, gpu_frames;
    char gpu_name[512];
    pupil_why warning;      /* why the CPU has taken over; for the user, and then to be emptied */
    unsigned char *display; /* RGB8, tightly packed */
    size_t display_bytes;
} replay_work;

/* 0; -1: not enough memory. Closing takes what a failed opening left. */
int replay_work_open(replay_work *w, const frame_options *options);
void replay_work_close(replay_work *w);

/* Unless it is cpu_only, from now on the GPU, in the current context, whose functions get_proc finds, or (NULL) in one
 * without a window; or a warning. */
void replay_work_gles(replay_work *w, pupil_gles_get_proc get_proc);

/* The GPU cannot go on: a warning, and the CPU takes over. */
void replay_work_give_up(replay_work *w, pupil_t *pupil, const char *why);

/* After options.config was changed. */
void replay_work_retune(replay_work *w, pupil_t *pupil);

/* One frame: its statistics, the curve that mapped it, and the display picture, which is of the frame's size where it
 * is `whole` (or the CPU made it), or else small: enough for its figures. -1 and a sentence. */
int replay_work_frame(replay_work *w, pupil_t *pupil, const pupil_frame *frame, int whole, pupil_stats *stats,
                      pupil_curve *curve, pupil_image *display, pupil_why *why);

/* The CPU maps the frame anew, to `display`, which is the one of replay_work_frame; -1: not enough memory. */
int replay_work_map(replay_work *w, const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *in,
                    pupil_image *display);

/* "; GPU: ..." where it was asked for. */
void replay_work_tell(const replay_work *w, char *text, size_t text_bytes);

#endif
