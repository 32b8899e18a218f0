/* A picture with its veil. */
#include "scatter.h"

#include "core/mapping.h"

_Static_assert(sizeof(scatter_block) <= sizeof(pupil_veil_scratch), "PUPIL_VEIL_SCRATCH_BYTES is too small");

int pupil_veil_map_rows(const pupil_veil *veil, const pupil_t *pupil, const pupil_curve *curve,
                        const pupil_image_const *rows, const pupil_image *out, pupil_veil_scratch *scratch)
{
    pupil_tone by;
    pupil_input in;
    pupil_output to;
    int error = scratch ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = pupil_mapping_read(&by, &in, &to, curve, rows, out);
    if (error)
        return error;
    const veil_object *o = pupil_veil_object_of_const(veil);
    if (pupil_pixel_is_mosaic(in.image.pixel))
        return PUPIL_ERR_PIXEL;
    if (in.image.width != o->config.width)
        return PUPIL_ERR_SIZE;
    if (by.first_row >= o->config.height || in.image.height > o->config.height - by.first_row)
        return PUPIL_ERR_ROWS;
    const scatter_map map = {
        .veil = o, .out = &to.image, .first_row = by.first_row, .block = (scatter_block *)(void *)scratch};
    pupil_scatter_map(&map, pupil_object_of_const(pupil), &by, &in.image);
    return PUPIL_OK;
}
