/* lib/kernels/bloom_filters.h: bloom's filters in two steps each: down the rows to lines in the L1 cache, then along
 * these lines. The file that includes it has defined bloom_columns, bloom_rows and bloom_up before. */
#ifndef PUPIL_KERNELS_BLOOM_FILTERS_H
#define PUPIL_KERNELS_BLOOM_FILTERS_H

#include "bloom_loops.h"

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define BLOOM_MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#endif
#endif
#ifndef BLOOM_MIX /* gcc before 12 */
#define BLOOM_MIX(a, b, ...) __builtin_shuffle(a, b, (bloom_places){__VA_ARGS__})
#endif

/* Row k from pixel i on. */
#define BLOOM_AT(k, i) (*(const bloom_loose *)(const void *)(row[k] + (i)))

static inline __attribute__((always_inline)) void bloom_eight(const float *const row[8], uint32_t i, bloom_lanes *sum)
{
    *sum = ((BLOOM_AT(3, i) + BLOOM_AT(4, i)) * 0x89p-9f + (BLOOM_AT(2, i) + BLOOM_AT(5, i)) * 0x54p-9f) +
           ((BLOOM_AT(1, i) + BLOOM_AT(6, i)) * 0x1ep-9f + (BLOOM_AT(0, i) + BLOOM_AT(7, i)) * 0x5p-9f);
}

/* Even and odd sums are stored apart, as halve_line takes them. */
static void bloom_down(const float *const rows[8], size_t ahead, uint32_t n, float *even, float *odd)
{
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[8] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]};
    for (uint32_t i = 0; i < n; i += 2 * BLOOM_LANES) {
        bloom_lanes a, b;
        if (ahead) {
            __builtin_prefetch(row[6] + ahead + i);
            __builtin_prefetch(row[7] + ahead + i);
        }
        bloom_eight(row, i, &a);
        bloom_eight(row, i + BLOOM_LANES, &b);
        const bloom_lanes evens = BLOOM_MIX(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
        const bloom_lanes odds = BLOOM_MIX(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
        __builtin_memcpy(even + i / 2, &evens, sizeof evens);
        __builtin_memcpy(odd + i / 2, &odds, sizeof odds);
    }
}

#define BLOOM_FROM(p) (*(const bloom_loose *)(const void *)(p))

static void halve_line(const float *even, const float *odd, uint32_t n, float *to)
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

static void widen_line(const float *from, uint32_t n, float *to, int add)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        const float *f = from + i;
        const bloom_lanes here = BLOOM_FROM(f) * 0x89p-8f, before = BLOOM_FROM(f - 1), after = BLOOM_FROM(f + 1);
        const bloom_lanes even = (here + before * 0x54p-8f) + (after * 0x1ep-8f + BLOOM_FROM(f - 2) * 0x5p-8f);
        const bloom_lanes odd = (here + after * 0x54p-8f) + (before * 0x1ep-8f + BLOOM_FROM(f + 2) * 0x5p-8f);
        float *at = to + 2 * (size_t)i;
        bloom_lanes low = BLOOM_MIX(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
        bloom_lanes high = BLOOM_MIX(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
        if (add) {
            low += BLOOM_FROM(at);
            high += BLOOM_FROM(at + BLOOM_LANES);
        }
        __builtin_memcpy(at, &low, sizeof low);
        __builtin_memcpy(at + BLOOM_LANES, &high, sizeof high);
    }
}

enum { BLOOM_PART_OF_LINE = PUPIL_BLOOM_LINE - 2 * PUPIL_BLOOM_SIDE };

/* `count` rows, from pixel `first` on. */
static inline void bloom_rows_from(const float *const *row, uint32_t count, size_t first, const float **to)
{
    for (uint32_t k = 0; k < count; k++)
        to[k] = row[k] + first;
}

static inline uint32_t bloom_part(uint32_t left)
{
    return left < BLOOM_PART_OF_LINE ? left : BLOOM_PART_OF_LINE;
}

static void bloom_scatter(const float *const *row, size_t ahead, const pupil_bloom_taps *taps, uint32_t n,
                          pupil_bloom_room room, const float *with, float *to)
{
    for (uint32_t first = 0; first < n; first += BLOOM_PART_OF_LINE) {
        const uint32_t part = bloom_part(n - first);
        const float *from[PUPIL_BLOOM_ROWS];
        bloom_rows_from(row, PUPIL_BLOOM_ROWS, first, from);
        bloom_columns(from, ahead, taps, part + 2 * PUPIL_BLOOM_SIDE, room);
        bloom_rows((const float(*)[PUPIL_BLOOM_LINE])room, part, with ? with + first : 0, to + first);
    }
}

static void bloom_halve(const float *const *row, size_t ahead, uint32_t n, pupil_bloom_room room, float *to)
{
    enum { BEFORE = PUPIL_BLOOM_SIDE / 2 };
    for (uint32_t first = 0; first < n; first += BLOOM_PART_OF_LINE) {
        const uint32_t part = (bloom_part(n - first) + 15) / 16 * 16;
        const float *from[8];
        bloom_rows_from(row, 8, 2 * (size_t)first, from);
        bloom_down(from, ahead, 2 * part + 2 * PUPIL_BLOOM_SIDE, room[0], room[2]);
        halve_line(room[0] + BEFORE, room[2] + BEFORE, part, to + first);
    }
}

static void bloom_widen(const float *const *row, const float tap[4], uint32_t n, pupil_bloom_room room, float *to,
                        int add)
{
    for (uint32_t first = 0; first < n; first += BLOOM_PART_OF_LINE) {
        const uint32_t part = bloom_part(n - first);
        const float *from[4];
        bloom_rows_from(row, 4, first, from);
        bloom_up(from, tap, part + 2 * PUPIL_BLOOM_SIDE, room[0]);
        widen_line(room[0] + PUPIL_BLOOM_SIDE, part, to + 2 * (size_t)first, add);
    }
}

#endif
