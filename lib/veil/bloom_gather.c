/* The first octave of a bloom, from a frame: its light at half the size, and where it has lamps. */
#include "bloom_private.h"

#include "core/image.h"

enum {
    HALVED = 8,
    PART = (BLOOM_LINE - 2 * BLOOM_SIDE) / 2, /* pixels of the octave */
    UNITS = PART / BLOOM_UNIT,
    GROUP = 8, /* rows of the octave for which the frame is searched for lamps at a time */
    AROUND = HALVED - 2,
    MOST_UNITS = PUPIL_MAX_SIDE_PX / 2 / BLOOM_UNIT + 2
};
_Static_assert(PART % BLOOM_UNIT == 0, "a part is whole units");

/* A worker's scratch. */
typedef struct gathering {
    BLOOM_ALIGNED bloom_line row[HALVED];
    BLOOM_ALIGNED pupil_bloom_room room;
    uint8_t state[HALVED];
    int32_t is[HALVED];                                   /* the frame's rows that are in `row` */
    uint32_t lamps[2 * GROUP + AROUND][BLOOM_MOST_WORDS]; /* with a bright pass, of the frame's rows from `first` on */
    int32_t first;
    int32_t own, own_end;           /* the caller's rows of the frame: lamps of rows next to them are not kept */
    uint8_t lit[GROUP][MOST_UNITS]; /* of the octave's rows */
    bloom_frame frame;
} gathering;
_Static_assert(sizeof(gathering) + 64 <= sizeof(pupil_bloom_scratch), "PUPIL_BLOOM_SCRATCH_BYTES is too small");

/* Rows first to end of the octave, in units first_unit to end_unit. */
typedef struct gathered {
    int32_t first, end;
    uint32_t first_unit, end_unit;
} gathered;

static bloom_object *object_of(pupil_bloom *bloom)
{
    return (bloom_object *)(void *)bloom;
}

/* --- where lamps are --- */

/* The lamps of row y within reach of the units of a part. */
static uint32_t lamps_of_part(const bloom_object *o, const gathering *g, int32_t y, const gathered *part)
{
    const int32_t eight = (int32_t)(part->first_unit * 2 * BLOOM_UNIT / BLOOM_EIGHT) - 2;
    return pupil_bloom_bits(g->lamps[y - g->first], o->config.width, eight, 2 * PART / BLOOM_EIGHT + 2);
}

static void find_units(const bloom_object *o, gathering *g, int32_t j, uint8_t *lit)
{
    enum { BITS = 2 * BLOOM_UNIT / BLOOM_EIGHT };
    const uint32_t words = pupil_bloom_words(o->config.width);
    uint32_t any[BLOOM_MOST_WORDS] = {0};
    for (int32_t y = 2 * j - 3; y <= 2 * j + 4; y++)
        for (uint32_t i = 0; i < words; i++)
            any[i] |= g->lamps[y - g->first][i];
    for (uint32_t u = 0; u < o->octave[1].units; u++)
        lit[u] = pupil_bloom_bits(any, o->config.width, (int32_t)(BITS * u) - 2, BITS + 2) != 0;
}

/* The lamps of the frame's rows that make up rows first to end of the octave. `before`: these follow the last ones,
 * some of which are used again. */
static void find_lamps(bloom_object *o, gathering *g, int32_t first, int32_t end, int before)
{
    const int32_t from = 2 * first - 3, to = 2 * end + 3;
    const uint32_t words = pupil_bloom_words(o->config.width);
    int32_t y = from;
    if (before) {
        __builtin_memmove(g->lamps, g->lamps[from - g->first], AROUND * sizeof g->lamps[0]);
        y += AROUND;
    }
    for (g->first = from; y < to; y++) {
        pupil_bloom_find_lamps(&g->frame, y, g->lamps[y - from]);
        if (y >= g->own && y < g->own_end)
            __builtin_memcpy(pupil_bloom_lamps_of(o, y), g->lamps[y - from], words * sizeof(uint32_t));
    }
    for (int32_t j = first; j < end; j++)
        find_units(o, g, j, g->lit[j - first]);
}

/* --- parts, down the rows --- */

/* Row y of the frame for the part, `n` pixels of the octave wide. */
static void read_row(const bloom_object *o, gathering *g, int32_t y, const gathered *part, uint32_t n)
{
    const uint32_t at = (uint32_t)(y + 2 * HALVED) % HALVED;
    const int bright_pass = g->frame.threshold > 0.0f;
    if (g->is[at] == y)
        return;
    g->is[at] = y;
    if (!bright_pass || lamps_of_part(o, g, y, part)) {
        const int32_t x = 2 * ((int32_t)(part->first_unit * BLOOM_UNIT) - BLOOM_MARGIN) - BLOOM_SIDE;
        pupil_bloom_light(&g->frame, y, x, 2 * n + 2 * BLOOM_SIDE, g->row[at]);
        g->state[at] = BLOOM_LIT;
    } else if (g->state[at] != BLOOM_BLACK) {
        __builtin_memset(g->row[at], 0, sizeof g->row[at]);
        g->state[at] = BLOOM_BLACK;
    }
}

/* Prefetches the row that is written next: for pieces of rows a CPU would wait. */
static void announce(const float *row, uint32_t n)
{
    enum { FLOATS = 16 };
    for (uint32_t at = 0; at < n; at += FLOATS)
        __builtin_prefetch(row + at, 1);
}

static void gather_row(bloom_object *o, gathering *g, int32_t j, const gathered *part)
{
    const bloom_octave *at = &o->octave[1];
    const uint32_t from = part->first_unit * BLOOM_UNIT, all = at->width + 2 * BLOOM_MARGIN;
    const uint32_t end = part->end_unit * BLOOM_UNIT, n = (end < all ? end : all) - from;
    for (int32_t y = 2 * j - 3; y <= 2 * j + 4; y++)
        read_row(o, g, y, part, n);
    const float *row[HALVED];
    for (uint32_t k = 0; k < HALVED; k++)
        row[k] = g->row[((uint32_t)(2 * j - 3 + 2 * HALVED) + k) % HALVED][0];
    for (int channel = 0; channel < 3; channel++) {
        for (int k = 0; channel && k < HALVED; k++)
            row[k] += BLOOM_LINE;
        float *to = o->memory + pupil_bloom_row(o, 1, at->light, channel, j) + BLOOM_LEFT - BLOOM_MARGIN + from;
        announce(to + at->stride, n);
        PUPIL_PIECE(g->frame.kernels, bloom_halve)(row, 0, n, g->room, to);
    }
}

static void forget_rows(gathering *g)
{
    for (int i = 0; i < HALVED; i++) {
        g->is[i] = -4 * HALVED; /* none */
        g->state[i] = BLOOM_DARK;
    }
}

/* All light. */
static void gather_part(bloom_object *o, gathering *g, const gathered *part)
{
    const uint32_t units = part->end_unit - part->first_unit;
    forget_rows(g);
    for (int32_t j = part->first; j < part->end; j++) {
        gather_row(o, g, j, part);
        __builtin_memset(pupil_bloom_flags(o, 1, o->octave[1].lit, j) + part->first_unit, 1, units);
    }
}

/* The units of the part that have light in one of its rows. */
static gathered lit_part(const gathering *g, const gathered *part)
{
    gathered lit = {part->first, part->end, part->end_unit, part->first_unit};
    for (int32_t j = part->first; j < part->end; j++)
        for (uint32_t u = part->first_unit; u < part->end_unit; u++)
            if (g->lit[j - part->first][u]) {
                lit.first_unit = u < lit.first_unit ? u : lit.first_unit;
                lit.end_unit = u >= lit.end_unit ? u + 1 : lit.end_unit;
            }
    return lit;
}

/* Gathers the rows of the part that have light, and clears what an earlier frame left elsewhere. */
static void gather_lit(bloom_object *o, gathering *g, const gathered *part)
{
    const size_t light = o->octave[1].light, flags = o->octave[1].lit;
    const gathered lit = lit_part(g, part);
    forget_rows(g);
    for (int32_t j = part->first; j < part->end; j++) {
        const uint8_t *now = g->lit[j - part->first];
        uint32_t any = 0;
        for (uint32_t u = lit.first_unit; u < lit.end_unit; u++)
            any |= now[u];
        if (any) {
            gather_row(o, g, j, &lit);
            pupil_bloom_clear(o, 1, light, flags, j, part->first_unit, lit.first_unit);
            pupil_bloom_clear(o, 1, light, flags, j, lit.end_unit, part->end_unit);
            for (uint32_t u = lit.first_unit; u < lit.end_unit; u++)
                pupil_bloom_flags(o, 1, flags, j)[u] = now[u];
        } else
            pupil_bloom_clear(o, 1, light, flags, j, part->first_unit, part->end_unit);
    }
}

/* Rows first to end of the octave. */
static void gather_all(bloom_object *o, gathering *g, int32_t first, int32_t end)
{
    const int bright_pass = g->frame.threshold > 0.0f;
    const int32_t most = bright_pass ? GROUP : end - first;
    for (int32_t j = first; j < end; j += most) {
        const int32_t last = end - j < most ? end : j + most;
        if (bright_pass)
            find_lamps(o, g, j, last, j > first);
        for (uint32_t u = 0; u < o->octave[1].units; u += UNITS) {
            const uint32_t end_unit = o->octave[1].units - u < UNITS ? o->octave[1].units : u + UNITS;
            const gathered part = {j, last, u, end_unit};
            bright_pass ? gather_lit(o, g, &part) : gather_part(o, g, &part);
        }
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
    if (error || !count)
        return error;
    gathering *g = (gathering *)pupil_bloom_aligned(scratch);
    g->frame.kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    g->frame.threshold = (float)o->config.threshold;
    g->frame.ahead = 2; /* it takes two at a time */
    pupil_veil_rows_begin(&g->frame.rows, &in.image);
    g->own = (int32_t)first_row;
    g->own_end = (int32_t)(first_row + count);
    if (o->octaves < 2) {
        for (int32_t y = g->own; y < g->own_end && g->frame.threshold > 0.0f; y++)
            pupil_bloom_find_lamps(&g->frame, y, pupil_bloom_lamps_of(o, y));
        return PUPIL_OK;
    }
    const int last = first_row + count == o->config.height;
    const int32_t first = first_row ? (int32_t)(first_row / 2) : 1 - BLOOM_MARGIN;
    const int32_t end = last ? (int32_t)o->octave[1].height + BLOOM_MARGIN - 1 : (int32_t)((first_row + count) / 2);
    gather_all(o, g, first, end);
    return PUPIL_OK;
}
