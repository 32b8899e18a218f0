/* lib/kernels/vector_bloom.h: filters of rows in vectors, as scalar.c's bloom_pairs(). */
#ifndef PUPIL_KERNELS_VECTOR_BLOOM_H
#define PUPIL_KERNELS_VECTOR_BLOOM_H

#include "bloom_loops.h"
#include "vector.h"

/* gcc needs this to keep sums in registers. */
#if defined(__clang__)
#define FOR_EACH_OF(vectors, k) for (int k = 0; k < (vectors); k++)
#else
#define FOR_EACH_OF(vectors, k) _Pragma("GCC unroll 8") for (int k = 0; k < (vectors); k++)
#endif

/* `vectors` of them at pixel i: at most 8. */
INLINE void pairs_at(const float *const *one, const float *const *other, const float *tap, uint32_t pairs, size_t i,
                     float *to, int add, int vectors)
{
    floats sum[8];
    FOR_EACH_OF(vectors, k) sum[k] = add ? v_load(to + i + k * WIDTH) : v_all(0.0f);
    for (size_t p = 0; p < pairs; p++) {
        const float *a = one[p] + i, *b = other[p] + i;
        const floats by = v_all(tap[p]);
        FOR_EACH_OF(vectors, k)
        sum[k] = v_add(sum[k], v_mul(by, v_add(v_load(a + k * WIDTH), v_load(b + k * WIDTH))));
    }
    FOR_EACH_OF(vectors, k) v_store(to + i + k * WIDTH, sum[k]);
}

static void bloom_pairs(const float *const *one, const float *const *other, const float *tap, uint32_t pairs,
                        uint32_t n, float *to, int add)
{
    uint32_t i = 0;
    for (; WIDTH > 4 && i + 32 < n; i += 64)
        pairs_at(one, other, tap, pairs, i, to, add, WIDTH > 4 ? 64 / WIDTH : 8);
    for (; i < n; i += 32)
        pairs_at(one, other, tap, pairs, i, to, add, 32 / WIDTH);
}

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

static void bloom_up(const float *const row[3], const float tap[3], uint32_t n, float *to)
{
    const floats a = v_all(tap[0]), b = v_all(tap[1]), c = v_all(tap[2]);
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += WIDTH)
        v_store(to + i,
                v_add(v_add(v_mul(a, v_load(row[0] + i)), v_mul(b, v_load(row[1] + i))), v_mul(c, v_load(row[2] + i))));
}

INLINE floats near_column(floats m, floats a, floats b, floats tm, floats ta, floats tb)
{
    return v_add(v_add(v_mul(tm, m), v_mul(ta, a)), v_mul(tb, b));
}

INLINE void columns_at(const float *const *row, const floats t[6], const floats w[6], size_t i, pupil_bloom_sums to)
{
    const floats m = v_load(row[5] + i), a = both_of(row[4] + i, row[6] + i), b = both_of(row[3] + i, row[7] + i);
    const floats c = both_of(row[2] + i, row[8] + i), d = both_of(row[1] + i, row[9] + i);
    const floats e = both_of(row[0] + i, row[10] + i);
    v_store(to[0] + i, near_column(m, a, b, t[0], t[1], t[3]));
    v_store(to[1] + i, near_column(m, a, b, t[1], t[2], t[4]));
    v_store(to[2] + i, near_column(m, a, b, t[3], t[4], t[5]));
    const floats ma = v_add(v_mul(w[0], m), v_mul(w[1], a)), bc = v_add(v_mul(w[2], b), v_mul(w[3], c));
    v_store(to[3] + i, v_add(v_add(ma, bc), v_add(v_mul(w[4], d), v_mul(w[5], e))));
}

static void bloom_columns(const float *const *row, const pupil_bloom_taps *taps, uint32_t n, pupil_bloom_sums sums)
{
    floats t[6], w[6];
    FOR_EACH_OF(6, k) t[k] = v_all(taps->near[k]);
    FOR_EACH_OF(6, k) w[k] = v_all(taps->column[k]);
    for (size_t i = 0; i < (n + 15) / 16 * 16; i += 16)
        FOR_EACH_OF(16 / WIDTH, k) columns_at(row, t, w, i + k * WIDTH, sums);
}

INLINE void rows_at(const float *at, const floats w[6], float *to)
{
    const float *const one = at + PUPIL_BLOOM_LINE, *const two = one + PUPIL_BLOOM_LINE;
    const float *const f = two + PUPIL_BLOOM_LINE;
    const floats near = v_add(v_add(v_load(at), both_of(one - 1, one + 1)), both_of(two - 2, two + 2));
    const floats inner = v_add(v_mul(w[0], v_load(f)), v_mul(w[1], both_of(f - 1, f + 1)));
    const floats middle = v_add(v_mul(w[2], both_of(f - 2, f + 2)), v_mul(w[3], both_of(f - 3, f + 3)));
    const floats outer = v_add(v_mul(w[4], both_of(f - 4, f + 4)), v_mul(w[5], both_of(f - 5, f + 5)));
    v_store(to, v_add(v_load(to), v_add(near, v_add(v_add(inner, middle), outer))));
}

static void bloom_rows(const pupil_bloom_sums sums, const pupil_bloom_taps *taps, uint32_t n, float *to)
{
    floats w[6];
    FOR_EACH_OF(6, k) w[k] = v_all(taps->row[k]);
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i += 16)
        FOR_EACH_OF(16 / WIDTH, k) rows_at(sums[0] + PUPIL_BLOOM_SIDE + i + k * WIDTH, w, to + i + k * WIDTH);
}

#endif
