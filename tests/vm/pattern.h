/* tests/vm/pattern.h: what vivid's test patterns are in each pixel format, sample by sample.
 *
 * Source: the kernel's drivers/media/common/v4l2-tpg, with brightness, contrast, saturation and hue as they are by
 * default. RGB and mosaics have full codes. What comes from a matrix is 255/256 of it, rounded down; grey is BT.709's
 * luma in 8 bits of full range, and zeros below. */
#ifndef PUPIL_TESTS_VM_PATTERN_H
#define PUPIL_TESTS_VM_PATTERN_H

#include <math.h>
#include <stdlib.h>

#include "source.h"
#include "v4l2/format.h"

/* The items of the menu "Test Pattern" (enum tpg_pattern). */
enum { PATTERN_RED = 7, PATTERN_BLUE = 9, PATTERN_CHECKERS = 10 };

/* Red, green or blue of a pixel: 0 or 1. */
static int pattern_at(int pattern, uint32_t x, uint32_t y, uint32_t channel)
{
    switch (pattern) {
    case PATTERN_RED:
        return channel == 0;
    case PATTERN_BLUE:
        return channel == 2;
    case PATTERN_CHECKERS: /* of 16 x 16 */
        return !((x / 16 + y / 16) % 2);
    default:
        return 0;
    }
}

static double pattern_luma(int pattern, uint32_t x, uint32_t y, int is_709)
{
    const double red = is_709 ? 0.2126 : 0.299, blue = is_709 ? 0.0722 : 0.114;
    return red * pattern_at(pattern, x, y, 0) + (1.0 - red - blue) * pattern_at(pattern, x, y, 1) +
           blue * pattern_at(pattern, x, y, 2);
}

/* The code of Y' (what 0), Cb (1), Cr (2). */
static int pattern_yuv(const pupil_v4l2_format *f, int pattern, uint32_t x, uint32_t y, int what)
{
    const int limited = f->coding.range == PUPIL_RANGE_LIMITED, is_709 = f->coding.matrix == PUPIL_MATRIX_BT709;
    const double luma = pattern_luma(pattern, x, y, is_709);
    if (what == 0)
        return (int)floor((limited ? 16 : 0) + (limited ? 219 : 255) * luma * 255 / 256 + 1e-9);
    const double weight = what == 1 ? is_709 ? 0.0722 : 0.114 : is_709 ? 0.2126 : 0.299;
    const double off = (pattern_at(pattern, x, y, what == 1 ? 2 : 0) - luma) / (2 * (1 - weight));
    return (int)floor(128 + (limited ? 224 : 255) * off * 255 / 256 + 1e-9);
}

static uint32_t pattern_bits(uint32_t pixel)
{
    static const uint32_t bits[PUPIL_PIXEL_COUNT] = {
        [PUPIL_PIXEL_GREY8] = 8,  [PUPIL_PIXEL_GREY10] = 10,  [PUPIL_PIXEL_GREY12] = 12,  [PUPIL_PIXEL_GREY16] = 16,
        [PUPIL_PIXEL_BAYER8] = 8, [PUPIL_PIXEL_BAYER10] = 10, [PUPIL_PIXEL_BAYER12] = 12, [PUPIL_PIXEL_BAYER16] = 16};
    return bits[pixel];
}

/* Of a format with one sample a pixel. */
static int pattern_mono(const pupil_v4l2_format *f, int pattern, uint32_t x, uint32_t y)
{
    const uint32_t bits = pattern_bits(f->pixel);
    if (f->pixel < PUPIL_PIXEL_BAYER8)
        return (int)(pattern_luma(pattern, x, y, 1) * 255 * 255 / 256) << (bits - 8);
    const uint32_t red_x = f->coding.bayer == PUPIL_BAYER_GRBG || f->coding.bayer == PUPIL_BAYER_BGGR;
    const uint32_t red_y = f->coding.bayer == PUPIL_BAYER_GBRG || f->coding.bayer == PUPIL_BAYER_BGGR;
    const uint32_t channel = (x % 2 == red_x) && (y % 2 == red_y) ? 0 : (x % 2 != red_x) && (y % 2 != red_y) ? 2 : 1;
    return pattern_at(pattern, x, y, channel) * ((1 << bits) - 1);
}

/* Sample i of a row, as it is in memory; of NV12, Y' and Cb Cr by turns. */
static int pattern_sample(const pupil_v4l2_format *f, int pattern, uint32_t i, uint32_t y)
{
    switch (f->pixel) {
    case PUPIL_PIXEL_YUYV:
        return i % 2 ? pattern_yuv(f, pattern, i / 4 * 2, y, i % 4 == 1 ? 1 : 2) : pattern_yuv(f, pattern, i / 2, y, 0);
    case PUPIL_PIXEL_NV12:
        return i % 2 ? pattern_yuv(f, pattern, i / 4 * 2, y, i % 4 == 1 ? 1 : 2) : pattern_yuv(f, pattern, i / 2, y, 0);
    case PUPIL_PIXEL_RGB8:
        return 255 * pattern_at(pattern, i / 3, y, i % 3);
    case PUPIL_PIXEL_RGBA8: /* alpha is vivid's own affair */
        return i % 4 == 3 ? -1 : 255 * pattern_at(pattern, i / 4, y, i % 4);
    default:
        return pattern_mono(f, pattern, i, y);
    }
}

/* How far the farthest sample of a frame is from the pattern's, in codes of 8 bits. Rows repeat after 32;
 * from first_row on. */
static double pattern_off(const pupil_image_const *image, const pupil_v4l2_format *f, int pattern, uint32_t first_row)
{
    static int expected[32][PUPIL_MAX_SIDE_PX * 4];
    const int nv12 = f->pixel == PUPIL_PIXEL_NV12, yuyv = f->pixel == PUPIL_PIXEL_YUYV;
    const uint32_t samples = image->width * (nv12 || yuyv                    ? 2
                                             : f->pixel == PUPIL_PIXEL_RGB8  ? 3
                                             : f->pixel == PUPIL_PIXEL_RGBA8 ? 4
                                                                             : 1);
    const uint32_t bits = pattern_bits(f->pixel);
    int most = 0;
    for (uint32_t y = 0; y < 32; y++)
        for (uint32_t i = 0; i < samples; i++)
            expected[y][i] =
                y < 2 || y % 16 == 0 || y == 17 ? pattern_sample(f, pattern, i, y) : expected[y / 16 * 16 + y % 2][i];
    for (uint32_t y = first_row; y < image->height; y++) {
        const unsigned char *row = (const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes;
        const unsigned char *chroma =
            nv12 ? (const unsigned char *)image->chroma + (ptrdiff_t)(y / 2) * image->chroma_stride_bytes : row;
        for (uint32_t i = 0; i < samples; i++) {
            const int code = bits > 8 ? row[2 * i] | row[2 * i + 1] << 8
                             : nv12   ? i % 2 ? chroma[i / 2] : row[i / 2]
                                      : row[i];
            const int want = expected[y % 32][i], off = abs(code - want);
            most = want >= 0 && off > most ? off : most;
        }
    }
    return (double)most / (1u << (bits > 8 ? bits - 8 : 0));
}

/* Black and white are exact; so is what comes from no matrix. Its factors are vivid's own integers. */
static double pattern_tolerance(const pupil_v4l2_format *f, int pattern)
{
    const int exact = pattern == PATTERN_CHECKERS || f->pixel == PUPIL_PIXEL_RGB8 || f->pixel == PUPIL_PIXEL_RGBA8 ||
                      f->pixel >= PUPIL_PIXEL_BAYER8;
    return exact ? 0.0 : 1.0;
}

#endif
