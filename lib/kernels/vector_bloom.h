/* lib/kernels/vector_bloom.h: bloom's light and filters in vectors, as scalar.c's. */
#ifndef PUPIL_KERNELS_VECTOR_BLOOM_H
#define PUPIL_KERNELS_VECTOR_BLOOM_H

#include "bloom_loops.h"
#include "vector.h"

/* gcc needs this to keep taps in registers. */
#if defined(__clang__)
#define FOR_EACH_OF(vectors, k) for (int k = 0; k < (vectors); k++)
#else
#define FOR_EACH_OF(vectors, k) _Pragma("GCC unroll 16") for (int k = 0; k < (vectors); k++)
#endif

INLINE floats both_of(const float *a, const float *b)
{
    return v_add(v_load(a), v_load(b));
}

INLINE floats bound_of(const float *v)
{
    return v_min(v_where(v_greater(v_load(v), v_all(0.0f)), v_load(v)), v_all(PUPIL_CEILING));
}

INLINE float bound_one(float v)
{
    v = v > 0.0f ? v : 0.0f;
    return v < PUPIL_CEILING ? v : PUPIL_CEILING;
}

/* Whole vectors up to the line's end, and then one by one. */
INLINE void bright_channel(const float *from, uint32_t n, float *to)
{
    uint32_t i = 0;
    for (; i + WIDTH <= n; i += WIDTH)
        v_store(to + i, bound_of(from + i));
    for (; i < n; i++)
        to[i] = bound_one(from[i]);
}

/* The same from pixels of four floats, without a threshold. Bits are compared, because -0 becomes 0. */
static int bloom_light_rgba32f(const void *source, ptrdiff_t next_row, uint32_t n, float *const to[3])
{
    const uint8_t *at = source;
    const floats zero = v_all(0.0f), one = v_all(1.0f), ceiling = v_all(PUPIL_CEILING);
    mask opaque = v_at_least(one, one);
    ints differ = v_all_ints(0);
    uint32_t i = 0;
    for (; i + WIDTH <= n; i += WIDTH, at += 16 * WIDTH) {
        floats v[3], alpha;
        for (int k = 0; k < 16 * WIDTH; k += 64)
            __builtin_prefetch(at + next_row + k);
        rgba32f.vector(at, &v[0], &v[1], &v[2], &alpha);
        opaque = v_both(opaque, v_at_least(alpha, one));
        for (int k = 0; k < 3; k++) {
            const floats bounded = v_min(v_where(v_greater(v[k], zero), v[k]), ceiling);
            differ = v_or(differ, v_minus(v_bits(bounded), v_bits(v[k])));
            v_store(to[k] + i, bounded);
        }
    }
    int whole = v_every(v_both(opaque, v_equal_ints(differ, v_all_ints(0))));
    for (const float *v = (const float *)(const void *)at; i < n; i++, v += 4) {
        for (int k = 0; k < 3; k++) {
            to[k][i] = bound_one(v[k]);
            whole &= pupil_bits_of_float(to[k][i]) == pupil_bits_of_float(v[k]);
        }
        whole &= v[3] >= 1.0f;
    }
    return whole;
}

static void bloom_bright(const pupil_planes *planes, uint32_t n, float threshold, float *const to[3])
{
    bright_channel(planes->r, n, to[0]);
    bright_channel(planes->g, n, to[1]);
    bright_channel(planes->b, n, to[2]);
    if (threshold > 0.0f)
        bloom_above(n, threshold, to[0], to[1], to[2]);
}

/* The columns' sums of seven rows, at pixel i: of the kernel's middle column, and of those one, two and three pixels
 * away. */
INLINE void columns_at(const float *const row[7], const floats t[PUPIL_BLOOM_TAPS], size_t i, floats sum[4])
{
    const floats m = v_load(row[3] + i), a = both_of(row[2] + i, row[4] + i);
    const floats b = both_of(row[1] + i, row[5] + i), c = both_of(row[0] + i, row[6] + i);
    sum[0] = v_add(v_add(v_mul(t[0], m), v_mul(t[1], a)), v_add(v_mul(t[3], b), v_mul(t[6], c)));
    sum[1] = v_add(v_add(v_mul(t[1], m), v_mul(t[2], a)), v_add(v_mul(t[4], b), v_mul(t[7], c)));
    sum[2] = v_add(v_add(v_mul(t[3], m), v_mul(t[4], a)), v_add(v_mul(t[5], b), v_mul(t[8], c)));
    sum[3] = v_add(v_add(v_mul(t[6], m), v_mul(t[7], a)), v_mul(t[8], b));
}

INLINE floats up_at(const float *const row[4], const floats t[4], size_t i)
{
    return v_add(v_add(v_mul(t[0], v_load(row[0] + i)), v_mul(t[1], v_load(row[1] + i))),
                 v_add(v_mul(t[2], v_load(row[2] + i)), v_mul(t[3], v_load(row[3] + i))));
}

#if WIDTH == 16
#include "avx512_bloom.h"
#else

static void bloom_up(const float *const rows[4], const float tap[4], uint32_t n, float *to)
{
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[4] = {rows[0], rows[1], rows[2], rows[3]};
    const floats t[4] = {v_all(tap[0]), v_all(tap[1]), v_all(tap[2]), v_all(tap[3])};
    for (size_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
        v_store(to + i, up_at(row, t, i));
}

static void bloom_columns(const float *const *rows, size_t ahead, const pupil_bloom_taps *taps, uint32_t n,
                          pupil_bloom_room to)
{
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[7] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6]};
    floats t[PUPIL_BLOOM_TAPS], sum[4];
    FOR_EACH_OF(PUPIL_BLOOM_TAPS, k) t[k] = v_all(taps->tap[k]);
    for (size_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH) {
        if (ahead)
            __builtin_prefetch(row[6] + ahead + i);
        columns_at(row, t, i, sum);
        for (int k = 0; k < 4; k++)
            v_store(to[k] + i, sum[k]);
    }
}

INLINE floats row_at(const float *at)
{
    const float *const one = at + PUPIL_BLOOM_LINE, *const two = one + PUPIL_BLOOM_LINE;
    const float *const three = two + PUPIL_BLOOM_LINE;
    return v_add(v_add(v_load(at), both_of(one - 1, one + 1)),
                 v_add(both_of(two - 2, two + 2), both_of(three - 3, three + 3)));
}

static void bloom_rows(const pupil_bloom_room sums, uint32_t n, const float *with, float *to)
{
    const float *at = sums[0] + PUPIL_BLOOM_SIDE;
    if (with)
        for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
            v_store(to + i, v_add(v_load(with + i), row_at(at + i)));
    else
        for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
            v_store(to + i, row_at(at + i));
}

#include "bloom_filters.h"

#endif

#endif
