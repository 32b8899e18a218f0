/* tests/vm/pattern.h: what vivid's test patterns are in each pixel format, sample by sample.
 *
 * Source: the kernel's drivers/media/common/v4l2-tpg, with default brightness, contrast, saturation and hue. RGB and
 * mosaics have full codes. Values from a matrix are 255/256 of the formula, rounded down; grey is BT.709's luma in 8
 * bits of full range, with zeros below. */
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

static int pattern_is_yuv(uint32_t pixel)
{
    return pupil_pixel_planes(pixel) > 1 || pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
}

/* For a format with one sample per pixel. */
static int pattern_mono(const pupil_v4l2_format *f, int pattern, uint32_t x, uint32_t y)
{
    const uint32_t bits = pupil_pixel_bits(f->pixel);
    if (!pupil_pixel_is_mosaic(f->pixel))
        return (int)(pattern_luma(pattern, x, y, 1) * 255 * 255 / 256) << (bits - 8);
    const uint32_t red_x = f->coding.bayer == PUPIL_BAYER_GRBG || f->coding.bayer == PUPIL_BAYER_BGGR;
    const uint32_t red_y = f->coding.bayer == PUPIL_BAYER_GBRG || f->coding.bayer == PUPIL_BAYER_BGGR;
    const uint32_t channel = (x % 2 == red_x) && (y % 2 == red_y) ? 0 : (x % 2 != red_x) && (y % 2 != red_y) ? 2 : 1;
    return pattern_at(pattern, x, y, channel) * ((1 << bits) - 1);
}

/* Sample i of a row of 8-bit RGB; -1: alpha, which is not checked. */
static int pattern_rgb(const pupil_v4l2_format *f, int pattern, uint32_t i, uint32_t y)
{
    const uint32_t bytes = (uint32_t)pupil_pixel_bytes(f->pixel), channel = i % bytes;
    const int blue_first = f->pixel == PUPIL_PIXEL_BGR8 || f->pixel == PUPIL_PIXEL_BGRX8;
    return channel == 3 ? -1 : 255 * pattern_at(pattern, i / bytes, y, blue_first ? 2 - channel : channel);
}

/* Sample i of a row of a plane (0 data, 1 chroma, 2 cr), as it is in memory; y is the row of the picture. */
static int pattern_sample(const pupil_v4l2_format *f, int pattern, uint32_t plane, uint32_t i, uint32_t y)
{
    const uint32_t luma_at = f->pixel == PUPIL_PIXEL_UYVY, turned = f->pixel == PUPIL_PIXEL_NV21;
    if (!pattern_is_yuv(f->pixel))
        return pupil_pixel_bits(f->pixel) ? pattern_mono(f, pattern, i, y) : pattern_rgb(f, pattern, i, y);
    if (pupil_pixel_planes(f->pixel) == 1) {
        const int what = i % 2 == luma_at ? 0 : i % 4 < 2 ? 1 : 2;
        return pattern_yuv(f, pattern, what ? i / 4 * 2 : i / 2, y, what);
    }
    if (plane == 0)
        return pattern_yuv(f, pattern, i, y, 0);
    if (pupil_pixel_planes(f->pixel) == 3)
        return pattern_yuv(f, pattern, 2 * i, y, (int)plane);
    return pattern_yuv(f, pattern, i / 2 * 2, y, i % 2 == turned ? 1 : 2);
}

/* The largest difference of a plane from the pattern; rows of the picture repeat after 32. */
static int pattern_plane_off(const pupil_image_const *image, const pupil_v4l2_format *f, int pattern,
                             uint32_t first_row, uint32_t plane)
{
    static int expected[32][PUPIL_MAX_SIDE_PX * 4];
    const uint32_t is_word = pupil_pixel_bits(f->pixel) > 8;
    const size_t row_bytes =
        plane ? pupil_chroma_row_bytes(f->pixel, image->width) : pupil_row_bytes(f->pixel, image->width);
    const uint32_t samples = (uint32_t)row_bytes >> is_word;
    const unsigned char *data = plane == 0 ? image->data : plane == 1 ? image->chroma : image->cr;
    const ptrdiff_t stride = plane == 0   ? image->stride_bytes
                             : plane == 1 ? image->chroma_stride_bytes
                                          : image->cr_stride_bytes;
    int most = 0;
    for (uint32_t y = 0; y < 32; y++)
        for (uint32_t i = 0; i < samples; i++)
            expected[y][i] = y < 2 || y % 16 == 0 || y == 17 ? pattern_sample(f, pattern, plane, i, y)
                                                             : expected[y / 16 * 16 + y % 2][i];
    for (uint32_t y = first_row; y < image->height; y++) {
        const unsigned char *row = data + (plane ? pupil_chroma_row_of(f->pixel, y) : (ptrdiff_t)y) * stride;
        for (uint32_t i = 0; i < samples; i++) {
            const int code = is_word ? row[2 * i] | row[2 * i + 1] << 8 : row[i];
            const int want = expected[y % 32][i], off = abs(code - want);
            most = want >= 0 && off > most ? off : most;
        }
    }
    return most;
}

/* The largest difference in a frame from first_row on, in codes of 8 bits. */
static double pattern_off(const pupil_image_const *image, const pupil_v4l2_format *f, int pattern, uint32_t first_row)
{
    const uint32_t bits = pupil_pixel_bits(f->pixel);
    int most = 0;
    for (uint32_t plane = 0; plane < pupil_pixel_planes(f->pixel); plane++) {
        const int off = pattern_plane_off(image, f, pattern, first_row, plane);
        most = off > most ? off : most;
    }
    return (double)most / (1u << (bits > 8 ? bits - 8 : 0));
}

/* Black and white are exact; so are values without a matrix. The matrix's factors are vivid's own integers. */
static double pattern_tolerance(const pupil_v4l2_format *f, int pattern)
{
    const int grey = pupil_pixel_bits(f->pixel) && !pupil_pixel_is_mosaic(f->pixel);
    return pattern != PATTERN_CHECKERS && (grey || pattern_is_yuv(f->pixel)) ? 1.0 : 0.0;
}

#endif
