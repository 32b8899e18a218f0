/* apps/view/view.h: the window of --view: the result at the source's pace, keys, a plot of the level.
 *
 * If reading or mapping takes longer than the frame period, frames come late: all are metered, but some are not shown.
 * Every frame's level is the same as without a window.
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

/* What is viewed; the caller keeps it. Keys change options->config, and retune the pipeline. */
typedef struct view_of {
    frame_options *options;
    frame_pipeline *pipeline;
    double fps;
    int live; /* frames are shown at once, and continue while the viewer pauses */
} view_of;

enum { VIEW_ON = 0, VIEW_QUIT = 1 };

/* A window for pictures of the first frame's shape; the pipeline's GPU uses its context, if that is of a GPU or --gles
 * asks for it. -1 and a sentence: there is no display, or no OpenGL ES 3. */
int view_open(view **v, const view_of *of, const pupil_image_const *first, pupil_why *why);

/* frame_pipeline_close comes first. NULL is allowed. */
void view_close(view *v);

/* Shows the frame that the pipeline has just mapped when its time has come, and as long as the viewer pauses.
 * VIEW_QUIT: the viewer, or Ctrl-C, has ended the run. */
int view_frame(view *v, const pupil_frame *frame, const frame_log_entry *entry);

/* Shows the last frame until the viewer quits. */
void view_stay(view *v);

#endif
