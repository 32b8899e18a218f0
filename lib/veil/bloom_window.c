/* A bloom at full size: its narrow lobes, and what comes from the octaves below. */
#include "bloom_private.h"

static bloom_line *line_of(bloom_window *w, int32_t y)
{
    return &w->ring[(y + BLOOM_RING) % BLOOM_RING];
}

void pupil_bloom_window_begin(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x)
{
    const int32_t reach = (int32_t)o->reach;
    for (int32_t i = (int32_t)y - reach; i < (int32_t)y + reach; i++)
        pupil_bloom_light(&w->frame, i, (int32_t)x - BLOOM_LEFT, *line_of(w, i));
}

/* A channel's lobes at full size of the row whose line is *middle. */
static void add_lobe(const bloom_lobe *lobe, bloom_window *w, bloom_line *const *middle, int channel, uint32_t n)
{
    const float *one[BLOOM_TAPS], *other[BLOOM_TAPS];
    const int taps = (int)lobe->taps;
    for (int k = 0; k < taps; k++) {
        one[k] = (*middle[-k])[channel];
        other[k] = (*middle[k])[channel];
    }
    PUPIL_PIECE(w->frame.kernels, bloom_pairs)(one, other, lobe->column, lobe->taps, n + 2 * BLOOM_LEFT, w->line, 0);
    for (int k = 0; k < taps; k++) {
        one[k] = w->line + BLOOM_LEFT - k;
        other[k] = w->line + BLOOM_LEFT + k;
    }
    PUPIL_PIECE(w->frame.kernels, bloom_pairs)(one, other, lobe->row, lobe->taps, n, w->sum.from[channel], 1);
}

void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n,
                            pupil_planes *planes)
{
    const int32_t row = (int32_t)y;
    bloom_line *around[BLOOM_RING];
    for (int32_t i = 0; i < BLOOM_RING; i++)
        around[i] = line_of(w, row + i - BLOOM_RING / 2);
    pupil_bloom_light(&w->frame, row + (int32_t)o->reach, (int32_t)x - BLOOM_LEFT,
                      *line_of(w, row + (int32_t)o->reach));
    for (int channel = 0; channel < 3; channel++) {
        __builtin_memcpy(w->sum.more[channel], (*around[BLOOM_RING / 2])[channel] + BLOOM_LEFT,
                         sizeof w->sum.more[channel]);
        __builtin_memset(w->sum.from[channel], 0, sizeof w->sum.from[channel]);
        for (uint32_t i = 0; i < o->lobes; i++)
            if (!o->lobe[i].octave)
                add_lobe(&o->lobe[i], w, around + BLOOM_RING / 2, channel, n);
        if (o->octaves < 2)
            continue;
        const uint32_t halves = (n + 1) / 2;
        pupil_bloom_between(o, w->frame.kernels, 1, channel, row, BLOOM_LEFT - BLOOM_MARGIN + x / 2,
                            halves + 2 * BLOOM_MARGIN, w->line);
        PUPIL_PIECE(w->frame.kernels, bloom_widen)(w->line + BLOOM_MARGIN, halves, w->sum.from[channel]);
    }
    PUPIL_PIECE(w->frame.kernels, scatter)(planes, n, 1.0f, &w->sum, o->middle);
}
