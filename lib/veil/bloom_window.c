/* A bloom at full size: its narrow lobes, and what comes from the octaves below. */
#include "bloom_private.h"

enum { REACH = PUPIL_BLOOM_ROWS / 2 };

static uint32_t place_of(int32_t y)
{
    return (uint32_t)(y + PUPIL_BLOOM_ROWS) % PUPIL_BLOOM_ROWS;
}

static void read_row(bloom_window *w, int32_t y, uint32_t x, uint32_t n)
{
    const uint32_t at = place_of(y);
    w->units[at] = pupil_bloom_light(&w->frame, y, (int32_t)x - BLOOM_SIDE, n + 2 * BLOOM_SIDE, w->ring[at]);
    w->state[at] = w->units[at] ? BLOOM_LIT : BLOOM_DARK;
}

void pupil_bloom_window_begin(bloom_window *w, uint32_t y, uint32_t x, uint32_t n)
{
    for (int32_t i = (int32_t)y - REACH; i < (int32_t)y + REACH; i++)
        read_row(w, i, x, n);
}

/* What the kernel at full size scatters to n pixels from the block's pixel x on. */
static void add_pixels(const bloom_object *o, bloom_window *w, int32_t y, uint32_t x, uint32_t n, float *const plane[3])
{
    const float *row[PUPIL_BLOOM_ROWS];
    uint32_t place = place_of(y - REACH);
    for (int i = 0; i < PUPIL_BLOOM_ROWS; i++) {
        row[i] = w->ring[place][0] + x;
        place = place + 1 < PUPIL_BLOOM_ROWS ? place + 1 : 0;
    }
    for (int channel = 0; channel < 3; channel++) {
        for (int i = 0; channel && i < PUPIL_BLOOM_ROWS; i++)
            row[i] += BLOOM_LINE;
        PUPIL_PIECE(w->frame.kernels, bloom_columns)(row, &o->taps[0], n + 2 * BLOOM_SIDE, w->sums);
        PUPIL_PIECE(w->frame.kernels, bloom_rows)((const float(*)[PUPIL_BLOOM_LINE])w->sums, n, plane[channel] + x, 1);
    }
}

/* Where there is light within reach: a line begins half a unit before the block, so a unit of the block has two of it
 * within reach. */
static void add_full(const bloom_object *o, bloom_window *w, int32_t y, uint32_t n, float *const plane[3])
{
    uint32_t lit = 0;
    for (int i = 0; i < PUPIL_BLOOM_ROWS; i++)
        lit |= w->units[i];
    const uint32_t need = lit | lit >> 1, units = (n + BLOOM_UNIT - 1) / BLOOM_UNIT;
    for (uint32_t first = 0, end; first < units; first = end + 1) {
        for (end = first; end < units && need >> end & 1; end++)
            ;
        const uint32_t x = first * BLOOM_UNIT, most = (end - first) * BLOOM_UNIT;
        if (most)
            add_pixels(o, w, y, x, most < n - x ? most : n - x, plane);
    }
}

/* What the next rows need of the octave: pieces of rows are too short for a CPU to expect that by itself. */
static void announce(const bloom_object *o, int channel, int32_t y, uint32_t from, uint32_t n)
{
    enum { FLOATS = 16 };
    const float *next = o->memory + pupil_bloom_row(o, 1, o->octave[1].blurred, channel, y / 2 + 3) + from;
    for (uint32_t at = 0; at < n; at += FLOATS)
        __builtin_prefetch(next + at);
}

void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n,
                            pupil_planes *planes)
{
    float *const plane[3] = {planes->r, planes->g, planes->b};
    const uint32_t halves = (n + 1) / 2, from = BLOOM_LEFT - BLOOM_MARGIN + x / 2;
    read_row(w, (int32_t)y + REACH, x, n);
    const int lit = pupil_bloom_any(w->ring, w->state, PUPIL_BLOOM_ROWS);
    if (lit)
        add_full(o, w, (int32_t)y, n, plane);
    for (int channel = 0; channel < 3 && o->lit; channel++) {
        if (y % 2 == 0)
            announce(o, channel, (int32_t)y, from, halves + 2 * BLOOM_MARGIN);
        pupil_bloom_between(o, w->frame.kernels, 1, channel, (int32_t)y, from, halves + 2 * BLOOM_MARGIN, w->line);
        PUPIL_PIECE(w->frame.kernels, bloom_widen)(w->line + BLOOM_MARGIN, halves, plane[channel]);
    }
}
