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

/* Whether any lane is set. */
static inline __attribute__((always_inline)) uint32_t bloom_some(const bloom_places *set)
{
    int32_t any = 0;
    for (int k = 0; k < BLOOM_LANES; k++)
        any |= (*set)[k];
    return any != 0;
}

static inline __attribute__((always_inline)) void bloom_eight_pixels(const float *v, float threshold, bloom_places *any)
{
    const bloom_loose *of = (const bloom_loose *)(const void *)v;
    *any |= ((of[0] > threshold) | (of[1] > threshold)) | ((of[2] > threshold) | (of[3] > threshold));
}

/* Of pixels of four floats. Almost all are dark: 32 of them at a time, and then eight. */
static uint32_t bloom_lamps_rgba32f(const void *source, uint32_t n, float threshold)
{
    enum { MANY = 32, EIGHT = 8 };
    static const bloom_places colours = {-1, -1, -1, 0, -1, -1, -1, 0};
    const float *v = source;
    uint32_t lamps = 0, i = 0;
    for (; i + MANY <= n; i += MANY) {
        bloom_places any = {0};
        for (uint32_t k = i; k < i + MANY; k += EIGHT)
            bloom_eight_pixels(v + 4 * (size_t)k, threshold, &any);
        any &= colours;
        for (uint32_t k = i; k < i + MANY && bloom_some(&any); k += EIGHT) {
            bloom_places eight = {0};
            bloom_eight_pixels(v + 4 * (size_t)k, threshold, &eight);
            eight &= colours;
            lamps |= bloom_some(&eight) << k / EIGHT;
        }
    }
    for (v += 4 * (size_t)i; i < n; i++, v += 4)
        lamps |= (uint32_t)(v[0] > threshold || v[1] > threshold || v[2] > threshold) << i / EIGHT;
    return lamps;
}

static uint32_t bloom_lamps(const pupil_planes *planes, uint32_t n, float threshold)
{
    const float *r = planes->r, *g = planes->g, *b = planes->b;
    uint32_t lamps = 0, i = 0;
    for (; i + BLOOM_LANES <= n; i += BLOOM_LANES) {
        bloom_lanes light[3];
        __builtin_memcpy(&light[0], r + i, sizeof light[0]);
        __builtin_memcpy(&light[1], g + i, sizeof light[1]);
        __builtin_memcpy(&light[2], b + i, sizeof light[2]);
        const bloom_places any = (light[0] > threshold) | (light[1] > threshold) | (light[2] > threshold);
        lamps |= bloom_some(&any) << i / BLOOM_LANES;
    }
    for (; i < n; i++)
        lamps |= (uint32_t)(r[i] > threshold || g[i] > threshold || b[i] > threshold) << i / BLOOM_LANES;
    return lamps;
}

static void bloom_widen(const float *from, uint32_t n, float *to, int add)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        const float *f = from + i;
        const bloom_lanes here = BLOOM_FROM(f) * 0x89p-8f, before = BLOOM_FROM(f - 1), after = BLOOM_FROM(f + 1);
        const bloom_lanes even = (here + before * 0x54p-8f) + (after * 0x1ep-8f + BLOOM_FROM(f - 2) * 0x5p-8f);
        const bloom_lanes odd = (here + after * 0x54p-8f) + (before * 0x1ep-8f + BLOOM_FROM(f + 2) * 0x5p-8f);
        bloom_lanes low = {0}, high = {0};
        if (add) {
            __builtin_memcpy(&low, to + 2 * (size_t)i, sizeof low);
            __builtin_memcpy(&high, to + 2 * (size_t)i + BLOOM_LANES, sizeof high);
        }
        low += BLOOM_MIX(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
        high += BLOOM_MIX(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
        __builtin_memcpy(to + 2 * (size_t)i, &low, sizeof low);
        __builtin_memcpy(to + 2 * (size_t)i + BLOOM_LANES, &high, sizeof high);
    }
}

#define BLOOM_PIECES                                                                                                   \
    .bloom_columns = bloom_columns, .bloom_rows = bloom_rows, .bloom_bright = bloom_bright, .bloom_down = bloom_down,  \
    .bloom_up = bloom_up, .bloom_halve = bloom_halve, .bloom_widen = bloom_widen,                                      \
    .bloom_lamps_rgba32f = bloom_lamps_rgba32f, .bloom_lamps = bloom_lamps

#endif
