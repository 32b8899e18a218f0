/* Adds scattered light to rows, in planes, which are then mapped as any others. */
#include "scatter.h"

/* --- the veil of a block --- */

/* The veil of pixels between two rows of nodes: from[i] + part * more[i], part being the distance below the upper
 * row. */
static void find_veil(const veil_object *o, uint32_t cell_row, uint32_t x, uint32_t n, pupil_scattered *s)
{
    const uint32_t width = o->config.width;
    const float cells_a_pixel = (float)VEIL_CELLS / (float)width;
    for (uint32_t at = 0; at < n;) {
        const uint32_t cell = pupil_veil_cell_of(x + at, width), next = pupil_veil_first_in_cell(cell + 1, width);
        const uint32_t end = next - x < n ? next - x : n;
        const float part = (float)(2 * (x + at) + 1) * (float)VEIL_CELLS / (float)(2 * width) - (float)cell;
        for (int channel = 0; channel < 3; channel++) {
            const float *upper = &o->solved[channel][cell_row][cell], *lower = &o->solved[channel][cell_row + 1][cell];
            const float across = upper[1] - upper[0], across_below = lower[1] - lower[0];
            const float from = upper[0] + part * across, below = lower[0] + part * across_below;
            const float step = cells_a_pixel * across, more = below - from;
            const float more_step = cells_a_pixel * across_below - step;
            float *restrict to = s->from[channel] + at, *restrict to_more = s->more[channel] + at;
            for (int32_t i = 0; i < (int32_t)(end - at); i++) {
                to[i] = from + step * (float)i;
                to_more[i] = more + more_step * (float)i;
            }
        }
        at = end;
    }
}

/* The veil of a row. That of its blocks is computed only if the present one is of another row of nodes. */
static float find_row(const scatter_map *m, uint32_t y, uint32_t x, uint32_t end, uint32_t *cell_row)
{
    const veil_object *o = m->veil;
    const uint32_t above = pupil_veil_cell_of(y, o->config.height);
    for (uint32_t at = x; above != *cell_row && at < end; at += PUPIL_BLOCK)
        find_veil(o, above, at, end - at < PUPIL_BLOCK ? end - at : PUPIL_BLOCK,
                  &m->block->veil[(at - x) / PUPIL_BLOCK]);
    *cell_row = above;
    return (float)(2 * y + 1) * (float)VEIL_CELLS / (float)(2 * o->config.height) - (float)above;
}

/* --- blocks --- */

/* A CPU prefetches along a row, but the next piece is in the row below. It is prefetched here, a part at a time,
 * because few cache lines can be in flight at once. */
static void fetch(const uint8_t *from, size_t bytes)
{
    for (size_t i = 0; i < bytes; i += 64)
        __builtin_prefetch(from + i);
}

/* Maps pixels x to end of row i of the call to `target`. */
static void map_row(const scatter_map *m, uint32_t i, uint32_t x, uint32_t end, uint32_t *cell_row, uint8_t *target)
{
    scatter_block *b = m->block;
    const pupil_row_job *job = &b->job.map;
    pupil_row row = pupil_veil_row_of(&b->rows, i);
    const size_t in_bytes = pupil_pixel_bytes(job->in_pixel), out_bytes = pupil_pixel_bytes(job->out_pixel);
    const uint32_t y = m->first_row + i;
    row.y = y;
    const float part = m->veil ? find_row(m, y, x, end, cell_row) : 0.0f;
    const float direct = m->veil ? (float)m->veil->result.direct : 1.0f;
    const int all_light = m->bloom && !(m->bloom->config.threshold > 0.0);
    const pupil_scattered *veil = b->veil;
    const uint8_t *next = row.data + (i + 1 < m->out->height ? b->rows.image->stride_bytes : 0) + x * in_bytes;
    for (; x < end; x += PUPIL_BLOCK, target += PUPIL_BLOCK * out_bytes) {
        const uint32_t n = end - x < PUPIL_BLOCK ? end - x : PUPIL_BLOCK;
        const int reached = m->bloom && pupil_bloom_window_step(m->bloom, m->window, y);
        if (!reached && !m->veil) { /* as without bloom */
            fetch(next, n * in_bytes);
            pupil_work_run(job, &row, x, n, target, 0, 0, 0);
            continue; /* which was the last block: with a bloom there is one at a time */
        }
        const int whole = reached && pupil_bloom_window_read(m->window, y) && !m->veil;
        const int opaque = whole || PUPIL_PIECE(job->kernels, load[job->in_pixel])(job->coder, &row, x, n, &b->planes);
        const size_t third = all_light ? 0 : n * in_bytes / 3; /* reading all light prefetches rows further down */
        fetch(next, third);
        if (m->veil)
            PUPIL_PIECE(job->kernels, scatter)(&b->planes, n, direct, veil++, part);
        if (reached)
            pupil_bloom_window_add(m->bloom, m->window, y, whole, &b->planes);
        fetch(next + third, third);
        pupil_map_planes(job, x, y, n, &b->planes, opaque ? 0 : row.data + x * in_bytes, target);
        fetch(next + 2 * third, third);
        next += n * in_bytes;
    }
}

/* Rows first to end of the call. They are few enough to be in a cache still when the next blocks are mapped, so what a
 * CPU prefetches beyond short pieces of rows is not wasted. */
typedef struct band {
    uint32_t first, end;
} band;

static void map_blocks(const scatter_map *m, band rows, uint32_t x, uint32_t end)
{
    uint32_t cell_row = VEIL_CELLS; /* none yet */
    const pupil_image *out = m->out;
    const size_t offset = x * pupil_pixel_bytes(out->pixel);
    for (uint32_t i = rows.first; i < rows.end; i++)
        map_row(m, i, x, end, &cell_row, (uint8_t *)out->data + (ptrdiff_t)i * out->stride_bytes + offset);
}

/* One block, in pairs of rows, which share their chroma. */
static void map_block_to_yuv(const scatter_map *m, band rows, uint32_t x, uint32_t end)
{
    scatter_block *b = m->block;
    uint32_t cell_row = VEIL_CELLS;
    const pupil_image *out = m->out;
    const int planes = (int)pupil_pixel_planes(out->pixel);
    const size_t at_chroma = pupil_chroma_row_bytes(out->pixel, x);
    for (uint32_t i = rows.first; i < rows.end; i += 2) {
        const int two = i + 1 < rows.end;
        uint8_t *upper = (uint8_t *)out->data + (ptrdiff_t)i * out->stride_bytes + x;
        const pupil_yuv_rows to = {
            .upper = upper,
            .lower = upper + out->stride_bytes,
            .chroma = (uint8_t *)out->chroma + (ptrdiff_t)(i / 2) * out->chroma_stride_bytes + at_chroma,
            .cr = planes > 2 ? (uint8_t *)out->cr + (ptrdiff_t)(i / 2) * out->cr_stride_bytes + at_chroma : 0};
        map_row(m, i, x, end, &cell_row, b->codes[0]);
        if (two)
            map_row(m, i + 1, x, end, &cell_row, b->codes[1]);
        pupil_yuv_of_codes(b->job.map.kernels, &b->chroma, b->codes[0], two ? b->codes[1] : 0, end - x, &to);
    }
}

/* Pixels x to end as without bloom. */
static void map_plain(const scatter_map *m, band rows, uint32_t x, uint32_t end)
{
    const pupil_row_job *job = &m->block->job.map;
    const size_t offset = x * pupil_pixel_bytes(m->out->pixel);
    for (uint32_t i = rows.first; i < rows.end && x < end; i++) {
        pupil_row row = pupil_veil_row_of(&m->block->rows, i);
        row.y = m->first_row + i;
        uint8_t *target = (uint8_t *)m->out->data + (ptrdiff_t)i * m->out->stride_bytes + offset;
        pupil_work_run(job, &row, x, end - x, target, 0, 0, 0);
    }
}

/* Blocks that no lamp reaches are mapped together: the longer a piece of a row, the quicker it is read. */
static int is_plain(const scatter_map *m, band rows, uint32_t x, uint32_t end)
{
    if (!m->bloom || m->veil || pupil_pixel_planes(m->out->pixel) > 1 || !(m->bloom->config.threshold > 0.0))
        return 0;
    return !pupil_bloom_reaches(m->bloom, m->first_row + rows.first, m->first_row + rows.end, x, end - x);
}

static void map_band(const scatter_map *m, band rows)
{
    const uint32_t width = m->out->width;
    const int yuv = pupil_pixel_planes(m->out->pixel) > 1;
    const uint32_t step = m->bloom ? BLOOM_PART : yuv ? PUPIL_BLOCK : SCATTER_BLOCKS * PUPIL_BLOCK;
    uint32_t plain = 0; /* from here on */
    for (uint32_t x = 0; x < width; x += step) {
        const uint32_t end = width - x < step ? width : x + step;
        if (is_plain(m, rows, x, end))
            continue;
        map_plain(m, rows, plain, x);
        plain = end;
        if (m->bloom)
            pupil_bloom_window_begin(m->bloom, m->window, m->first_row + rows.first, x, end - x);
        if (yuv)
            map_block_to_yuv(m, rows, x, end);
        else
            map_blocks(m, rows, x, end);
    }
    map_plain(m, rows, plain, width);
}

void pupil_scatter_map(const scatter_map *m, const pupil_object *pupil, const pupil_tone *curve,
                       const pupil_image_const *in)
{
    /* Even numbers of rows. A bloom of all light reads some rows of the band above again, so its bands are larger. */
    const uint32_t most = m->bloom && !(m->bloom->config.threshold > 0.0) ? 128 : 32, height = m->out->height;
    const int yuv = pupil_pixel_planes(m->out->pixel) > 1;
    scatter_block *b = m->block;
    pupil_picture_job_make(pupil, in, curve, yuv ? (uint32_t)PUPIL_PIXEL_RGBA8 : m->out->pixel, &b->job);
    if (yuv)
        pupil_chroma_coder_make(m->out->coding, &b->chroma);
    pupil_veil_rows_begin(&b->rows, in);
    for (uint32_t y = 0; y < height; y += most)
        map_band(m, (band){y, height - y < most ? height : y + most});
}
