#include "object.h"

/* `unit` pixels have `bytes` bytes in `data`; `sample` is what an address is a multiple of. */
typedef struct format {
    uint8_t bytes, unit, sample, bits, mosaic;
} format;

static const format formats[PUPIL_PIXEL_COUNT] = {
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

static format format_of(uint32_t pixel)
{
    return formats[pixel < PUPIL_PIXEL_COUNT ? pixel : PUPIL_PIXEL_NONE];
}

size_t pupil_pixel_bytes(uint32_t pixel)
{
    const format f = format_of(pixel);
    return f.unit && f.bytes % f.unit == 0 ? f.bytes / f.unit : 0;
}

size_t pupil_row_bytes(uint32_t pixel, uint32_t width)
{
    const format f = format_of(pixel);
    return f.unit ? ((size_t)width + f.unit - 1) / f.unit * f.bytes : 0;
}

int pupil_pixel_is_mosaic(uint32_t pixel)
{
    return format_of(pixel).mosaic;
}

uint32_t pupil_pixel_bits(uint32_t pixel)
{
    return format_of(pixel).bits;
}

uint32_t pupil_pixel_rows(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_NV12 || pupil_pixel_is_mosaic(pixel) ? 2 : 1;
}

static int usable(uint32_t pixel, int out)
{
    if (pixel >= PUPIL_PIXEL_COUNT)
        return 0;
    if (out)
        return pupil_kernels_scalar.store[pixel] || pixel == PUPIL_PIXEL_NV12;
    return pupil_kernels_scalar.load[pixel] || pupil_kernels_scalar.unpack[pixel];
}

static size_t magnitude(ptrdiff_t stride)
{
    return stride < 0 ? (size_t)0 - (size_t)stride : (size_t)stride;
}

/* NV12's second plane. */
static int check_chroma(const pupil_image_const *image)
{
    if (!image->chroma)
        return PUPIL_ERR_NULL;
    const size_t row = (size_t)image->width + image->width % 2;
    return image->height > 2 && magnitude(image->chroma_stride_bytes) < row ? PUPIL_ERR_STRIDE : PUPIL_OK;
}

int pupil_image_check(const pupil_image_const *image, int out)
{
    if (!image->data)
        return PUPIL_ERR_NULL;
    if (!usable(image->pixel, out))
        return PUPIL_ERR_PIXEL;
    if (!image->width || !image->height || image->width > PUPIL_MAX_SIDE_PX || image->height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    const format f = format_of(image->pixel);
    if (f.mosaic && (image->width % 2 || image->height % 2 || image->width % f.unit))
        return PUPIL_ERR_SIZE;

    const size_t stride = magnitude(image->stride_bytes);
    if (image->height > 1 && stride < pupil_row_bytes(image->pixel, image->width))
        return PUPIL_ERR_STRIDE;
    if ((uintptr_t)image->data % f.sample || stride % f.sample)
        return PUPIL_ERR_ALIGNMENT;
    const int error = image->pixel == PUPIL_PIXEL_NV12 ? check_chroma(image) : PUPIL_OK;
    return error || !image->coding ? error : pupil_coding_check(image->coding, image->pixel, 0);
}
