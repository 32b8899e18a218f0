/* apps/output/frame_log_fill.h: what became of a frame, as a record. */
#ifndef PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H
#define PUPIL_APPS_OUTPUT_FRAME_LOG_FILL_H

#include "frame_log.h"
#include "pupil/pupil.h"
#include "source.h"

/* After the frame was adapted to under `config` and mapped with `curve` to `display`; NULL: nobody asks for figures of
 * the picture. The frame's number and how long things took are left at 0. */
frame_log_entry frame_log_fill(const pupil_t *pupil, const pupil_config *config, const pupil_stats *stats,
                               const pupil_curve *curve, const pupil_frame *frame, const pupil_image_const *display);

#endif
