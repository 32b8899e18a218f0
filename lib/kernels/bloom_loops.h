/* lib/kernels/bloom_loops.h: what a bloom does with rows (pupil/bloom.h). Plain loops, compiled for each level; eight
 * lanes, which the compiler splits where its registers are shorter. */
#ifndef PUPIL_KERNELS_BLOOM_LOOPS_H
#define PUPIL_KERNELS_BLOOM_LOOPS_H

#include "kernels.h"

enum { BLOOM_LANES = 8 };
typedef float bloom_lanes __attribute__((vector_size(4 * BLOOM_LANES)));
/* Anywhere in a row. */
typedef float bloom_loose __attribute__((vector_size(4 * BLOOM_LANES), aligned(4), may_alias));
typedef int32_t bloom_places __attribute__((vector_size(4 * BLOOM_LANES)));

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define BLOOM_MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#endif
#endif
#ifndef BLOOM_MIX /* gcc before 12 */
#define BLOOM_MIX(a, b, ...) __builtin_shuffle(a, b, (bloom_places){__VA_ARGS__})
#endif

/* A function of its own: what is inlined forgets that its pointers do not meet. */
static __attribute__((noinline)) void bloom_above(uint32_t n, float threshold, float *restrict r, float *restrict g,
                                                  float *restrict b)
{
    for (uint32_t i = 0; i < n; i++) {
        const float rg = r[i] > g[i] ? r[i] : g[i], most = rg > b[i] ? rg : b[i];
        const float share = most > threshold ? (most - threshold) / most : 0.0f;
        r[i] *= share;
        g[i] *= share;
        b[i] *= share;
    }
}

/* Row k from pixel i on. */
#define BLOOM_AT(k, i) (*(const bloom_loose *)(const void *)(row[k] + (i)))

static inline __attribute__((always_inline)) void bloom_eight(const float *const row[8], uint32_t i, bloom_lanes *sum)
{
    *sum = ((BLOOM_AT(3, i) + BLOOM_AT(4, i)) * 0x89p-9f + (BLOOM_AT(2, i) + BLOOM_AT(5, i)) * 0x54p-9f) +
           ((BLOOM_AT(1, i) + BLOOM_AT(6, i)) * 0x1ep-9f + (BLOOM_AT(0, i) + BLOOM_AT(7, i)) * 0x5p-9f);
}

/* Every other one apart: what halves the row then takes them as they are. */
static void bloom_down(const float *const rows[8], uint32_t n, float *even, float *odd)
{
    /* which nothing writes to */
    const float *const row[8] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]};
    for (uint32_t i = 0; i < n; i += 2 * BLOOM_LANES) {
        bloom_lanes a, b;
        bloom_eight(row, i, &a);
        bloom_eight(row, i + BLOOM_LANES, &b);
        const bloom_lanes evens = BLOOM_MIX(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
        const bloom_lanes odds = BLOOM_MIX(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
        __builtin_memcpy(even + i / 2, &evens, sizeof evens);
        __builtin_memcpy(odd + i / 2, &odds, sizeof odds);
    }
}

#define BLOOM_FROM(p) (*(const bloom_loose *)(const void *)(p))

static void bloom_halve(const float *even, const float *odd, uint32_t n, float *to)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        const float *e = even + i, *o = odd + i;
        const bloom_lanes inner =
            (BLOOM_FROM(e) + BLOOM_FROM(o)) * 0x89p-9f + (BLOOM_FROM(o - 1) + BLOOM_FROM(e + 1)) * 0x54p-9f;
        const bloom_lanes outer =
            (BLOOM_FROM(e - 1) + BLOOM_FROM(o + 1)) * 0x1ep-9f + (BLOOM_FROM(o - 2) + BLOOM_FROM(e + 2)) * 0x5p-9f;
        const bloom_lanes sum = inner + outer;
        __builtin_memcpy(to + i, &sum, sizeof sum);
    }
}

/* Whether a channel of pixels of four floats is above a threshold. */
static int bloom_lit_rgba32f(const void *source, ptrdiff_t next_row, uint32_t n, float threshold)
{
    static const bloom_places colours = {-1, -1, -1, 0, -1, -1, -1, 0};
    const float *v = source;
    bloom_places any = {0}, more = {0};
    uint32_t i = 0;
    for (; i + 8 <= n; i += 8, v += 4 * BLOOM_LANES) {
        const bloom_loose *of = (const bloom_loose *)(const void *)v;
        __builtin_prefetch((const uint8_t *)v + next_row);
        __builtin_prefetch((const uint8_t *)v + next_row + 64);
        any |= (of[0] > threshold) | (of[1] > threshold);
        more |= (of[2] > threshold) | (of[3] > threshold);
    }
    any |= more;
    for (; i + 2 <= n; i += 2, v += BLOOM_LANES)
        any |= *(const bloom_loose *)(const void *)v > threshold;
    any &= colours;
    int32_t lit = i < n && (v[0] > threshold || v[1] > threshold || v[2] > threshold);
    for (int k = 0; k < BLOOM_LANES; k++)
        lit |= any[k];
    return lit != 0;
}

static uint32_t bloom_units(const float *r, const float *g, const float *b, uint32_t n)
{
    uint32_t units = 0;
    for (uint32_t i = 0; i < n; i += 2 * BLOOM_LANES) {
        bloom_places low[3], high[3];
        const float *const from[3] = {r + i, g + i, b + i};
        for (int k = 0; k < 3; k++) {
            __builtin_memcpy(&low[k], from[k], sizeof low[k]);
            __builtin_memcpy(&high[k], from[k] + BLOOM_LANES, sizeof high[k]);
        }
        const bloom_places any = (low[0] | low[1] | low[2]) | (high[0] | high[1] | high[2]);
        uint32_t lit = 0;
        for (int k = 0; k < BLOOM_LANES; k++)
            lit |= (uint32_t)any[k];
        units |= (uint32_t)(lit != 0) << i / (2 * BLOOM_LANES);
    }
    return units;
}

static void bloom_widen(const float *from, uint32_t n, float *to)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        const float *f = from + i;
        const bloom_lanes here = BLOOM_FROM(f) * 0x89p-8f, before = BLOOM_FROM(f - 1), after = BLOOM_FROM(f + 1);
        const bloom_lanes even = (here + before * 0x54p-8f) + (after * 0x1ep-8f + BLOOM_FROM(f - 2) * 0x5p-8f);
        const bloom_lanes odd = (here + after * 0x54p-8f) + (before * 0x1ep-8f + BLOOM_FROM(f + 2) * 0x5p-8f);
        bloom_lanes low, high;
        __builtin_memcpy(&low, to + 2 * (size_t)i, sizeof low);
        __builtin_memcpy(&high, to + 2 * (size_t)i + BLOOM_LANES, sizeof high);
        low += BLOOM_MIX(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
        high += BLOOM_MIX(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
        __builtin_memcpy(to + 2 * (size_t)i, &low, sizeof low);
        __builtin_memcpy(to + 2 * (size_t)i + BLOOM_LANES, &high, sizeof high);
    }
}

#define BLOOM_PIECES                                                                                                   \
    .bloom_columns = bloom_columns, .bloom_rows = bloom_rows, .bloom_bright = bloom_bright, .bloom_down = bloom_down,  \
    .bloom_up = bloom_up, .bloom_halve = bloom_halve, .bloom_widen = bloom_widen,                                      \
    .bloom_lit_rgba32f = bloom_lit_rgba32f, .bloom_units = bloom_units

#endif
