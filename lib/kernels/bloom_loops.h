/* lib/kernels/bloom_loops.h: what a bloom does with rows (pupil/bloom.h). Plain loops, compiled for each level; eight
 * lanes, which the compiler splits where its registers are shorter. */
#ifndef PUPIL_KERNELS_BLOOM_LOOPS_H
#define PUPIL_KERNELS_BLOOM_LOOPS_H

#include "kernels.h"

enum { BLOOM_LANES = 8 };
typedef float bloom_lanes __attribute__((vector_size(4 * BLOOM_LANES)));
/* Unaligned: anywhere in a row. */
typedef float bloom_loose __attribute__((vector_size(4 * BLOOM_LANES), aligned(4), may_alias));
typedef int32_t bloom_places __attribute__((vector_size(4 * BLOOM_LANES)));

/* A function of its own: inlined, the compiler would forget that its pointers do not alias. */
static __attribute__((noinline)) void bloom_above(uint32_t n, float threshold, float *restrict r, float *restrict g,
                                                  float *restrict b)
{
    for (uint32_t i = 0; i < n; i++) {
        const float rg = r[i] > g[i] ? r[i] : g[i], most = rg > b[i] ? rg : b[i];
        const float share = most > threshold ? (most - threshold) / most : 0.0f;
        r[i] *= share;
        g[i] *= share;
        b[i] *= share;
    }
}

/* Whether any lane is set. */
static inline __attribute__((always_inline)) uint32_t bloom_some(const bloom_places *set)
{
    int32_t any = 0;
    for (int k = 0; k < BLOOM_LANES; k++)
        any |= (*set)[k];
    return any != 0;
}

static inline __attribute__((always_inline)) void bloom_eight_pixels(const float *v, float threshold, bloom_places *any)
{
    const bloom_loose *of = (const bloom_loose *)(const void *)v;
    *any |= ((of[0] > threshold) | (of[1] > threshold)) | ((of[2] > threshold) | (of[3] > threshold));
}

/* Of pixels of four floats. Almost all are dark: so 32 are tested at once, and eight only if one of these is not. */
static uint32_t bloom_lamps_rgba32f(const void *source, uint32_t n, float threshold)
{
    enum { MANY = 32, EIGHT = 8 };
    static const bloom_places colours = {-1, -1, -1, 0, -1, -1, -1, 0};
    const float *v = source;
    uint32_t lamps = 0, i = 0;
    for (; i + MANY <= n; i += MANY) {
        bloom_places any = {0};
        for (uint32_t k = i; k < i + MANY; k += EIGHT)
            bloom_eight_pixels(v + 4 * (size_t)k, threshold, &any);
        any &= colours;
        for (uint32_t k = i; k < i + MANY && bloom_some(&any); k += EIGHT) {
            bloom_places eight = {0};
            bloom_eight_pixels(v + 4 * (size_t)k, threshold, &eight);
            eight &= colours;
            lamps |= bloom_some(&eight) << k / EIGHT;
        }
    }
    for (v += 4 * (size_t)i; i < n; i++, v += 4)
        lamps |= (uint32_t)(v[0] > threshold || v[1] > threshold || v[2] > threshold) << i / EIGHT;
    return lamps;
}

static uint32_t bloom_lamps(const pupil_planes *planes, uint32_t n, float threshold)
{
    const float *r = planes->r, *g = planes->g, *b = planes->b;
    uint32_t lamps = 0, i = 0;
    for (; i + BLOOM_LANES <= n; i += BLOOM_LANES) {
        bloom_lanes light[3];
        __builtin_memcpy(&light[0], r + i, sizeof light[0]);
        __builtin_memcpy(&light[1], g + i, sizeof light[1]);
        __builtin_memcpy(&light[2], b + i, sizeof light[2]);
        const bloom_places any = (light[0] > threshold) | (light[1] > threshold) | (light[2] > threshold);
        lamps |= bloom_some(&any) << i / BLOOM_LANES;
    }
    for (; i < n; i++)
        lamps |= (uint32_t)(r[i] > threshold || g[i] > threshold || b[i] > threshold) << i / BLOOM_LANES;
    return lamps;
}

#define BLOOM_PIECES                                                                                                   \
    .bloom_scatter = bloom_scatter, .bloom_halve = bloom_halve, .bloom_widen = bloom_widen,                            \
    .bloom_bright = bloom_bright, .bloom_lamps_rgba32f = bloom_lamps_rgba32f, .bloom_lamps = bloom_lamps

#endif
