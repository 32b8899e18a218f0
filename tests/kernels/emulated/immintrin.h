/* AVX-512 instructions as functions, for a CPU without them: SIMDe's, and here those that SIMDe 0.7 lacks. Slow, and
 * exact. */
#ifndef PUPIL_EMULATED_IMMINTRIN_H
#define PUPIL_EMULATED_IMMINTRIN_H

#define SIMDE_NO_NATIVE /* the header that this one replaces */
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/avx2.h>
#include <simde/x86/avx512.h>
#include <simde/x86/f16c.h>
#include <simde/x86/fma.h>

#include <string.h>

typedef uint16_t __mmask16;
typedef uint32_t __mmask32;

/* A result of 16 numbers, computed element by element. */
#define EMULATED(RESULT, TYPE, EXPRESSION)                                                                             \
    TYPE out_[16];                                                                                                     \
    RESULT result_;                                                                                                    \
    for (int i = 0; i < 16; i++)                                                                                       \
        out_[i] = (EXPRESSION);                                                                                        \
    memcpy(&result_, out_, sizeof result_);                                                                            \
    return result_
#define APART(TYPE, NAME, FROM)                                                                                        \
    TYPE NAME[sizeof(FROM) / sizeof(TYPE)];                                                                            \
    memcpy(NAME, &FROM, sizeof FROM)

/* Out of range: the "integer indefinite" (Intel SDM, CVTTPS2DQ). */
static inline __m512i emulated_cvttps_epi32(__m512 v)
{
    APART(float, in, v);
    EMULATED(__m512i, int32_t, in[i] >= -0x1p31f && in[i] < 0x1p31f ? (int32_t)in[i] : INT32_MIN);
}
#define _mm512_cvttps_epi32 emulated_cvttps_epi32

static inline __m512 emulated_cvtepi32_ps(__m512i v)
{
    APART(int32_t, in, v);
    EMULATED(__m512, float, (float)in[i]);
}
#define _mm512_cvtepi32_ps emulated_cvtepi32_ps

static inline __m512i emulated_srai_epi32(__m512i v, int n)
{
    APART(int32_t, in, v);
    EMULATED(__m512i, int32_t, in[i] >> n);
}
#define _mm512_srai_epi32 emulated_srai_epi32

static inline __m512i emulated_cvtepu16_epi32(__m256i v)
{
    APART(uint16_t, in, v);
    EMULATED(__m512i, int32_t, in[i]);
}
#define _mm512_cvtepu16_epi32 emulated_cvtepu16_epi32

static inline float emulated_half(uint16_t h)
{
    const __m128 v = _mm_cvtph_ps(_mm_set1_epi16((short)h));
    return _mm_cvtss_f32(v);
}

static inline __m512 emulated_cvtph_ps(__m256i v)
{
    APART(uint16_t, in, v);
    EMULATED(__m512, float, emulated_half(in[i]));
}
#define _mm512_cvtph_ps emulated_cvtph_ps

static inline __m512i emulated_i32gather_epi32(__m512i index, const void *base, int scale)
{
    APART(int32_t, at, index);
    int32_t word[16];
    for (int i = 0; i < 16; i++)
        memcpy(word + i, (const char *)base + (ptrdiff_t)at[i] * scale, sizeof *word);
    EMULATED(__m512i, int32_t, word[i]);
}
#define _mm512_i32gather_epi32 emulated_i32gather_epi32

/* Eight words of 64 bits. */
static inline __m512i emulated_i32gather_epi64(__m256i index, const void *base, int scale)
{
    APART(int32_t, at, index);
    int64_t word[8];
    for (int i = 0; i < 8; i++)
        memcpy(word + i, (const char *)base + (ptrdiff_t)at[i] * scale, sizeof *word);
    __m512i result;
    memcpy(&result, word, sizeof result);
    return result;
}
#define _mm512_i32gather_epi64 emulated_i32gather_epi64

static inline __m512i emulated_cvtepu8_epi32(__m128i v)
{
    APART(uint8_t, in, v);
    EMULATED(__m512i, int32_t, in[i]);
}
#define _mm512_cvtepu8_epi32 emulated_cvtepu8_epi32

static inline __m512i emulated_cvtepi8_epi32(__m128i v)
{
    APART(int8_t, in, v);
    EMULATED(__m512i, int32_t, in[i]);
}
#define _mm512_cvtepi8_epi32 emulated_cvtepi8_epi32

/* Two quarters of a, then two of b. */
static inline __m512 emulated_shuffle_f32x4(__m512 a, __m512 b, int order)
{
    APART(float, x, a);
    APART(float, y, b);
    EMULATED(__m512, float, (i < 8 ? x : y)[4 * (order >> i / 4 * 2 & 3) + i % 4]);
}
#define _mm512_shuffle_f32x4 emulated_shuffle_f32x4

static inline __m512i emulated_alignr_epi32(__m512i b, __m512i a, int n)
{
    APART(int32_t, low, a);
    APART(int32_t, high, b);
    EMULATED(__m512i, int32_t, i + n < 16 ? low[i + n] : high[i + n - 16]);
}
#define _mm512_alignr_epi32 emulated_alignr_epi32

static inline __mmask16 emulated_cmplt_epu32_mask(__m512i a, __m512i b)
{
    APART(uint32_t, x, a);
    APART(uint32_t, y, b);
    __mmask16 mask = 0;
    for (int i = 0; i < 16; i++)
        mask = (__mmask16)(mask | (x[i] < y[i]) << i);
    return mask;
}
#define _mm512_cmplt_epu32_mask emulated_cmplt_epu32_mask

static inline __mmask32 emulated_cmpgt_epi16_mask(__m512i a, __m512i b)
{
    APART(int16_t, x, a);
    APART(int16_t, y, b);
    __mmask32 mask = 0;
    for (int i = 0; i < 32; i++)
        mask |= (__mmask32)(x[i] > y[i]) << i;
    return mask;
}
#define _mm512_cmpgt_epi16_mask emulated_cmpgt_epi16_mask

static inline void emulated_mask_storeu_epi32(void *to, __mmask16 mask, __m512i v)
{
    APART(int32_t, in, v);
    for (int i = 0; i < 16; i++)
        if (mask >> i & 1)
            memcpy((char *)to + 4 * i, in + i, 4);
}
#define _mm512_mask_storeu_epi32 emulated_mask_storeu_epi32

#endif
