/* lib/kernels/by_luma.h: quads by tables of luma (kernels.h: pupil_luma_tables), one by one. The scalar level's
 * kernels; other levels use them for the last quads of a row (vector_luma.h). */
#ifndef PUPIL_KERNELS_BY_LUMA_H
#define PUPIL_KERNELS_BY_LUMA_H

#include "kernels.h"

/* a * b in 2^-15, rounded: an instruction of every level but this one. */
static inline int32_t times_15(int32_t a, int32_t b)
{
    return (a * b + 0x4000) >> 15;
}

static inline int32_t larger_of(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static inline int32_t smaller_of(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline uint8_t byte_within(int32_t x)
{
    return (uint8_t)larger_of(smaller_of(x, 255), 0);
}

/* Bytes i to n. */
static inline void bytes_by_table(const uint8_t *restrict table, const uint8_t *from, uint32_t i, uint32_t n,
                                  uint8_t *to)
{
    for (; i < n; i++) {
        to[i] = table[from[i]];
        PUPIL_ONE_BY_ONE;
    }
}

/* New codes of the pixels of two rows, or twice of one. */
typedef struct luma_codes {
    const uint8_t *upper, *lower;
} luma_codes;

/* Of the quads of a part, in lists that are each made by a loop of its own: all loops except the look-ups suit vectors.
 */
typedef struct luma_lists {
    int16_t ratio[PUPIL_LUMA_PART];
    int16_t u[PUPIL_LUMA_PART], v[PUPIL_LUMA_PART];                              /* scaled */
    int16_t red[PUPIL_LUMA_PART], green[PUPIL_LUMA_PART], blue[PUPIL_LUMA_PART]; /* above grey, in quarters of a code */
} luma_lists;

static inline void find_means(const uint8_t *restrict upper, const uint8_t *restrict lower, uint32_t n,
                              int16_t *restrict mean)
{
    for (size_t i = 0; i < n; i++)
        mean[i] = (int16_t)((upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1]) >> 3);
}

static inline void look_up_ratios(const pupil_luma_tables *t, uint32_t n, int16_t *ratio)
{
    for (uint32_t i = 0; i < n; i++) {
        const int32_t mean = ratio[i];
        ratio[i] = (int16_t)(t->ratio_low[mean] | t->ratio_high[mean] << 8);
        PUPIL_ONE_BY_ONE;
    }
}

static inline void scale_chroma(const pupil_luma_tables *t, const uint8_t *restrict chroma, uint32_t n, luma_lists *q)
{
    const int16_t *restrict ratio = q->ratio;
    int16_t *restrict u = q->u, *restrict v = q->v;
    for (size_t i = 0; i < n; i++) {
        u[i] = (int16_t)times_15((int16_t)((chroma[2 * i] - 128) * 256), ratio[i]);
        v[i] = (int16_t)times_15((int16_t)((chroma[2 * i + 1] - 128) * 256), ratio[i]);
    }
    const int16_t red_v = t->red_v, green_u = t->green_u, green_v = t->green_v, blue_u = t->blue_u;
    int16_t *restrict red = q->red, *restrict green = q->green, *restrict blue = q->blue;
    for (size_t i = 0; i < n; i++) {
        red[i] = (int16_t)times_15(v[i], red_v);
        green[i] = (int16_t)(times_15(u[i], green_u) + times_15(v[i], green_v));
        blue[i] = (int16_t)times_15(u[i], blue_u);
    }
}

/* Which quads are to be mapped exactly, by their new codes a and b. */
static inline void find_exact(const pupil_luma_tables *t, const uint8_t *restrict a, const uint8_t *restrict b,
                              const luma_lists *q, uint32_t n, uint16_t *restrict exact)
{
    const int16_t *restrict red = q->red, *restrict green = q->green, *restrict blue = q->blue;
    const int16_t slope = t->surface_slope, far_slope = t->far_slope;
    const int32_t surface_at_0 = t->surface, far_at_0 = t->far;
    for (size_t i = 0; i < n; i++) {
        const int16_t most = (int16_t)larger_of(larger_of(a[2 * i], a[2 * i + 1]), larger_of(b[2 * i], b[2 * i + 1]));
        const int16_t least =
            (int16_t)smaller_of(smaller_of(a[2 * i], a[2 * i + 1]), smaller_of(b[2 * i], b[2 * i + 1]));
        const int32_t surface = surface_at_0 - times_15((int16_t)(most * 128), slope);
        const int32_t far = larger_of(far_at_0 + times_15((int16_t)(least * 128), far_slope), PUPIL_LUMA_NOISE);
        exact[i] = larger_of(larger_of(red[i], blue[i]), green[i]) > smaller_of(surface, far);
    }
}

/* Quads i to n; returns the bits of a pupil_by_luma_kernel. */
static inline uint32_t look_up_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, const luma_codes *new,
                                     uint32_t i, uint32_t n, luma_lists *q, uint16_t *exact)
{
    const size_t at = 2 * (size_t)i;
    uint32_t parts = 0;
    find_means(in->upper + at, (in->lower ? in->lower : in->upper) + at, n - i, q->ratio);
    look_up_ratios(t, n - i, q->ratio);
    scale_chroma(t, in->chroma + at, n - i, q);
    find_exact(t, new->upper + at, new->lower + at, q, n - i, exact + i);
    for (; i < n; i++)
        parts |= (uint32_t)exact[i] << i / PUPIL_LUMA_PART;
    return parts;
}

static inline uint8_t chroma_of_scaled(int32_t scaled)
{
    return byte_within(((scaled + 8) >> 4) + 128);
}

static inline void store_chroma(const int16_t *restrict u, const int16_t *restrict v, uint32_t n, uint8_t *restrict to)
{
    for (size_t i = 0; i < n; i++) {
        to[2 * i] = chroma_of_scaled(u[i]);
        to[2 * i + 1] = chroma_of_scaled(v[i]);
    }
}

/* Quads i to n; as a kernel. */
static inline uint32_t yuv_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t i, uint32_t n,
                                 const pupil_luma_target *out, uint16_t *exact)
{
    const luma_codes new = {out->upper, out->lower ? out->lower : out->upper};
    luma_lists q;
    uint32_t parts = 0;
    bytes_by_table(t->luma, in->upper, 2 * i, 2 * n, out->upper);
    if (out->lower)
        bytes_by_table(t->luma, in->lower, 2 * i, 2 * n, out->lower);
    for (uint32_t end; i < n; i = end) {
        end = n - i < PUPIL_LUMA_PART ? n : i + PUPIL_LUMA_PART;
        parts |= look_up_quads(t, in, &new, i, end, &q, exact);
        store_chroma(q.u, q.v, end - i, out->chroma + 2 * (size_t)i);
    }
    return parts;
}

static inline void rgb_pixel(int32_t grey, const luma_lists *q, uint32_t i, int blue_first, uint8_t to[4])
{
    to[blue_first ? 2 : 0] = byte_within(grey + ((q->red[i] + 2) >> 2));
    to[1] = byte_within(grey + ((q->green[i] + 2) >> 2));
    to[blue_first ? 0 : 2] = byte_within(grey + ((q->blue[i] + 2) >> 2));
    to[3] = 255;
}

/* grey: two rows of PUPIL_LUMA_QUADS; those from quad i on are made here. */
static inline uint32_t rgb_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t i, uint32_t n,
                                 const pupil_luma_target *out, uint8_t grey[2][2 * PUPIL_LUMA_QUADS], uint16_t *exact)
{
    const luma_codes new = {grey[0], grey[in->lower ? 1 : 0]};
    luma_lists q;
    uint32_t parts = 0;
    bytes_by_table(t->luma, in->upper, 2 * i, 2 * n, grey[0]);
    if (in->lower)
        bytes_by_table(t->luma, in->lower, 2 * i, 2 * n, grey[1]);
    for (uint32_t end; i < n; i = end) {
        end = n - i < PUPIL_LUMA_PART ? n : i + PUPIL_LUMA_PART;
        parts |= look_up_quads(t, in, &new, i, end, &q, exact);
        for (uint32_t at = 2 * i; at < 2 * end; at++) {
            rgb_pixel(grey[0][at], &q, at / 2 - i, out->blue_first, out->upper + 4 * (size_t)at);
            if (in->lower)
                rgb_pixel(grey[1][at], &q, at / 2 - i, out->blue_first, out->lower + 4 * (size_t)at);
        }
    }
    return parts;
}

#endif
