#include "frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GUARD 64

frame frame_make(uint32_t width, uint32_t height, uint32_t pixel, size_t padding, int upside_down)
{
    frame f;
    const size_t stride = width * pupil_pixel_bytes(pixel) + padding;
    f.bytes = stride * height + 2 * GUARD;
    f.memory = malloc(f.bytes);
    if (!f.memory)
        abort();
    memset(f.memory, 0xff, f.bytes);
    f.image.data = f.memory + GUARD + (upside_down ? stride * (height - 1) : 0);
    f.image.stride_bytes = upside_down ? -(ptrdiff_t)stride : (ptrdiff_t)stride;
    f.image.width = width;
    f.image.height = height;
    f.image.pixel = pixel;
    return f;
}

void frame_free(frame *f)
{
    free(f->memory);
    f->memory = NULL;
}

pupil_image frame_writable(const frame *f)
{
    pupil_image image = {f->memory + ((const unsigned char *)f->image.data - f->memory), f->image.stride_bytes,
                         f->image.width, f->image.height, f->image.pixel};
    return image;
}

int frame_guards_intact(const frame *f)
{
    const size_t row = f->image.width * pupil_pixel_bytes(f->image.pixel);
    const size_t stride = (size_t)llabs((long long)f->image.stride_bytes);
    for (size_t i = 0; i < f->bytes; i++) {
        const int inside = i >= GUARD && i < f->bytes - GUARD && (i - GUARD) % stride < row;
        if (!inside && f->memory[i] != 0xff)
            return 0;
    }
    return 1;
}

uint16_t frame_half(double value)
{
    const uint16_t sign = signbit(value) ? 0x8000 : 0;
    const double size = fabs(value);
    int exponent;
    if (isnan(value))
        return sign | 0x7e00;
    if (size >= 65520)
        return sign | 0x7c00;
    if (size < 0x1p-14)
        return sign | (uint16_t)nearbyint(size * 0x1p24);
    frexp(size, &exponent);
    exponent--; /* size is in [2^exponent, 2^(exponent+1)) */
    return (uint16_t)(sign + ((exponent + 14) << 10) + (int)nearbyint(ldexp(size, 10 - exponent)));
}

static unsigned to_code(double value, double top)
{
    return value > 0 ? (unsigned)floor(fmin(value, 1) * top + 0.5) : 0;
}

static double srgb(double light)
{
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

void frame_set(frame *f, uint32_t x, uint32_t y, double r, double g, double b, double a)
{
    const double value[4] = {r, g, b, a};
    const size_t pixel_bytes = pupil_pixel_bytes(f->image.pixel);
    unsigned char *at =
        (unsigned char *)frame_writable(f).data + (ptrdiff_t)y * f->image.stride_bytes + x * pixel_bytes;
    for (int c = 0; c < 4; c++) {
        const float single = (float)value[c];
        const uint16_t half = frame_half(value[c]), code = (uint16_t)to_code(value[c], 65535);
        switch (f->image.pixel) {
        case PUPIL_PIXEL_RGBA32F:
        case PUPIL_PIXEL_RGB32F:
            if (c < (int)(pixel_bytes / 4))
                memcpy(at + 4 * c, &single, 4);
            break;
        case PUPIL_PIXEL_RGBA16F:
            memcpy(at + 2 * c, &half, 2);
            break;
        case PUPIL_PIXEL_RGBA16:
        case PUPIL_PIXEL_RGB16:
            if (c < (int)(pixel_bytes / 2))
                memcpy(at + 2 * c, &code, 2);
            break;
        default:
            if (c < (int)pixel_bytes)
                at[c] = (unsigned char)to_code(c < 3 ? srgb(value[c]) : value[c], 255);
        }
    }
}

void frame_fill(frame *f, double r, double g, double b)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++)
            frame_set(f, x, y, r, g, b, 1);
}

static double gauss(frame_random *random) /* Box and Muller 1958 */
{
    const double radius = sqrt(-2 * log(1 - random()));
    return radius * cos(6.283185307179586 * random());
}

void frame_lognormal(frame *f, double middle, double sigma_stops, frame_random *random)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = middle * exp2(sigma_stops * gauss(random));
            frame_set(f, x, y, light * (0.5 + random()), light * (0.5 + random()), light * (0.5 + random()), random());
        }
}

void frame_gradient(frame *f, double from, double to)
{
    const double end = (double)f->image.width + f->image.height;
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = from * pow(to / from, (x + y + 0.5) / end);
            frame_set(f, x, y, light * 1.2, light, light * 0.7, (double)x / f->image.width);
        }
}

void frame_checker(frame *f, double a, double b)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = (x + y) & 1 ? a : b;
            frame_set(f, x, y, light, light, light, 1);
        }
}

void frame_one(frame *f, double background, double bright, frame_random *random)
{
    frame_fill(f, background, background, background);
    frame_set(f, (uint32_t)(random() * f->image.width), (uint32_t)(random() * f->image.height), bright, bright, bright,
              1);
}

void frame_odd(frame *f, frame_random *random)
{
    static const double odd[] = {NAN,     INFINITY, -INFINITY, -1,     -0.0,  0,      0x1p-149, 0x1p-127,
                                 0x1p-24, 0x1p-14,  0.18,      1,      65504, 0x1p29, 0x1p30,   0x1.fffffep127,
                                 0.02,    3,        -1e30,     0x1p31, 0.5,   0x1p-30};
    const unsigned n = sizeof odd / sizeof *odd;
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            /* half of them grey, half with odd values in single channels */
            const double a = odd[(unsigned)(random() * n)], b = odd[(unsigned)(random() * n)];
            const int grey = random() < 0.5;
            frame_set(f, x, y, a, grey ? a : b, grey ? a : odd[(unsigned)(random() * n)], b);
        }
}

void frame_bits(frame *f, frame_random *random)
{
    const size_t row = f->image.width * pupil_pixel_bytes(f->image.pixel);
    for (uint32_t y = 0; y < f->image.height; y++)
        for (size_t i = 0; i < row; i++)
            ((unsigned char *)frame_writable(f).data)[(ptrdiff_t)y * f->image.stride_bytes + (ptrdiff_t)i] =
                (unsigned char)(random() * 256);
}
