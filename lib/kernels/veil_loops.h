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

static void veil_gather(const pupil_planes *planes, const pupil_veil_ramp *run, uint32_t count, pupil_veil_sums *sums)
{
    for (uint32_t c = 0, at = 0; c < count; at += run[c].n, c++) {
        veil_gather_channel(planes->r + at, run[c].n, &sums[c].sum[0], &sums[c].moment[0]);
        veil_gather_channel(planes->g + at, run[c].n, &sums[c].sum[1], &sums[c].moment[1]);
        veil_gather_channel(planes->b + at, run[c].n, &sums[c].sum[2], &sums[c].moment[2]);
    }
}

/* Two pixels are one vector; four at a time, so that none waits for the one before. */
static inline void veil_add_run(const float *source, const pupil_veil_ramp *run, float direct, float *rgba)
{
    const float b0 = run->base[0], b1 = run->base[1], b2 = run->base[2];
    const float s0 = run->step[0], s1 = run->step[1], s2 = run->step[2];
    const veil_lanes by = {direct, direct, direct, 1.0f, direct, direct, direct, 1.0f};
    const veil_lanes base = {b0, b1, b2, 0.0f, b0, b1, b2, 0.0f}, step = {s0, s1, s2, 0.0f, s0, s1, s2, 0.0f};
    veil_lanes at[2] = {{0, 0, 0, 0, 1, 1, 1, 1}, {2, 2, 2, 2, 3, 3, 3, 3}}, light[2];
    uint32_t i = 0;
    for (; i + 4 <= run->n; i += 4) {
        __builtin_memcpy(light, source + (size_t)4 * i, sizeof light);
        for (int k = 0; k < 2; k++) {
            light[k] = by * light[k] + (base + step * at[k]);
            at[k] += 4.0f;
        }
        __builtin_memcpy(rgba + (size_t)4 * i, light, sizeof light);
    }
    for (; i < run->n; i++)
        for (uint32_t c = 0; c < 4; c++) /* alpha: times 1 */
            rgba[4 * i + c] = c == 3 ? source[4 * i + c]
                                     : direct * source[4 * i + c] + (run->base[c] + run->step[c] * (float)(int32_t)i);
}

static void veil_add(const float *source, const pupil_veil_ramp *run, uint32_t count, float direct, float *rgba)
{
    for (uint32_t c = 0; c < count; c++) {
        veil_add_run(source, &run[c], direct, rgba);
        source += (size_t)4 * run[c].n;
        rgba += (size_t)4 * run[c].n;
    }
}

#define VEIL_PIECES .veil_gather = veil_gather, .veil_add = veil_add

#endif
