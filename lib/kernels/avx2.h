/* lib/kernels/avx2.h: vectors of 8 floats, for vector.h. */
#ifndef PUPIL_KERNELS_AVX2_H
#define PUPIL_KERNELS_AVX2_H

#include <immintrin.h>
#include <stdint.h>

#include "x86_pairs.h"

#define WIDTH 8
typedef __m256 floats;
typedef __m256i ints;
typedef __m256 mask;

INLINE floats v_load(const float *p)
{
    return _mm256_loadu_ps(p);
}
INLINE void v_store(float *p, floats v)
{
    _mm256_storeu_ps(p, v);
}
INLINE void v_store_ints(int32_t *p, ints v)
{
    _mm256_storeu_si256((__m256i *)(void *)p, v);
}
INLINE ints v_load_ints(const int32_t *p)
{
    return _mm256_loadu_si256((const __m256i *)(const void *)p);
}
INLINE floats v_all(float x)
{
    return _mm256_set1_ps(x);
}
INLINE ints v_all_ints(uint32_t x)
{
    return _mm256_set1_epi32((int32_t)x);
}

INLINE floats v_add(floats a, floats b)
{
    return _mm256_add_ps(a, b);
}
INLINE floats v_sub(floats a, floats b)
{
    return _mm256_sub_ps(a, b);
}
INLINE floats v_mul(floats a, floats b)
{
    return _mm256_mul_ps(a, b);
}
/* a * b + c, rounded once: only where no result depends on the rounding */
INLINE floats v_about(floats a, floats b, floats c)
{
    return _mm256_fmadd_ps(a, b, c);
}
INLINE floats v_div(floats a, floats b)
{
    return _mm256_div_ps(a, b);
}
/* a > b ? a : b and a < b ? a : b: b where one is NaN */
INLINE floats v_max(floats a, floats b)
{
    return _mm256_max_ps(a, b);
}
INLINE floats v_min(floats a, floats b)
{
    return _mm256_min_ps(a, b);
}

INLINE mask v_greater(floats a, floats b)
{
    return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}
INLINE mask v_less(floats a, floats b)
{
    return _mm256_cmp_ps(a, b, _CMP_LT_OQ);
}
INLINE mask v_at_least(floats a, floats b)
{
    return _mm256_cmp_ps(a, b, _CMP_GE_OQ);
}
INLINE mask v_is_number(floats a)
{
    return _mm256_cmp_ps(a, a, _CMP_ORD_Q);
}
INLINE mask v_both(mask a, mask b)
{
    return _mm256_and_ps(a, b);
}
INLINE mask v_not(mask a)
{
    return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
}
INLINE floats v_select(mask m, floats yes, floats no)
{
    return _mm256_blendv_ps(no, yes, m);
}
INLINE floats v_where(mask m, floats a)
{
    return _mm256_and_ps(m, a);
} /* else 0 */
INLINE int v_every(mask m)
{
    return _mm256_movemask_ps(m) == 0xff;
}
INLINE uint32_t v_mask_bits(mask m)
{
    return (uint32_t)_mm256_movemask_ps(m);
}

/* its fraction, as a number in [1, 2) */
INLINE floats v_fraction(floats a)
{
    const __m256i fraction = _mm256_and_si256(_mm256_castps_si256(a), _mm256_set1_epi32(0x007fffff));
    return _mm256_castsi256_ps(_mm256_or_si256(fraction, _mm256_set1_epi32(0x3f800000)));
}

INLINE ints v_bits(floats a)
{
    return _mm256_castps_si256(a);
}
INLINE floats v_of_bits(ints a)
{
    return _mm256_castsi256_ps(a);
}
INLINE ints v_plus(ints a, ints b)
{
    return _mm256_add_epi32(a, b);
}
INLINE ints v_minus(ints a, ints b)
{
    return _mm256_sub_epi32(a, b);
}
INLINE ints v_and(ints a, ints b)
{
    return _mm256_and_si256(a, b);
}
INLINE ints v_or(ints a, ints b)
{
    return _mm256_or_si256(a, b);
}
#define v_right(a, n)        _mm256_srli_epi32(a, n)
#define v_right_signed(a, n) _mm256_srai_epi32(a, n)
#define v_left(a, n)         _mm256_slli_epi32(a, n)
INLINE ints v_max_unsigned(ints a, ints b)
{
    return _mm256_max_epu32(a, b);
}
INLINE ints v_min_halves(ints a, ints b)
{
    return _mm256_min_epu16(a, b);
}
INLINE ints v_to_ints(floats a)
{
    return _mm256_cvttps_epi32(a);
}
/* the integer below */
INLINE floats v_floor(floats a)
{
    return _mm256_floor_ps(a);
}
INLINE floats v_from_ints(ints a)
{
    return _mm256_cvtepi32_ps(a);
}
INLINE mask v_equal_ints(ints a, ints b)
{
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b));
}
/* unsigned */
INLINE mask v_at_most(ints a, ints b)
{
    return v_equal_ints(v_max_unsigned(a, b), b);
}

/* how many are true, over several masks */
typedef uint32_t tally;
INLINE tally v_no_tally(void)
{
    return 0;
}
INLINE tally v_tally(tally t, mask m)
{
    return t + (uint32_t)__builtin_popcount(v_mask_bits(m));
}
INLINE uint32_t v_tallied(tally t)
{
    return t;
}
/* of two masks, 32 bits for each */
INLINE uint64_t v_group_bits(const mask *m)
{
    return v_mask_bits(m[0]) | (uint64_t)v_mask_bits(m[1]) << 32;
}

/* table[i & 7] of 8 floats */
INLINE floats v_table8_of(const float *table)
{
    return _mm256_loadu_ps(table);
}
INLINE floats v_table8(floats table, ints i)
{
    return _mm256_permutevar8x32_ps(table, i);
}
INLINE ints v_gather(const uint32_t *table, ints i)
{
    return _mm256_i32gather_epi32((const int *)(const void *)table, i, 4);
}

/* light[i][0] + rest * light[i][1] */
INLINE floats v_interpolate(const float (*light)[2], ints i, floats rest)
{
    int64_t two[WIDTH / 2];
    __m256 part[2];
    v_store_ints((int32_t *)(void *)two, i);
    parts_of_pairs(light[0], 2, two, part);
    return v_add(part[0], v_mul(rest, part[1]));
}

/* from knot[i] to knot[i + 1], by a part of the way */
INLINE floats v_between(const float *knot, ints i, floats part)
{
    int64_t two[WIDTH / 2];
    __m256 ends[2];
    v_store_ints((int32_t *)(void *)two, i);
    parts_of_pairs(knot, 1, two, ends);
    return v_add(ends[0], v_mul(part, v_sub(ends[1], ends[0])));
}

/* 16 bytes in both halves, so that one shuffle takes any of them to any place. */
INLINE __m256i sixteen_twice(const uint8_t *p)
{
    return _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)p));
}

/* Byte k as the lowest byte of a number, and as its top byte; the other bytes are 0. */
#define LOW(k)  (int32_t)(0x80808000u | (k))
#define HIGH(k) (int32_t)((uint32_t)(k) << 24 | 0x808080u)

/* 16 bytes as numbers */
INLINE void v_of_bytes(const uint8_t *p, floats to[2])
{
    const __m256i all = sixteen_twice(p);
    const __m256i first = _mm256_setr_epi32(LOW(0), LOW(1), LOW(2), LOW(3), LOW(4), LOW(5), LOW(6), LOW(7));
    const __m256i last = _mm256_setr_epi32(LOW(8), LOW(9), LOW(10), LOW(11), LOW(12), LOW(13), LOW(14), LOW(15));
    to[0] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, first));
    to[1] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, last));
}

/* 8 pairs of bytes as two numbers less 128, each twice, in units of CHROMA_UNIT: a byte becomes the top byte of a
 * signed number. */
#define CHROMA_UNIT 0x1p-24f
INLINE void v_of_chroma(const uint8_t *p, floats u[2], floats v[2])
{
    const __m256i all = _mm256_xor_si256(sixteen_twice(p), _mm256_set1_epi8(-128));
    const __m256i first = _mm256_setr_epi32(HIGH(0), HIGH(0), HIGH(2), HIGH(2), HIGH(4), HIGH(4), HIGH(6), HIGH(6));
    const __m256i last =
        _mm256_setr_epi32(HIGH(8), HIGH(8), HIGH(10), HIGH(10), HIGH(12), HIGH(12), HIGH(14), HIGH(14));
    const __m256i next = _mm256_set1_epi32(1 << 24);
    u[0] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, first));
    u[1] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, last));
    v[0] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, _mm256_add_epi32(first, next)));
    v[1] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, _mm256_add_epi32(last, next)));
}

/* The same of 16 pixels in YUYV (luma_at 0) or UYVY (1). */
INLINE void v_of_packed(const uint8_t *p, int32_t luma_at, floats y[2], floats u[2], floats v[2])
{
    const __m256i luma =
        _mm256_add_epi32(_mm256_setr_epi32(LOW(0), LOW(2), LOW(4), LOW(6), LOW(8), LOW(10), LOW(12), LOW(14)),
                         _mm256_set1_epi32(luma_at));
    const __m256i first =
        _mm256_sub_epi32(_mm256_setr_epi32(HIGH(1), HIGH(1), HIGH(5), HIGH(5), HIGH(9), HIGH(9), HIGH(13), HIGH(13)),
                         _mm256_set1_epi32(luma_at << 24));
    const __m256i second = _mm256_add_epi32(first, _mm256_set1_epi32(2 << 24));
    for (int k = 0; k < 2; k++) {
        const __m256i all = sixteen_twice(p + 16 * k), chroma = _mm256_xor_si256(all, _mm256_set1_epi8(-128));
        y[k] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(all, luma));
        u[k] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(chroma, first));
        v[k] = _mm256_cvtepi32_ps(_mm256_shuffle_epi8(chroma, second));
    }
}

#undef LOW
#undef HIGH

/* --- load WIDTH pixels; *a is alpha --- */

INLINE __m256 two_of_ps(const float *low, const float *high)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
}

INLINE void load8_rgba32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    __m256 p04 = two_of_ps(s, s + 16), p15 = two_of_ps(s + 4, s + 20);
    __m256 p26 = two_of_ps(s + 8, s + 24), p37 = two_of_ps(s + 12, s + 28);
    __m256 rg01 = _mm256_unpacklo_ps(p04, p15), ba01 = _mm256_unpackhi_ps(p04, p15);
    __m256 rg23 = _mm256_unpacklo_ps(p26, p37), ba23 = _mm256_unpackhi_ps(p26, p37);
    *r = _mm256_shuffle_ps(rg01, rg23, 0x44);
    *g = _mm256_shuffle_ps(rg01, rg23, 0xee);
    *b = _mm256_shuffle_ps(ba01, ba23, 0x44);
    *a = _mm256_shuffle_ps(ba01, ba23, 0xee);
}

INLINE void load8_rgb32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    __m256 x = two_of_ps(s, s + 12);                              /* r0 g0 b0 r1 */
    __m256 y = two_of_ps(s + 4, s + 16);                          /* g1 b1 r2 g2 */
    __m256 z = two_of_ps(s + 8, s + 20);                          /* b2 r3 g3 b3 */
    __m256 yz = _mm256_shuffle_ps(y, z, _MM_SHUFFLE(2, 1, 3, 2)); /* r2 g2 r3 g3 */
    __m256 xy = _mm256_shuffle_ps(x, y, _MM_SHUFFLE(1, 0, 2, 1)); /* g0 b0 g1 b1 */
    *r = _mm256_shuffle_ps(x, yz, _MM_SHUFFLE(2, 0, 3, 0));
    *g = _mm256_shuffle_ps(xy, yz, _MM_SHUFFLE(3, 1, 2, 0));
    *b = _mm256_shuffle_ps(xy, z, _MM_SHUFFLE(3, 0, 3, 1));
    *a = v_all(1.0f);
}

/* 16 pixels of four 16-bit samples to one vector a channel: pixels 0 to 7 in the lower half, 8 to 15 in the upper. */
INLINE __m256i two_of_16(const uint8_t *low, const uint8_t *high)
{
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)low)),
                                   _mm_loadu_si128((const __m128i *)(const void *)high), 1);
}

INLINE void planes_of_16(const uint8_t *s, __m256i *r, __m256i *g, __m256i *b, __m256i *a)
{
    const __m256i p01 = two_of_16(s, s + 64), p23 = two_of_16(s + 16, s + 80);
    const __m256i p45 = two_of_16(s + 32, s + 96), p67 = two_of_16(s + 48, s + 112);
    const __m256i p02 = _mm256_unpacklo_epi16(p01, p23), p13 = _mm256_unpackhi_epi16(p01, p23);
    const __m256i p46 = _mm256_unpacklo_epi16(p45, p67), p57 = _mm256_unpackhi_epi16(p45, p67);
    const __m256i rg0123 = _mm256_unpacklo_epi16(p02, p13), ba0123 = _mm256_unpackhi_epi16(p02, p13);
    const __m256i rg4567 = _mm256_unpacklo_epi16(p46, p57), ba4567 = _mm256_unpackhi_epi16(p46, p57);
    *r = _mm256_unpacklo_epi64(rg0123, rg4567);
    *g = _mm256_unpackhi_epi64(rg0123, rg4567);
    *b = _mm256_unpacklo_epi64(ba0123, ba4567);
    *a = _mm256_unpackhi_epi64(ba0123, ba4567);
}

INLINE void from_half(__m256i v, floats to[2])
{
    to[0] = _mm256_cvtph_ps(_mm256_castsi256_si128(v));
    to[1] = _mm256_cvtph_ps(_mm256_extracti128_si256(v, 1));
}

/* A mask of 16-bit lanes to one of half as many: both of two are set. */
INLINE mask both_halves(__m256i m)
{
    return _mm256_castsi256_ps(_mm256_and_si256(m, _mm256_slli_epi32(m, 16)));
}

INLINE void load16_rgba16f(const uint8_t *source, floats r[2], floats g[2], floats b[2], mask *opaque)
{
    __m256i pr, pg, pb, pa;
    planes_of_16(source, &pr, &pg, &pb, &pa);
    from_half(pr, r);
    from_half(pg, g);
    from_half(pb, b);
    /* from 1.0 to infinity: positive halves compare as 16-bit numbers */
    const __m256i above_1 = _mm256_sub_epi16(pa, _mm256_set1_epi16(0x3c00)), reach = _mm256_set1_epi16(0x7c00 - 0x3c00);
    *opaque = both_halves(_mm256_cmpeq_epi16(_mm256_max_epu16(above_1, reach), reach));
}

INLINE floats from_16(__m128i v)
{
    return _mm256_mul_ps(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(v)), _mm256_set1_ps(1.0f / 65535.0f));
}

INLINE void from_16s(__m256i v, floats to[2])
{
    to[0] = from_16(_mm256_castsi256_si128(v));
    to[1] = from_16(_mm256_extracti128_si256(v, 1));
}

INLINE void load16_rgba16(const uint8_t *source, floats r[2], floats g[2], floats b[2], mask *opaque)
{
    __m256i pr, pg, pb, pa;
    planes_of_16(source, &pr, &pg, &pb, &pa);
    from_16s(pr, r);
    from_16s(pg, g);
    from_16s(pb, b);
    *opaque = both_halves(_mm256_cmpeq_epi16(pa, _mm256_set1_epi16(-1)));
}

/* 8 pixels of three 16-bit samples: every third sample of 24, by byte shuffles whose results do not overlap. */
INLINE __m128i every_third(__m128i x, __m128i y, __m128i z, __m128i sx, __m128i sy, __m128i sz)
{
    return _mm_or_si128(_mm_or_si128(_mm_shuffle_epi8(x, sx), _mm_shuffle_epi8(y, sy)), _mm_shuffle_epi8(z, sz));
}

INLINE void words_of_three(const void *source, __m128i *r, __m128i *g, __m128i *b)
{
    const __m128i *s = source;
    const __m128i x = _mm_loadu_si128(s), y = _mm_loadu_si128(s + 1), z = _mm_loadu_si128(s + 2);
#define NONE -1, -1
    *r = every_third(x, y, z, _mm_setr_epi8(0, 1, 6, 7, 12, 13, NONE, NONE, NONE, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, NONE, 2, 3, 8, 9, 14, 15, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, NONE, NONE, NONE, NONE, 4, 5, 10, 11));
    *g = every_third(x, y, z, _mm_setr_epi8(2, 3, 8, 9, 14, 15, NONE, NONE, NONE, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, NONE, 4, 5, 10, 11, NONE, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, NONE, NONE, NONE, 0, 1, 6, 7, 12, 13));
    *b = every_third(x, y, z, _mm_setr_epi8(4, 5, 10, 11, NONE, NONE, NONE, NONE, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, 0, 1, 6, 7, 12, 13, NONE, NONE, NONE),
                     _mm_setr_epi8(NONE, NONE, NONE, NONE, NONE, 2, 3, 8, 9, 14, 15));
#undef NONE
}

INLINE void load8_rgb16(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m128i red, green, blue;
    words_of_three(source, &red, &green, &blue);
    *r = from_16(red);
    *g = from_16(green);
    *b = from_16(blue);
    *a = v_all(1.0f);
}

INLINE void load8_rgb16f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m128i red, green, blue;
    words_of_three(source, &red, &green, &blue);
    *r = _mm256_cvtph_ps(red);
    *g = _mm256_cvtph_ps(green);
    *b = _mm256_cvtph_ps(blue);
    *a = v_all(1.0f);
}

/* --- store WIDTH pixels of 8-bit codes --- */

/* Pixels whose codes are the third bytes of three numbers each, opaque. */
INLINE ints v_pixels(ints first, ints second, ints third)
{
    const __m256i to_first =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(2, -1, -1, -1, 6, -1, -1, -1, 10, -1, -1, -1, 14, -1, -1, -1));
    const __m256i to_second =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(-1, 2, -1, -1, -1, 6, -1, -1, -1, 10, -1, -1, -1, 14, -1, -1));
    const __m256i ends = _mm256_blend_epi16(_mm256_shuffle_epi8(first, to_first), third, 0xaa);
    return _mm256_or_si256(_mm256_or_si256(ends, _mm256_shuffle_epi8(second, to_second)),
                           _mm256_set1_epi32((int32_t)0xff000000u));
}

INLINE void v_store_four(ints pixel, uint8_t *target)
{
    _mm256_storeu_si256((__m256i *)(void *)target, pixel);
}

/* The first three bytes of each; writes 4 bytes beyond the last. */
INLINE void v_store_three(ints pixel, uint8_t *target)
{
    const __m256i order = _mm256_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1, /**/
                                           0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
    const __m256i packed = _mm256_shuffle_epi8(pixel, order);
    _mm_storeu_si128((__m128i *)(void *)target, _mm256_castsi256_si128(packed));
    _mm_storeu_si128((__m128i *)(void *)(target + 12), _mm256_extracti128_si256(packed, 1));
}

#endif
