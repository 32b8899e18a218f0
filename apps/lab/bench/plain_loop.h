/* apps/lab/bench/plain_loop.h: the loop of plain.h, for the two sources that include it. */
#include "plain.h"

#include <math.h>

static uint8_t code_of(float x)
{
    x = x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f;
    x = 255.0f * x + 0.5f;
    return (uint8_t)(x < 0.0f ? 0.0f : x > 255.0f ? 255.0f : x);
}

static float plain(const float *rgba, size_t pixels, float white, uint8_t *out)
{
    float sum = 0.0f;
    for (size_t i = 0; i < pixels; i++)
        sum += logf(1e-6f + 0.2126f * rgba[4 * i] + 0.7152f * rgba[4 * i + 1] + 0.0722f * rgba[4 * i + 2]);
    const float average = expf(sum / (float)pixels), scale = 0.18f / average;
    for (size_t i = 0; i < pixels; i++) {
        const float *p = rgba + 4 * i;
        const float l = scale * (0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2]);
        const float s = scale * (1.0f + l / (white * white)) / (1.0f + l);
        out[4 * i] = code_of(p[0] * s);
        out[4 * i + 1] = code_of(p[1] * s);
        out[4 * i + 2] = code_of(p[2] * s);
        out[4 * i + 3] = 255;
    }
    return average;
}
