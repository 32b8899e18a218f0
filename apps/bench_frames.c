#include "bench_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const bench_format_names[] = {"rgba32f", "rgb32f", "rgba16f", "rgba16", "rgb16", "rgba8", "rgb8", NULL};

/* SplitMix64 (Steele, Lea, Flood 2014), as a number in [0, 1). */
static double random_of(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Over six stops, with a grain of half a stop, and colour that is strong in a thirtieth of the pixels. */
static void easy_pixel(uint32_t x, uint32_t y, uint64_t *state, float rgba[4])
{
    double light = exp2(2.0 * sin(x * 0.004) + cos(y * 0.006) + 0.5 * (random_of(state) - 0.5)) / 8.0;
    double red = random_of(state) < 1.0 / 30.0 ? 0.2 : 0.7;
    rgba[0] = (float)(light * (red + 0.3 * random_of(state)));
    rgba[1] = (float)(light * (0.7 + 0.3 * random_of(state)));
    rgba[2] = (float)(light * (0.6 + 0.3 * random_of(state)));
    rgba[3] = 1.0f;
}

/* One in sixteen is nothing that light could be, one a denormal, one black; the others are spread over 40 stops. */
static void hard_pixel(uint64_t *state, float rgba[4])
{
    static const float odd[] = {NAN, INFINITY, -INFINITY, -1.0f, 3e38f, -0.0f};
    for (int k = 0; k < 4; k++) {
        double kind = 16.0 * random_of(state);
        rgba[k] = kind < 1.0   ? odd[(int)(random_of(state) * 6.0)]
                  : kind < 2.0 ? 1e-41f
                  : kind < 3.0 ? 0.0f
                               : (float)exp2(40.0 * random_of(state) - 24.0);
    }
}

static double clamped(double value)
{
    return value > 0.0 ? value < 1.0 ? value : 1.0 : 0.0;
}

static double srgb_code(double light) /* IEC 61966-2-1 */
{
    return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055);
}

/* The nearest binary16, by way of its exponent: what overflows is Inf, NaN stays. */
static uint16_t half_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint16_t sign = (uint16_t)(bits >> 16 & 0x8000u);
    const double size = fabs((double)value);
    if (isnan(value))
        return 0x7e00;
    if (size >= 65520.0)
        return (uint16_t)(sign | 0x7c00u);
    const int exponent = size < 0x1p-14 ? -14 : ilogb(size);
    const double steps = nearbyint(ldexp(size, 10 - exponent)); /* 1024..2048, or less where subnormal */
    return (uint16_t)(sign | ((uint32_t)(exponent + 14) * 1024u + (uint32_t)steps));
}

static void store(uint32_t pixel, const float rgba[4], void *target)
{
    const int samples = pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_RGB16 || pixel == PUPIL_PIXEL_RGB8 ? 3 : 4;
    for (int k = 0; k < samples; k++) {
        const double code = clamped((double)rgba[k]);
        if (pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F)
            ((float *)target)[k] = rgba[k];
        else if (pixel == PUPIL_PIXEL_RGBA16F)
            ((uint16_t *)target)[k] = half_of(rgba[k]);
        else if (pixel == PUPIL_PIXEL_RGBA16 || pixel == PUPIL_PIXEL_RGB16)
            ((uint16_t *)target)[k] = (uint16_t)(code * 65535.0 + 0.5);
        else
            ((uint8_t *)target)[k] = (uint8_t)((k == 3 ? 255.0 * code : srgb_code(code)) + 0.5);
    }
}

pupil_image_const bench_frame(uint32_t pixel, uint32_t width, uint32_t height, int hard)
{
    const size_t bytes = pupil_pixel_bytes(pixel), row = width * bytes, all = (row * height + 63) / 64 * 64;
    unsigned char *data = aligned_alloc(64, all);
    uint64_t state = 1;
    pupil_image_const image = {
        .data = data, .stride_bytes = (ptrdiff_t)row, .width = width, .height = height, .pixel = pixel};
    if (!data)
        return image;
    memset(data, 0, all);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            float rgba[4];
            if (hard)
                hard_pixel(&state, rgba);
            else
                easy_pixel(x, y, &state, rgba);
            store(pixel, rgba, data + y * row + x * bytes);
        }
    return image;
}
