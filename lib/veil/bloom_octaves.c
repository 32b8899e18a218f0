/* The octaves of a bloom: a frame's light at half the size, and again, and each one's blurs. */
#include "bloom_private.h"

#include "base/numeric.h"
#include "core/image.h"

enum { PART = BLOOM_PART / 2, HALVED = 8, REACH = PUPIL_BLOOM_ROWS / 2 };
_Static_assert(PART % 8 == 0, "kernels write whole vectors");

/* What a worker gathers with. */
typedef struct gathering {
    BLOOM_ALIGNED bloom_line row[HALVED];
    BLOOM_ALIGNED float even[3][BLOOM_LINE / 2], odd[3][BLOOM_LINE / 2];
    uint8_t state[HALVED];
    bloom_frame frame;
} gathering;
_Static_assert(sizeof(gathering) + 64 <= sizeof(pupil_bloom_scratch), "PUPIL_BLOOM_SCRATCH_BYTES is too small");

static bloom_object *object_of(pupil_bloom *bloom)
{
    return (bloom_object *)(void *)bloom;
}

/* --- the first octave, from the frame --- */

static void read_row(gathering *g, int32_t y, int32_t x, uint32_t n)
{
    const uint32_t at = (uint32_t)(y + 2 * HALVED) % HALVED;
    const uint32_t lit = pupil_bloom_light(&g->frame, y, 2 * x - BLOOM_SIDE, 2 * n + 2 * BLOOM_SIDE, g->row[at]);
    g->state[at] = lit ? BLOOM_LIT : BLOOM_DARK;
}

/* Which units of row j have light, `count` pixels of them from x on. Where all light scatters, it is in all. */
static void mark(bloom_object *o, uint32_t octave, int32_t j, uint32_t x, uint32_t count, int bright_pass)
{
    uint8_t *lit = pupil_bloom_lit(o, octave, j);
    for (uint32_t at = x; at < x + count; at += BLOOM_STEP) {
        const uint32_t n = x + count - at < BLOOM_STEP ? x + count - at : BLOOM_STEP;
        uint32_t any = !bright_pass;
        for (int channel = 0; channel < 3 && !any; channel++) {
            const float *row = o->memory + pupil_bloom_row(o, octave, o->octave[octave].light, channel, j);
            for (uint32_t i = 0; i < n; i++)
                any |= pupil_bits_of_float(row[BLOOM_LEFT - BLOOM_MARGIN + at + i]);
        }
        lit[at / BLOOM_STEP] = any != 0;
    }
}

/* They have none; what a frame before left there goes. */
static void clear(bloom_object *o, uint32_t octave, int32_t j, uint32_t x, uint32_t count)
{
    uint8_t *lit = pupil_bloom_lit(o, octave, j);
    for (uint32_t at = x; at < x + count; at += BLOOM_STEP) {
        for (int channel = 0; channel < 3 && lit[at / BLOOM_STEP]; channel++) {
            float *row = o->memory + pupil_bloom_row(o, octave, o->octave[octave].light, channel, j);
            __builtin_memset(row + BLOOM_LEFT - BLOOM_MARGIN + at, 0, BLOOM_STEP * sizeof *row);
        }
        lit[at / BLOOM_STEP] = 0;
    }
}

/* Row j of the octave, `n` pixels from x on. */
static void gather_row(bloom_object *o, gathering *g, int32_t j, int32_t x, uint32_t n)
{
    const uint32_t from_margin = (uint32_t)(x + BLOOM_MARGIN);
    if (!pupil_bloom_any(g->row, g->state, HALVED)) {
        clear(o, 1, j, from_margin, n);
        return;
    }
    for (int channel = 0; channel < 3; channel++) {
        const float *row[HALVED];
        for (int32_t k = 0; k < HALVED; k++)
            row[k] = g->row[(2 * j - 3 + k + 2 * HALVED) % HALVED][channel];
        PUPIL_PIECE(g->frame.kernels, bloom_down)(row, 2 * n + 2 * BLOOM_SIDE, g->even[channel], g->odd[channel]);
    }
    for (int channel = 0; channel < 3; channel++) {
        const float *even = g->even[channel] + BLOOM_SIDE / 2, *odd = g->odd[channel] + BLOOM_SIDE / 2;
        float *to = o->memory + pupil_bloom_row(o, 1, o->octave[1].light, channel, j) + BLOOM_LEFT + x;
        PUPIL_PIECE(g->frame.kernels, bloom_halve)(even, odd, n, to);
    }
    mark(o, 1, j, from_margin, n, g->frame.threshold > 0.0f);
}

/* Rows first to end of the octave, `n` pixels from x on, down the rows; x may be before the picture. */
static void gather_part(bloom_object *o, gathering *g, int32_t first, int32_t end, int32_t x, uint32_t n)
{
    for (int32_t y = 2 * first - 3; y < 2 * first + 3; y++)
        read_row(g, y, x, n);
    for (int32_t j = first; j < end; j++) {
        read_row(g, 2 * j + 3, x, n);
        read_row(g, 2 * j + 4, x, n);
        gather_row(o, g, j, x, n);
    }
}

static int check_frame(const bloom_object *o, const pupil_image_const *frame, uint32_t first_row, uint32_t count)
{
    if (pupil_pixel_is_mosaic(frame->pixel))
        return PUPIL_ERR_PIXEL;
    if (frame->width != o->config.width || frame->height != o->config.height)
        return PUPIL_ERR_SIZE;
    if (first_row > frame->height || count > frame->height - first_row || first_row % 2)
        return PUPIL_ERR_ROWS;
    return count % 2 && first_row + count != frame->height ? PUPIL_ERR_ROWS : PUPIL_OK;
}

int pupil_bloom_gather_rows(pupil_bloom *bloom, const pupil_t *pupil, const pupil_image_const *frame,
                            uint32_t first_row, uint32_t count, pupil_bloom_scratch *scratch)
{
    pupil_input in;
    int error = scratch ? pupil_bloom_check(bloom) : PUPIL_ERR_NULL;
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = pupil_input_read(&in, frame);
    if (!error)
        error = check_frame(object_of(bloom), &in.image, first_row, count);
    bloom_object *o = object_of(bloom);
    if (error || !count || o->octaves < 2)
        return error;
    gathering *g = (gathering *)pupil_bloom_aligned(scratch);
    g->frame.kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    g->frame.threshold = (float)o->config.threshold;
    pupil_veil_rows_begin(&g->frame.rows, &in.image);
    const int last = first_row + count == o->config.height;
    const int32_t first = first_row ? (int32_t)(first_row / 2) : 1 - BLOOM_MARGIN;
    const int32_t end = last ? (int32_t)o->octave[1].height + BLOOM_MARGIN - 1 : (int32_t)((first_row + count) / 2);
    const int32_t beyond = (int32_t)o->octave[1].width + BLOOM_MARGIN;
    for (int32_t x = -BLOOM_MARGIN; x < beyond; x += PART)
        gather_part(o, g, first, end, x, (uint32_t)(beyond - x < PART ? beyond - x : PART));
    return PUPIL_OK;
}

/* --- the others --- */

static int is_row_lit(bloom_object *o, uint32_t octave, int32_t y)
{
    if (y < -BLOOM_MARGIN || y >= (int32_t)o->octave[octave].height + BLOOM_MARGIN)
        return 0;
    const uint8_t *lit = pupil_bloom_lit(o, octave, y);
    uint32_t any = 0;
    for (uint32_t u = 0; u < o->octave[octave].units; u++)
        any |= lit[u];
    return any != 0;
}

/* Row j of octave k + 1. */
static void halve_row(bloom_object *o, const pupil_kernels *kernels, uint32_t k, int32_t j)
{
    const bloom_octave *from = &o->octave[k], *to = &o->octave[k + 1];
    const uint32_t across = to->width + 2 * BLOOM_MARGIN, middle = BLOOM_LEFT / 2 - BLOOM_MARGIN;
    float *even = o->memory + o->line, *odd = even + from->stride / 2;
    int lit = 0;
    for (int32_t i = 0; i < HALVED; i++)
        lit |= is_row_lit(o, k, 2 * j - 3 + i);
    if (!lit) {
        clear(o, k + 1, j, 0, across);
        return;
    }
    for (int channel = 0; channel < 3; channel++) {
        const float *rows[HALVED];
        for (int32_t i = 0; i < HALVED; i++)
            rows[i] = o->memory + pupil_bloom_row(o, k, from->light, channel, 2 * j - 3 + i);
        float *row = o->memory + pupil_bloom_row(o, k + 1, to->light, channel, j) + BLOOM_LEFT - BLOOM_MARGIN;
        PUPIL_PIECE(kernels, bloom_down)(rows, from->stride, even, odd);
        PUPIL_PIECE(kernels, bloom_halve)(even + middle, odd + middle, across, row);
    }
    mark(o, k + 1, j, 0, across, o->config.threshold > 0.0);
}

static void halve(bloom_object *o, const pupil_kernels *kernels, uint32_t k)
{
    const int32_t end = (int32_t)o->octave[k + 1].height + BLOOM_MARGIN - 1;
    for (int32_t j = 1 - BLOOM_MARGIN; j < end; j++)
        halve_row(o, kernels, k, j);
}

/* Units first to end of row y get what the kernel scatters. */
static void blur_units(bloom_object *o, const pupil_kernels *kernels, uint32_t octave, int channel, int32_t y,
                       uint32_t first, uint32_t end)
{
    enum { MOST = BLOOM_PART / BLOOM_STEP };
    const bloom_octave *at = &o->octave[octave];
    float(*sums)[PUPIL_BLOOM_LINE] = (float(*)[PUPIL_BLOOM_LINE])(void *)(o->memory + o->sums);
    float *to = o->memory + pupil_bloom_row(o, octave, at->blurred, channel, y) + BLOOM_LEFT - BLOOM_MARGIN;
    for (; first < end; first += MOST) {
        const uint32_t n = (end - first < MOST ? end - first : MOST) * BLOOM_STEP, from = first * BLOOM_STEP;
        const float *row[PUPIL_BLOOM_ROWS];
        for (int32_t i = 0; i < PUPIL_BLOOM_ROWS; i++)
            row[i] = o->memory + pupil_bloom_row(o, octave, at->light, channel, y - REACH + i) + BLOOM_LEFT -
                     BLOOM_MARGIN - BLOOM_SIDE + from;
        PUPIL_PIECE(kernels, bloom_columns)(row, &o->taps[octave], n + 2 * BLOOM_SIDE, sums);
        PUPIL_PIECE(kernels, bloom_rows)((const float(*)[PUPIL_BLOOM_LINE])sums, n, to + from, 0);
    }
}

/* Which units of row y have light within reach: some rows, and the units beside them. */
static uint8_t *find_need(bloom_object *o, uint32_t octave, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    uint8_t *need = (uint8_t *)o->memory + o->need;
    if (!(o->config.threshold > 0.0)) {
        __builtin_memset(need, 1, at->units);
        return need;
    }
    __builtin_memset(need, 0, at->units);
    for (int32_t j = y - REACH; j <= y + REACH; j++) {
        if (j < -BLOOM_MARGIN || j >= (int32_t)at->height + BLOOM_MARGIN)
            continue;
        const uint8_t *lit = pupil_bloom_lit(o, octave, j);
        for (uint32_t u = 0; u < at->units; u++)
            need[u] |= lit[u];
    }
    for (uint32_t u = 0, before = 0; u < at->units; u++) {
        const uint32_t here = need[u], after = u + 1 < at->units ? need[u + 1] : 0;
        need[u] = (uint8_t)(before | here | after);
        before = here;
    }
    return need;
}

/* Units of an octave that are worked down the rows: what all rows within reach have there is in the L1 cache. */
typedef struct bloom_strip {
    uint32_t octave, first, end;
    int channel;
} bloom_strip;
enum { STRIP = 512 };

static void blur_strip_row(bloom_object *o, const pupil_kernels *kernels, const bloom_strip *s, int32_t y,
                           const uint8_t *need)
{
    float *row = o->memory + pupil_bloom_row(o, s->octave, o->octave[s->octave].blurred, s->channel, y);
    for (uint32_t first = s->first, end; first < s->end; first = end) {
        for (end = first; end < s->end && need[end]; end++)
            ;
        blur_units(o, kernels, s->octave, s->channel, y, first, end);
        for (; end < s->end && !need[end]; end++)
            __builtin_memset(row + BLOOM_LEFT - BLOOM_MARGIN + end * BLOOM_STEP, 0, BLOOM_STEP * sizeof *row);
    }
}

/* What comes from the octave above. */
static void add_coarser(bloom_object *o, const pupil_kernels *kernels, const bloom_strip *s, int32_t y)
{
    enum { BEFORE = 6 }; /* of a strip's first pixel, so that lines are read from multiples of 8 on */
    const bloom_octave *at = &o->octave[s->octave];
    const uint32_t half = s->first * (BLOOM_STEP / 2), all = at->width / 2 + BLOOM_MARGIN;
    const uint32_t most = (s->end - s->first) * (BLOOM_STEP / 2), n = all - half < most ? all - half : most;
    const uint32_t from = BLOOM_LEFT - BLOOM_MARGIN / 2 - BEFORE + half;
    float *line = o->memory + o->line;
    float *row = o->memory + pupil_bloom_row(o, s->octave, at->blurred, s->channel, y);
    if (all <= half)
        return;
    pupil_bloom_between(o, kernels, s->octave + 1, s->channel, y, from, most + BLOOM_STEP / 2, line);
    PUPIL_PIECE(kernels, bloom_widen)(line + BEFORE, n, row + BLOOM_LEFT - BLOOM_MARGIN + 2 * half);
}

static void blur(bloom_object *o, const pupil_kernels *kernels, uint32_t octave)
{
    const bloom_octave *at = &o->octave[octave];
    const int32_t end = (int32_t)at->height + BLOOM_MARGIN - 1;
    for (uint32_t first = 0; first < at->units; first += STRIP)
        for (int channel = 0; channel < 3; channel++) {
            const bloom_strip s = {.octave = octave,
                                   .first = first,
                                   .end = at->units - first < STRIP ? at->units : first + STRIP,
                                   .channel = channel};
            for (int32_t y = 1 - BLOOM_MARGIN; y < end; y++) {
                blur_strip_row(o, kernels, &s, y, find_need(o, octave, y));
                if (octave + 1 < o->octaves)
                    add_coarser(o, kernels, &s, y);
            }
        }
}

static int is_lit(bloom_object *o)
{
    int lit = 0;
    for (int32_t y = -BLOOM_MARGIN; o->octaves > 1 && y < (int32_t)o->octave[1].height + BLOOM_MARGIN && !lit; y++)
        lit = is_row_lit(o, 1, y);
    return lit;
}

int pupil_bloom_solve(pupil_bloom *bloom, const pupil_t *pupil)
{
    int error = pupil_bloom_check(bloom);
    if (!error)
        error = pupil_object_check(pupil);
    if (error)
        return error;
    bloom_object *o = object_of(bloom);
    const pupil_kernels *kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    o->lit = (uint32_t)is_lit(o);
    if (!o->lit)
        return PUPIL_OK;
    for (uint32_t k = 1; k + 1 < o->octaves; k++)
        halve(o, kernels, k);
    for (uint32_t k = o->octaves - 1; k > 0; k--)
        blur(o, kernels, k);
    return PUPIL_OK;
}
