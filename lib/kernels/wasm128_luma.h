/* lib/kernels/wasm128_luma.h: 16 bytes, or 8 words, for vector_luma.h. */
#ifndef PUPIL_KERNELS_WASM128_LUMA_H
#define PUPIL_KERNELS_WASM128_LUMA_H

#include "kernels.h"
#include "wasm128.h"

#define QUADS 8
typedef v128_t v_bytes;
typedef v128_t v_words;

INLINE v_bytes b_load(const uint8_t *p)
{
    return wasm_v128_load(p);
}
INLINE void b_store(uint8_t *p, v_bytes v)
{
    wasm_v128_store(p, v);
}
#define w_load b_load
INLINE void w_store(uint16_t *p, v_words v)
{
    wasm_v128_store(p, v);
}
INLINE v_words w_all(int x)
{
    return wasm_i16x8_splat((int16_t)x);
}
#define w_of_bytes(a)        (a)
#define b_max(a, b)          wasm_u8x16_max(a, b)
#define b_min(a, b)          wasm_u8x16_min(a, b)
#define b_more(a, b)         wasm_u8x16_add_sat(a, b)
#define b_less(a, b)         wasm_u8x16_sub_sat(a, b)
#define b_sums(a)            wasm_u16x8_extadd_pairwise_u8x16(a)
#define w_add(a, b)          wasm_i16x8_add(a, b)
#define w_sub(a, b)          wasm_i16x8_sub(a, b)
#define w_and(a, b)          wasm_v128_and(a, b)
#define w_minus_and(a, b)    wasm_v128_andnot(a, b)
#define w_or(a, b)           wasm_v128_or(a, b)
#define w_xor(a, b)          wasm_v128_xor(a, b)
#define w_max(a, b)          wasm_i16x8_max(a, b)
#define w_min(a, b)          wasm_i16x8_min(a, b)
#define w_greater(a, b)      wasm_i16x8_gt(a, b)
#define w_left(a, n)         wasm_i16x8_shl(a, n)
#define w_right(a, n)        wasm_u16x8_shr(a, n)
#define w_right_signed(a, n) wasm_i16x8_shr(a, n)
#define w_times(a, b)        wasm_i16x8_q15mulr_sat(a, b)
/* the words of numbers up to 32767 */
#define w_of_ints(a, b) wasm_u16x8_narrow_i32x4(a, b)
INLINE uint32_t w_least(v_words a)
{
    a = wasm_u16x8_min(a, wasm_i64x2_shuffle(a, a, 1, 0));
    a = wasm_u16x8_min(a, wasm_i32x4_shuffle(a, a, 1, 0, 3, 2));
    return wasm_u16x8_extract_lane(wasm_u16x8_min(a, wasm_u32x4_shr(a, 16)), 0);
}
#define b_all(x) wasm_i8x16_splat((int8_t)(x))
/* how many bytes are the same, over several vectors */
typedef uint32_t matches;
#define b_no_matches()   0
#define b_match(m, a, b) ((m) + (uint32_t)__builtin_popcount(wasm_i8x16_bitmask(wasm_i8x16_eq(a, b))))
#define b_matched(m)     (m)
#define w_any(a)         ((int)wasm_v128_any_true(a))

/* A shuffle looks up 16 entries; an index of 16 or more gives 0. */
INLINE v_bytes b_look_up(const uint8_t *table, uint32_t count, v_bytes at)
{
    v_bytes found = wasm_i8x16_splat(0);
    for (uint32_t k = 0; k < count; k++) {
        found = wasm_v128_or(found, wasm_i8x16_swizzle(wasm_v128_load(table + 16 * (size_t)k), at));
        at = wasm_i8x16_sub(at, wasm_i8x16_splat(16));
    }
    return found;
}

/* They are loaded where they are needed. */
typedef struct luma_entries {
    const uint8_t *table;
} luma_entries;

INLINE void luma_entries_of(const pupil_luma_tables *t, luma_entries *e)
{
    const uint8_t *table = t->luma;
    e->table = table;
}

INLINE void luma_by_table(const luma_entries *e, const uint8_t *table, const uint8_t *from, uint32_t n, uint8_t *to)
{
    (void)e;
    for (uint32_t i = 0; i < n; i += 16)
        b_store(to + i, b_look_up(table, 16, b_load(from + i)));
}

typedef struct ratio_tables {
    const pupil_luma_tables *t;
} ratio_tables;

INLINE void ratio_tables_of(const pupil_luma_tables *t, ratio_tables *r)
{
    r->t = t;
}

/* Of words up to 127. */
INLINE void w_look_up(const ratio_tables *r, v_words first, v_words second, v_words ratio[2])
{
    const v_bytes at = wasm_u8x16_narrow_i16x8(first, second);
    const v_bytes low = b_look_up(r->t->ratio_low, 8, at), high = b_look_up(r->t->ratio_high, 8, at);
    ratio[0] = wasm_i8x16_shuffle(low, high, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    ratio[1] = wasm_i8x16_shuffle(low, high, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}

/* Scaled Cb and Cr as codes, interleaved. */
INLINE v_bytes w_to_pairs(v_words u, v_words v)
{
    const v_words half = w_all(8);
    const v_bytes packed =
        wasm_i8x16_narrow_i16x8(wasm_i16x8_shr(wasm_i16x8_add(u, half), 4), wasm_i16x8_shr(wasm_i16x8_add(v, half), 4));
    const v_bytes turns = wasm_i8x16_shuffle(packed, packed, 0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
    return wasm_v128_xor(turns, wasm_i8x16_splat(-128));
}

/* Words as bytes, 0 for negative ones; in b_twice's order. */
#define w_to_bytes(a, b) wasm_u8x16_narrow_i16x8(a, b)
/* Each byte twice: those of the first words, and those of the second. */
INLINE void b_twice(v_bytes a, v_bytes to[2])
{
    to[0] = wasm_i8x16_shuffle(a, a, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
    to[1] = wasm_i8x16_shuffle(a, a, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13, 14, 14, 15, 15);
}

INLINE void b_store_rgba(uint8_t *p, v_bytes r, v_bytes g, v_bytes b)
{
    const v_bytes a = wasm_i8x16_splat(-1);
    const v_bytes rg0 = wasm_i8x16_shuffle(r, g, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const v_bytes rg1 = wasm_i8x16_shuffle(r, g, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    const v_bytes ba0 = wasm_i8x16_shuffle(b, a, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const v_bytes ba1 = wasm_i8x16_shuffle(b, a, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    b_store(p, wasm_i16x8_shuffle(rg0, ba0, 0, 8, 1, 9, 2, 10, 3, 11));
    b_store(p + 16, wasm_i16x8_shuffle(rg0, ba0, 4, 12, 5, 13, 6, 14, 7, 15));
    b_store(p + 32, wasm_i16x8_shuffle(rg1, ba1, 0, 8, 1, 9, 2, 10, 3, 11));
    b_store(p + 48, wasm_i16x8_shuffle(rg1, ba1, 4, 12, 5, 13, 6, 14, 7, 15));
}

#endif
