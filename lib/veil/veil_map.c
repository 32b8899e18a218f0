/* A picture with its veil: rows in light, a chunk of columns at a time, with the veil in them, and then mapped as any
 * other rows. */
#include "veil_private.h"

#include "core/mapping.h"
#include "veil_rows.h"

typedef struct mapping {
    const veil_object *object;
    const pupil_object *pupil;
    const pupil_kernels *kernels;
    veil_rows rows;
    veil_scratch *scratch;
} mapping;

/* --- a row's veil --- */

/* The nodes above and below the row, as much of each as it is near. */
static void find_row(const veil_object *o, uint32_t y, veil_scratch *s)
{
    const float at = (float)(2 * y + 1) * (float)VEIL_CELLS / (float)(2 * o->config.height);
    const uint32_t above = pupil_veil_cell_of(y, o->config.height);
    const float part = at - (float)above;
    for (int channel = 0; channel < 3; channel++) {
        const float *restrict upper = o->solved[channel][above], *restrict lower = o->solved[channel][above + 1];
        for (int i = 0; i < VEIL_NODES; i++)
            s->row[channel][i] = upper[i] + part * (lower[i] - upper[i]);
    }
}

/* Pixels x to x + n as runs between two nodes; how many runs. */
static uint32_t find_ramps(const veil_object *o, veil_scratch *s, uint32_t x, uint32_t n)
{
    const uint32_t width = o->config.width, end = x + n;
    const float a_pixel = (float)VEIL_CELLS / (float)width;
    uint32_t count = 0;
    while (x < end) {
        const uint32_t cell = pupil_veil_cell_of(x, width), next = pupil_veil_first_in_cell(cell + 1, width);
        const float part = (float)(2 * x + 1) * (float)VEIL_CELLS / (float)(2 * width) - (float)cell;
        pupil_veil_ramp *r = &s->run[count++];
        r->n = (next < end ? next : end) - x;
        for (int channel = 0; channel < 3; channel++) {
            const float here = s->row[channel][cell], more = s->row[channel][cell + 1] - here;
            r->base[channel] = here + more * part;
            r->step[channel] = more * a_pixel;
        }
        x += r->n;
    }
    return count;
}

/* --- a chunk --- */

/* Row i of the image, in light, pixels x to x + n; the row's nodes are in scratch. */
static void fill_chunk(const mapping *m, uint32_t i, uint32_t x, uint32_t n, float *rgba)
{
    const pupil_kernels *k = m->kernels;
    const uint32_t pixel = m->rows.image->pixel;
    const pupil_row row = pupil_veil_row_of(&m->rows, i);
    const float direct = (float)m->object->result.direct;
    veil_scratch *s = m->scratch;
    for (uint32_t done = 0; done < n; done += PUPIL_BLOCK) {
        const uint32_t count = n - done < PUPIL_BLOCK ? n - done : PUPIL_BLOCK;
        float *to = rgba + 4 * done;
        const int opaque = PUPIL_PIECE(k, load[pixel])(&m->rows.coder, &row, x + done, count, &s->planes);
        const uint32_t runs = find_ramps(m->object, s, x + done, count);
        PUPIL_PIECE(k, veil_add)(&s->planes, s->run, runs, count, direct, &s->veil, to);
        if (opaque || !pupil_kernels_scalar.alpha_light[pixel])
            continue;
        PUPIL_PIECE(k, alpha_light[pixel])
        (row.data + (x + done) * pupil_pixel_bytes(pixel), count, s->veil.grey);
        for (uint32_t j = 0; j < count; j++)
            to[4 * j + 3] = s->veil.grey[j];
    }
}

/* The columns from x on, which is even. */
static pupil_image columns_of(pupil_image out, uint32_t x, uint32_t width)
{
    out.data = (unsigned char *)out.data + pupil_row_bytes(out.pixel, x);
    if (out.chroma)
        out.chroma = (unsigned char *)out.chroma + pupil_chroma_row_bytes(out.pixel, x);
    if (out.cr)
        out.cr = (unsigned char *)out.cr + pupil_chroma_row_bytes(out.pixel, x);
    out.width = width;
    return out;
}

/* `count` rows, one or a pair, that are mapped together. */
static __attribute__((noinline)) void map_together(const mapping *m, const pupil_tone *curve, uint32_t i,
                                                   uint32_t count, const pupil_image *out)
{
    veil_scratch *s = m->scratch;
    const uint32_t width = m->rows.image->width, first_row = curve->first_row;
    pupil_tone by = *curve;
    by.first_row = first_row + i;
    for (uint32_t x = 0; x < width; x += VEIL_CHUNK_PX) {
        const uint32_t n = width - x < VEIL_CHUNK_PX ? width - x : VEIL_CHUNK_PX;
        for (uint32_t k = 0; k < count; k++) {
            if (x == 0 || count > 1)
                find_row(m->object, first_row + i + k, s);
            fill_chunk(m, i + k, x, n, s->rgba[k]);
        }
        const pupil_image_const in = {.data = s->rgba,
                                      .stride_bytes = sizeof s->rgba[0],
                                      .width = n,
                                      .height = count,
                                      .pixel = PUPIL_PIXEL_RGBA32F};
        const pupil_image to = columns_of(pupil_image_out_rows(*out, i, count), x, n);
        pupil_work_rows(m->pupil, &in, by.first_row, count, 0, &by, &to);
    }
}

static __attribute__((noinline)) void map_all(const veil_object *o, const pupil_object *pupil, const pupil_tone *curve,
                                              const pupil_image_const *in, const pupil_image *out,
                                              veil_scratch *scratch)
{
    mapping m = {.object = o, .pupil = pupil, .kernels = pupil_level_kernels(pupil->level), .scratch = scratch};
    pupil_veil_rows_begin(&m.rows, in);
    const uint32_t together = pupil_pixel_planes(out->pixel) > 1 ? 2 : 1;
    for (uint32_t i = 0; i < in->height; i += together) {
        const uint32_t left = in->height - i;
        map_together(&m, curve, i, left < together ? left : together, out);
    }
}

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
    map_all(o, pupil_object_of_const(pupil), &by, &in.image, &to.image, (veil_scratch *)(void *)scratch);
    return PUPIL_OK;
}
