/* apps/frame/gles_work.h: one frame through meter -> adapt -> map on the GPU, beside frame_work.h, which is the CPU's.
 *
 * What is replayed must not depend on how fast the GPU is: a frame's statistics are waited for, so that it is mapped by
 * its own light (or, fused, by that of the frame before), as on the CPU.
 *
 * Errors: -1 and a sentence; the pupil_t is then as it was before the call, and the CPU can do the frame.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_FRAME_GLES_WORK_H
#define PUPIL_APPS_FRAME_GLES_WORK_H

#include <stddef.h>

#include "pupil/error.h"
#include "pupil/gles.h"

typedef struct gles_work gles_work;

/* In the current context, whose functions get_proc finds; NULL: in one of its own, without a window. `version` is a
 * pupil_gles_version. */
int gles_work_open(gles_work **g, const pupil_config *config, uint32_t version, pupil_gles_get_proc get_proc,
                   pupil_why *why);
void gles_work_close(gles_work *g);

/* Takes a frame in, meters it and adapts to it; leaves its statistics and the curve that it is to be mapped by. Frames
 * may change in size and format. */
int gles_work_process(gles_work *g, pupil_t *pupil, int fused, const pupil_image_const *in,
                      const pupil_frame_info *info, pupil_stats *stats, pupil_curve *curve, pupil_why *why);

/* Maps the frame that was processed last: to the caller's RGB8 image of any size, or to a target of GL. */
int gles_work_read(gles_work *g, const pupil_curve *curve, const pupil_image *rgb8, pupil_why *why);
int gles_work_draw(gles_work *g, const pupil_curve *curve, const pupil_gles_target *target, pupil_why *why);

/* New settings for `pupil` and the GPU. */
int gles_work_retune(gles_work *g, pupil_t *pupil, const pupil_config *config, pupil_why *why);

/* "llvmpipe (...), OpenGL ES 3.2 ..., metering as in ES 3.1", once a frame was processed. */
void gles_work_describe(const gles_work *g, char *text, size_t text_bytes);

#endif
