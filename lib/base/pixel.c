/* The layout of each format's pixels in memory. */
#include "pixel.h"

/* In the order of the struct's fields: pixels one after another; samples of grey and mosaics. */
#define PLAIN(BYTES, SAMPLE)                                                                                           \
    {                                                                                                                  \
        BYTES, 1, SAMPLE, 0, 0, 1, 0, 0, 0, 0                                                                          \
    }
#define SAMPLES(BYTES, UNIT, SAMPLE, BITS, MOSAIC)                                                                     \
    {                                                                                                                  \
        BYTES, UNIT, SAMPLE, BITS, MOSAIC, 1, 0, 0, 0, 0                                                               \
    }

static const pupil_pixel_layout layouts[PUPIL_PIXEL_COUNT] = {
    [PUPIL_PIXEL_RGBA32F] = PLAIN(16, 4),
    [PUPIL_PIXEL_RGB32F] = PLAIN(12, 4),
    [PUPIL_PIXEL_RGBA16F] = PLAIN(8, 2),
    [PUPIL_PIXEL_RGBA16] = PLAIN(8, 2),
    [PUPIL_PIXEL_RGB16] = PLAIN(6, 2),
    [PUPIL_PIXEL_RGBA8] = PLAIN(4, 1),
    [PUPIL_PIXEL_RGB8] = PLAIN(3, 1),
    [PUPIL_PIXEL_BGRX8] = PLAIN(4, 1),
    [PUPIL_PIXEL_BGR8] = PLAIN(3, 1),
    [PUPIL_PIXEL_RGBX8] = PLAIN(4, 1),
    [PUPIL_PIXEL_RGB10A2] = PLAIN(4, 4),
    [PUPIL_PIXEL_P010] = {2, 1, 2, 0, 0, 2, 4, 2, 2, 10},
    [PUPIL_PIXEL_I420_10] = {2, 1, 2, 0, 0, 3, 2, 2, 2, 10},
    [PUPIL_PIXEL_I444_16] = {2, 1, 2, 0, 0, 3, 2, 1, 1, 16},
    [PUPIL_PIXEL_BGR32F] = PLAIN(12, 4),
    [PUPIL_PIXEL_RGB16F] = PLAIN(6, 2),
    [PUPIL_PIXEL_GREY10P] = SAMPLES(5, 4, 1, 10, 0),
    [PUPIL_PIXEL_GREY12P] = SAMPLES(3, 2, 1, 12, 0),
    [PUPIL_PIXEL_YUYV] = {4, 2, 1, 0, 0, 1, 0, 0, 0, 8},
    [PUPIL_PIXEL_UYVY] = {4, 2, 1, 0, 0, 1, 0, 0, 0, 8},
    [PUPIL_PIXEL_NV12] = {1, 1, 1, 0, 0, 2, 2, 2, 2, 8},
    [PUPIL_PIXEL_NV21] = {1, 1, 1, 0, 0, 2, 2, 2, 2, 8},
    [PUPIL_PIXEL_NV16] = {1, 1, 1, 0, 0, 2, 2, 2, 1, 8},
    [PUPIL_PIXEL_I420] = {1, 1, 1, 0, 0, 3, 1, 2, 2, 8},
    [PUPIL_PIXEL_GREY8] = SAMPLES(1, 1, 1, 8, 0),
    [PUPIL_PIXEL_GREY10] = SAMPLES(2, 1, 2, 10, 0),
    [PUPIL_PIXEL_GREY12] = SAMPLES(2, 1, 2, 12, 0),
    [PUPIL_PIXEL_GREY16] = SAMPLES(2, 1, 2, 16, 0),
    [PUPIL_PIXEL_BAYER8] = SAMPLES(1, 1, 1, 8, 1),
    [PUPIL_PIXEL_BAYER10] = SAMPLES(2, 1, 2, 10, 1),
    [PUPIL_PIXEL_BAYER12] = SAMPLES(2, 1, 2, 12, 1),
    [PUPIL_PIXEL_BAYER14] = SAMPLES(2, 1, 2, 14, 1),
    [PUPIL_PIXEL_BAYER16] = SAMPLES(2, 1, 2, 16, 1),
    [PUPIL_PIXEL_BAYER10P] = SAMPLES(5, 4, 1, 10, 1),
    [PUPIL_PIXEL_BAYER12P] = SAMPLES(3, 2, 1, 12, 1),
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

uint32_t pupil_pixel_planes(uint32_t pixel)
{
    return pupil_pixel_layout_of(pixel).planes;
}

size_t pupil_chroma_row_bytes(uint32_t pixel, uint32_t width)
{
    const pupil_pixel_layout f = pupil_pixel_layout_of(pixel);
    return f.chroma_bytes ? ((size_t)width + f.chroma_columns - 1) / f.chroma_columns * f.chroma_bytes : 0;
}

uint32_t pupil_chroma_rows(uint32_t pixel, uint32_t height)
{
    const uint32_t each = pupil_pixel_layout_of(pixel).chroma_rows;
    return each ? (uint32_t)(((uint64_t)height + each - 1) / each) : 0;
}

uint32_t pupil_pixel_rows(uint32_t pixel)
{
    const pupil_pixel_layout f = pupil_pixel_layout_of(pixel);
    return f.mosaic || f.chroma_rows == 2 ? 2 : 1;
}
