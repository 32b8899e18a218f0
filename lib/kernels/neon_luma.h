/* lib/kernels/neon_luma.h: 16 bytes, or 8 words, for vector_luma.h. */
#ifndef PUPIL_KERNELS_NEON_LUMA_H
#define PUPIL_KERNELS_NEON_LUMA_H

#include "kernels.h"
#include "neon.h"

#define QUADS 8
typedef uint8x16_t v_bytes;
typedef int16x8_t v_words;
#define w_of_bytes(a)  vreinterpretq_s16_u8(a)
#define OF_UNSIGNED(a) vreinterpretq_s16_u16(a)
#define UNSIGNED(a)    vreinterpretq_u16_s16(a)

INLINE v_bytes b_load(const uint8_t *p)
{
    return vld1q_u8(p);
}
INLINE void b_store(uint8_t *p, v_bytes v)
{
    vst1q_u8(p, v);
}
INLINE v_words w_load(const uint8_t *p)
{
    return w_of_bytes(vld1q_u8(p));
}
INLINE void w_store(uint16_t *p, v_words v)
{
    vst1q_u16(p, UNSIGNED(v));
}
INLINE v_words w_all(int x)
{
    return vdupq_n_s16((int16_t)x);
}
#define b_max(a, b)          vmaxq_u8(a, b)
#define b_min(a, b)          vminq_u8(a, b)
#define b_more(a, b)         vqaddq_u8(a, b)
#define b_less(a, b)         vqsubq_u8(a, b)
#define b_sums(a)            OF_UNSIGNED(vpaddlq_u8(a))
#define w_add(a, b)          vaddq_s16(a, b)
#define w_sub(a, b)          vsubq_s16(a, b)
#define w_and(a, b)          vandq_s16(a, b)
#define w_minus_and(a, b)    vbicq_s16(a, b)
#define w_or(a, b)           vorrq_s16(a, b)
#define w_xor(a, b)          veorq_s16(a, b)
#define w_max(a, b)          vmaxq_s16(a, b)
#define w_min(a, b)          vminq_s16(a, b)
#define w_greater(a, b)      OF_UNSIGNED(vcgtq_s16(a, b))
#define w_left(a, n)         vshlq_n_s16(a, n)
#define w_right(a, n)        OF_UNSIGNED(vshrq_n_u16(UNSIGNED(a), n))
#define w_right_signed(a, n) vshrq_n_s16(a, n)
#define w_times(a, b)        vqrdmulhq_s16(a, b)
/* the words of numbers up to 32767 */
#define w_of_ints(a, b) OF_UNSIGNED(vuzp1q_u16(vreinterpretq_u16_u32(a), vreinterpretq_u16_u32(b)))
#define w_least(a)      ((uint32_t)vminvq_u16(UNSIGNED(a)))
#define b_all(x)        vdupq_n_u8((uint8_t)(x))
/* how many bytes are the same, over up to 16 vectors */
typedef uint8x16_t matches;
#define b_no_matches()   vdupq_n_u8(0)
#define b_match(m, a, b) vsubq_u8(m, vceqq_u8(a, b))
#define b_matched(m)     ((uint32_t)vaddlvq_u8(m))
INLINE int w_any(v_words a)
{
    return vmaxvq_u16(UNSIGNED(a)) != 0;
}

typedef struct luma_entries {
    uint8x16x4_t part[4];
} luma_entries;

INLINE void luma_entries_of(const pupil_luma_tables *t, luma_entries *e)
{
    const uint8_t *table = t->luma;
    for (int k = 0; k < 4; k++)
        e->part[k] = vld1q_u8_x4(table + 64 * (size_t)k);
}

/* 64 entries at a time: an index that is not below 64 finds none, and leaves what was found. */
INLINE void luma_by_table(const luma_entries *e, const uint8_t *table, const uint8_t *from, uint32_t n, uint8_t *to)
{
    (void)table;
    const v_bytes step = vdupq_n_u8(64);
    for (uint32_t i = 0; i < n; i += 16) {
        v_bytes at = vld1q_u8(from + i), found = vqtbl4q_u8(e->part[0], at);
        at = vsubq_u8(at, step);
        found = vqtbx4q_u8(found, e->part[1], at);
        at = vsubq_u8(at, step);
        found = vqtbx4q_u8(found, e->part[2], at);
        at = vsubq_u8(at, step);
        vst1q_u8(to + i, vqtbx4q_u8(found, e->part[3], at));
    }
}

typedef struct ratio_tables {
    uint8x16x4_t low[2], high[2];
} ratio_tables;

INLINE void ratio_tables_of(const pupil_luma_tables *t, ratio_tables *r)
{
    for (int k = 0; k < 2; k++) {
        r->low[k] = vld1q_u8_x4(t->ratio_low + 64 * (size_t)k);
        r->high[k] = vld1q_u8_x4(t->ratio_high + 64 * (size_t)k);
    }
}

/* Of words up to 127. */
INLINE void w_look_up(const ratio_tables *r, v_words first, v_words second, v_words ratio[2])
{
    const v_bytes at = vuzp1q_u8(vreinterpretq_u8_s16(first), vreinterpretq_u8_s16(second));
    const v_bytes next = vsubq_u8(at, vdupq_n_u8(64));
    const v_bytes low = vqtbx4q_u8(vqtbl4q_u8(r->low[0], at), r->low[1], next);
    const v_bytes high = vqtbx4q_u8(vqtbl4q_u8(r->high[0], at), r->high[1], next);
    ratio[0] = w_of_bytes(vzip1q_u8(low, high));
    ratio[1] = w_of_bytes(vzip2q_u8(low, high));
}

/* Scaled Cb and Cr as codes, interleaved. */
INLINE v_bytes w_to_pairs(v_words u, v_words v)
{
    const int8x16_t apart = vqrshrn_high_n_s16(vqrshrn_n_s16(u, 4), v, 4);
    const v_bytes turns = {0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15};
    return veorq_u8(vqtbl1q_u8(vreinterpretq_u8_s8(apart), turns), vdupq_n_u8(128));
}

/* Words as bytes, 0 for negative ones; in b_twice's order. */
#define w_to_bytes(a, b) vqmovun_high_s16(vqmovun_s16(a), b)
/* Each byte twice: those of the first words, and those of the second. */
INLINE void b_twice(v_bytes a, v_bytes to[2])
{
    to[0] = vzip1q_u8(a, a);
    to[1] = vzip2q_u8(a, a);
}

INLINE void b_store_rgba(uint8_t *p, v_bytes r, v_bytes g, v_bytes b)
{
    vst4q_u8(p, (uint8x16x4_t){{r, g, b, vdupq_n_u8(255)}});
}

#endif
