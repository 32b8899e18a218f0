/* lib/kernels/bins.h: which bin of the histograms light is in, and counting pixel by pixel. */
#ifndef PUPIL_KERNELS_BINS_H
#define PUPIL_KERNELS_BINS_H

#include "kernels.h"

#include "base/numeric.h"

#define FIRST_STOP (127 + PUPIL_HISTOGRAM_MIN_EV)
/* A float's exponent and top fraction bits are its bin: three of them for luminance, two for the brightest channel. */
#define BIN_BITS       20
#define PEAK_BIN_BITS  21
#define FIRST_BIN      (FIRST_STOP * PUPIL_HISTOGRAM_BINS_PER_STOP)
#define FIRST_PEAK_BIN (FIRST_STOP * PUPIL_PEAK_BINS_PER_STOP)

/* Data first in each comparison, so that NaN goes to the floor. */
static inline float clamp_luminance(float l, float floor)
{
    float v = l > floor ? l : floor;
    return v < PUPIL_CEILING ? v : PUPIL_CEILING;
}

static inline float max3(float a, float b, float c)
{
    float m = a > b ? a : b;
    return m > c ? m : c;
}

/* Pixels `from` to n, as a pupil_sampled_histogram_kernel. */
static inline void count_sampled(const pupil_row_job *job, const pupil_planes *planes, const pupil_planes *picture,
                                 uint32_t from, uint32_t n, uint32_t first, uint32_t weight, pupil_stats *stats)
{
    const float floor = job->floor, wr = job->luma[0], wg = job->luma[1], wb = job->luma[2];
    const uint32_t step = job->histogram;
    float peak = stats->peak;
    for (; from < n; from += step) {
        const uint32_t left = n - from < step ? n - from : step, i = from + (first < left ? first : left - 1);
        const float l = (wr * planes->r[i] + wg * planes->g[i]) + wb * planes->b[i];
        /* where no channel is NaN the largest does not depend on their order; where one is, so is L */
        const float largest = l == l ? max3(picture->r[i], picture->g[i], picture->b[i]) : floor;
        const float brightest = clamp_luminance(largest, floor);
        stats->bin[(pupil_bits_of_float(clamp_luminance(l, floor)) >> BIN_BITS) - FIRST_BIN] += left * weight;
        stats->peak_bin[(pupil_bits_of_float(brightest) >> PEAK_BIN_BITS) - FIRST_PEAK_BIN] += left * weight;
        peak = brightest > peak ? brightest : peak;
    }
    stats->peak = peak;
}

#endif
