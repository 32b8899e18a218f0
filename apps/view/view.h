/* apps/view/view.h: the window of --view: the result at the source's pace, keys, a plot of the level.
 *
 * Frames come late where reading or mapping them takes longer than they last: they are metered all the same, and some
 * of them are not shown. Every frame's level is what it is without a window.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_VIEW_VIEW_H
#define PUPIL_APPS_VIEW_VIEW_H

#include "frame/pipeline.h"
#include "options/frame_options.h"
#include "output/frame_log.h"
#include "pupil/error.h"

typedef struct view view;

/* What is viewed; stays the caller's. Keys change options->config, and retune the pipeline. */
typedef struct view_of {
    frame_options *options;
    frame_pipeline *pipeline;
    double fps;
    int live; /* frames are shown at once, and continue while the viewer pauses */
} view_of;

enum { VIEW_ON = 0, VIEW_QUIT = 1 };

/* A window for pictures of the first frame's shape, and in its context the pipeline's GPU, where it is one or --gles
 * asks for it. -1 and a sentence: there is no display, or no OpenGL ES 3. */
int view_open(view **v, const view_of *of, const pupil_image_const *first, pupil_why *why);

/* frame_pipeline_close comes first. NULL is allowed. */
void view_close(view *v);

/* The frame that the pipeline has just mapped, and its entry: shown when its time has come, and as long as the viewer
 * pauses. VIEW_QUIT: the viewer, or Ctrl-C, has ended it. */
int view_frame(view *v, const pupil_frame *frame, const frame_log_entry *entry);

/* The last frame stays until the viewer ends it. */
void view_stay(view *v);

#endif
