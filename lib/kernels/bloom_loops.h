/* lib/kernels/bloom_loops.h: what a bloom does with rows (pupil/bloom.h). Plain loops, compiled for each level; eight
 * lanes, which the compiler splits where its registers are shorter. */
#ifndef PUPIL_KERNELS_BLOOM_LOOPS_H
#define PUPIL_KERNELS_BLOOM_LOOPS_H

#include "kernels.h"

enum { BLOOM_LANES = 8 };
typedef float bloom_lanes __attribute__((vector_size(4 * BLOOM_LANES)));

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define BLOOM_MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#endif
#endif
#ifndef BLOOM_MIX /* gcc before 12 */
typedef int32_t bloom_places __attribute__((vector_size(4 * BLOOM_LANES)));
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

static inline void bloom_part(const float *from, bloom_lanes *even, bloom_lanes *odd)
{
    bloom_lanes a, b;
    __builtin_memcpy(&a, from, sizeof a);
    __builtin_memcpy(&b, from + BLOOM_LANES, sizeof b);
    *even = BLOOM_MIX(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
    *odd = BLOOM_MIX(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
}

static void bloom_halve(const float *from, uint32_t n, float *to)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        bloom_lanes e0, o0, e1, o1, e2, o2;
        bloom_part(from + 2 * (size_t)i - 2, &e0, &o0);
        bloom_part(from + 2 * (size_t)i, &e1, &o1);
        bloom_part(from + 2 * (size_t)i + 2, &e2, &o2);
        const bloom_lanes sum = ((e1 + o1) * 0xap-5f + (o0 + e2) * 0x5p-5f) + (e0 + o2) * 0x1p-5f;
        __builtin_memcpy(to + i, &sum, sizeof sum);
    }
}

static void bloom_widen(const float *from, uint32_t n, float *to)
{
    for (uint32_t i = 0; i < n; i += BLOOM_LANES) {
        bloom_lanes before, here, after, low, high;
        __builtin_memcpy(&before, from + i - 1, sizeof before);
        __builtin_memcpy(&here, from + i, sizeof here);
        __builtin_memcpy(&after, from + i + 1, sizeof after);
        const bloom_lanes middle = here * 0xap-4f;
        const bloom_lanes even = (middle + before * 0x5p-4f) + after * 0x1p-4f;
        const bloom_lanes odd = (middle + after * 0x5p-4f) + before * 0x1p-4f;
        __builtin_memcpy(&low, to + 2 * (size_t)i, sizeof low);
        __builtin_memcpy(&high, to + 2 * (size_t)i + BLOOM_LANES, sizeof high);
        low += BLOOM_MIX(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
        high += BLOOM_MIX(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
        __builtin_memcpy(to + 2 * (size_t)i, &low, sizeof low);
        __builtin_memcpy(to + 2 * (size_t)i + BLOOM_LANES, &high, sizeof high);
    }
}

#define BLOOM_PIECES                                                                                                   \
    .bloom_pairs = bloom_pairs, .bloom_columns = bloom_columns, .bloom_rows = bloom_rows,                              \
    .bloom_bright = bloom_bright, .bloom_down = bloom_down, .bloom_up = bloom_up, .bloom_halve = bloom_halve,          \
    .bloom_widen = bloom_widen

#endif
