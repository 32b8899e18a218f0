/* lib/kernels/wasm128.h: vectors of 4 floats (WebAssembly's fixed-width SIMD), for vector.h. Strict IEEE, no fused
 * multiply-add; "relaxed" instructions, whose results differ between CPUs, are not used. */
#ifndef PUPIL_KERNELS_WASM128_H
#define PUPIL_KERNELS_WASM128_H

#include <stdint.h>
#include <wasm_simd128.h>

#define WIDTH 4
typedef v128_t floats;
typedef v128_t ints;
typedef v128_t mask;

#define INLINE static inline __attribute__((always_inline))

INLINE floats v_load(const float *p)
{
    return wasm_v128_load(p);
}
INLINE void v_store(float *p, floats v)
{
    wasm_v128_store(p, v);
}
INLINE void v_store_ints(int32_t *p, ints v)
{
    wasm_v128_store(p, v);
}
INLINE ints v_load_ints(const int32_t *p)
{
    return wasm_v128_load(p);
}
INLINE floats v_all(float x)
{
    return wasm_f32x4_splat(x);
}
INLINE ints v_all_ints(uint32_t x)
{
    return wasm_i32x4_splat((int32_t)x);
}

INLINE floats v_add(floats a, floats b)
{
    return wasm_f32x4_add(a, b);
}
INLINE floats v_sub(floats a, floats b)
{
    return wasm_f32x4_sub(a, b);
}
INLINE floats v_mul(floats a, floats b)
{
    return wasm_f32x4_mul(a, b);
}
INLINE floats v_div(floats a, floats b)
{
    return wasm_f32x4_div(a, b);
}
/* a > b ? a : b and a < b ? a : b: b where one is NaN. One instruction on x86, where the functions of the same names
 * without a p take six. */
INLINE floats v_max(floats a, floats b)
{
    return wasm_f32x4_pmax(b, a);
}
INLINE floats v_min(floats a, floats b)
{
    return wasm_f32x4_pmin(b, a);
}

INLINE mask v_greater(floats a, floats b)
{
    return wasm_f32x4_gt(a, b);
}
INLINE mask v_less(floats a, floats b)
{
    return wasm_f32x4_lt(a, b);
}
INLINE mask v_at_least(floats a, floats b)
{
    return wasm_f32x4_ge(a, b);
}
INLINE mask v_is_number(floats a)
{
    return wasm_f32x4_eq(a, a);
}
INLINE mask v_both(mask a, mask b)
{
    return wasm_v128_and(a, b);
}
INLINE mask v_not(mask a)
{
    return wasm_v128_not(a);
}
INLINE floats v_select(mask m, floats yes, floats no)
{
    return wasm_v128_bitselect(yes, no, m);
}
INLINE floats v_where(mask m, floats a)
{
    return wasm_v128_and(m, a);
} /* else 0 */
INLINE int v_every(mask m)
{
    return wasm_i32x4_all_true(m);
}

/* its fraction, as a number in [1, 2) */
INLINE floats v_fraction(floats a)
{
    return wasm_v128_or(wasm_v128_and(a, v_all_ints(0x007fffff)), v_all_ints(0x3f800000));
}

/* how many are true, over several masks */
typedef v128_t tally;
INLINE tally v_no_tally(void)
{
    return v_all_ints(0);
}
INLINE tally v_tally(tally t, mask m)
{
    return wasm_i32x4_sub(t, m);
}
INLINE uint32_t v_tallied(tally t)
{
    return (uint32_t)(wasm_i32x4_extract_lane(t, 0) + wasm_i32x4_extract_lane(t, 1) + wasm_i32x4_extract_lane(t, 2) +
                      wasm_i32x4_extract_lane(t, 3));
}
/* of four masks, 16 bits for each */
INLINE uint64_t v_group_bits(const mask *m)
{
    const uint32_t low = (uint32_t)wasm_i32x4_bitmask(m[0]) | (uint32_t)wasm_i32x4_bitmask(m[1]) << 16;
    const uint32_t high = (uint32_t)wasm_i32x4_bitmask(m[2]) | (uint32_t)wasm_i32x4_bitmask(m[3]) << 16;
    return low | (uint64_t)high << 32;
}

INLINE ints v_bits(floats a)
{
    return a;
}
INLINE floats v_of_bits(ints a)
{
    return a;
}
INLINE ints v_plus(ints a, ints b)
{
    return wasm_i32x4_add(a, b);
}
INLINE ints v_minus(ints a, ints b)
{
    return wasm_i32x4_sub(a, b);
}
INLINE ints v_max_unsigned(ints a, ints b)
{
    return wasm_u32x4_max(a, b);
}
INLINE mask v_at_most(ints a, ints b)
{
    return wasm_u32x4_le(a, b);
}
INLINE mask v_equal_ints(ints a, ints b)
{
    return wasm_i32x4_eq(a, b);
}
INLINE ints v_and(ints a, ints b)
{
    return wasm_v128_and(a, b);
}
INLINE ints v_or(ints a, ints b)
{
    return wasm_v128_or(a, b);
}
#define v_right(a, n) wasm_u32x4_shr(a, n)
#define v_left(a, n)  wasm_i32x4_shl(a, n)
/* of numbers from 0 on */
INLINE ints v_to_ints(floats a)
{
    return wasm_i32x4_trunc_sat_f32x4(a);
}
INLINE floats v_from_ints(ints a)
{
    return wasm_f32x4_convert_i32x4(a);
}

/* Two pairs of floats. */
INLINE floats two_pairs(const float *first, const float *second)
{
    return wasm_v128_load64_lane(second, wasm_v128_load64_zero(first), 1);
}

/* The pairs at four addresses, the first of each to *even, the second to *odd. */
INLINE void four_pairs(const float *p0, const float *p1, const float *p2, const float *p3, floats *even, floats *odd)
{
    const floats low = two_pairs(p0, p1), high = two_pairs(p2, p3);
    *even = wasm_i32x4_shuffle(low, high, 0, 2, 4, 6);
    *odd = wasm_i32x4_shuffle(low, high, 1, 3, 5, 7);
}

/* 16 bytes as numbers, and 8 pairs of bytes as two numbers less 128, each twice */
INLINE void v_of_bytes(const uint8_t *p, floats to[4])
{
    const v128_t bytes = wasm_v128_load(p);
    const v128_t low = wasm_u16x8_extend_low_u8x16(bytes), high = wasm_u16x8_extend_high_u8x16(bytes);
    to[0] = wasm_f32x4_convert_i32x4(wasm_u32x4_extend_low_u16x8(low));
    to[1] = wasm_f32x4_convert_i32x4(wasm_u32x4_extend_high_u16x8(low));
    to[2] = wasm_f32x4_convert_i32x4(wasm_u32x4_extend_low_u16x8(high));
    to[3] = wasm_f32x4_convert_i32x4(wasm_u32x4_extend_high_u16x8(high));
}

INLINE void v_of_chroma(const uint8_t *p, floats u[4], floats v[4])
{
    const v128_t bytes = wasm_v128_load(p), none = wasm_f32x4_splat(128.0f);
    uint8_t twice[2][16];
    wasm_v128_store(twice[0], wasm_i8x16_shuffle(bytes, bytes, 0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14));
    wasm_v128_store(twice[1], wasm_i8x16_shuffle(bytes, bytes, 1, 1, 3, 3, 5, 5, 7, 7, 9, 9, 11, 11, 13, 13, 15, 15));
    v_of_bytes(twice[0], u);
    v_of_bytes(twice[1], v);
    for (int k = 0; k < 4; k++) {
        u[k] = wasm_f32x4_sub(u[k], none);
        v[k] = wasm_f32x4_sub(v[k], none);
    }
}

/* light[i][0] + rest * light[i][1] */
INLINE floats v_interpolate(const float (*light)[2], ints i, floats rest)
{
    floats from, slope;
    four_pairs(light[wasm_i32x4_extract_lane(i, 0)], light[wasm_i32x4_extract_lane(i, 1)],
               light[wasm_i32x4_extract_lane(i, 2)], light[wasm_i32x4_extract_lane(i, 3)], &from, &slope);
    return v_add(from, v_mul(rest, slope));
}
/* from knot[i] to knot[i + 1], by a part of the way */
INLINE floats v_between(const float *knot, ints i, floats part)
{
    floats from, to;
    four_pairs(knot + wasm_i32x4_extract_lane(i, 0), knot + wasm_i32x4_extract_lane(i, 1),
               knot + wasm_i32x4_extract_lane(i, 2), knot + wasm_i32x4_extract_lane(i, 3), &from, &to);
    return v_add(from, v_mul(part, v_sub(to, from)));
}

/* --- load WIDTH pixels; *a is alpha, or whether it is opaque --- */

INLINE void load4_rgba32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    const floats p0 = v_load(s), p1 = v_load(s + 4), p2 = v_load(s + 8), p3 = v_load(s + 12);
    const floats rg01 = wasm_i32x4_shuffle(p0, p1, 0, 4, 1, 5), ba01 = wasm_i32x4_shuffle(p0, p1, 2, 6, 3, 7);
    const floats rg23 = wasm_i32x4_shuffle(p2, p3, 0, 4, 1, 5), ba23 = wasm_i32x4_shuffle(p2, p3, 2, 6, 3, 7);
    *r = wasm_i64x2_shuffle(rg01, rg23, 0, 2);
    *g = wasm_i64x2_shuffle(rg01, rg23, 1, 3);
    *b = wasm_i64x2_shuffle(ba01, ba23, 0, 2);
    *a = wasm_i64x2_shuffle(ba01, ba23, 1, 3);
}

INLINE void load4_rgb32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    const floats x = v_load(s), y = v_load(s + 4), z = v_load(s + 8); /* r0 g0 b0 r1, g1 b1 r2 g2, b2 r3 g3 b3 */
    const floats xy = wasm_i32x4_shuffle(x, y, 1, 2, 4, 5);           /* g0 b0 g1 b1 */
    const floats yz = wasm_i32x4_shuffle(y, z, 2, 3, 5, 6);           /* r2 g2 r3 g3 */
    *r = wasm_i32x4_shuffle(x, yz, 0, 3, 4, 6);
    *g = wasm_i32x4_shuffle(xy, yz, 0, 2, 5, 7);
    *b = wasm_i32x4_shuffle(xy, z, 1, 3, 4, 7);
    *a = v_all(1.0f);
}

/* Four pixels of four 16-bit samples, each in the lower half of a lane. */
INLINE void words_of_four(const void *source, ints *r, ints *g, ints *b, ints *a)
{
    const uint8_t *s = source;
    const ints p01 = wasm_v128_load(s), p23 = wasm_v128_load(s + 16), lower = v_all_ints(0xffff);
    const ints rg = wasm_i32x4_shuffle(p01, p23, 0, 2, 4, 6), ba = wasm_i32x4_shuffle(p01, p23, 1, 3, 5, 7);
    *r = v_and(rg, lower);
    *g = v_right(rg, 16);
    *b = v_and(ba, lower);
    *a = v_right(ba, 16);
}

/* Of three: words 12 to 15 are zeros. */
INLINE void words_of_three(const void *source, ints *r, ints *g, ints *b)
{
    const uint8_t *s = source;
    const ints x = wasm_v128_load(s), y = wasm_v128_load64_zero(s + 16);
    *r = wasm_i16x8_shuffle(x, y, 0, 12, 3, 12, 6, 12, 9, 12);
    *g = wasm_i16x8_shuffle(x, y, 1, 12, 4, 12, 7, 12, 10, 12);
    *b = wasm_i16x8_shuffle(x, y, 2, 12, 5, 12, 8, 12, 11, 12);
}

INLINE floats from_16(ints v)
{
    return v_mul(v_from_ints(v), v_all(1.0f / 65535.0f));
}

/* Halves: the exponent from a bias of 15 to one of 127. Subnormals are a fraction of 2^-14: 2^-14 plus that fraction,
 * less 2^-14, is exact. Those with the largest exponent stay NaN or infinity. */
INLINE floats from_half(ints v)
{
    const ints magnitude = v_left(v_and(v, v_all_ints(0x7fff)), 13), sign = v_left(v_and(v, v_all_ints(0x8000)), 16);
    const ints normal = v_plus(magnitude, v_all_ints(112u << 23)), unit = v_all_ints(113u << 23);
    const floats small = v_sub(v_of_bits(v_plus(magnitude, unit)), v_of_bits(unit));
    const floats finite = v_select(v_at_most(v_all_ints(1u << 23), magnitude), v_of_bits(normal), small);
    const mask odd = v_at_most(v_all_ints(31u << 23), magnitude);
    return v_or(v_or(finite, v_and(odd, v_all_ints(0x7f800000))), sign);
}

INLINE void load4_rgba16(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    ints red, green, blue, alpha;
    words_of_four(source, &red, &green, &blue, &alpha);
    *r = from_16(red);
    *g = from_16(green);
    *b = from_16(blue);
    *a = v_from_ints(v_minus(alpha, v_all_ints(65534))); /* 1.0 where it is opaque */
}

INLINE void load4_rgb16(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    ints red, green, blue;
    words_of_three(source, &red, &green, &blue);
    *r = from_16(red);
    *g = from_16(green);
    *b = from_16(blue);
    *a = v_all(1.0f);
}

INLINE void load4_rgba16f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    ints red, green, blue, alpha;
    words_of_four(source, &red, &green, &blue, &alpha);
    *r = from_half(red);
    *g = from_half(green);
    *b = from_half(blue);
    *a = from_half(alpha);
}

INLINE void load4_rgb16f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    ints red, green, blue;
    words_of_three(source, &red, &green, &blue);
    *r = from_half(red);
    *g = from_half(green);
    *b = from_half(blue);
    *a = v_all(1.0f);
}

#endif
