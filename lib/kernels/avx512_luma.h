/* lib/kernels/avx512_luma.h: 64 bytes, or 32 words, for vector_luma.h. */
#ifndef PUPIL_KERNELS_AVX512_LUMA_H
#define PUPIL_KERNELS_AVX512_LUMA_H

#include "avx512.h"
#include "kernels.h"

#define QUADS 32
typedef __m512i v_bytes;
typedef __m512i v_words;

INLINE v_bytes b_load(const uint8_t *p)
{
    return _mm512_loadu_si512(p);
}
INLINE void b_store(uint8_t *p, v_bytes v)
{
    _mm512_storeu_si512(p, v);
}
#define w_load b_load
INLINE void w_store(uint16_t *p, v_words v)
{
    _mm512_storeu_si512(p, v);
}
INLINE v_words w_all(int x)
{
    return _mm512_set1_epi16((short)x);
}
#define w_of_bytes(a)        (a)
#define b_max(a, b)          _mm512_max_epu8(a, b)
#define b_min(a, b)          _mm512_min_epu8(a, b)
#define b_more(a, b)         _mm512_adds_epu8(a, b)
#define b_less(a, b)         _mm512_subs_epu8(a, b)
#define w_add(a, b)          _mm512_add_epi16(a, b)
#define w_sub(a, b)          _mm512_sub_epi16(a, b)
#define w_and(a, b)          _mm512_and_si512(a, b)
#define w_minus_and(a, b)    _mm512_andnot_si512(b, a)
#define w_or(a, b)           _mm512_or_si512(a, b)
#define w_xor(a, b)          _mm512_xor_si512(a, b)
#define w_max(a, b)          _mm512_max_epi16(a, b)
#define w_min(a, b)          _mm512_min_epi16(a, b)
#define w_greater(a, b)      _mm512_movm_epi16(_mm512_cmpgt_epi16_mask(a, b))
#define w_left(a, n)         _mm512_slli_epi16(a, n)
#define w_right(a, n)        _mm512_srli_epi16(a, n)
#define w_right_signed(a, n) _mm512_srai_epi16(a, n)
#define w_times(a, b)        _mm512_mulhrs_epi16(a, b)
INLINE v_words b_sums(v_bytes a)
{
    return _mm512_maddubs_epi16(a, _mm512_set1_epi8(1));
}
/* the words of numbers up to 32767 */
static const int16_t even_words[32] = {0,  2,  4,  6,  8,  10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30,
                                       32, 34, 36, 38, 40, 42, 44, 46, 48, 50, 52, 54, 56, 58, 60, 62};
INLINE v_words w_of_ints(ints a, ints b)
{
    return _mm512_permutex2var_epi16(a, _mm512_loadu_si512(even_words), b);
}
INLINE __m128i least_of_4(__m512i a)
{
    const __m256i two = _mm256_min_epu16(_mm512_castsi512_si256(a), _mm512_extracti64x4_epi64(a, 1));
    return _mm_min_epu16(_mm256_castsi256_si128(two), _mm256_extracti128_si256(two, 1));
}
INLINE uint32_t w_least(v_words a)
{
    return (uint32_t)_mm_cvtsi128_si32(_mm_minpos_epu16(least_of_4(a))) & 0xffff;
}
INLINE v_bytes b_all(uint32_t x)
{
    return _mm512_set1_epi8((char)x);
}
/* how many bytes are the same, over several vectors */
typedef uint32_t matches;
#define b_no_matches() 0
INLINE matches b_match(matches m, v_bytes a, v_bytes b)
{
    return m + (uint32_t)__builtin_popcountll(_mm512_cmpeq_epi8_mask(a, b));
}
#define b_matched(m) (m)
INLINE int w_any(v_words a)
{
    return _mm512_test_epi32_mask(a, a) != 0;
}

/* 128 words, by the lower 7 bits of an index. */
INLINE v_words w_of_128(const __m512i table[4], v_words at)
{
    const __m512i low = _mm512_permutex2var_epi16(table[0], at, table[1]);
    const __m512i high = _mm512_permutex2var_epi16(table[2], at, table[3]);
    return _mm512_mask_blend_epi16(_mm512_test_epi16_mask(at, _mm512_set1_epi16(64)), low, high);
}

typedef struct luma_entries {
    __m512i word[4];
} luma_entries;

INLINE void luma_entries_of(const pupil_luma_tables *t, luma_entries *e)
{
    const uint8_t *table = t->luma;
    for (size_t k = 0; k < 4; k++)
        e->word[k] = b_load(table + 64 * k);
}

/* 256 bytes are looked up as 128 words; the code's lowest bit selects a byte. */
INLINE void luma_by_table(const luma_entries *e, const uint8_t *table, const uint8_t *from, uint32_t n, uint8_t *to)
{
    (void)table;
    const __m512i low = _mm512_set1_epi16(0xff), eight = _mm512_set1_epi16(8);
    for (uint32_t i = 0; i < n; i += 64) {
        const __m512i code = b_load(from + i);
        const __m512i even = w_of_128(e->word, _mm512_srli_epi16(code, 1));
        const __m512i odd = w_of_128(e->word, _mm512_srli_epi16(code, 9));
        const __m512i even_half = _mm512_and_si512(_mm512_slli_epi16(code, 3), eight);
        const __m512i odd_half = _mm512_and_si512(_mm512_srli_epi16(code, 5), eight);
        b_store(to + i, _mm512_or_si512(_mm512_and_si512(_mm512_srlv_epi16(even, even_half), low),
                                        _mm512_slli_epi16(_mm512_srlv_epi16(odd, odd_half), 8)));
    }
}

typedef struct ratio_tables {
    __m512i word[4];
} ratio_tables;

INLINE void ratio_tables_of(const pupil_luma_tables *t, ratio_tables *r)
{
    uint16_t word[128];
    for (int i = 0; i < 128; i++)
        word[i] = (uint16_t)(t->ratio_low[i] | t->ratio_high[i] << 8);
    for (size_t k = 0; k < 4; k++)
        r->word[k] = _mm512_loadu_si512(word + 32 * k);
}

/* Of words up to 127. */
INLINE void w_look_up(const ratio_tables *r, v_words first, v_words second, v_words ratio[2])
{
    ratio[0] = w_of_128(r->word, first);
    ratio[1] = w_of_128(r->word, second);
}

/* Scaled Cb and Cr as codes, interleaved. */
INLINE v_bytes w_to_pairs(v_words u, v_words v)
{
    const __m512i sixteenth = _mm512_set1_epi16(0x8000 / 16);
    const __m512i turns = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15));
    const __m512i packed = _mm512_packs_epi16(w_times(u, sixteenth), w_times(v, sixteenth));
    return _mm512_xor_si512(_mm512_shuffle_epi8(packed, turns), _mm512_set1_epi8(-128));
}

/* Words as bytes, 0 for negative ones; in b_twice's order. */
#define w_to_bytes(a, b) _mm512_packus_epi16(a, b)
/* Each byte twice: those of the first words, and those of the second. */
INLINE void b_twice(v_bytes a, v_bytes to[2])
{
    to[0] = _mm512_unpacklo_epi8(a, a);
    to[1] = _mm512_unpackhi_epi8(a, a);
}

/* The first 16-byte lane of each of four vectors, then the second of each, and so on. */
INLINE void store_lanes(uint8_t *p, __m512i a, __m512i b, __m512i c, __m512i d)
{
    const __m512i ab0 = _mm512_shuffle_i32x4(a, b, 0x44), ab1 = _mm512_shuffle_i32x4(a, b, 0xee);
    const __m512i cd0 = _mm512_shuffle_i32x4(c, d, 0x44), cd1 = _mm512_shuffle_i32x4(c, d, 0xee);
    b_store(p, _mm512_shuffle_i32x4(ab0, cd0, 0x88));
    b_store(p + 64, _mm512_shuffle_i32x4(ab0, cd0, 0xdd));
    b_store(p + 128, _mm512_shuffle_i32x4(ab1, cd1, 0x88));
    b_store(p + 192, _mm512_shuffle_i32x4(ab1, cd1, 0xdd));
}

INLINE void b_store_rgba(uint8_t *p, v_bytes r, v_bytes g, v_bytes b)
{
    const __m512i full = _mm512_set1_epi8(-1);
    const __m512i rg0 = _mm512_unpacklo_epi8(r, g), rg1 = _mm512_unpackhi_epi8(r, g);
    const __m512i ba0 = _mm512_unpacklo_epi8(b, full), ba1 = _mm512_unpackhi_epi8(b, full);
    store_lanes(p, _mm512_unpacklo_epi16(rg0, ba0), _mm512_unpackhi_epi16(rg0, ba0), _mm512_unpacklo_epi16(rg1, ba1),
                _mm512_unpackhi_epi16(rg1, ba1));
}

#endif
