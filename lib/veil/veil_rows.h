/* lib/veil/veil_rows.h: rows of a frame for the kernels that load them. */
#ifndef PUPIL_VEIL_VEIL_ROWS_H
#define PUPIL_VEIL_VEIL_ROWS_H

#include "core/object.h"

typedef struct veil_rows {
    const pupil_image_const *image;
    pupil_coder coder;
} veil_rows;

static inline void pupil_veil_rows_begin(veil_rows *rows, const pupil_image_const *image)
{
    rows->image = image;
    pupil_coder_make(image->coding, image->pixel, &rows->coder);
}

/* Row i of the image, which is no mosaic. */
static inline pupil_row pupil_veil_row_of(const veil_rows *rows, uint32_t i)
{
    const pupil_image_const *in = rows->image;
    const ptrdiff_t chroma_row = pupil_chroma_row_of(in->pixel, i);
    pupil_row row = {.data = (const uint8_t *)in->data + (ptrdiff_t)i * in->stride_bytes, .width = in->width};
    if (pupil_pixel_planes(in->pixel) > 1)
        row.chroma = (const uint8_t *)in->chroma + chroma_row * in->chroma_stride_bytes;
    if (pupil_pixel_planes(in->pixel) > 2)
        row.cr = (const uint8_t *)in->cr + chroma_row * in->cr_stride_bytes;
    return row;
}

#endif
