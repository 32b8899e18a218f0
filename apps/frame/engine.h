/* apps/frame/engine.h: the interface of the engines that process a frame's pixels: the CPU's threads (cpu_engine.h) or
 * the GPU (gles_engine.h). The pipeline (pipeline.h) decides what is done when, and by which curve. */
#ifndef PUPIL_APPS_FRAME_ENGINE_H
#define PUPIL_APPS_FRAME_ENGINE_H

#include "pupil/pupil.h"
#include "source.h"

/* Each returns 0, or -1 and a sentence. */
typedef struct frame_engine_ops {
    /* Writes the frame's statistics, with its code_light where it has one. The level stays as it is; an engine without
     * a histogram retunes `pupil`. */
    int (*meter)(void *self, pupil_t *pupil, const pupil_frame *frame, pupil_stats *stats, pupil_why *why);

    /* Maps the frame that was metered last to an RGB8 image. */
    int (*map)(void *self, const pupil_t *pupil, const pupil_curve *curve, const pupil_frame *frame,
               const pupil_image *rgb8, pupil_why *why);

    /* Both in one pass over the pixels. NULL: the engine needs two. */
    int (*meter_and_map)(void *self, const pupil_t *pupil, const pupil_curve *curve, const pupil_frame *frame,
                         const pupil_image *rgb8, pupil_stats *stats, pupil_why *why);
} frame_engine_ops;

#endif
