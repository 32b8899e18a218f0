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
    float cells_a_pixel;
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

/* Where a row's pixels are between the nodes, once for all rows. */
static void find_places(uint32_t width, veil_scratch *s)
{
    uint32_t count = 0, block = 0;
    for (uint32_t x = 0; x < width;) {
        const uint32_t cell = pupil_veil_cell_of(x, width), next = pupil_veil_first_in_cell(cell + 1, width);
        const uint32_t block_end = (x / PUPIL_BLOCK + 1) * PUPIL_BLOCK, end = next < block_end ? next : block_end;
        if (x % PUPIL_BLOCK == 0)
            s->first[block++] = count;
        s->place[count++] = (veil_place){
            .cell = (uint16_t)cell,
            .n = (uint16_t)((end < width ? end : width) - x),
            .part = (float)(2 * x + 1) * (float)VEIL_CELLS / (float)(2 * width) - (float)cell,
        };
        x = end;
    }
    s->first[block] = count;
}

/* The runs of a block between the nodes of its row; how many. */
static uint32_t find_ramps(veil_scratch *s, uint32_t block, float cells_a_pixel)
{
    const veil_place *place = s->place + s->first[block];
    const uint32_t count = s->first[block + 1] - s->first[block];
    for (uint32_t i = 0; i < count; i++) {
        pupil_veil_ramp *r = &s->run[i];
        r->n = place[i].n;
        for (int channel = 0; channel < 3; channel++) {
            const float here = s->row[channel][place[i].cell], more = s->row[channel][place[i].cell + 1] - here;
            r->base[channel] = here + more * place[i].part;
            r->step[channel] = more * cells_a_pixel;
        }
    }
    return count;
}

/* --- a chunk --- */

/* Pixels x to x + n of a row as RGBA. */
static void load_block(const mapping *m, const pupil_row *row, uint32_t x, uint32_t n, float *rgba)
{
    const uint32_t pixel = m->rows.image->pixel;
    pupil_planes *p = &m->scratch->planes;
    const int opaque = PUPIL_PIECE(m->kernels, load[pixel])(&m->rows.coder, row, x, n, p);
    const int has_alpha = !opaque && pupil_kernels_scalar.alpha_light[pixel];
    if (has_alpha)
        PUPIL_PIECE(m->kernels, alpha_light[pixel])(row->data + x * pupil_pixel_bytes(pixel), n, p->grey);
    for (uint32_t i = 0; i < n; i++) {
        rgba[4 * i] = p->r[i];
        rgba[4 * i + 1] = p->g[i];
        rgba[4 * i + 2] = p->b[i];
        rgba[4 * i + 3] = has_alpha ? p->grey[i] : 1.0f;
    }
}

/* Row i of the image, in light, pixels x to x + n; the row's nodes are in scratch. Floats are taken where they are. */
static void fill_chunk(const mapping *m, uint32_t i, uint32_t x, uint32_t n, float *rgba)
{
    const pupil_row row = pupil_veil_row_of(&m->rows, i);
    const float direct = (float)m->object->result.direct;
    const int in_place = m->rows.image->pixel == PUPIL_PIXEL_RGBA32F;
    for (uint32_t done = 0; done < n; done += PUPIL_BLOCK) {
        const uint32_t count = n - done < PUPIL_BLOCK ? n - done : PUPIL_BLOCK;
        float *to = rgba + 4 * done;
        const float *source = in_place ? (const float *)(const void *)row.data + 4 * (size_t)(x + done) : to;
        if (!in_place)
            load_block(m, &row, x + done, count, to);
        const uint32_t runs = find_ramps(m->scratch, (x + done) / PUPIL_BLOCK, m->cells_a_pixel);
        PUPIL_PIECE(m->kernels, veil_add)(source, m->scratch->run, runs, direct, to);
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
    mapping m = {.object = o,
                 .pupil = pupil,
                 .kernels = pupil_level_kernels(pupil->level),
                 .scratch = scratch,
                 .cells_a_pixel = (float)VEIL_CELLS / (float)in->width};
    find_places(in->width, scratch);
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
