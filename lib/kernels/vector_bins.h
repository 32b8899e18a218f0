/* lib/kernels/vector_bins.h: the histogram, as scalar.c's, by vectors and the functions of avx2_luma.h, avx512_luma.h,
 * neon_luma.h or wasm128_luma.h: w_ is for 16-bit words, b_ for bytes.
 *
 * Neighbouring pixels are in few bins, and each addition to a bin waits for the one before if that is to the same bin.
 * So all pixels are compared, as bytes, with each bin from the lowest to the highest, and a bin is added to once. If
 * there are many bins, pixels are added one by one: they seldom wait. */
#ifndef PUPIL_KERNELS_VECTOR_BINS_H
#define PUPIL_KERNELS_VECTOR_BINS_H

#include "vector.h"

enum { IN_WORDS = 2 * WIDTH, IN_BYTES = 4 * WIDTH, NO_BIN = 0x7fff };

/* The upper bits of each pixel's luminance or brightest channel; a histogram's first one is bin 0. */
typedef struct word_bins {
    uint16_t word[PUPIL_BLOCK];
    v_words least, most;
} word_bins;

/* Of the pixels of a block. */
typedef struct block_bins {
    word_bins luminance, peak;
    floats brightest;
} block_bins;

INLINE void bins_of(const pupil_channels *light, const pupil_channels *picture, uint32_t i, const meter_constants *c,
                    ints *bin, ints *peak_bin, floats *brightest)
{
    const floats l = luminance(v_load(light->r + i), v_load(light->g + i), v_load(light->b + i), c);
    const floats of_3 = max_of_3(v_load(picture->r + i), v_load(picture->g + i), v_load(picture->b + i));
    const floats largest = v_min(v_max(v_select(v_is_number(l), of_3, c->floor), c->floor), c->ceiling);
    *bin = v_right(v_bits(v_min(v_max(l, c->floor), c->ceiling)), BIN_BITS);
    *peak_bin = v_right(v_bits(largest), PEAK_BIN_BITS);
    *brightest = v_max(largest, *brightest);
}

INLINE void put_words(word_bins *to, uint32_t at, ints first, ints second)
{
    const v_words word = w_of_ints(first, second);
    w_store(to->word + at, word);
    to->least = w_min(to->least, word);
    to->most = w_max(to->most, word);
}

/* Pixels i to i + IN_WORDS, which become the bins from `at` on. */
INLINE void find_bins(const pupil_channels *light, const pupil_channels *picture, uint32_t i, const meter_constants *c,
                      uint32_t at, block_bins *to)
{
    ints bin[2], peak_bin[2];
    for (uint32_t k = 0; k < 2; k++)
        bins_of(light, picture, i + k * WIDTH, c, &bin[k], &peak_bin[k], &to->brightest);
    put_words(&to->luminance, at, bin[0], bin[1]);
    put_words(&to->peak, at, peak_bin[0], peak_bin[1]);
}

/* The last pixels of n, from i on, which are fewer: the first of them is repeated, and its copies are not counted. */
static __attribute__((noinline)) void find_last_bins(const pupil_channels *light, const pupil_channels *picture,
                                                     uint32_t i, uint32_t n, const meter_constants *c, block_bins *to)
{
    const float *const of[6] = {light->r, light->g, light->b, picture->r, picture->g, picture->b};
    float rest[6][IN_WORDS];
    for (int k = 0; k < 6; k++)
        for (uint32_t j = 0; j < IN_WORDS; j++)
            rest[k][j] = of[k][j < n - i ? i + j : i];
    const pupil_channels light_of_rest = {rest[0], rest[1], rest[2]}, picture_of_rest = {rest[3], rest[4], rest[5]};
    find_bins(&light_of_rest, &picture_of_rest, 0, c, i, to);
}

/* Pixels that are compared with bins in a turn of the loop. */
enum { IN_PIECE = 64 };
#if defined(__clang__)
#define FOR_EACH_VECTOR(k) for (size_t k = 0; k < IN_PIECE; k += IN_BYTES)
#else
#define FOR_EACH_VECTOR(k) _Pragma("GCC unroll 4") for (size_t k = 0; k < IN_PIECE; k += IN_BYTES)
#endif

/* Bins from `least` on, as bytes; returns how many, in whole pieces: the last ones are of no pixel, and no bin. */
INLINE uint32_t find_codes(word_bins *of, uint32_t n, uint32_t least, uint8_t code[PUPIL_BLOCK])
{
    const v_words from = w_all((int)least);
    for (; n % IN_PIECE; n++)
        of->word[n] = NO_BIN;
    for (uint32_t i = 0; i < n; i += IN_BYTES) {
        const uint8_t *at = (const uint8_t *)(of->word + i);
        b_store(code + i, w_to_bytes(w_sub(w_load(at), from), w_sub(w_load(at + IN_BYTES), from)));
    }
    return n;
}

#ifndef LEVEL_HAS_ADD_MATCHED
INLINE void b_add_matched(const matches m[4], uint32_t weight, uint64_t bin[4])
{
    FOR_FOUR(t) bin[t] += (uint64_t)weight * b_matched(m[t]);
}
#endif

/* Each bin of a span, which is a multiple of four, is compared with n codes. */
INLINE void count_by_bins(const uint8_t *code, uint32_t n, uint32_t span, uint32_t weight, uint64_t *bin)
{
    v_bytes wanted[4];
    FOR_FOUR(t) wanted[t] = b_all((uint32_t)t);
    for (uint64_t *end = bin + span; bin < end; bin += 4) { /* four at once: each vector of codes is loaded once */
        matches found[4];
        FOR_FOUR(t) found[t] = b_no_matches();
        for (const uint8_t *at = code; at < code + n; at += IN_PIECE)
            FOR_EACH_VECTOR(k)
            {
                const v_bytes some = b_load(at + k);
                FOR_FOUR(t) found[t] = b_match(found[t], some, wanted[t]);
            }
        b_add_matched(found, weight, bin);
        FOR_FOUR(t) wanted[t] = b_more(wanted[t], b_all(4));
    }
}

/* One by one, in turns from four quarters: pixels that are far apart are less often in the same bin. */
INLINE void count_by_pixels(const uint16_t *word, uint32_t n, uint32_t first, uint32_t weight, uint64_t *bin)
{
    const uint32_t quarter = n / 4;
    uint32_t i;
    for (i = 0; i < quarter; i++)
        FOR_FOUR(k) bin[word[i + (uint32_t)k * quarter] - first] += weight;
    for (i = 4 * quarter; i < n; i++)
        bin[word[i] - first] += weight;
}

enum { MOST_SPAN = 48 };

INLINE uint32_t most_of(v_words a)
{
    return 0xffff - w_least(w_xor(a, w_all(-1)));
}

/* `first` is in bin 0 of `bins`. */
INLINE void count_bins(word_bins *of, uint32_t n, uint32_t first, uint32_t bins, uint32_t weight, uint64_t *bin)
{
    const uint32_t lowest = w_least(of->least), span = (most_of(of->most) - lowest) / 4 * 4 + 4;
    if (span <= MOST_SPAN) {
        const uint32_t last = first + bins - span, least = lowest < last ? lowest : last;
        uint8_t code[PUPIL_BLOCK];
        n = find_codes(of, n, least, code);
        count_by_bins(code, n, span, weight, bin + (least - first));
    } else {
        count_by_pixels(of->word, n, first, weight, bin);
    }
}

static void histogram(const pupil_row_job *job, const pupil_channels *light, const pupil_channels *picture, uint32_t n,
                      uint32_t weight, pupil_stats *stats)
{
    const meter_constants c = meter_constants_of(job);
    const floats before = v_all(stats->peak);
    block_bins bins;
    uint32_t i = 0;
    bins.luminance.least = bins.peak.least = w_all(NO_BIN);
    bins.luminance.most = bins.peak.most = w_all(0);
    bins.brightest = before;
    for (; i + IN_WORDS <= n; i += IN_WORDS)
        find_bins(light, picture, i, &c, i, &bins);
    if (i < n)
        find_last_bins(light, picture, i, n, &c, &bins);
    count_bins(&bins.luminance, n, FIRST_BIN, PUPIL_HISTOGRAM_BINS, weight, stats->bin);
    count_bins(&bins.peak, n, FIRST_PEAK_BIN, PUPIL_PEAK_BINS, weight, stats->peak_bin);
    if (!v_every(v_at_least(before, bins.brightest))) {
        float lane[WIDTH];
        v_store(lane, bins.brightest);
        for (int j = 0; j < WIDTH; j++)
            stats->peak = lane[j] > stats->peak ? lane[j] : stats->peak;
    }
}

#endif
