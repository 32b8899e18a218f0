/* lib/kernels/x86_pairs.h: pairs of floats from places in memory that are not in a row, for avx2.h and avx512.h. */
#ifndef PUPIL_KERNELS_X86_PAIRS_H
#define PUPIL_KERNELS_X86_PAIRS_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#define INLINE static inline __attribute__((always_inline))

/* vector.h: products with denormals, which these CPUs do not foresee. */
#define DENORMALS_ARE_SLOW 1

/* Two floats, which are aligned as floats are, in all places. */
INLINE __m256d pair_everywhere(const float *pair)
{
    double both;
    __builtin_memcpy(&both, pair, sizeof both);
    return _mm256_set1_pd(both);
}

/* Four pairs of floats. From memory to all places of a vector, and from there to one: that takes no shuffle, of which
 * most CPUs do one a cycle. */
INLINE __m256 four_pairs(const float *first, const float *second, const float *third, const float *fourth)
{
    const __m256d a = pair_everywhere(first);
    const __m256d b = pair_everywhere(second);
    const __m256d c = pair_everywhere(third);
    const __m256d d = pair_everywhere(fourth);
    return _mm256_castpd_ps(_mm256_blend_pd(_mm256_blend_pd(a, b, 2), _mm256_blend_pd(c, d, 8), 12));
}

/* The pairs from eight places: those of the even lanes by twos, and of the odd ones. Two indices a number, since loads
 * are what all of this waits for. Not by a gather: on many CPUs it takes several times as long (AMD's; Intel's with the
 * microcode against Gather Data Sampling). */
INLINE void eight_pairs(const float *first, size_t step, const uint64_t two[4], __m256 *even, __m256 *odd)
{
#define AT(k) (first + step * ((k) % 2 ? two[(k) / 2] >> 32 : (uint32_t)two[(k) / 2]))
    *even = four_pairs(AT(0), AT(1), AT(4), AT(5));
    *odd = four_pairs(AT(2), AT(3), AT(6), AT(7));
#undef AT
}

/* Their first floats, and their second ones. */
INLINE void parts_of_pairs(const float *first, size_t step, const uint64_t two[4], __m256 part[2])
{
    __m256 even, odd;
    eight_pairs(first, step, two, &even, &odd);
    part[0] = _mm256_shuffle_ps(even, odd, 0x88);
    part[1] = _mm256_shuffle_ps(even, odd, 0xdd);
}

#endif
