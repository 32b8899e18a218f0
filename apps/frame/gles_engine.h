/* apps/frame/gles_engine.h: the pixels of a frame on the GPU.
 *
 * A replay must not depend on how fast the GPU is, so metering waits for the frame's statistics. A frame is then mapped
 * by its own light (or, fused, by that of the frame before), as on the CPU.
 *
 * Errors: -1 and a sentence. The GPU cannot be used any more: gles_engine_close.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_FRAME_GLES_ENGINE_H
#define PUPIL_APPS_FRAME_GLES_ENGINE_H

#include "engine.h"
#include "pupil/gles.h"
#include "pupil/veil.h"

typedef struct gles_engine gles_engine;

/* In the current context, whose functions get_proc finds; NULL: in a new context without a window. `version` is a
 * pupil_gles_version. */
int gles_engine_open(gles_engine **g, const pupil_config *config, uint32_t version, pupil_gles_get_proc get_proc,
                     pupil_why *why);
void gles_engine_close(gles_engine *g); /* NULL is allowed */

/* From now on frames are mapped with a veil, which gles_engine_set_veil sets between metering and mapping each
 * frame. */
void gles_engine_use_veil(gles_engine *g);
int gles_engine_set_veil(gles_engine *g, const pupil_veil *veil, pupil_why *why);

extern const frame_engine_ops gles_engine_ops; /* self: a gles_engine. RGB8 images may have any size */

/* Maps the frame that was metered last to a target of GL. */
int gles_engine_draw(gles_engine *g, const pupil_curve *curve, const pupil_gles_target *target, pupil_why *why);

/* New settings for `pupil` and the GPU. */
int gles_engine_retune(gles_engine *g, pupil_t *pupil, const pupil_config *config, pupil_why *why);

/* "llvmpipe (...), OpenGL ES 3.2 ..., metering as in ES 3.1", once a frame was metered; and whether a camera's frames
 * are read without a copy. */
void gles_engine_describe(const gles_engine *g, char *text, size_t text_bytes);

#endif
