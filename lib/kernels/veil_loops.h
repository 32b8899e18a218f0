/* lib/kernels/veil_loops.h: what the veil does with each pixel (pupil/veil.h). Plain loops, compiled for each level;
 * eight fixed lanes, so that the bits are the same. */
#ifndef PUPIL_KERNELS_VEIL_LOOPS_H
#define PUPIL_KERNELS_VEIL_LOOPS_H

#include "kernels.h"

#if defined(__AVX__)
#include <immintrin.h>
#endif

enum { VEIL_LANES = 8 };

/* Of GCC and clang, on any CPU; the compiler splits them where its registers are shorter. */
typedef float veil_lanes __attribute__((vector_size(4 * VEIL_LANES)));
typedef int32_t veil_masks __attribute__((vector_size(4 * VEIL_LANES)));
typedef float veil_pixel __attribute__((vector_size(16)));

/* 0 where it is negative or NaN, and at most PUPIL_CEILING. */
static inline void veil_bound(veil_lanes *v)
{
    const veil_lanes ceiling = {PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING,
                                PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING};
    const veil_lanes positive = (veil_lanes)((veil_masks)*v & (*v > 0.0f));
#if defined(__AVX__)
    *v = (veil_lanes)_mm256_min_ps((__m256)positive, (__m256)ceiling);
#else
    const veil_masks below = positive < ceiling;
    *v = (veil_lanes)(((veil_masks)positive & below) | ((veil_masks)ceiling & ~below));
#endif
}

static inline float veil_sum(const veil_lanes *lane)
{
    veil_pixel half[2];
    __builtin_memcpy(half, lane, sizeof half);
    half[0] += half[1];
    return (half[0][0] + half[0][2]) + (half[0][1] + half[0][3]);
}

/* Of a channel: the light, and that times its place. */
typedef struct veil_pair {
    veil_lanes sum, moment;
} veil_pair;

static inline void veil_add(const float *v, const veil_lanes *at, veil_pair *to)
{
    veil_lanes light;
    __builtin_memcpy(&light, v, sizeof light);
    veil_bound(&light);
    to->sum += light;
    to->moment += light * *at;
}

static inline void veil_add_some(const float *v, const veil_lanes *at, const veil_masks *some, veil_pair *to)
{
    veil_lanes light;
    __builtin_memcpy(&light, v, sizeof light);
    veil_bound(&light);
    light = (veil_lanes)((veil_masks)light & *some);
    to->sum += light;
    to->moment += light * *at;
}

/* Of n pixels. Lanes beyond n are read, and count as 0. */
static inline void veil_gather_run(const float *r, const float *g, const float *b, uint32_t n, pupil_veil_sums *to)
{
    veil_pair red = {{0}, {0}}, green = {{0}, {0}}, blue = {{0}, {0}};
    veil_lanes at = {0, 1, 2, 3, 4, 5, 6, 7};
    uint32_t i = 0;
    for (; i + VEIL_LANES <= n; i += VEIL_LANES) {
        veil_add(r + i, &at, &red);
        veil_add(g + i, &at, &green);
        veil_add(b + i, &at, &blue);
        at += (float)VEIL_LANES;
    }
    if (i < n) {
        const veil_masks some = at < (float)(int32_t)n;
        veil_add_some(r + i, &at, &some, &red);
        veil_add_some(g + i, &at, &some, &green);
        veil_add_some(b + i, &at, &some, &blue);
    }
    *to = (pupil_veil_sums){.sum = {veil_sum(&red.sum), veil_sum(&green.sum), veil_sum(&blue.sum)},
                            .moment = {veil_sum(&red.moment), veil_sum(&green.moment), veil_sum(&blue.moment)}};
}

static void veil_gather(const pupil_planes *planes, const uint32_t *n, uint32_t count, pupil_veil_sums *sums)
{
    for (uint32_t c = 0, at = 0; c < count; at += n[c], c++)
        veil_gather_run(planes->r + at, planes->g + at, planes->b + at, n[c], &sums[c]);
}

static inline void scatter_channel(float *restrict v, uint32_t n, float direct, const float *restrict from,
                                   const float *restrict more, float part)
{
    for (uint32_t i = 0; i < n; i++)
        v[i] = direct * v[i] + (from[i] + part * more[i]);
}

static void scatter(pupil_planes *planes, uint32_t n, float direct, const pupil_scattered *s, float part)
{
    n = (n + 15) / 16 * 16; /* planes have room */
    scatter_channel(planes->r, n, direct, s->from[0], s->more[0], part);
    scatter_channel(planes->g, n, direct, s->from[1], s->more[1], part);
    scatter_channel(planes->b, n, direct, s->from[2], s->more[2], part);
}

#define VEIL_PIECES .veil_gather = veil_gather, .scatter = scatter

#endif
