/* lib/kernels/gamut.h: moves a colour beyond the display's gamut back into it (pupil.h: pupil_curve). The reference;
 * vector_scale.h and map.frag have the same operations in the same order.
 *
 * Oklab is linear in the cube roots of the cones' responses, and those of grey are equal (Ottosson 2020,
 * bottosson.github.io, "A perceptual color space for image processing"). So a straight line in cube roots toward any
 * grey keeps the hue. */
#ifndef PUPIL_KERNELS_GAMUT_H
#define PUPIL_KERNELS_GAMUT_H

#include "kernels.h"

#include "base/numeric.h"

/* Of more than 0, to 2.3e-7. The last line is the series of c^(-2/3) at 1. */
static inline float cube_root(float x)
{
    const uint32_t third = (uint32_t)((float)(int32_t)pupil_bits_of_float(x) * ROOT_THIRD);
    float y = pupil_float_of_bits(ROOT_BITS - third);
    const float c = x * y * y * y;
    y = y * (ROOT_0 - c * (ROOT_1 - ROOT_2 * c));
    const float root = x * y * y;
    return root * (5.0f / 3.0f - (2.0f / 3.0f) * (root * y));
}

static inline float largest_of(const float v[3])
{
    const float m = v[0] > v[1] ? v[0] : v[1];
    return m > v[2] ? m : v[2];
}

static inline float row_times(const float row[3], const float v[3])
{
    return (row[0] * v[0] + row[1] * v[1]) + row[2] * v[2];
}

/* The largest component that stays as it is, for a pixel of the display luminance `grey`. */
static inline float gamut_limit(float grey, float gamut)
{
    const float knee = gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f;
    return knee + (1.0f - knee) * grey;
}

/* A cone's response, as a share of the middle cone's, after its cube root has moved `part` of the way to equality. */
static inline float toward_grey(float response, float part)
{
    const float p = cube_root(response), q = p + part * (1.0f - p);
    return q * q * q;
}

/* A colour whose largest component is beyond its limit, of the display luminance `grey` below 1. */
static inline void fit_colour(const pupil_cones *cones, float gamut, float grey, float rgb[3])
{
    const float knee = gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f, limit = gamut_limit(grey, gamut), room = 1.0f - grey;
    const float largest = largest_of(rgb), beyond_grey = largest - grey;
    float most = limit + (largest - limit) * room / (room + gamut * (largest - knee * room));
    most = most < 1.0f ? most : 1.0f;

    const float way = most * (beyond_grey > LEAST_DIVISOR ? beyond_grey : LEAST_DIVISOR);
    const float dim = grey > LEAST_GREY ? grey : LEAST_GREY;
    float part = dim * dim * dim * ((largest - most) / way);
    part = part < 1.0f ? part : 1.0f;

    for (int i = 0; i < 3; i++)
        rgb[i] = rgb[i] > LEAST_VISIBLE ? rgb[i] : LEAST_VISIBLE;
    const float unit = 1.0f / row_times(cones->from_rgb + 3, rgb);
    const float cone[3] = {toward_grey(row_times(cones->from_rgb, rgb) * unit, part), 1.0f,
                           toward_grey(row_times(cones->from_rgb + 6, rgb) * unit, part)};
    for (int i = 0; i < 3; i++)
        rgb[i] = row_times(cones->to_rgb + 3 * i, cone);
    const float scale = most / largest_of(rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = rgb[i] * scale > 0.0f ? rgb[i] * scale : 0.0f;
}

/* The pixels of a block that are beyond the gamut. */
static inline void fit_gamut(pupil_planes *restrict p, const float *restrict display, uint32_t n, float gamut,
                             const pupil_cones *cones)
{
    for (uint32_t i = 0; i < n; i++) {
        float rgb[3] = {p->r[i], p->g[i], p->b[i]};
        if (!(largest_of(rgb) > gamut_limit(display[i], gamut)))
            continue;
        if (display[i] < 1.0f)
            fit_colour(cones, gamut, display[i], rgb);
        else
            rgb[0] = rgb[1] = rgb[2] = 1.0f;
        p->r[i] = rgb[0];
        p->g[i] = rgb[1];
        p->b[i] = rgb[2];
    }
}

#endif
