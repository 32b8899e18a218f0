/* lib/kernels/avx2_luma.h: 32 bytes, or 16 words, for vector_luma.h. */
#ifndef PUPIL_KERNELS_AVX2_LUMA_H
#define PUPIL_KERNELS_AVX2_LUMA_H

#include "avx2.h"
#include "by_luma.h"

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
/* how many bytes are the same, over up to 255 vectors */
typedef __m256i matches;
#define b_no_matches()   _mm256_setzero_si256()
#define b_match(m, a, b) _mm256_sub_epi8(m, _mm256_cmpeq_epi8(a, b))
INLINE __m256i sums_of_two(matches a, matches b)
{
    const __m256i none = _mm256_setzero_si256(), first = _mm256_sad_epu8(a, none), second = _mm256_sad_epu8(b, none);
    return _mm256_add_epi64(_mm256_unpacklo_epi64(first, second), _mm256_unpackhi_epi64(first, second));
}
#define LEVEL_HAS_ADD_MATCHED
INLINE void b_add_matched(const matches m[4], uint32_t weight, uint64_t bin[4])
{
    const __m256i low = sums_of_two(m[0], m[1]), high = sums_of_two(m[2], m[3]);
    const __m256i sums =
        _mm256_add_epi64(_mm256_permute2x128_si256(low, high, 0x20), _mm256_permute2x128_si256(low, high, 0x31));
    const __m256i more = _mm256_mul_epu32(sums, _mm256_set1_epi64x(weight));
    __m256i *to = (__m256i *)(void *)bin;
    _mm256_storeu_si256(to, _mm256_add_epi64(_mm256_loadu_si256(to), more));
}
INLINE int w_any(v_words a)
{
    return !_mm256_testz_si256(a, a);
}

/* A shuffle looks up 16 entries, and gives 0 for an index below 0. Each next 16 entries hold the difference (exclusive
 * or) to the last ones; it is applied as long as the index, less 16 each time, is not below 0. A chain of such shuffles
 * has 128 entries at most, for an index is signed; and only as many as there are from the least code to the largest. */
INLINE __m256i sixteen_of(const uint8_t *table, size_t k)
{
    return _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)(table + 16 * k)));
}

/* After the first. */
#if defined(__clang__)
#define FOR_SPAN(k, SPAN) for (size_t k = (SPAN).first + 1; k <= (SPAN).last; k++)
#else
#define FOR_SPAN(k, SPAN) _Pragma("GCC unroll 1") for (size_t k = (SPAN).first + 1; k <= (SPAN).last; k++)
#endif

typedef struct luma_entries {
    const uint8_t *table, *steps;
} luma_entries;

/* Sixteens of codes, from first to last: in a part of a picture, codes are often near each other. */
typedef struct luma_span {
    uint32_t first, last;
} luma_span;

INLINE uint32_t b_least(__m256i a)
{
    const __m128i half = _mm_min_epu8(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
    return (uint32_t)_mm_cvtsi128_si32(_mm_minpos_epu16(_mm_min_epu8(half, _mm_srli_epi16(half, 8)))) & 0xff;
}

/* Of 128 codes in each of two rows. */
INLINE luma_span span_of(const uint8_t *upper, const uint8_t *lower)
{
    __m256i low = b_load(upper), high = low;
    FOR_FOUR(j)
    {
        const __m256i a = b_load(upper + 32 * (size_t)j), b = b_load(lower + 32 * (size_t)j);
        low = b_min(low, b_min(a, b));
        high = b_max(high, b_max(a, b));
    }
    return (luma_span){b_least(low) / 16, (255 - b_least(_mm256_xor_si256(high, b_all(255)))) / 16};
}

/* The entries of 128 codes; span: 8 sixteens at most. Codes below it, and from 128 above its first on, get 0. */
INLINE void look_up_chain(const luma_entries *e, luma_span span, const uint8_t *from, __m256i found[4])
{
    const __m256i step = b_all(16), start = b_all(16 * span.first);
    __m256i entries = sixteen_of(e->table, span.first), at[4];
    FOR_FOUR(j)
    {
        at[j] = _mm256_sub_epi8(b_load(from + 32 * (size_t)j), start);
        found[j] = _mm256_xor_si256(found[j], _mm256_shuffle_epi8(entries, at[j]));
    }
    FOR_SPAN(k, span)
    {
        entries = sixteen_of(e->steps, k);
        FOR_FOUR(j)
        {
            at[j] = _mm256_subs_epi8(at[j], step);
            found[j] = _mm256_xor_si256(found[j], _mm256_shuffle_epi8(entries, at[j]));
        }
    }
}

/* Not inline: gcc would copy all entries. */
static __attribute__((noinline)) void look_up_128(const luma_entries *e, luma_span span, const uint8_t *from,
                                                  uint8_t *to)
{
    __m256i found[4];
    FOR_FOUR(j) found[j] = _mm256_setzero_si256();
    if (span.last - span.first < 8) {
        look_up_chain(e, span, from, found);
    } else {
        look_up_chain(e, (luma_span){0, 7}, from, found);
        look_up_chain(e, (luma_span){8, 15}, from, found);
    }
    FOR_FOUR(j) b_store(to + 32 * (size_t)j, found[j]);
}

#if defined(__clang__)
#define FOR_TWO(j) for (size_t j = 0; j < 2; j++)
#else
#define FOR_TWO(j) _Pragma("GCC unroll 2") for (size_t j = 0; j < 2; j++)
#endif

/* An eighth of the sums of 16 quads' codes, which are the ratios' indices. */
INLINE __m256i indices_of(const uint8_t *upper, const uint8_t *lower)
{
    return w_right(w_add(b_sums(b_load(upper)), b_sums(b_load(lower))), 3);
}

/* The ratios of 64 quads. The steps from sixteen to sixteen are made here: there are few. */
static __attribute__((noinline)) void look_up_64_ratios(const pupil_luma_tables *t, luma_span span,
                                                        const uint8_t *upper, const uint8_t *lower, int16_t *ratio)
{
    const __m256i step = b_all(16), start = b_all(16 * span.first);
    __m256i low_last = sixteen_of(t->ratio_low, span.first), high_last = sixteen_of(t->ratio_high, span.first);
    __m256i at[2], low[2], high[2];
    FOR_TWO(j)
    {
        const __m256i first = indices_of(upper + 64 * j, lower + 64 * j);
        const __m256i second = indices_of(upper + 64 * j + 32, lower + 64 * j + 32);
        at[j] = _mm256_sub_epi8(_mm256_packus_epi16(first, second), start);
        low[j] = _mm256_shuffle_epi8(low_last, at[j]);
        high[j] = _mm256_shuffle_epi8(high_last, at[j]);
    }
    FOR_SPAN(k, span)
    {
        const __m256i low_next = sixteen_of(t->ratio_low, k), high_next = sixteen_of(t->ratio_high, k);
        const __m256i low_step = _mm256_xor_si256(low_last, low_next);
        const __m256i high_step = _mm256_xor_si256(high_last, high_next);
        FOR_TWO(j)
        {
            at[j] = _mm256_subs_epi8(at[j], step);
            low[j] = _mm256_xor_si256(low[j], _mm256_shuffle_epi8(low_step, at[j]));
            high[j] = _mm256_xor_si256(high[j], _mm256_shuffle_epi8(high_step, at[j]));
        }
        low_last = low_next;
        high_last = high_next;
    }
    FOR_TWO(j)
    {
        uint8_t *to = (uint8_t *)(ratio + 32 * j);
        b_store(to, _mm256_unpacklo_epi8(low[j], high[j]));
        b_store(to + 32, _mm256_unpackhi_epi8(low[j], high[j]));
    }
}

/* Found together with the codes: spans are the same. */
#define LEVEL_HAS_LUMA_ROWS
typedef struct luma_ratios {
    int16_t word[PUPIL_LUMA_QUADS];
} luma_ratios;

INLINE void ratios_at(const luma_ratios *r, const pupil_luma_quads *in, size_t i, v_words ratio[2])
{
    (void)in;
    ratio[0] = w_load((const uint8_t *)(r->word + i));
    ratio[1] = w_load((const uint8_t *)(r->word + i + QUADS));
}

/* The new codes of both rows, 2 n bytes each (lower NULL: of one row), and the quads' ratios. n is a multiple of 32; if
 * it is none of 64, the last 64 overlap those before. All spans are found first, so the lengths of the loops that
 * follow are known early: fewer branches are mispredicted, and those cost less. */
static void luma_rows(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n, uint8_t *upper,
                      uint8_t *lower, luma_ratios *r)
{
    const luma_entries e = {t->luma, t->luma_steps};
    const uint8_t *in_lower = in->lower ? in->lower : in->upper;
    luma_span spans[PUPIL_LUMA_QUADS / 64];
    if (n < 64) {
        bytes_by_table(t->luma, in->upper, 0, 2 * n, upper);
        if (lower)
            bytes_by_table(t->luma, in->lower, 0, 2 * n, lower);
        find_means(in->upper, in_lower, n, r->word);
        look_up_ratios(t, n, r->word);
        return;
    }
    for (uint32_t i = 0; i < n; i += 64) {
        const size_t at = 2 * (size_t)(n - i < 64 ? n - 64 : i);
        spans[i / 64] = span_of(in->upper + at, in_lower + at);
    }
    for (uint32_t i = 0; i < n; i += 64) {
        const size_t quad = n - i < 64 ? n - 64 : i, at = 2 * quad;
        const luma_span span = spans[i / 64], half = {span.first / 2, span.last / 2};
        look_up_128(&e, span, in->upper + at, upper + at);
        if (lower)
            look_up_128(&e, span, in->lower + at, lower + at);
        look_up_64_ratios(t, half, in->upper + at, in_lower + at, r->word + quad);
    }
}

/* Scaled Cb and Cr as codes, interleaved. */
INLINE v_bytes w_to_pairs(v_words u, v_words v)
{
    const __m256i sixteenth = _mm256_set1_epi16(0x8000 / 16);
    const __m256i turns =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15));
    const __m256i packed = _mm256_packs_epi16(w_times(u, sixteenth), w_times(v, sixteenth));
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
