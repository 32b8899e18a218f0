#include "image.h"

#include "base/pixel.h"
#include "kernels/kernels.h"
#include "read.h"

static int usable(uint32_t pixel, int out)
{
    if (pixel >= PUPIL_PIXEL_COUNT)
        return 0;
    if (out)
        return pupil_kernels_scalar.store[pixel] || pixel == PUPIL_PIXEL_NV12 || pixel == PUPIL_PIXEL_I420;
    return pupil_kernels_scalar.load[pixel] || pupil_kernels_scalar.unpack[pixel];
}

static size_t magnitude(ptrdiff_t stride)
{
    return stride < 0 ? (size_t)0 - (size_t)stride : (size_t)stride;
}

/* A plane of Cb and Cr, or of one of them. */
static int check_plane(const pupil_image_const *image, const void *plane, ptrdiff_t stride_bytes)
{
    const size_t sample = pupil_pixel_layout_of(image->pixel).sample, stride = magnitude(stride_bytes);
    if (!plane)
        return PUPIL_ERR_NULL;
    if (pupil_chroma_rows(image->pixel, image->height) > 1 &&
        stride < pupil_chroma_row_bytes(image->pixel, image->width))
        return PUPIL_ERR_STRIDE;
    return (uintptr_t)plane % sample || stride % sample ? PUPIL_ERR_ALIGNMENT : PUPIL_OK;
}

static int check_chroma(const pupil_image_const *image)
{
    const uint32_t planes = pupil_pixel_planes(image->pixel);
    int error = planes > 1 ? check_plane(image, image->chroma, image->chroma_stride_bytes) : PUPIL_OK;
    if (!error && planes > 2)
        error = check_plane(image, image->cr, image->cr_stride_bytes);
    return error;
}

int pupil_image_check(const pupil_image_const *image, int out)
{
    if (!image->data)
        return PUPIL_ERR_NULL;
    if (!usable(image->pixel, out))
        return out ? PUPIL_ERR_PIXEL_OUT : PUPIL_ERR_PIXEL;
    if (!image->width || !image->height || image->width > PUPIL_MAX_SIDE_PX || image->height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    const pupil_pixel_layout f = pupil_pixel_layout_of(image->pixel);
    if (f.mosaic && (image->width % 2 || image->height % 2 || image->width % f.unit))
        return PUPIL_ERR_SIZE;

    const size_t stride = magnitude(image->stride_bytes);
    if (image->height > 1 && stride < pupil_row_bytes(image->pixel, image->width))
        return PUPIL_ERR_STRIDE;
    if ((uintptr_t)image->data % f.sample || stride % f.sample)
        return PUPIL_ERR_ALIGNMENT;
    const int error = check_chroma(image);
    return error || !image->coding ? error : pupil_coding_check(image->coding, image->pixel, 0);
}

int pupil_input_read(pupil_input *ours, const pupil_image_const *theirs)
{
    pupil_image_const *image = &ours->image;
    const int error = pupil_image_read(image, theirs);
    if (error)
        return error;
    if (image->coding && pupil_coding_read(&ours->coding, image->coding))
        return PUPIL_ERR_CODING;
    image->coding = image->coding ? &ours->coding : 0;
    return pupil_image_check(image, 0);
}

int pupil_output_read(pupil_output *ours, const pupil_image *theirs)
{
    pupil_image *image = &ours->image;
    const int error = pupil_image_out_read(image, theirs);
    if (error)
        return error;
    if (image->coding && pupil_coding_read(&ours->coding, image->coding))
        return PUPIL_ERR_CODING;
    image->coding = image->coding ? &ours->coding : 0;
    const pupil_image_const as_const = pupil_image_as_const(*image);
    return pupil_image_check(&as_const, 1);
}
