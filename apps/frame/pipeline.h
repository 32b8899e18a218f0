/* apps/frame/pipeline.h: one frame at a time through meter -> adapt -> map, by the CPU's threads, or by the GPU until
 * it fails, after which the CPU continues from the same adapted level.
 *
 *     frame_pipeline_meter -> (the caller may replace the curve) -> frame_pipeline_map
 *
 * The curve that maps a frame is always in `curve`.
 *
 * Threads: the one that opens it.
 */
#ifndef PUPIL_APPS_FRAME_PIPELINE_H
#define PUPIL_APPS_FRAME_PIPELINE_H

#include "cpu_engine.h"
#include "gles_engine.h"

typedef struct frame_pipeline {
    pupil_t pupil;       /* the adapted level */
    pupil_config config; /* its settings: frame_pipeline_retune changes them */

    /* of the frame that was metered last */
    pupil_frame_info info;
    pupil_stats stats;
    int has_light;       /* that frame, or one before it, had light: the level is known */
    pupil_curve adapted; /* the curve for the level after that frame */
    pupil_curve curve;   /* that maps it: adapted, or (fused) that of the level before, or the caller's */
    pupil_image display; /* RGB8, tightly packed, after it was mapped */

    cpu_engine *cpu;
    gles_engine *gpu; /* NULL: frames are done by the CPU */
    int veil;         /* frames have one */
    int cpu_only;     /* frame_pipeline_use_gpu does nothing */
    double window[4]; /* of the frame that was metered last: source.h */
    int own_curve;    /* the caller replaces each frame's curve, so new settings do not change it */
    int is_mapped;    /* in the pass that metered it */
    uint64_t frames, gpu_frames;
    char gpu_name[512];
    pupil_why warning; /* why the CPU has taken over; emptied once the user has it */
    size_t display_bytes;
} frame_pipeline;

/* A configuration that pupil_config_check accepts. `threads`: 0: one for each processor. 0; -1: not enough memory.
 * Closing takes what a failed opening left. */
int frame_pipeline_open(frame_pipeline *p, const pupil_config *config, unsigned threads);
void frame_pipeline_close(frame_pipeline *p);

/* From now on frames have a veil; to be called before frame_pipeline_use_gpu. With `bloom_above` (NULL: without) also
 * the bloom of light above that, by the CPU. -1: not enough memory. */
int frame_pipeline_use_veil(frame_pipeline *p, const pupil_veil_config *config, const double *bloom_above);

/* Unless cpu_only is set, the GPU does the frames from now on, in the current context, whose functions get_proc finds,
 * or (NULL) in a context without a window. Without a GPU: a warning. `version` is a pupil_gles_version. */
void frame_pipeline_use_gpu(frame_pipeline *p, uint32_t version, pupil_gles_get_proc get_proc);

/* The settings from the next frame on; `adapted` follows them at once. */
void frame_pipeline_retune(frame_pipeline *p, const pupil_config *config);

/* Before the frame is metered, where frame_pipeline_meter does not do it: its window alone counts, as with --roi. */
void frame_pipeline_look_at(frame_pipeline *p, const pupil_frame *frame);

/* Meters the frame and adapts to it: stats, adapted and curve are this frame's. -1 and a sentence. */
int frame_pipeline_meter(frame_pipeline *p, const pupil_frame *frame, pupil_why *why);

/* Maps the frame that was metered last by `curve` to `display`, unless metering did so already (fused). The picture has
 * the frame's size if `whole` is set or the CPU makes it; else it is small, just enough for its figures. -1 and a
 * sentence. */
int frame_pipeline_map(frame_pipeline *p, const pupil_frame *frame, int whole, pupil_why *why);

/* The CPU maps the frame again, by another curve, to `display`. -1: it cannot. */
int frame_pipeline_map_again(frame_pipeline *p, const pupil_curve *curve, const pupil_frame *frame);

/* The GPU draws the frame that was metered last to a target of GL. -1: there is no GPU (any more). */
int frame_pipeline_draw(frame_pipeline *p, const pupil_curve *curve, const pupil_gles_target *target);

/* The GPU cannot continue: a warning, and the CPU takes over. */
void frame_pipeline_give_up_gpu(frame_pipeline *p, const pupil_why *why);

/* "; GPU: ..." or "; by the CPU". */
void frame_pipeline_describe(const frame_pipeline *p, char *text, size_t text_bytes);

#endif
