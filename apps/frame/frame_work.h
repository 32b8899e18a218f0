/* apps/frame/frame_work.h: one frame through meter -> adapt -> map on several threads, with the bits of one. */
#ifndef PUPIL_APPS_FRAME_FRAME_WORK_H
#define PUPIL_APPS_FRAME_FRAME_WORK_H

#include "pupil/pupil.h"
#include "workers.h"

typedef struct frame_work frame_work;

/* NULL where memory is short. The workers stay the caller's. */
frame_work *frame_work_open(workers *w);
void frame_work_close(frame_work *f);

/* From now on rows are mapped with these gains, one of each row of the frame (pupil/row_gain.h), unless in the pass
 * that meters them, too; NULL: with none. */
void frame_work_gain(frame_work *f, const float *gain);

/* What pupil_process does, in the order `fused` says; leaves the frame's statistics and the curve that mapped it. */
int frame_work_process(frame_work *f, pupil_t *pupil, int fused, const pupil_image_const *in,
                       const pupil_frame_info *info, const pupil_image *out, pupil_stats *stats, pupil_curve *curve);

/* Meters and adapts alone. */
int frame_work_meter(frame_work *f, pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info,
                     pupil_stats *stats);

/* Maps alone. */
int frame_work_map(frame_work *f, const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *in,
                   const pupil_image *out);

#endif
