/* lib/kernels/avx512.h: vectors of 16 floats, for vector.h: AVX-512 F, BW, DQ and VL. */
#ifndef PUPIL_KERNELS_AVX512_H
#define PUPIL_KERNELS_AVX512_H

#include <immintrin.h>
#include <stdint.h>

#include "x86_pairs.h"

#define WIDTH 16
typedef __m512 floats;
typedef __m512i ints;
typedef __mmask16 mask;

INLINE floats v_load(const float *p)
{
    return _mm512_loadu_ps(p);
}
INLINE void v_store(float *p, floats v)
{
    _mm512_storeu_ps(p, v);
}
INLINE void v_store_ints(int32_t *p, ints v)
{
    _mm512_storeu_si512(p, v);
}
INLINE ints v_load_ints(const int32_t *p)
{
    return _mm512_loadu_si512(p);
}
INLINE floats v_all(float x)
{
    return _mm512_set1_ps(x);
}
INLINE ints v_all_ints(uint32_t x)
{
    return _mm512_set1_epi32((int32_t)x);
}

INLINE floats v_add(floats a, floats b)
{
    return _mm512_add_ps(a, b);
}
INLINE floats v_sub(floats a, floats b)
{
    return _mm512_sub_ps(a, b);
}
INLINE floats v_mul(floats a, floats b)
{
    return _mm512_mul_ps(a, b);
}
/* a * b + c, rounded once: only where no result depends on the rounding */
INLINE floats v_about(floats a, floats b, floats c)
{
    return _mm512_fmadd_ps(a, b, c);
}
INLINE floats v_div(floats a, floats b)
{
    return _mm512_div_ps(a, b);
}
/* a > b ? a : b and a < b ? a : b: b where one is NaN */
INLINE floats v_max(floats a, floats b)
{
    return _mm512_max_ps(a, b);
}
INLINE floats v_min(floats a, floats b)
{
    return _mm512_min_ps(a, b);
}

INLINE mask v_greater(floats a, floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ);
}
INLINE mask v_less(floats a, floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
INLINE mask v_at_least(floats a, floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ);
}
INLINE mask v_is_number(floats a)
{
    return _mm512_cmp_ps_mask(a, a, _CMP_ORD_Q);
}
INLINE mask v_both(mask a, mask b)
{
    return (mask)(a & b);
}
INLINE mask v_not(mask a)
{
    return (mask)~a;
}
INLINE floats v_select(mask m, floats yes, floats no)
{
    return _mm512_mask_blend_ps(m, no, yes);
}
INLINE floats v_where(mask m, floats a)
{
    return _mm512_maskz_mov_ps(m, a);
} /* else 0 */
INLINE int v_every(mask m)
{
    return m == 0xffff;
}
INLINE uint32_t v_mask_bits(mask m)
{
    return m;
}

/* its fraction, as a number in [1, 2) */
INLINE floats v_fraction(floats a)
{
    const __m512i fraction = _mm512_and_si512(_mm512_castps_si512(a), _mm512_set1_epi32(0x007fffff));
    return _mm512_castsi512_ps(_mm512_or_si512(fraction, _mm512_set1_epi32(0x3f800000)));
}

INLINE ints v_bits(floats a)
{
    return _mm512_castps_si512(a);
}
INLINE floats v_of_bits(ints a)
{
    return _mm512_castsi512_ps(a);
}
INLINE ints v_plus(ints a, ints b)
{
    return _mm512_add_epi32(a, b);
}
INLINE ints v_minus(ints a, ints b)
{
    return _mm512_sub_epi32(a, b);
}
INLINE ints v_and(ints a, ints b)
{
    return _mm512_and_si512(a, b);
}
INLINE ints v_or(ints a, ints b)
{
    return _mm512_or_si512(a, b);
}
#define v_right(a, n)        _mm512_srli_epi32(a, n)
#define v_right_signed(a, n) _mm512_srai_epi32(a, n)
#define v_left(a, n)         _mm512_slli_epi32(a, n)
INLINE ints v_max_unsigned(ints a, ints b)
{
    return _mm512_max_epu32(a, b);
}
INLINE ints v_min_halves(ints a, ints b)
{
    return _mm512_min_epu16(a, b);
}
INLINE ints v_to_ints(floats a)
{
    return _mm512_cvttps_epi32(a);
}
/* the integer below: 1 rounds down, to 0 binary places */
INLINE floats v_floor(floats a)
{
    return _mm512_roundscale_ps(a, 1);
}
INLINE floats v_from_ints(ints a)
{
    return _mm512_cvtepi32_ps(a);
}
INLINE mask v_equal_ints(ints a, ints b)
{
    return _mm512_cmpeq_epi32_mask(a, b);
}
/* unsigned */
INLINE mask v_at_most(ints a, ints b)
{
    return _mm512_cmple_epu32_mask(a, b);
}

/* how many are true, over several masks */
typedef uint32_t tally;
INLINE tally v_no_tally(void)
{
    return 0;
}
INLINE tally v_tally(tally t, mask m)
{
    return t + (uint32_t)__builtin_popcount(m);
}
INLINE uint32_t v_tallied(tally t)
{
    return t;
}
/* of one mask */
INLINE uint64_t v_group_bits(const mask *m)
{
    return m[0];
}

/* table[i & 7] of 8 floats: twice in a vector, whose look-up takes the lower four bits */
INLINE floats v_table8_of(const float *table)
{
    return _mm512_broadcast_f32x8(_mm256_loadu_ps(table));
}
INLINE floats v_table8(floats table, ints i)
{
    return _mm512_permutexvar_ps(i, table);
}
INLINE ints v_gather(const uint32_t *table, ints i)
{
    return _mm512_i32gather_epi32(i, table, 4);
}

/* As parts_of_pairs, of sixteen. */
INLINE void parts_of_16_pairs(const float *first, ptrdiff_t step, ints i, floats part[2])
{
    int64_t two[WIDTH / 2];
    __m256 low[2], high[2];
    v_store_ints((int32_t *)(void *)two, i);
    parts_of_pairs(first, step, two, low);
    parts_of_pairs(first, step, two + 4, high);
    for (int k = 0; k < 2; k++)
        part[k] = _mm512_insertf32x8(_mm512_castps256_ps512(low[k]), high[k], 1);
}

/* light[i][0] + rest * light[i][1] */
INLINE floats v_interpolate(const float (*light)[2], ints i, floats rest)
{
    floats part[2];
    parts_of_16_pairs(light[0], 2, i, part);
    return v_add(part[0], v_mul(rest, part[1]));
}

/* from knot[i] to knot[i + 1], by a part of the way */
INLINE floats v_between(const float *knot, ints i, floats part)
{
    floats ends[2];
    parts_of_16_pairs(knot, 1, i, ends);
    return v_add(ends[0], v_mul(part, v_sub(ends[1], ends[0])));
}

/* 16 bytes as numbers, and 8 pairs of bytes as two numbers less 128, each twice */
INLINE void v_of_bytes(const uint8_t *p, floats to[1])
{
    to[0] = _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)(const void *)p)));
}

#define CHROMA_UNIT 1.0f
INLINE void v_of_chroma(const uint8_t *p, floats u[1], floats v[1])
{
    const __m128i pairs = _mm_xor_si128(_mm_loadu_si128((const __m128i *)(const void *)p), _mm_set1_epi8(-128));
    const __m128i twice_u = _mm_setr_epi8(0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14);
    const __m128i twice_v = _mm_setr_epi8(1, 1, 3, 3, 5, 5, 7, 7, 9, 9, 11, 11, 13, 13, 15, 15);
    u[0] = _mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(_mm_shuffle_epi8(pairs, twice_u)));
    v[0] = _mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(_mm_shuffle_epi8(pairs, twice_v)));
}

/* The same of 16 pixels in YUYV (luma_at 0) or UYVY (1). */
INLINE void v_of_packed(const uint8_t *p, int32_t luma_at, floats y[1], floats u[1], floats v[1])
{
    const __m512i both = _mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)p));
    const __m512i byte = _mm512_set1_epi32(0xff);
    const __m512i luma = _mm512_and_si512(_mm512_srl_epi32(both, _mm_cvtsi32_si128(8 * luma_at)), byte);
    const __m512i chroma = _mm512_and_si512(_mm512_srl_epi32(both, _mm_cvtsi32_si128(8 - 8 * luma_at)), byte);
    const floats u_and_v = _mm512_cvtepi32_ps(_mm512_sub_epi32(chroma, _mm512_set1_epi32(128)));
    y[0] = _mm512_cvtepi32_ps(luma);
    u[0] = _mm512_shuffle_ps(u_and_v, u_and_v, 0xa0); /* lanes 0, 0, 2, 2 */
    v[0] = _mm512_shuffle_ps(u_and_v, u_and_v, 0xf5); /* lanes 1, 1, 3, 3 */
}

/* --- load 16 pixels; *a is alpha, or whether it is opaque --- */

/* Every fourth float of 32, from the first and from the second (or the third and the fourth). */
static const int32_t fourths[2][16] = {{0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29},
                                       {2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31}};

INLINE void load16_rgba32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    const __m512 p = _mm512_loadu_ps(s), q = _mm512_loadu_ps(s + 16);
    const __m512 t = _mm512_loadu_ps(s + 32), u = _mm512_loadu_ps(s + 48);
    const __m512i rg = v_load_ints(fourths[0]), ba = v_load_ints(fourths[1]);
    const __m512 rg_low = _mm512_permutex2var_ps(p, rg, q), rg_high = _mm512_permutex2var_ps(t, rg, u);
    const __m512 ba_low = _mm512_permutex2var_ps(p, ba, q), ba_high = _mm512_permutex2var_ps(t, ba, u);
    *r = _mm512_shuffle_f32x4(rg_low, rg_high, 0x44);
    *g = _mm512_shuffle_f32x4(rg_low, rg_high, 0xee);
    *b = _mm512_shuffle_f32x4(ba_low, ba_high, 0x44);
    *a = _mm512_shuffle_f32x4(ba_low, ba_high, 0xee);
}

/* Every third float of 48: first of the lower 32 (with anything in the place of the others), then of the rest. */
static const int32_t thirds[3][2][16] = {
    {{0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29}},
    {{1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30}},
    {{2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31}}};

INLINE floats third_of(__m512 p, __m512 q, __m512 t, int which)
{
    const __m512 low = _mm512_permutex2var_ps(p, v_load_ints(thirds[which][0]), q);
    return _mm512_permutex2var_ps(low, v_load_ints(thirds[which][1]), t);
}

INLINE void load16_rgb32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float *s = source;
    const __m512 p = _mm512_loadu_ps(s), q = _mm512_loadu_ps(s + 16), t = _mm512_loadu_ps(s + 32);
    *r = third_of(p, q, t, 0);
    *g = third_of(p, q, t, 1);
    *b = third_of(p, q, t, 2);
    *a = v_all(1.0f);
}

/* As fourths, of 64 words. */
static const int16_t word_fourths[2][32] = {{0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60,
                                             1, 5, 9, 13, 17, 21, 25, 29, 33, 37, 41, 45, 49, 53, 57, 61},
                                            {2, 6, 10, 14, 18, 22, 26, 30, 34, 38, 42, 46, 50, 54, 58, 62,
                                             3, 7, 11, 15, 19, 23, 27, 31, 35, 39, 43, 47, 51, 55, 59, 63}};

/* Two vectors of 16 words each: the samples in the lower half, then in the upper. */
INLINE void words_of_four(const void *source, __m512i *rg, __m512i *ba)
{
    const __m512i p = _mm512_loadu_si512(source), q = _mm512_loadu_si512((const char *)source + 64);
    *rg = _mm512_permutex2var_epi16(p, _mm512_loadu_si512(word_fourths[0]), q);
    *ba = _mm512_permutex2var_epi16(p, _mm512_loadu_si512(word_fourths[1]), q);
}

INLINE __m256i lower_words(__m512i v)
{
    return _mm512_castsi512_si256(v);
}
INLINE __m256i upper_words(__m512i v)
{
    return _mm512_extracti64x4_epi64(v, 1);
}

INLINE void load16_rgba16f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m512i rg, ba;
    words_of_four(source, &rg, &ba);
    *r = _mm512_cvtph_ps(lower_words(rg));
    *g = _mm512_cvtph_ps(upper_words(rg));
    *b = _mm512_cvtph_ps(lower_words(ba));
    *a = _mm512_cvtph_ps(upper_words(ba));
}

INLINE floats from_16(__m256i v)
{
    return _mm512_mul_ps(_mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(v)), _mm512_set1_ps(1.0f / 65535.0f));
}

INLINE void load16_rgba16(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m512i rg, ba;
    words_of_four(source, &rg, &ba);
    *r = from_16(lower_words(rg));
    *g = from_16(upper_words(rg));
    *b = from_16(lower_words(ba));
    *a = from_16(_mm256_cmpeq_epi16(upper_words(ba), _mm256_set1_epi16(-1)));
}

/* Every third word of 48: red and green, blue (its second half is not used). */
static const int16_t word_thirds[2][32] = {
    {0, 3, 6, 9,  12, 15, 18, 21, 24, 27, 30, 33, 36, 39, 42, 45,
     1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 34, 37, 40, 43, 46},
    {2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 32, 35, 38, 41, 44, 47, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};

INLINE void words_of_three(const void *source, __m512i *rg, __m512i *b)
{
    const __m512i p = _mm512_loadu_si512(source);
    const __m512i q =
        _mm512_castsi256_si512(_mm256_loadu_si256((const __m256i *)(const void *)((const char *)source + 64)));
    *rg = _mm512_permutex2var_epi16(p, _mm512_loadu_si512(word_thirds[0]), q);
    *b = _mm512_permutex2var_epi16(p, _mm512_loadu_si512(word_thirds[1]), q);
}

INLINE void load16_rgb16(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m512i rg, blue;
    words_of_three(source, &rg, &blue);
    *r = from_16(lower_words(rg));
    *g = from_16(upper_words(rg));
    *b = from_16(lower_words(blue));
    *a = v_all(1.0f);
}

INLINE void load16_rgb16f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    __m512i rg, blue;
    words_of_three(source, &rg, &blue);
    *r = _mm512_cvtph_ps(lower_words(rg));
    *g = _mm512_cvtph_ps(upper_words(rg));
    *b = _mm512_cvtph_ps(lower_words(blue));
    *a = v_all(1.0f);
}

/* --- store 16 pixels of 8-bit codes --- */

/* Pixels whose codes are the third bytes of three numbers each, opaque. */
INLINE ints v_pixels(ints first, ints second, ints third)
{
    const __m512i to_first = _mm512_set4_epi32(14, 10, 6, 2),
                  to_second = _mm512_set4_epi32(14 << 8, 10 << 8, 6 << 8, 2 << 8);
    const __m512i ends =
        _mm512_mask_blend_epi16(0xaaaaaaaa, _mm512_maskz_shuffle_epi8(0x1111111111111111, first, to_first), third);
    return _mm512_ternarylogic_epi32(ends, _mm512_maskz_shuffle_epi8(0x2222222222222222, second, to_second),
                                     _mm512_set1_epi32((int32_t)0xff000000u), 0xfe); /* or */
}

INLINE void v_store_four(ints pixel, uint8_t *target)
{
    _mm512_storeu_si512(target, pixel);
}

/* The first three bytes of each, and nothing beyond. */
INLINE void v_store_three(ints pixel, uint8_t *target)
{
    const __m512i order = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1));
    const __m512i together = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    const __m512i packed = _mm512_permutexvar_epi32(together, _mm512_shuffle_epi8(pixel, order));
    _mm512_mask_storeu_epi32(target, 0x0fff, packed);
}

#endif
