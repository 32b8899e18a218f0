/* lib/kernels/vector_table.h: the kernels of a level with vectors, and the entries of its table. The level has defined
 * its formats before (vector_formats.h): rgba32f, rgb32f, rgba16f, rgba16, rgb16, rgb16f. */
#ifndef PUPIL_KERNELS_VECTOR_TABLE_H
#define PUPIL_KERNELS_VECTOR_TABLE_H

#include "bloom_loops.h"
#include "pixels_to_linear.h"
#include "vector_bins.h"
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
    static __attribute__((noinline))                                                                                   \
    size_t hard_##FORMAT(const pupil_row_job *job, const uint8_t *source, size_t i, size_t n, pupil_run *run)          \
    {                                                                                                                  \
        return meter_groups_hard(&FORMAT, job, source, i, n, run);                                                     \
    }                                                                                                                  \
    static __attribute__((noinline)) size_t hard_scale_##FORMAT(                                                       \
        const pupil_row_job *job, const uint8_t *source, size_t i, size_t n, pupil_planes *planes, scaled_block *to)   \
    {                                                                                                                  \
        return scale_groups_hard(&FORMAT, job, source, i, n, planes, to);                                              \
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
        const int opaque = scale_groups(&FORMAT, hard_scale_##FORMAT, job, source, n, planes, &keep);                  \
        meter_kept(hard_##FORMAT, job, source, n, &keep, run);                                                         \
        return opaque;                                                                                                 \
    }                                                                                                                  \
    static int scale_##FORMAT(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,          \
                              pupil_run *run)                                                                          \
    {                                                                                                                  \
        return run ? fused_##FORMAT(job, source, n, planes, run)                                                       \
                   : scale_groups(&FORMAT, hard_scale_##FORMAT, job, source, n, planes, 0);                            \
    }

FORMAT_KERNELS(rgba32f)
FORMAT_KERNELS(rgb32f)
FORMAT_KERNELS(rgba16f)
FORMAT_KERNELS(rgba16)
FORMAT_KERNELS(rgb16)

/* Less usual formats go through planes, which takes a third of the code. */
INLINE void load_blue_first(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    rgb32f.vector(source, b, g, r, a);
}

static const format bgr32f = {.bytes = 12, .vector = load_blue_first};
FORMAT_LOAD(bgr32f)
FORMAT_LOAD(rgb16f)

static __attribute__((noinline)) size_t hard_planes(const pupil_row_job *job, const uint8_t *source, size_t i, size_t n,
                                                    pupil_run *run)
{
    return meter_groups_hard(&in_planes, job, source, i, n, run);
}

static __attribute__((noinline)) size_t hard_scale_planes(const pupil_row_job *job, const uint8_t *source, size_t i,
                                                          size_t n, pupil_planes *planes, scaled_block *to)
{
    return scale_groups_hard(&in_planes, job, source, i, n, planes, to);
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
    if (run)
        return fused_planes(job, n, planes, run);
    if (WIDTH == 4) /* an ARM board's CPU has little room for instructions in flight, and would load twice */
        return scale_groups(&in_planes, hard_scale_planes, job, (const uint8_t *)planes, n, planes, 0);
    scale_all_planes(hard_scale_planes, job, n, planes);
    return 0;
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
    store_vectors(p, p->r, p->g, p->b, n, e, target, 4);
}

static void store_bgrx8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p, p->b, p->g, p->r, n, e, target, 4);
}

static void store_rgb8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p, p->r, p->g, p->b, n, e, target, 3);
}

static void store_bgr8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p, p->b, p->g, p->r, n, e, target, 3);
}

/* scalar.c's alpha_of_float in the fourth bytes of WIDTH pixels. */
INLINE void put_alpha(const void *source, void *rgba)
{
    floats r, g, b, a;
    rgba32f.vector(source, &r, &g, &b, &a);
    const floats alpha = v_min(v_where(v_at_least(a, v_all(0x1p-10f)), a), v_all(1.0f));
    const ints code = v_to_ints(v_add(v_mul(alpha, v_all(255.0f)), v_all(0.5f)));
    v_store_ints(rgba, v_or(v_and(v_load_ints(rgba), v_all_ints(0x00ffffff)), v_left(code, 24)));
}

static void alpha_rgba32f(const void *source, uint32_t n, uint8_t *rgba)
{
    const uint8_t *from = source;
    size_t i = 0;
    for (; i + WIDTH <= n; i += WIDTH)
        put_alpha(from + 16 * i, rgba + 4 * i);
    if (i < n) {
        uint8_t rest[16 * WIDTH] = {0}, to[4 * WIDTH] = {0};
        __builtin_memcpy(rest, from + 16 * i, 16 * (n - i));
        __builtin_memcpy(to, rgba + 4 * i, 4 * (n - i));
        put_alpha(rest, to);
        __builtin_memcpy(rgba + 4 * i, to, 4 * (n - i));
    }
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
    .alpha = {[PUPIL_PIXEL_RGBA32F] = alpha_rgba32f}, CAMERA_PIECES, VEIL_PIECES, BLOOM_PIECES, LUMA_PIECES,           \
    .bloom_light_rgba32f = bloom_light_rgba32f

#endif
