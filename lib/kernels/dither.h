/* lib/kernels/dither.h: ordered dither of display light, before it becomes 8-bit codes (config.h: dither). The
 * reference; vector_scale.h and dither.glsl have the same operations.
 *
 * The threshold is Bayer's of 8 x 8 pixels (1973), the same for all channels, so that grey stays grey. It moves light
 * by less than half a code, so light that is exactly a code's does not change. */
#ifndef PUPIL_KERNELS_DITHER_H
#define PUPIL_KERNELS_DITHER_H

#include "kernels.h"

#include "base/numeric.h"

/* In codes, from -0.46 to 0.46: with the error of the power, less than half. */
static inline float dither_threshold(uint32_t x, uint32_t y)
{
    const uint32_t q = x ^ y;
    const uint32_t order = (q & 1) << 5 | (y & 1) << 4 | (q & 2) << 2 | (y & 2) << 1 | (q & 4) >> 1 | (y & 4) >> 2;
    return ((float)(int32_t)order - 31.5f) * (0.94f / 64.0f);
}

static inline float dithered(float x, float threshold, const pupil_code_width *of)
{
    const uint32_t bits = (uint32_t)((float)(int32_t)pupil_bits_of_float(x) * of->power) + of->offset;
    const float step = pupil_float_of_bits(bits) * of->scale;
    const float v = x + threshold * (step > of->least ? step : of->least);
    return v > 0.0f ? v : 0.0f;
}

#endif
