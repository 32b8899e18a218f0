#include "object.h"

size_t pupil_pixel_bytes(uint32_t pixel)
{
    static const uint8_t bytes[PUPIL_PIXEL_COUNT] = {
        [PUPIL_PIXEL_RGBA32F] = 16, [PUPIL_PIXEL_RGB32F] = 12, [PUPIL_PIXEL_RGBA16F] = 8, [PUPIL_PIXEL_RGBA16] = 8,
        [PUPIL_PIXEL_RGB16] = 6,    [PUPIL_PIXEL_RGBA8] = 4,   [PUPIL_PIXEL_RGB8] = 3,    [PUPIL_PIXEL_BGRX8] = 4,
    };
    return pixel < PUPIL_PIXEL_COUNT ? bytes[pixel] : 0;
}

static size_t sample_bytes(uint32_t pixel)
{
    if (pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F)
        return 4;
    return pixel == PUPIL_PIXEL_RGBA16F || pixel == PUPIL_PIXEL_RGBA16 || pixel == PUPIL_PIXEL_RGB16 ? 2 : 1;
}

int pupil_image_check(const pupil_image_const *image, int out)
{
    if (!image->data)
        return PUPIL_ERR_NULL;
    if (image->pixel >= PUPIL_PIXEL_COUNT)
        return PUPIL_ERR_PIXEL;
    if (out ? !pupil_kernels_scalar.store[image->pixel] : !pupil_kernels_scalar.load[image->pixel])
        return PUPIL_ERR_PIXEL;
    if (!image->width || !image->height || image->width > PUPIL_MAX_SIDE_PX || image->height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;

    size_t row = image->width * pupil_pixel_bytes(image->pixel), sample = sample_bytes(image->pixel);
    size_t stride = image->stride_bytes < 0 ? (size_t)0 - (size_t)image->stride_bytes : (size_t)image->stride_bytes;
    if (image->height > 1 && stride < row)
        return PUPIL_ERR_STRIDE;
    if ((uintptr_t)image->data % sample || stride % sample)
        return PUPIL_ERR_ALIGNMENT;
    return PUPIL_OK;
}
