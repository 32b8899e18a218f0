/* lib/kernels/by_luma.h: quads by tables of luma (kernels.h: pupil_luma_tables), one by one. The scalar level's
 * kernels; others take it for the last quads of a row (vector_luma.h). */
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

/* In a loop of look-ups: gcc would put vectors together out of single loads, which takes half as long again. */
#if defined(__clang__)
#define ONE_BY_ONE (void)0
#else
#define ONE_BY_ONE __asm__ volatile("")
#endif

/* Bytes i to n. */
static inline void bytes_by_table(const uint8_t *restrict table, const uint8_t *from, uint32_t i, uint32_t n,
                                  uint8_t *to)
{
    for (; i < n; i++) {
        to[i] = table[from[i]];
        ONE_BY_ONE;
    }
}

/* New codes of the pixels of two rows, or twice of one. */
typedef struct luma_codes {
    const uint8_t *upper, *lower;
} luma_codes;

typedef struct luma_quad {
    int32_t u, v;             /* scaled */
    int32_t red, green, blue; /* above grey, in quarters of a code */
} luma_quad;

/* Whether it is to be mapped exactly. */
static inline uint16_t look_up_quad(const pupil_luma_tables *t, const pupil_luma_quads *in, const luma_codes *new,
                                    uint32_t i, luma_quad *q)
{
    const size_t at = 2 * (size_t)i;
    const uint8_t *upper = in->upper + at, *lower = (in->lower ? in->lower : in->upper) + at;
    const uint8_t *a = new->upper + at, *b = new->lower + at;
    const uint32_t mean = (uint32_t)(upper[0] + upper[1] + lower[0] + lower[1]) >> 3;
    const int32_t ratio = t->ratio_low[mean] | t->ratio_high[mean] << 8;
    q->u = times_15((in->chroma[at] - 128) * 256, ratio);
    q->v = times_15((in->chroma[at + 1] - 128) * 256, ratio);
    q->red = times_15(q->v, t->red_v);
    q->green = times_15(q->u, t->green_u) + times_15(q->v, t->green_v);
    q->blue = times_15(q->u, t->blue_u);
    const int32_t most = larger_of(larger_of(a[0], a[1]), larger_of(b[0], b[1]));
    const int32_t least = smaller_of(smaller_of(a[0], a[1]), smaller_of(b[0], b[1]));
    const int32_t surface = t->surface - times_15(most * 128, t->surface_slope);
    const int32_t far = larger_of(t->far + times_15(least * 128, t->far_slope), PUPIL_LUMA_NOISE);
    return larger_of(larger_of(q->red, q->blue), q->green) > smaller_of(surface, far);
}

static inline uint8_t chroma_of_scaled(int32_t scaled)
{
    return byte_within(((scaled + 8) >> 4) + 128);
}

/* Quads i to n; as a kernel. */
static inline uint32_t yuv_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t i, uint32_t n,
                                 const pupil_luma_target *out, uint16_t *exact)
{
    const luma_codes new = {out->upper, out->lower ? out->lower : out->upper};
    uint32_t parts = 0;
    bytes_by_table(t->luma, in->upper, 2 * i, 2 * n, out->upper);
    if (out->lower)
        bytes_by_table(t->luma, in->lower, 2 * i, 2 * n, out->lower);
    for (; i < n; i++) {
        luma_quad q;
        exact[i] = look_up_quad(t, in, &new, i, &q);
        parts |= (uint32_t)exact[i] << i / PUPIL_LUMA_PART;
        out->chroma[2 * (size_t)i] = chroma_of_scaled(q.u);
        out->chroma[2 * (size_t)i + 1] = chroma_of_scaled(q.v);
    }
    return parts;
}

static inline void rgb_pixel(int32_t grey, const luma_quad *q, int blue_first, uint8_t to[4])
{
    to[blue_first ? 2 : 0] = byte_within(grey + ((q->red + 2) >> 2));
    to[1] = byte_within(grey + ((q->green + 2) >> 2));
    to[blue_first ? 0 : 2] = byte_within(grey + ((q->blue + 2) >> 2));
    to[3] = 255;
}

/* grey: two rows of PUPIL_LUMA_QUADS; those from quad i on are made here. */
static inline uint32_t rgb_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t i, uint32_t n,
                                 const pupil_luma_target *out, uint8_t grey[2][2 * PUPIL_LUMA_QUADS], uint16_t *exact)
{
    const luma_codes new = {grey[0], grey[in->lower ? 1 : 0]};
    uint32_t parts = 0;
    bytes_by_table(t->luma, in->upper, 2 * i, 2 * n, grey[0]);
    if (in->lower)
        bytes_by_table(t->luma, in->lower, 2 * i, 2 * n, grey[1]);
    for (; i < n; i++) {
        luma_quad q;
        exact[i] = look_up_quad(t, in, &new, i, &q);
        parts |= (uint32_t)exact[i] << i / PUPIL_LUMA_PART;
        for (uint32_t k = 0; k < 2; k++) {
            const size_t at = 2 * (size_t)i + k;
            rgb_pixel(grey[0][at], &q, out->blue_first, out->upper + 4 * at);
            if (in->lower)
                rgb_pixel(grey[1][at], &q, out->blue_first, out->lower + 4 * at);
        }
    }
    return parts;
}

#endif
