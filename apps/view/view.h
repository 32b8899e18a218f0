/* apps/view/view.h: the window of --view: the result at the source's pace, keys, a plot of the level.
 *
 * Frames come late where reading or mapping them takes longer than they last: they are metered all the same, and some
 * of them are not shown. Every frame's level is what it is without a window.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_VIEW_VIEW_H
#define PUPIL_APPS_VIEW_VIEW_H

#include "frame/replay_work.h"
#include "output/frame_log.h"
#include "pupil/error.h"

typedef struct view view;

/* What is viewed; stays the caller's. Keys change options->config, of the pupil_t and of the work. */
typedef struct view_of {
    frame_options *options;
    pupil_t *pupil;
    replay_work *work;
    double fps;
    int live; /* frames are shown at once, and continue while the viewer pauses */
    int (*curve)(void *context, pupil_curve *curve); /* 1: the frame's curve, regardless of the pupil_t's own; 0: the
                                                      * pupil_t's. NULL: always that */
    void *context;
} view_of;

enum { VIEW_ON = 0, VIEW_QUIT = 1 };

/* A window for pictures of the first frame's shape, and in its context the work's GPU, where it is one or --gles asks
 * for it. -1 and a sentence: there is no display, or no OpenGL ES 3. */
int view_open(view **v, const view_of *of, const pupil_image_const *first, pupil_why *why);

/* replay_work_close comes first. NULL is allowed. */
void view_close(view *v);

/* The frame that the work has just done: shown when its time has come, and as long as the viewer pauses. VIEW_QUIT: the
 * viewer, or Ctrl-C, has ended it. */
int view_frame(view *v, const pupil_frame *frame, const pupil_curve *curve, const pupil_image_const *display,
               const frame_log_entry *record);

/* The last frame stays until the viewer ends it. */
void view_stay(view *v);

#endif
