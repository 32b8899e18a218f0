/* lib/kernels/avx2_luma.h: 32 bytes, or 16 words, for vector_luma.h. */
#ifndef PUPIL_KERNELS_AVX2_LUMA_H
#define PUPIL_KERNELS_AVX2_LUMA_H

#include "avx2.h"
#include "kernels.h"

#define QUADS 16
typedef __m256i v_bytes;
typedef __m256i v_words;

INLINE v_bytes b_load(const uint8_t *p)
{
    return _mm256_loadu_si256((const __m256i *)(const void *)p);
}
INLINE void b_store(uint8_t *p, v_bytes v)
{
    _mm256_storeu_si256((__m256i *)(void *)p, v);
}
#define w_load b_load
INLINE void w_store(uint16_t *p, v_words v)
{
    _mm256_storeu_si256((__m256i *)(void *)p, v);
}
INLINE v_words w_all(int x)
{
    return _mm256_set1_epi16((short)x);
}
#define w_of_bytes(a)        (a)
#define b_max(a, b)          _mm256_max_epu8(a, b)
#define b_min(a, b)          _mm256_min_epu8(a, b)
#define b_more(a, b)         _mm256_adds_epu8(a, b)
#define b_less(a, b)         _mm256_subs_epu8(a, b)
#define w_add(a, b)          _mm256_add_epi16(a, b)
#define w_sub(a, b)          _mm256_sub_epi16(a, b)
#define w_and(a, b)          _mm256_and_si256(a, b)
#define w_minus_and(a, b)    _mm256_andnot_si256(b, a)
#define w_or(a, b)           _mm256_or_si256(a, b)
#define w_xor(a, b)          _mm256_xor_si256(a, b)
#define w_max(a, b)          _mm256_max_epi16(a, b)
#define w_min(a, b)          _mm256_min_epi16(a, b)
#define w_greater(a, b)      _mm256_cmpgt_epi16(a, b)
#define w_left(a, n)         _mm256_slli_epi16(a, n)
#define w_right(a, n)        _mm256_srli_epi16(a, n)
#define w_right_signed(a, n) _mm256_srai_epi16(a, n)
#define w_times(a, b)        _mm256_mulhrs_epi16(a, b)
INLINE v_words b_sums(v_bytes a)
{
    return _mm256_maddubs_epi16(a, _mm256_set1_epi8(1));
}
/* the words of numbers up to 32767 */
#define w_of_ints(a, b) _mm256_permute4x64_epi64(_mm256_packus_epi32(a, b), 0xd8)
INLINE uint32_t w_least(v_words a)
{
    const __m128i eight = _mm_min_epu16(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
    return (uint32_t)_mm_cvtsi128_si32(_mm_minpos_epu16(eight)) & 0xffff;
}
INLINE v_bytes b_all(uint32_t x)
{
    return _mm256_set1_epi8((char)x);
}
/* how many bytes are the same, over several vectors */
typedef uint32_t matches;
#define b_no_matches() 0
INLINE matches b_match(matches m, v_bytes a, v_bytes b)
{
    return m + (uint32_t)__builtin_popcount((uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(a, b)));
}
#define b_matched(m) (m)
INLINE int w_any(v_words a)
{
    return !_mm256_testz_si256(a, a);
}

/* Forces a vector into a register here: gcc would make all look-ups first and combine them later, run out of registers,
 * and load entries again for each shuffle. */
#define IN_REGISTER(v) __asm__("" : "+x"(v))

/* A shuffle looks up 16 entries, and gives 0 for an index below 0. Each next 16 entries hold the difference (exclusive
 * or) to the last ones; it is applied as long as the index, less 16 each time, is not below 0. Indices from 128 on
 * begin below 0, and have a chain of their own. */
INLINE __m256i sixteen_of(const uint8_t *table, int k)
{
    return _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)(table + 16 * (size_t)k)));
}

#if defined(__clang__)
#define FOR_CHAIN(k, COUNT) for (int k = 0; k < COUNT; k++)
#else
#define FOR_CHAIN(k, COUNT) _Pragma("GCC unroll 8") for (int k = 0; k < COUNT; k++)
#endif

INLINE void look_up_chain(const uint8_t steps[128], __m256i at[4], __m256i found[4])
{
    const __m256i step = _mm256_set1_epi8(16);
    FOR_CHAIN(k, 8)
    {
        __m256i entries = sixteen_of(steps, k);
        IN_REGISTER(entries);
        FOR_FOUR(j)
        {
            found[j] = _mm256_xor_si256(found[j], _mm256_shuffle_epi8(entries, at[j]));
            IN_REGISTER(found[j]);
            at[j] = _mm256_subs_epi8(at[j], step);
        }
    }
}

typedef struct luma_entries {
    const uint8_t *steps;
} luma_entries;

INLINE void luma_entries_of(const pupil_luma_tables *t, luma_entries *e)
{
    e->steps = t->luma_steps;
}

/* 128 codes. In a part of a picture there are often none below 128, or none above. Not inline: gcc would copy all
 * entries. */
static __attribute__((noinline)) void look_up_128(const uint8_t steps[256], const uint8_t *from, uint8_t *to)
{
    const __m256i upper = _mm256_set1_epi8(-128);
    __m256i code[4], at[4], found[4];
    FOR_FOUR(j)
    {
        code[j] = at[j] = b_load(from + 32 * (size_t)j);
        found[j] = _mm256_setzero_si256();
    }
    const __m256i any = _mm256_or_si256(_mm256_or_si256(code[0], code[1]), _mm256_or_si256(code[2], code[3]));
    const __m256i all = _mm256_and_si256(_mm256_and_si256(code[0], code[1]), _mm256_and_si256(code[2], code[3]));
    if (!_mm256_testc_si256(all, upper))
        look_up_chain(steps, at, found);
    if (!_mm256_testz_si256(any, upper)) {
        FOR_FOUR(j) at[j] = _mm256_xor_si256(code[j], upper);
        look_up_chain(steps + 128, at, found);
    }
    FOR_FOUR(j) b_store(to + 32 * (size_t)j, found[j]);
}

/* n is a multiple of 64; if it is none of 128, the last 128 overlap those before. */
INLINE void luma_by_table(const luma_entries *e, const uint8_t *table, const uint8_t *from, uint32_t n, uint8_t *to)
{
    for (uint32_t i = 0; i + 128 <= n; i += 128)
        look_up_128(e->steps, from + i, to + i);
    if (n % 128 && n > 128)
        look_up_128(e->steps, from + n - 128, to + n - 128);
    for (uint32_t i = 0; i < n && n < 128; i++)
        to[i] = table[from[i]];
}

typedef struct ratio_tables {
    __m256i low[8], high[8];
} ratio_tables;

INLINE void chain_of(const uint8_t table[128], __m256i chain[8])
{
    __m256i last = _mm256_setzero_si256();
    for (int k = 0; k < 8; k++) {
        const __m256i next = sixteen_of(table, k);
        chain[k] = _mm256_xor_si256(next, last);
        last = next;
    }
}

INLINE void ratio_tables_of(const pupil_luma_tables *t, ratio_tables *r)
{
    chain_of(t->ratio_low, r->low);
    chain_of(t->ratio_high, r->high);
}

/* Of words up to 127. */
INLINE void w_look_up(const ratio_tables *r, v_words first, v_words second, v_words ratio[2])
{
    const __m256i step = _mm256_set1_epi8(16);
    __m256i at = _mm256_packus_epi16(first, second), low = _mm256_setzero_si256(), high = low;
    FOR_CHAIN(k, 8)
    {
        low = _mm256_xor_si256(low, _mm256_shuffle_epi8(r->low[k], at));
        high = _mm256_xor_si256(high, _mm256_shuffle_epi8(r->high[k], at));
        IN_REGISTER(low);
        IN_REGISTER(high);
        at = _mm256_subs_epi8(at, step);
    }
    ratio[0] = _mm256_unpacklo_epi8(low, high);
    ratio[1] = _mm256_unpackhi_epi8(low, high);
}

/* Scaled Cb and Cr as codes, interleaved. */
INLINE v_bytes w_to_pairs(v_words u, v_words v)
{
    const __m256i half = _mm256_set1_epi16(8);
    const __m256i turns =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15));
    const __m256i packed = _mm256_packs_epi16(_mm256_srai_epi16(_mm256_add_epi16(u, half), 4),
                                              _mm256_srai_epi16(_mm256_add_epi16(v, half), 4));
    return _mm256_xor_si256(_mm256_shuffle_epi8(packed, turns), _mm256_set1_epi8(-128));
}

/* Words as bytes, 0 for negative ones; in b_twice's order. */
#define w_to_bytes(a, b) _mm256_packus_epi16(a, b)
/* Each byte twice: those of the first words, and those of the second. */
INLINE void b_twice(v_bytes a, v_bytes to[2])
{
    to[0] = _mm256_unpacklo_epi8(a, a);
    to[1] = _mm256_unpackhi_epi8(a, a);
}

INLINE void b_store_rgba(uint8_t *p, v_bytes r, v_bytes g, v_bytes b)
{
    const __m256i full = _mm256_set1_epi8(-1);
    const __m256i rg0 = _mm256_unpacklo_epi8(r, g), rg1 = _mm256_unpackhi_epi8(r, g);
    const __m256i ba0 = _mm256_unpacklo_epi8(b, full), ba1 = _mm256_unpackhi_epi8(b, full);
    const __m256i p0 = _mm256_unpacklo_epi16(rg0, ba0), p1 = _mm256_unpackhi_epi16(rg0, ba0);
    const __m256i p2 = _mm256_unpacklo_epi16(rg1, ba1), p3 = _mm256_unpackhi_epi16(rg1, ba1);
    b_store(p, _mm256_permute2x128_si256(p0, p1, 0x20));
    b_store(p + 32, _mm256_permute2x128_si256(p2, p3, 0x20));
    b_store(p + 64, _mm256_permute2x128_si256(p0, p1, 0x31));
    b_store(p + 96, _mm256_permute2x128_si256(p2, p3, 0x31));
}

#endif
