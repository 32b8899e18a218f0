/* lib/kernels/veil_loops.h: what the veil does with each pixel (pupil/veil.h). Plain loops, compiled for each level;
 * eight fixed lanes, so that the bits are the same. */
#ifndef PUPIL_KERNELS_VEIL_LOOPS_H
#define PUPIL_KERNELS_VEIL_LOOPS_H

#include "kernels.h"

enum { VEIL_LANES = 8 };

/* 0 where it is negative or NaN. */
static inline float veil_bounded(float v)
{
    v = v > 0.0f ? v : 0.0f;
    return v < PUPIL_CEILING ? v : PUPIL_CEILING;
}

static inline float veil_sum(const float lane[VEIL_LANES])
{
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/* Of v[0] to v[n - 1]: the sum, and the sum of each times its index. Lanes beyond n are read, and count as 0. */
static inline void veil_gather_channel(const float *restrict v, uint32_t n, float *sum, float *moment)
{
    float sums[VEIL_LANES] = {0}, moments[VEIL_LANES] = {0};
    for (uint32_t i = 0; i < n; i += VEIL_LANES)
        for (uint32_t j = 0; j < VEIL_LANES; j++) {
            const int32_t at = (int32_t)(i + j);
            const float light = veil_bounded(v[i + j]), here = at < (int32_t)n ? light : 0.0f;
            sums[j] += here;
            moments[j] += here * (float)at;
        }
    *sum = veil_sum(sums);
    *moment = veil_sum(moments);
}

static void veil_gather(const pupil_planes *planes, const pupil_veil_ramp *run, uint32_t count, pupil_veil_sums *sums)
{
    for (uint32_t c = 0, at = 0; c < count; at += run[c].n, c++) {
        veil_gather_channel(planes->r + at, run[c].n, &sums[c].sum[0], &sums[c].moment[0]);
        veil_gather_channel(planes->g + at, run[c].n, &sums[c].sum[1], &sums[c].moment[1]);
        veil_gather_channel(planes->b + at, run[c].n, &sums[c].sum[2], &sums[c].moment[2]);
    }
}

/* Whole groups of lanes: what is beyond a run the next one overwrites, and what is beyond the last has room. */
static inline void veil_ramp(const pupil_veil_ramp *run, uint32_t count, int channel, float *restrict to)
{
    for (uint32_t c = 0; c < count; to += run[c].n, c++)
        for (uint32_t i = 0; i < run[c].n; i += VEIL_LANES)
            for (uint32_t j = 0; j < VEIL_LANES; j++)
                to[i + j] = run[c].base[channel] + run[c].step[channel] * (float)(int32_t)(i + j);
}

static void veil_add(const pupil_planes *restrict planes, const pupil_veil_ramp *run, uint32_t count, uint32_t n,
                     float direct, pupil_planes *restrict veil, float *restrict rgba)
{
    veil_ramp(run, count, 0, veil->r); /* in this order: each writes beyond its end */
    veil_ramp(run, count, 1, veil->g);
    veil_ramp(run, count, 2, veil->b);
    for (uint32_t i = 0; i < n; i++) {
        rgba[4 * i] = direct * planes->r[i] + veil->r[i];
        rgba[4 * i + 1] = direct * planes->g[i] + veil->g[i];
        rgba[4 * i + 2] = direct * planes->b[i] + veil->b[i];
        rgba[4 * i + 3] = 1.0f;
    }
}

#define VEIL_PIECES .veil_gather = veil_gather, .veil_add = veil_add

#endif
