/* lib/kernels/vector_bloom.h: filters of rows in vectors, as scalar.c's bloom_pairs(). */
#ifndef PUPIL_KERNELS_VECTOR_BLOOM_H
#define PUPIL_KERNELS_VECTOR_BLOOM_H

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

#endif
