/* apps/output/frame_log_fill.h: what became of a frame, as an entry of the log. */
#ifndef PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H
#define PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H

#include "frame/pipeline.h"
#include "frame_log.h"

/* After the pipeline has mapped the frame. `with_figures`: the figures of the display picture, too. The frame's number
 * and how long things took are left at 0. */
frame_log_entry frame_log_fill(const frame_pipeline *p, const pupil_frame *frame, int with_figures);

/* The log-average that the display would have of the last frame if its light had a scaled log-average of `key`, through
 * the frame's own curve. Without a histogram: as if all of the light were at the log-average. */
double frame_log_aimed_level(const frame_pipeline *p, double key);

#endif
