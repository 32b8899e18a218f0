/* The layout of each format's pixels in memory. */
#include "pixel.h"

static const pupil_pixel_layout layouts[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = {16, 1, 4, 0, 0},  [PUPIL_PIXEL_RGB32F] = {12, 1, 4, 0, 0},
    [PUPIL_PIXEL_RGBA16F] = {8, 1, 2, 0, 0},   [PUPIL_PIXEL_RGBA16] = {8, 1, 2, 0, 0},
    [PUPIL_PIXEL_RGB16] = {6, 1, 2, 0, 0},     [PUPIL_PIXEL_RGBA8] = {4, 1, 1, 0, 0},
    [PUPIL_PIXEL_RGB8] = {3, 1, 1, 0, 0},      [PUPIL_PIXEL_BGRX8] = {4, 1, 1, 0, 0},
    [PUPIL_PIXEL_YUYV] = {4, 2, 1, 0, 0},      [PUPIL_PIXEL_NV12] = {1, 1, 1, 0, 0},
    [PUPIL_PIXEL_GREY8] = {1, 1, 1, 8, 0},     [PUPIL_PIXEL_GREY10] = {2, 1, 2, 10, 0},
    [PUPIL_PIXEL_GREY12] = {2, 1, 2, 12, 0},   [PUPIL_PIXEL_GREY16] = {2, 1, 2, 16, 0},
    [PUPIL_PIXEL_BAYER8] = {1, 1, 1, 8, 1},    [PUPIL_PIXEL_BAYER10] = {2, 1, 2, 10, 1},
    [PUPIL_PIXEL_BAYER12] = {2, 1, 2, 12, 1},  [PUPIL_PIXEL_BAYER14] = {2, 1, 2, 14, 1},
    [PUPIL_PIXEL_BAYER16] = {2, 1, 2, 16, 1},  [PUPIL_PIXEL_BAYER10P] = {5, 4, 1, 10, 1},
    [PUPIL_PIXEL_BAYER12P] = {3, 2, 1, 12, 1},
};

pupil_pixel_layout pupil_pixel_layout_of(uint32_t pixel)
{
    return layouts[pixel < PUPIL_PIXEL_COUNT ? pixel : PUPIL_PIXEL_NONE];
}

size_t pupil_pixel_bytes(uint32_t pixel)
{
    const pupil_pixel_layout f = pupil_pixel_layout_of(pixel);
    return f.unit && f.bytes % f.unit == 0 ? f.bytes / f.unit : 0;
}

size_t pupil_row_bytes(uint32_t pixel, uint32_t width)
{
    const pupil_pixel_layout f = pupil_pixel_layout_of(pixel);
    return f.unit ? ((size_t)width + f.unit - 1) / f.unit * f.bytes : 0;
}

int pupil_pixel_is_mosaic(uint32_t pixel)
{
    return pupil_pixel_layout_of(pixel).mosaic;
}

uint32_t pupil_pixel_bits(uint32_t pixel)
{
    return pupil_pixel_layout_of(pixel).bits;
}

uint32_t pupil_pixel_rows(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_NV12 || pupil_pixel_is_mosaic(pixel) ? 2 : 1;
}
