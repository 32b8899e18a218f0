/* lib/kernels/vector_bloom.h: filters of rows in vectors, as scalar.c's bloom_pairs(). */
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

/* Whole vectors, where they are not beyond the line's end, and then one by one. */
INLINE void bright_channel(const float *from, uint32_t n, float *to)
{
    uint32_t i = 0;
    for (; i + WIDTH <= n; i += WIDTH)
        v_store(to + i, bound_of(from + i));
    for (; i < n; i++)
        to[i] = bound_one(from[i]);
}

/* The same from pixels of four floats, with no threshold. */
static void bloom_light_rgba32f(const void *source, ptrdiff_t next_row, uint32_t n, float *const to[3])
{
    const uint8_t *at = source;
    const floats zero = v_all(0.0f), ceiling = v_all(PUPIL_CEILING);
    uint32_t i = 0;
    for (; i + WIDTH <= n; i += WIDTH, at += 16 * WIDTH) {
        floats v[3], alpha;
        for (int k = 0; k < 16 * WIDTH; k += 64)
            __builtin_prefetch(at + next_row + k);
        rgba32f.vector(at, &v[0], &v[1], &v[2], &alpha);
        for (int k = 0; k < 3; k++)
            v_store(to[k] + i, v_min(v_where(v_greater(v[k], zero), v[k]), ceiling));
    }
    for (const float *v = (const float *)(const void *)at; i < n; i++, v += 4)
        for (int k = 0; k < 3; k++)
            to[k][i] = bound_one(v[k]);
}

static void bloom_bright(const pupil_planes *planes, uint32_t n, float threshold, float *const to[3])
{
    bright_channel(planes->r, n, to[0]);
    bright_channel(planes->g, n, to[1]);
    bright_channel(planes->b, n, to[2]);
    if (threshold > 0.0f)
        bloom_above(n, threshold, to[0], to[1], to[2]);
}

static void bloom_up(const float *const row[4], const float tap[4], uint32_t n, float *to)
{
    const floats a = v_all(tap[0]), b = v_all(tap[1]), c = v_all(tap[2]), d = v_all(tap[3]);
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH) {
        const floats upper = v_add(v_mul(a, v_load(row[0] + i)), v_mul(b, v_load(row[1] + i)));
        const floats lower = v_add(v_mul(c, v_load(row[2] + i)), v_mul(d, v_load(row[3] + i)));
        v_store(to + i, v_add(upper, lower));
    }
}

INLINE floats of_column(const floats pair[4], floats m, floats a, floats b, floats c)
{
    return v_add(v_add(v_mul(m, pair[0]), v_mul(a, pair[1])), v_add(v_mul(b, pair[2]), v_mul(c, pair[3])));
}

INLINE void columns_at(const float *const row[7], const floats t[10], size_t i, pupil_bloom_sums to)
{
    const floats pair[4] = {v_load(row[3] + i), both_of(row[2] + i, row[4] + i), both_of(row[1] + i, row[5] + i),
                            both_of(row[0] + i, row[6] + i)};
    v_store(to[0] + i, of_column(pair, t[0], t[1], t[3], t[6]));
    v_store(to[1] + i, of_column(pair, t[1], t[2], t[4], t[7]));
    v_store(to[2] + i, of_column(pair, t[3], t[4], t[5], t[8]));
    v_store(to[3] + i, of_column(pair, t[6], t[7], t[8], t[9]));
}

static void bloom_columns(const float *const *rows, const pupil_bloom_taps *taps, uint32_t n, pupil_bloom_sums sums)
{
    /* which nothing writes to */
    const float *const row[7] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6]};
    floats t[PUPIL_BLOOM_TAPS];
    FOR_EACH_OF(PUPIL_BLOOM_TAPS, k) t[k] = v_all(taps->tap[k]);
    for (size_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
        columns_at(row, t, i, sums);
}

INLINE floats row_at(const float *at)
{
    const float *const one = at + PUPIL_BLOOM_LINE, *const two = one + PUPIL_BLOOM_LINE;
    const float *const three = two + PUPIL_BLOOM_LINE;
    return v_add(v_add(v_load(at), both_of(one - 1, one + 1)),
                 v_add(both_of(two - 2, two + 2), both_of(three - 3, three + 3)));
}

static void bloom_rows(const pupil_bloom_sums sums, uint32_t n, float *to, int add)
{
    const float *at = sums[0] + PUPIL_BLOOM_SIDE;
    if (add)
        for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
            v_store(to + i, v_add(v_load(to + i), row_at(at + i)));
    else
        for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
            v_store(to + i, row_at(at + i));
}

#endif
