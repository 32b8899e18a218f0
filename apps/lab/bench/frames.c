#include "frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "camera.h"
#include "common/pixel_light.h"

const bench_format bench_formats[] = {
    {"rgba32f", PUPIL_PIXEL_RGBA32F},   {"rgb32f", PUPIL_PIXEL_RGB32F},     {"rgba16f", PUPIL_PIXEL_RGBA16F},
    {"rgba16", PUPIL_PIXEL_RGBA16},     {"rgb16", PUPIL_PIXEL_RGB16},       {"rgba8", PUPIL_PIXEL_RGBA8},
    {"rgb8", PUPIL_PIXEL_RGB8},         {"yuyv", PUPIL_PIXEL_YUYV},         {"nv12", PUPIL_PIXEL_NV12},
    {"grey8", PUPIL_PIXEL_GREY8},       {"grey10", PUPIL_PIXEL_GREY10},     {"grey12", PUPIL_PIXEL_GREY12},
    {"grey16", PUPIL_PIXEL_GREY16},     {"bayer8", PUPIL_PIXEL_BAYER8},     {"bayer10", PUPIL_PIXEL_BAYER10},
    {"bayer12", PUPIL_PIXEL_BAYER12},   {"bayer14", PUPIL_PIXEL_BAYER14},   {"bayer16", PUPIL_PIXEL_BAYER16},
    {"bayer10p", PUPIL_PIXEL_BAYER10P}, {"bayer12p", PUPIL_PIXEL_BAYER12P}, {"i420", PUPIL_PIXEL_I420},
    {"nv21", PUPIL_PIXEL_NV21},         {"nv16", PUPIL_PIXEL_NV16},         {"uyvy", PUPIL_PIXEL_UYVY},
    {"bgr8", PUPIL_PIXEL_BGR8},         {"bgrx8", PUPIL_PIXEL_BGRX8},       {"rgbx8", PUPIL_PIXEL_RGBX8},
    {"grey10p", PUPIL_PIXEL_GREY10P},   {"grey12p", PUPIL_PIXEL_GREY12P},   {"bgr32f", PUPIL_PIXEL_BGR32F},
    {"rgb16f", PUPIL_PIXEL_RGB16F},     {"p010", PUPIL_PIXEL_P010},         {"i420-10", PUPIL_PIXEL_I420_10},
    {"rgb10a2", PUPIL_PIXEL_RGB10A2},   {"i444-16", PUPIL_PIXEL_I444_16},   {NULL, PUPIL_PIXEL_NONE}};

const char *bench_format_name(uint32_t pixel)
{
    const bench_format *f = bench_formats;
    while (f->name && f->pixel != pixel)
        f++;
    return f->name;
}

uint32_t bench_format_named(const char *name)
{
    const bench_format *f = bench_formats;
    while (f->name && strcmp(f->name, name) != 0)
        f++;
    return f->pixel;
}

/* SplitMix64 (Steele, Lea, Flood 2014), as a number in [0, 1). */
static double random_of(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* The light of lamps on a row, at half of daylight, so that no format clips it. turn: their phase on the first row; the
 * frame has two and a half turns (a readout of 25 ms under 100 Hz); negative: no lamps. */
static double lamp_on(uint32_t y, uint32_t height, double turn)
{
    const double two_pi = 6.28318530717958648;
    return turn < 0.0 ? 1.0 : 0.5 + 0.15 * cos(two_pi * (turn + 2.5 * (y + 0.5) / height));
}

static void shine(float rgba[4], double light)
{
    for (int k = 0; k < 3; k++)
        rgba[k] *= (float)light;
}

/* Six stops, with a grain of half a stop, and strong colour in a thirtieth of the pixels. */
static void easy_pixel(uint32_t x, uint32_t y, uint64_t *state, float rgba[4])
{
    double light = exp2(2.0 * sin(x * 0.004) + cos(y * 0.006) + 0.5 * (random_of(state) - 0.5)) / 8.0;
    double red = random_of(state) < 1.0 / 30.0 ? 0.2 : 0.7;
    rgba[0] = (float)(light * (red + 0.3 * random_of(state)));
    rgba[1] = (float)(light * (0.7 + 0.3 * random_of(state)));
    rgba[2] = (float)(light * (0.6 + 0.3 * random_of(state)));
    rgba[3] = 1.0f;
}

/* One sample in sixteen is no possible light, one a denormal, one black; the others are spread over 40 stops. */
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

/* The nearest binary16, by its exponent: overflow gives Inf, NaN stays. */
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

static void store_10(const float rgba[4], void *target)
{
    uint32_t word = 3u << 30;
    for (int k = 0; k < 3; k++)
        word |= (uint32_t)(srgb_code(clamped((double)rgba[k])) * 1023.0 / 255.0 + 0.5) << 10 * k;
    memcpy(target, &word, sizeof word);
}

static void store(uint32_t pixel, const float rgba[4], void *target)
{
    const int floats = pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_BGR32F;
    const int halves = pixel == PUPIL_PIXEL_RGBA16F || pixel == PUPIL_PIXEL_RGB16F;
    const int words = pixel == PUPIL_PIXEL_RGBA16 || pixel == PUPIL_PIXEL_RGB16;
    const int blue_first = pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGR32F || pixel == PUPIL_PIXEL_BGRX8;
    const size_t sample = floats ? 4 : halves || words ? 2 : 1, samples = pupil_pixel_bytes(pixel) / sample;
    if (pixel == PUPIL_PIXEL_RGB10A2) {
        store_10(rgba, target);
        return;
    }
    for (size_t k = 0; k < samples; k++) {
        const float value = rgba[blue_first && k < 3 ? 2 - k : k];
        const double code = clamped((double)value);
        if (floats)
            ((float *)target)[k] = value;
        else if (halves)
            ((uint16_t *)target)[k] = half_of(value);
        else if (words)
            ((uint16_t *)target)[k] = (uint16_t)(code * 65535.0 + 0.5);
        else
            ((uint8_t *)target)[k] = (uint8_t)((k == 3 ? 255.0 * code : srgb_code(code)) + 0.5);
    }
}

/* All planes but the first. */
static size_t chroma_bytes(uint32_t pixel, uint32_t width, uint32_t height)
{
    const size_t plane = pupil_chroma_row_bytes(pixel, width) * pupil_chroma_rows(pixel, height);
    return pupil_pixel_planes(pixel) > 2 ? 2 * plane : plane;
}

size_t bench_frame_bytes(uint32_t pixel, uint32_t width, uint32_t height)
{
    return pupil_row_bytes(pixel, width) * height + chroma_bytes(pixel, width, height);
}

pupil_image bench_room(uint32_t pixel, uint32_t width, uint32_t height)
{
    const size_t row = pupil_row_bytes(pixel, width), all = (bench_frame_bytes(pixel, width, height) + 63) / 64 * 64;
    unsigned char *data = aligned_alloc(64, all);
    pupil_image image = {
        .data = data, .stride_bytes = (ptrdiff_t)row, .width = width, .height = height, .pixel = pixel};
    if (!data)
        return image;
    memset(data, 0, all);
    const size_t chroma_row = pupil_chroma_row_bytes(pixel, width);
    image.chroma_stride_bytes = image.cr_stride_bytes = (ptrdiff_t)chroma_row;
    if (pupil_pixel_planes(pixel) > 1)
        image.chroma = data + row * height;
    if (pupil_pixel_planes(pixel) > 2)
        image.cr = data + row * height + chroma_row * pupil_chroma_rows(pixel, height);
    image.coding = bench_coding(pixel);
    return image;
}

static void fill(pupil_image image, int hard, double turn, uint64_t *state)
{
    for (uint32_t y = 0; y < image.height; y++)
        for (uint32_t x = 0; x < image.width; x++) {
            float rgba[4];
            if (hard)
                hard_pixel(state, rgba);
            else
                easy_pixel(x, y, state, rgba);
            shine(rgba, lamp_on(y, image.height, turn));
            store(image.pixel, rgba,
                  (unsigned char *)image.data + (ptrdiff_t)y * image.stride_bytes + x * pupil_pixel_bytes(image.pixel));
        }
}

static void fill_camera(pupil_image_const image, double turn, uint64_t *state)
{
    for (uint32_t y = 0; y < image.height; y += 2)
        for (uint32_t x = 0; x < image.width; x += 2) {
            float rgba[4][4];
            for (uint32_t i = 0; i < 4; i++) {
                easy_pixel(x + i % 2, y + i / 2, state, rgba[i]);
                shine(rgba[i], lamp_on(y + i / 2, image.height, turn));
            }
            bench_store_quad(&image, x, y, (const float(*)[4])rgba);
        }
}

static pupil_image_const make(uint32_t pixel, uint32_t width, uint32_t height, int hard, double turn)
{
    const pupil_image image = bench_room(pixel, width, height);
    const pupil_image_const frame = pupil_image_as_const(image);
    uint64_t state = 1;
    if (!image.data)
        return frame;
    if (!bench_is_yuv(pixel) && !pupil_pixel_bits(pixel))
        fill(image, hard, turn, &state);
    else if (hard)
        bench_store_any(&frame, random_of, &state);
    else
        fill_camera(frame, turn, &state);
    return frame;
}

pupil_image_const bench_frame(uint32_t pixel, uint32_t width, uint32_t height, int hard)
{
    return make(pixel, width, height, hard, -1.0);
}

pupil_image_const bench_lamp_frame(uint32_t pixel, uint32_t width, uint32_t height, double turn)
{
    return make(pixel, width, height, 0, turn);
}
