/* A bloom at full size: its narrow lobes, and the light from the coarser octaves. */
#include "bloom_private.h"

enum { REACH = PUPIL_BLOOM_ROWS / 2 };

static uint32_t place_of(int32_t y)
{
    return (uint32_t)(y + PUPIL_BLOOM_ROWS) % PUPIL_BLOOM_ROWS;
}

/* --- what light reaches --- */

static uint32_t lamps_at(const bloom_object *o, int32_t y, uint32_t x)
{
    enum { ACROSS = BLOOM_PART / BLOOM_EIGHT + 2 };
    if (y < 0 || y >= (int32_t)o->config.height)
        return 0;
    const uint32_t *lamps = (const uint32_t *)(const void *)(o->memory + pupil_bloom_lamps_row(o, y));
    return pupil_bloom_bits(lamps, o->config.width, (int32_t)(x / BLOOM_EIGHT) - 1, ACROSS);
}

/* Notes whether row y of the block has light. The light is read only where a kernel needs it. */
static void step_to(const bloom_object *o, bloom_window *w, int32_t y)
{
    const uint32_t at = place_of(y);
    w->lamps[at] = w->frame.threshold > 0.0f ? lamps_at(o, y, w->x) : ~UINT32_C(0);
    if (w->lamps[at])
        w->state[at] = BLOOM_UNREAD;
    else if (w->state[at] != BLOOM_BLACK)
        w->state[at] = BLOOM_DARK;
}

void pupil_bloom_window_begin(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n)
{
    w->x = x;
    w->n = n;
    __builtin_memset(w->state, BLOOM_DARK, sizeof w->state);
    for (int32_t i = (int32_t)y - REACH; i < (int32_t)y + REACH; i++)
        step_to(o, w, i);
}

/* Which units of the block have light within reach of the kernel at full size, that is in four of the lamps' bits: a
 * bit each. */
static uint32_t units_in_reach(const bloom_window *w)
{
    uint32_t lamps = 0;
    for (int i = 0; i < PUPIL_BLOOM_ROWS; i++)
        lamps |= w->lamps[i];
    uint32_t units =
        (lamps | lamps >> 1 | lamps >> 2 | lamps >> 3) & 0x55555555; /* every other bit, which are then packed */
    units = (units | units >> 1) & 0x33333333;
    units = (units | units >> 2) & 0x0f0f0f0f;
    units = (units | units >> 4) & 0x00ff00ff;
    return (units | units >> 8) & ((1u << (w->n + BLOOM_UNIT - 1) / BLOOM_UNIT) - 1);
}

/* Whether the octaves add light to rows y to end_row of a block. If a frame has no lamp, solve returns early and they
 * still hold an earlier frame. */
static int octaves_reach(const bloom_object *o, int32_t y, int32_t end_row, uint32_t x, uint32_t n)
{
    const uint32_t first = (x / 2 + BLOOM_MARGIN - 2) / BLOOM_UNIT;
    const uint32_t end = (x / 2 + (n + 1) / 2 + BLOOM_MARGIN + 1) / BLOOM_UNIT + 1;
    const int32_t above = y / 2 - (y & 1 ? 1 : 2), last = (end_row - 1) / 2 + (end_row & 1 ? 1 : 2);
    return o->lit && o->octaves > 1 && pupil_bloom_any(o, 1, o->octave[1].reached, above, last + 1 - above, first, end);
}

int pupil_bloom_reaches(const bloom_object *o, uint32_t y, uint32_t end_row, uint32_t x, uint32_t n)
{
    if (octaves_reach(o, (int32_t)y, (int32_t)end_row, x, n))
        return 1;
    for (int32_t i = (int32_t)y - REACH; i < (int32_t)end_row + REACH; i++)
        if (lamps_at(o, i, x))
            return 1;
    return 0;
}

int pupil_bloom_window_step(const bloom_object *o, bloom_window *w, uint32_t y)
{
    step_to(o, w, (int32_t)y + REACH);
    w->units = units_in_reach(w);
    w->octaves =
        !(w->frame.threshold > 0.0f) ? o->octaves > 1 : octaves_reach(o, (int32_t)y, (int32_t)y + 1, w->x, w->n);
    return w->units || w->octaves;
}

/* --- what it gives --- */

int pupil_bloom_window_read(bloom_window *w, uint32_t y)
{
    for (int32_t i = (int32_t)y - REACH; w->units && i <= (int32_t)y + REACH; i++) {
        const uint32_t at = place_of(i);
        if (w->state[at] == BLOOM_UNREAD) {
            w->whole[at] = (uint8_t)pupil_bloom_light(&w->frame, i, (int32_t)w->x - BLOOM_SIDE, w->n + 2 * BLOOM_SIDE,
                                                      w->ring[at]);
            w->state[at] = BLOOM_LIT;
        } else if (w->state[at] == BLOOM_DARK) {
            __builtin_memset(w->ring[at], 0, sizeof w->ring[at]);
            w->state[at] = BLOOM_BLACK;
        }
    }
    const uint32_t at = place_of((int32_t)y);
    return w->units && w->state[at] == BLOOM_LIT && w->whole[at];
}

/* What the kernel at full size scatters to n pixels from the block's pixel `from` on. */
static void add_pixels(const bloom_object *o, bloom_window *w, int32_t y, uint32_t from, uint32_t n, int whole,
                       float *const plane[3])
{
    const float *row[PUPIL_BLOOM_ROWS];
    uint32_t place = place_of(y - REACH);
    for (int i = 0; i < PUPIL_BLOOM_ROWS; i++) {
        row[i] = w->ring[place][0] + from;
        place = place + 1 < PUPIL_BLOOM_ROWS ? place + 1 : 0;
    }
    for (int channel = 0; channel < 3; channel++) {
        for (int i = 0; channel && i < PUPIL_BLOOM_ROWS; i++)
            row[i] += BLOOM_LINE;
        float *to = plane[channel] + from;
        const float *with = whole ? row[REACH] + BLOOM_SIDE : to;
        PUPIL_PIECE(w->frame.kernels, bloom_scatter)(row, 0, &o->taps[0], n, w->room, with, to);
    }
}

/* Where there is light within reach, by runs of units. */
static void add_full(const bloom_object *o, bloom_window *w, int32_t y, int whole, float *const plane[3])
{
    for (uint32_t left = w->units; left;) {
        const uint32_t first = (uint32_t)__builtin_ctz(left), count = (uint32_t)__builtin_ctz(~(left >> first));
        const uint32_t x = first * BLOOM_UNIT, most = count * BLOOM_UNIT;
        add_pixels(o, w, y, x, most < w->n - x ? most : w->n - x, whole, plane);
        left &= ~(((1u << count) - 1) << first);
    }
}

/* Prefetches what the next rows need of the octave: pieces of rows are too short for the CPU's own prefetch. */
static void announce(const float *row, uint32_t n)
{
    enum { FLOATS = 16 };
    for (uint32_t at = 0; at < n; at += FLOATS)
        __builtin_prefetch(row + at);
}

void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, int whole, pupil_planes *planes)
{
    float *const plane[3] = {planes->r, planes->g, planes->b};
    const uint32_t halves = (w->n + 1) / 2;
    bloom_four four;
    add_full(o, w, (int32_t)y, whole, plane);
    if (!w->octaves)
        return;
    pupil_bloom_find_four(o, 1, (int32_t)y, (int32_t)(w->x / 2), &four);
    for (int channel = 0; channel < 3; channel++) {
        if (y % 2 == 0)
            announce(four.row[3] + 2 * (size_t)o->octave[1].stride, halves + 2 * BLOOM_SIDE);
        pupil_bloom_take(w->frame.kernels, &four, halves, w->room, plane[channel], 1);
    }
}
