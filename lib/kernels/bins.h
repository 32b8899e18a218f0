/* lib/kernels/bins.h: which bin of the histograms light is in. */
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

#endif
