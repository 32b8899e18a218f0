/* lib/kernels/veil_loops.h: what the veil does with each pixel (pupil/veil.h). Plain loops, compiled for each level;
 * eight fixed lanes, so that the bits are the same. */
#ifndef PUPIL_KERNELS_VEIL_LOOPS_H
#define PUPIL_KERNELS_VEIL_LOOPS_H

#include "kernels.h"

enum { VEIL_LANES = 8 };

/* Of GCC and clang, on any CPU; the compiler splits them where its registers are shorter. */
typedef float veil_lanes __attribute__((vector_size(4 * VEIL_LANES)));
typedef int32_t veil_masks __attribute__((vector_size(4 * VEIL_LANES)));
typedef float veil_pixel __attribute__((vector_size(16)));

/* 0 where it is negative or NaN, and at most PUPIL_CEILING. */
#define VEIL_BOUND(v)                                                                                                  \
    do {                                                                                                               \
        const veil_lanes ceiling_ = {PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING,                       \
                                     PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING};                      \
        (v) = (veil_lanes)((veil_masks)(v) & ((v) > 0.0f));                                                            \
        const veil_masks below_ = (v) < ceiling_;                                                                      \
        (v) = (veil_lanes)(((veil_masks)(v)&below_) | ((veil_masks)ceiling_ & ~below_));                               \
    } while (0)

static inline float veil_sum(const veil_lanes *lane)
{
    veil_pixel half[2];
    __builtin_memcpy(half, lane, sizeof half);
    half[0] += half[1];
    return (half[0][0] + half[0][2]) + (half[0][1] + half[0][3]);
}

/* Of v[0] to v[n - 1]: the sum, and the sum of each times its index. Lanes beyond n are read, and count as 0. */
static inline void veil_gather_channel(const float *v, uint32_t n, float *sum, float *moment)
{
    veil_lanes sums = {0}, moments = {0}, at = {0, 1, 2, 3, 4, 5, 6, 7}, light;
    uint32_t i = 0;
    for (; i + VEIL_LANES <= n; i += VEIL_LANES) {
        __builtin_memcpy(&light, v + i, sizeof light);
        VEIL_BOUND(light);
        sums += light;
        moments += light * at;
        at += (float)VEIL_LANES;
    }
    if (i < n) {
        __builtin_memcpy(&light, v + i, sizeof light);
        VEIL_BOUND(light);
        light = (veil_lanes)((veil_masks)light & (at < (float)(int32_t)n));
        sums += light;
        moments += light * at;
    }
    *sum = veil_sum(&sums);
    *moment = veil_sum(&moments);
}

static void veil_gather(const pupil_planes *planes, const uint32_t *n, uint32_t count, pupil_veil_sums *sums)
{
    for (uint32_t c = 0, at = 0; c < count; at += n[c], c++) {
        veil_gather_channel(planes->r + at, n[c], &sums[c].sum[0], &sums[c].moment[0]);
        veil_gather_channel(planes->g + at, n[c], &sums[c].sum[1], &sums[c].moment[1]);
        veil_gather_channel(planes->b + at, n[c], &sums[c].sum[2], &sums[c].moment[2]);
    }
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
