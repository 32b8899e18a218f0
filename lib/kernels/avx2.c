/* The AVX2 level. Compiled for it whatever the build's flags say: level.c sees to it that no other CPU comes here. */
#if defined(__x86_64__)

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,f16c,popcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,fma,f16c,popcnt")
#endif

#include "avx2.h"
#include "loads.h"
#include "vector_formats.h"
#include "vector_store.h"

GROUP_OF_VECTORS(rgba32f, load8_rgba32f, 16)
GROUP_OF_VECTORS(rgb32f, load8_rgb32f, 12)
GROUP_OF_VECTORS(rgb16, load8_rgb16, 6)

INLINE void group_rgba16f(const uint8_t *source, group *p)
{
    load16_rgba16f(source, p->r, p->g, p->b, &p->opaque);
    p->top = top_of(p->r, p->g, p->b);
}

INLINE void group_rgba16(const uint8_t *source, group *p)
{
    load16_rgba16(source, p->r, p->g, p->b, &p->opaque);
    p->top = top_of(p->r, p->g, p->b);
}

ORDINARY_VECTORS(rgba32f, load8_rgba32f, 16)
ORDINARY_VECTORS(rgb32f, load8_rgb32f, 12)
ORDINARY_GROUP(rgba16f)
ORDINARY_GROUP(rgba16)
ORDINARY_VECTORS(rgb16, load8_rgb16, 6)

FORMAT_KERNELS(rgba32f, 16)
FORMAT_KERNELS(rgb32f, 12)
FORMAT_KERNELS(rgba16f, 8)
FORMAT_KERNELS(rgba16, 8)
FORMAT_KERNELS(rgb16, 6)

#if defined(__clang__)
#pragma clang attribute pop
#endif

const pupil_kernels pupil_kernels_avx2 = {
    .load =
        {
            [PUPIL_PIXEL_RGBA32F] = load_rgba32f,
            [PUPIL_PIXEL_RGB32F] = load_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = load_rgba16f,
            [PUPIL_PIXEL_RGBA16] = load_rgba16,
            [PUPIL_PIXEL_RGB16] = load_rgb16,
            LOADS_BY_FORMAT,
        },
    CAMERA_PIECES,
    .meter =
        {
            [PUPIL_PLANES] = meter_planes,
            [PUPIL_PIXEL_RGBA32F] = meter_rgba32f,
            [PUPIL_PIXEL_RGB32F] = meter_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = meter_rgba16f,
            [PUPIL_PIXEL_RGBA16] = meter_rgba16,
            [PUPIL_PIXEL_RGB16] = meter_rgb16,
        },
    .scale =
        {
            [PUPIL_PLANES] = scale_planes,
            [PUPIL_PIXEL_RGBA32F] = scale_rgba32f,
            [PUPIL_PIXEL_RGB32F] = scale_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = scale_rgba16f,
            [PUPIL_PIXEL_RGBA16] = scale_rgba16,
            [PUPIL_PIXEL_RGB16] = scale_rgb16,
        },
    .histogram = histogram,
    .store =
        {
            [PUPIL_PIXEL_RGBA8] = store_rgba8,
            [PUPIL_PIXEL_RGB8] = store_rgb8,
            [PUPIL_PIXEL_BGRX8] = store_bgrx8,
        },
};

#else
typedef int pupil_no_avx2; /* a file of C needs something */
#endif
