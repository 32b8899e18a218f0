/* lib/kernels/vector_luma.h: by_luma.h with vectors of bytes, and of 16-bit words, one for a quad, by the functions of
 * avx2_luma.h, avx512_luma.h, neon_luma.h or wasm128_luma.h: w_ is for words, b_ for bytes. The same bits. */
#ifndef PUPIL_KERNELS_VECTOR_LUMA_H
#define PUPIL_KERNELS_VECTOR_LUMA_H

#include "by_luma.h"

/* Constants, in every word. */
typedef struct luma_words {
    v_words low, grey, red_v, blue_u, green_u, green_v, surface, surface_slope, far, far_slope, noise;
} luma_words;

typedef struct scaled_words {
    v_words u, v, red, green, blue; /* as luma_lists's */
} scaled_words;

INLINE luma_words luma_words_of(const pupil_luma_tables *t)
{
    return (luma_words){.low = w_all(0xff),
                        .grey = w_all(-0x7f80),
                        .red_v = w_all(t->red_v),
                        .blue_u = w_all(t->blue_u),
                        .green_u = w_all(t->green_u),
                        .green_v = w_all(t->green_v),
                        .surface = w_all(t->surface),
                        .surface_slope = w_all(t->surface_slope),
                        .far = w_all(t->far),
                        .far_slope = w_all(t->far_slope),
                        .noise = w_all(PUPIL_LUMA_NOISE)};
}

/* Interleaved Cb and Cr, times the ratio. */
INLINE scaled_words scaled_by(const luma_words *c, v_words pairs, v_words ratio)
{
    scaled_words s;
    pairs = w_xor(pairs, c->grey); /* less 128 */
    s.u = w_times(w_left(pairs, 8), ratio);
    s.v = w_times(w_minus_and(pairs, c->low), ratio);
    s.red = w_times(s.v, c->red_v);
    s.blue = w_times(s.u, c->blue_u);
    s.green = w_add(w_times(s.u, c->green_u), w_times(s.v, c->green_v));
    return s;
}

/* All ones where a quad is to be mapped exactly, by its new codes. */
INLINE v_words is_beyond(const luma_words *c, const scaled_words *s, v_bytes upper, v_bytes lower)
{
    const v_words high = w_of_bytes(b_max(upper, lower)), low = w_of_bytes(b_min(upper, lower));
    const v_words most = w_max(w_and(high, c->low), w_right(high, 8)),
                  least = w_min(w_and(low, c->low), w_right(low, 8));
    const v_words surface = w_sub(c->surface, w_times(w_left(most, 7), c->surface_slope));
    const v_words far = w_max(w_add(c->far, w_times(w_left(least, 7), c->far_slope)), c->noise);
    return w_greater(w_max(w_max(s->red, s->blue), s->green), w_min(surface, far));
}

#ifndef LEVEL_HAS_LUMA_ROWS
typedef ratio_tables luma_ratios;

/* The index of the ratio, for the quads in two vectors of pixels: an eighth of four pixels' sum. */
INLINE v_words mean_of(v_bytes upper, v_bytes lower)
{
    return w_right(w_add(b_sums(upper), b_sums(lower)), 3);
}

/* Of two vectors of quads, from i on. */
INLINE void ratios_at(const luma_ratios *r, const pupil_luma_quads *in, size_t i, v_words ratio[2])
{
    const v_words first = mean_of(b_load(in->upper + 2 * i), b_load(in->lower + 2 * i));
    const v_words second = mean_of(b_load(in->upper + 2 * i + 2 * QUADS), b_load(in->lower + 2 * i + 2 * QUADS));
    w_look_up(r, first, second, ratio);
}

/* The new codes of both rows, 2 n bytes each; and what ratios_at needs. */
static void luma_rows(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n, uint8_t *upper,
                      uint8_t *lower, luma_ratios *r)
{
    luma_entries e;
    luma_entries_of(t, &e);
    luma_by_table(&e, t->luma, in->upper, 2 * n, upper);
    if (lower)
        luma_by_table(&e, t->luma, in->lower, 2 * n, lower);
    ratio_tables_of(t, r);
}
#endif

/* Two vectors of quads, from i on, of two rows; upper, lower: codes as luma_rows wrote them. */
typedef struct luma_step {
    scaled_words s[2];
    v_words beyond[2];
} luma_step;

INLINE luma_step step_of(const luma_words *c, const luma_ratios *ratios, const pupil_luma_quads *in,
                         const uint8_t *upper, const uint8_t *lower, size_t i)
{
    luma_step step;
    v_words ratio[2];
    fetch(in->upper + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
    fetch(in->lower + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
    fetch(in->chroma + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
    ratios_at(ratios, in, i, ratio);
    for (size_t k = 0; k < 2; k++) {
        const size_t at = 2 * (i + k * QUADS);
        step.s[k] = scaled_by(c, w_load(in->chroma + at), ratio[k]);
        step.beyond[k] = is_beyond(c, &step.s[k], b_load(upper + at), b_load(lower + at));
    }
    return step;
}

/* One row counts as two. */
INLINE pupil_luma_quads both_rows(const pupil_luma_quads *in)
{
    return (pupil_luma_quads){in->upper, in->lower ? in->lower : in->upper, in->chroma};
}

static uint32_t yuv_by_luma(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                            const pupil_luma_target *out, uint16_t *exact)
{
    const luma_words c = luma_words_of(t);
    luma_ratios ratios;
    const uint32_t whole = n / (2 * QUADS) * (2 * QUADS);
    uint32_t parts = 0;
    const pupil_luma_quads rows = both_rows(in); /* and `to`: copies, which no store can change */
    const pupil_luma_target to = {out->upper, out->lower ? out->lower : out->upper, out->chroma, 0};
    if (whole)
        luma_rows(t, in, whole, out->upper, out->lower, &ratios);
    for (size_t i = 0; i < whole; i += 2 * QUADS) {
        const luma_step step = step_of(&c, &ratios, &rows, to.upper, to.lower, i);
        fetch(to.upper + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
        fetch(to.lower + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
        fetch(to.chroma + 2 * i, 4 * QUADS, FETCH_AHEAD_BYTES);
        for (size_t k = 0; k < 2; k++) {
            b_store(to.chroma + 2 * (i + k * QUADS), w_to_pairs(step.s[k].u, step.s[k].v));
            w_store(exact + i + k * QUADS, step.beyond[k]);
        }
        parts |= (uint32_t)w_any(w_or(step.beyond[0], step.beyond[1])) << i / PUPIL_LUMA_PART;
    }
    return yuv_quads(t, in, whole, n, out, exact) | parts;
}

/* What is added to grey, as bytes that are added and bytes that are subtracted, twice each. */
typedef struct byte_change {
    v_bytes more[2], less[2];
} byte_change;

INLINE byte_change change_of(v_words first, v_words second)
{
    byte_change c;
    const v_words two = w_all(2), none = w_all(0);
    first = w_right_signed(w_add(first, two), 2);
    second = w_right_signed(w_add(second, two), 2);
    b_twice(w_to_bytes(first, second), c.more);
    b_twice(w_to_bytes(w_sub(none, first), w_sub(none, second)), c.less);
    return c;
}

INLINE void store_changed(const uint8_t *grey, const byte_change *red, const byte_change *green,
                          const byte_change *blue, int blue_first, uint8_t *rgba)
{
    for (int k = 0; k < 2; k++) {
        const v_bytes y = b_load(grey + (size_t)k * 2 * QUADS);
        const v_bytes r = b_less(b_more(y, red->more[k]), red->less[k]);
        const v_bytes g = b_less(b_more(y, green->more[k]), green->less[k]);
        const v_bytes b = b_less(b_more(y, blue->more[k]), blue->less[k]);
        b_store_rgba(rgba + (size_t)k * 8 * QUADS, blue_first ? b : r, g, blue_first ? r : b);
    }
}

static uint32_t rgb_by_luma(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                            const pupil_luma_target *out, uint16_t *exact)
{
    const luma_words c = luma_words_of(t);
    uint8_t grey[2][2 * PUPIL_LUMA_QUADS];
    luma_ratios ratios;
    const uint32_t whole = n / (2 * QUADS) * (2 * QUADS);
    uint32_t parts = 0;
    const pupil_luma_quads rows = both_rows(in);
    if (whole)
        luma_rows(t, in, whole, grey[0], in->lower ? grey[1] : 0, &ratios);
    for (size_t i = 0; i < whole; i += 2 * QUADS) {
        const luma_step step = step_of(&c, &ratios, &rows, grey[0], grey[in->lower ? 1 : 0], i);
        fetch(out->upper + 8 * i, 16 * QUADS, FETCH_AHEAD_BYTES);
        if (in->lower)
            fetch(out->lower + 8 * i, 16 * QUADS, FETCH_AHEAD_BYTES);
        const byte_change red = change_of(step.s[0].red, step.s[1].red);
        const byte_change green = change_of(step.s[0].green, step.s[1].green);
        const byte_change blue = change_of(step.s[0].blue, step.s[1].blue);
        store_changed(grey[0] + 2 * i, &red, &green, &blue, out->blue_first, out->upper + 8 * i);
        if (in->lower)
            store_changed(grey[1] + 2 * i, &red, &green, &blue, out->blue_first, out->lower + 8 * i);
        for (size_t k = 0; k < 2; k++) {
            w_store(exact + i + k * QUADS, step.beyond[k]);
        }
        parts |= (uint32_t)w_any(w_or(step.beyond[0], step.beyond[1])) << i / PUPIL_LUMA_PART;
    }
    return rgb_quads(t, in, whole, n, out, grey, exact) | parts;
}

#define LUMA_PIECES .yuv_by_luma = yuv_by_luma, .rgb_by_luma = rgb_by_luma

#endif
