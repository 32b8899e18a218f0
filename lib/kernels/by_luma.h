/* lib/kernels/by_luma.h: quads of 4:2:0 by tables of luma (config.h: pupil_accuracy). Plain loops, compiled in each
 * level's file; floats without fused multiply-add, so no result depends on which. */
#ifndef PUPIL_KERNELS_BY_LUMA_H
#define PUPIL_KERNELS_BY_LUMA_H

#include "kernels.h"

/* In a loop of look-ups: gcc would put vectors together out of single loads, which takes half as long again. */
#if defined(__clang__)
#define ONE_BY_ONE (void)0
#else
#define ONE_BY_ONE __asm__ volatile("")
#endif

static inline float larger_of(float a, float b)
{
    return a > b ? a : b;
}

/* A colour is mapped exactly where its largest channel comes near the gamut's surface, for it does not keep its ratio
 * there; and where it is so far from grey that luma is not its luminance. In R'G'B' codes, with some for noise. */
#define NEAR_ROOM 3.0f
#define FAR_ROOM  8.0f

static inline void luma_by_table(const uint8_t *restrict table, const uint8_t *from, uint32_t n, uint8_t *to)
{
    for (uint32_t i = 0; i < n; i++) {
        to[i] = table[from[i]];
        ONE_BY_ONE;
    }
}

/* Ratios for the quads' means; how bright their brightest pixel becomes, and their darkest, in R'G'B' codes. */
typedef struct quad_entries {
    float ratio[2 * PUPIL_LUMA_QUADS], most[PUPIL_LUMA_QUADS], least[PUPIL_LUMA_QUADS];
} quad_entries;

static inline void look_up_quads(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                                 quad_entries *restrict q)
{
    const uint8_t *restrict upper = in->upper, *restrict lower = in->lower;
    uint8_t mean[PUPIL_LUMA_QUADS], most[PUPIL_LUMA_QUADS], least[PUPIL_LUMA_QUADS], to[PUPIL_LUMA_QUADS];
    const float zero = t->zero, one = t->one, top = t->top;
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t a = upper[2 * i], b = upper[2 * i + 1], c = lower[2 * i], d = lower[2 * i + 1];
        const uint8_t ab = a > b ? a : b, cd = c > d ? c : d, less_ab = a < b ? a : b, less_cd = c < d ? c : d;
        mean[i] = (uint8_t)((uint16_t)(a + b + c + d + 2) >> 2);
        most[i] = ab > cd ? ab : cd;
        least[i] = less_ab < less_cd ? less_ab : less_cd;
    }
    luma_by_table(t->luma, mean, n, to);
    luma_by_table(t->luma, most, n, most);
    luma_by_table(t->luma, least, n, least);
    for (uint32_t i = 0; i < n; i++) {
        float from = (float)(int32_t)mean[i] - zero;
        from = from > 1.0f ? from : 1.0f;
        from = from < top ? from : top;
        q->ratio[2 * i] = q->ratio[2 * i + 1] = larger_of((float)(int32_t)to[i] - zero, 0.0f) / from;
        q->most[i] = ((float)(int32_t)most[i] - zero) * one;
        q->least[i] = larger_of(((float)(int32_t)least[i] - zero) * one, 0.0f);
    }
}

/* Of Cb and Cr in turns: 2 n codes, scaled, and rounded to codes again. */
static inline void scale_chroma(const uint8_t *restrict from, uint32_t n, const float *restrict ratio,
                                float *restrict scaled, uint8_t *restrict to)
{
    for (uint32_t i = 0; i < n; i++) {
        scaled[i] = (float)((int32_t)from[i] - 128) * ratio[i];
        float code = scaled[i] + 128.5f;
        code = code > 0.0f ? code : 0.0f;
        code = code < 255.0f ? code : 255.0f;
        to[i] = (uint8_t)(int32_t)code;
    }
}

static inline uint32_t find_exact(const pupil_luma_tables *t, const float *restrict uv, const quad_entries *restrict q,
                                  uint32_t n, uint8_t *restrict exact)
{
    const float red_v = t->red_v, blue_u = t->blue_u, green_u = t->green_u, green_v = t->green_v;
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const float u = uv[2 * i], v = uv[2 * i + 1];
        const float above = larger_of(larger_of(red_v * v, blue_u * u), green_u * u + green_v * v);
        const float surface = t->knee * (255.0f - q->most[i]) + NEAR_ROOM;
        const float far = t->far * q->least[i] + FAR_ROOM;
        const uint32_t beyond = above > (surface < far ? surface : far);
        exact[i] = (uint8_t)beyond;
        count += beyond;
    }
    return count;
}

static uint32_t by_luma(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                        const pupil_luma_target *out, uint8_t *exact)
{
    float uv[2 * PUPIL_LUMA_QUADS];
    quad_entries q;
    uint8_t from[2 * PUPIL_LUMA_QUADS], to[2 * PUPIL_LUMA_QUADS];
    const int in_turns = in->cr == in->cb + 1, to_turns = out->cr == out->cb + 1;
    look_up_quads(t, in, n, &q);
    for (uint32_t i = 0; i < n && !in_turns; i++) {
        from[2 * i] = in->cb[in->step * i];
        from[2 * i + 1] = in->cr[in->step * i];
    }
    scale_chroma(in_turns ? in->cb : from, 2 * n, q.ratio, uv, to_turns ? out->cb : to);
    for (uint32_t i = 0; i < n && !to_turns; i++) {
        out->cb[out->step * i] = to[2 * i];
        out->cr[out->step * i] = to[2 * i + 1];
    }
    luma_by_table(t->luma, in->upper, 2 * n, out->upper);
    luma_by_table(t->luma, in->lower, 2 * n, out->lower);
    return find_exact(t, uv, &q, n, exact);
}

#endif
