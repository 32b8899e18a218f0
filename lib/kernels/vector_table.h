/* lib/kernels/vector_table.h: the kernels of a level with vectors, and the entries of its table. The level has defined
 * its formats before (vector_formats.h): rgba32f, rgb32f, rgba16f, rgba16, rgb16, rgb16f. */
#ifndef PUPIL_KERNELS_VECTOR_TABLE_H
#define PUPIL_KERNELS_VECTOR_TABLE_H

#include "bloom_loops.h"
#include "pixels_to_linear.h"
#include "vector_bloom.h"
#include "vector_formats.h"
#include "vector_knots.h"
#include "vector_luma.h"
#include "veil_loops.h"

/* A format's kernels. They are functions of their own so that the format is a constant in each. The parts that are not
 * inlined have registers of their own. */
#define FORMAT_LOAD(FORMAT)                                                                                            \
    static int load_##FORMAT(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n,                   \
                             pupil_planes *planes)                                                                     \
    {                                                                                                                  \
        (void)coder;                                                                                                   \
        return load_groups(&FORMAT, row->data + x * FORMAT.bytes, n, planes);                                          \
    }

#define FORMAT_KERNELS(FORMAT)                                                                                         \
    FORMAT_LOAD(FORMAT)                                                                                                \
    static __attribute__((noinline)) void hard_##FORMAT(const pupil_row_job *job, const uint8_t *source, size_t i,     \
                                                        size_t n, pupil_run *run)                                      \
    {                                                                                                                  \
        meter_groups_hard(&FORMAT, job, source, i, n, run);                                                            \
    }                                                                                                                  \
    static void meter_##FORMAT(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,   \
                               pupil_run *run)                                                                         \
    {                                                                                                                  \
        (void)planes;                                                                                                  \
        meter_groups(&FORMAT, hard_##FORMAT, job, source, n, run);                                                     \
    }                                                                                                                  \
    static __attribute__((noinline)) int fused_##FORMAT(const pupil_row_job *job, const void *source, uint32_t n,      \
                                                        pupil_planes *planes, pupil_run *run)                          \
    {                                                                                                                  \
        kept keep;                                                                                                     \
        const int opaque = scale_groups(&FORMAT, job, source, n, planes, &keep);                                       \
        meter_kept(hard_##FORMAT, job, source, n, &keep, run);                                                         \
        return opaque;                                                                                                 \
    }                                                                                                                  \
    static int scale_##FORMAT(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,          \
                              pupil_run *run)                                                                          \
    {                                                                                                                  \
        return run ? fused_##FORMAT(job, source, n, planes, run) : scale_groups(&FORMAT, job, source, n, planes, 0);   \
    }

FORMAT_KERNELS(rgba32f)
FORMAT_KERNELS(rgb32f)
FORMAT_KERNELS(rgba16f)
FORMAT_KERNELS(rgba16)
FORMAT_KERNELS(rgb16)

/* Less usual ones go through planes: a third of the code. */
INLINE void load_blue_first(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    rgb32f.vector(source, b, g, r, a);
}

static const format bgr32f = {.bytes = 12, .vector = load_blue_first};
FORMAT_LOAD(bgr32f)
FORMAT_LOAD(rgb16f)

static __attribute__((noinline)) void hard_planes(const pupil_row_job *job, const uint8_t *source, size_t i, size_t n,
                                                  pupil_run *run)
{
    meter_groups_hard(&in_planes, job, source, i, n, run);
}

static void meter_planes(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,
                         pupil_run *run)
{
    (void)source;
    meter_groups(&in_planes, hard_planes, job, (const uint8_t *)planes, n, run);
}

static __attribute__((noinline)) int fused_planes(const pupil_row_job *job, uint32_t n, pupil_planes *planes,
                                                  pupil_run *run)
{
    meter_and_scale_planes(hard_planes, job, n, planes, run);
    return 0;
}

static int scale_planes(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, pupil_run *run)
{
    (void)source;
    return run ? fused_planes(job, n, planes, run)
               : scale_groups(&in_planes, job, (const uint8_t *)planes, n, planes, 0);
}

static int scale_by_knots(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,
                          pupil_run *run)
{
    if (run)
        meter_planes(job, source, planes, n, run);
    scale_planes_by_knots(job, n, planes);
    return 0;
}

static void store_rgba8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->r, p->g, p->b, n, e, target, 4);
}

static void store_bgrx8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->b, p->g, p->r, n, e, target, 4);
}

static void store_rgb8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->r, p->g, p->b, n, e, target, 3);
}

static void store_bgr8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->b, p->g, p->r, n, e, target, 3);
}

#define VECTOR_PIECES                                                                                                  \
    .load =                                                                                                            \
        {                                                                                                              \
            [PUPIL_PIXEL_RGBA32F] = load_rgba32f, [PUPIL_PIXEL_RGB32F] = load_rgb32f,                                  \
            [PUPIL_PIXEL_RGBA16F] = load_rgba16f, [PUPIL_PIXEL_RGBA16] = load_rgba16,                                  \
            [PUPIL_PIXEL_RGB16] = load_rgb16,     [PUPIL_PIXEL_BGR32F] = load_bgr32f,                                  \
            [PUPIL_PIXEL_RGB16F] = load_rgb16f,   LOADS_BY_FORMAT,                                                     \
    },                                                                                                                 \
    .meter =                                                                                                           \
        {                                                                                                              \
            [PUPIL_PLANES] = meter_planes,       [PUPIL_PIXEL_RGBA32F] = meter_rgba32f,                                \
            [PUPIL_PIXEL_RGB32F] = meter_rgb32f, [PUPIL_PIXEL_RGBA16F] = meter_rgba16f,                                \
            [PUPIL_PIXEL_RGBA16] = meter_rgba16, [PUPIL_PIXEL_RGB16] = meter_rgb16,                                    \
    },                                                                                                                 \
    .scale =                                                                                                           \
        {                                                                                                              \
            [PUPIL_PLANES] = scale_planes,       [PUPIL_PIXEL_RGBA32F] = scale_rgba32f,                                \
            [PUPIL_PIXEL_RGB32F] = scale_rgb32f, [PUPIL_PIXEL_RGBA16F] = scale_rgba16f,                                \
            [PUPIL_PIXEL_RGBA16] = scale_rgba16, [PUPIL_PIXEL_RGB16] = scale_rgb16,                                    \
    },                                                                                                                 \
    .scale_by_knots = scale_by_knots, .histogram = histogram, .dither = dither,                                        \
    .store =                                                                                                           \
        {                                                                                                              \
            [PUPIL_PIXEL_RGBA8] = store_rgba8,                                                                         \
            [PUPIL_PIXEL_RGB8] = store_rgb8,                                                                           \
            [PUPIL_PIXEL_BGRX8] = store_bgrx8,                                                                         \
            [PUPIL_PIXEL_BGR8] = store_bgr8,                                                                           \
            STORES_OF_LIGHT,                                                                                           \
    },                                                                                                                 \
    CAMERA_PIECES, VEIL_PIECES, BLOOM_PIECES, LUMA_PIECES, .bloom_light_rgba32f = bloom_light_rgba32f

#endif
