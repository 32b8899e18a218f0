/* A picture with its bloom, and with its veil. */
#include "scatter.h"

#include "core/image.h"
#include "core/read.h"

typedef struct mapping_scratch {
    bloom_window window;
    scatter_block block;
} mapping_scratch;
_Static_assert(sizeof(mapping_scratch) + 64 <= sizeof(pupil_bloom_scratch), "PUPIL_BLOOM_SCRATCH_BYTES is too small");

static int check(const bloom_object *o, const pupil_veil *veil, const pupil_image_const *frame, uint32_t first_row,
                 const pupil_image *out)
{
    const int error = veil ? pupil_veil_check(veil) : PUPIL_OK;
    if (error)
        return error;
    const pupil_veil_config *v = veil ? &pupil_veil_object_of_const(veil)->config : 0;
    if (pupil_pixel_is_mosaic(frame->pixel))
        return PUPIL_ERR_PIXEL;
    if (frame->width != o->config.width || frame->height != o->config.height)
        return PUPIL_ERR_SIZE;
    if (v && (v->width != frame->width || v->height != frame->height))
        return PUPIL_ERR_SIZE;
    if (out->width != frame->width)
        return PUPIL_ERR_SIZE;
    const int outside = first_row >= frame->height || out->height > frame->height - first_row;
    return outside || first_row % pupil_pixel_rows(frame->pixel) ? PUPIL_ERR_ROWS : PUPIL_OK;
}

int pupil_bloom_map_rows(const pupil_bloom *bloom, const pupil_veil *veil, const pupil_t *pupil,
                         const pupil_curve *curve, const pupil_image_const *frame, const pupil_image *out,
                         pupil_bloom_scratch *scratch)
{
    pupil_tone by;
    pupil_input whole;
    pupil_output to;
    int error = scratch && out ? pupil_bloom_check(bloom) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = pupil_input_read(&whole, frame);
    if (!error)
        error = pupil_output_read(&to, out);
    if (!error)
        error = pupil_curve_read(&by, curve);
    const bloom_object *o = (const bloom_object *)(const void *)bloom;
    if (!error)
        error = check(o, veil, &whole.image, by.first_row, &to.image);
    if (error)
        return error;
    const pupil_image_const rows = pupil_image_rows(whole.image, by.first_row, to.image.height);
    if (!veil && !o->lit) /* no light scatters */
        return pupil_map_rows(pupil, curve, &rows, out);
    mapping_scratch *s = (mapping_scratch *)pupil_bloom_aligned(scratch);
    s->window.frame.kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    s->window.frame.threshold = (float)o->config.threshold;
    s->window.frame.ahead = 1;
    pupil_veil_rows_begin(&s->window.frame.rows, &whole.image);
    const scatter_map map = {.veil = veil ? pupil_veil_object_of_const(veil) : 0,
                             .bloom = o,
                             .window = &s->window,
                             .out = &to.image,
                             .first_row = by.first_row,
                             .block = &s->block};
    pupil_scatter_map(&map, pupil_object_of_const(pupil), &by, &rows);
    return PUPIL_OK;
}
