/* apps/output/frame_log_fill.h: the log entry of a mapped frame. */
#ifndef PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H
#define PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H

#include "frame/pipeline.h"
#include "frame_log.h"

/* After the pipeline has mapped the frame. `with_figures`: the figures of the display picture, too. The frame's number
 * and the durations are left at 0. */
frame_log_entry frame_log_fill(const frame_pipeline *p, const pupil_frame *frame, int with_figures);

/* The display's log-average if the last frame's light had a scaled log-average of `key` and were mapped by the frame's
 * own curve. Without a histogram: as if all light were at the log-average. */
double frame_log_aimed_level(const frame_pipeline *p, double key);

#endif
