/* lib/kernels/x86_pairs.h: pairs of floats from scattered addresses, for avx2.h and avx512.h. */
#ifndef PUPIL_KERNELS_X86_PAIRS_H
#define PUPIL_KERNELS_X86_PAIRS_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#define INLINE static inline __attribute__((always_inline))

/* vector.h: products with denormals are slow on these CPUs. */
#define DENORMALS_ARE_SLOW 1

/* vector.h: a page, at whose end these CPUs stop prefetching by themselves. A block of RGBA float is a page, and while
 * its codes are made nothing would be read (docs/bench.md has the cost). */
#define FETCH_AHEAD_BYTES 4096

/* Two pairs of floats, which are aligned as floats are. */
INLINE __m128 two_pairs(const float *first, const float *second)
{
    double low;
    __builtin_memcpy(&low, first, sizeof low);
    return _mm_loadh_pi(_mm_castpd_ps(_mm_set_sd(low)), (const __m64 *)(const void *)second);
}

/* Four pairs. Loading a pair to either half of a vector is one instruction, and the number of instructions is the
 * bottleneck. */
INLINE __m256 four_pairs(const float *first, const float *second, const float *third, const float *fourth)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(two_pairs(first, second)), two_pairs(third, fourth), 1);
}

/* The pairs from eight addresses, by twos to `even` and `odd`. A number of `two` is two indices, which halves their
 * loads. A gather takes several times as long on many CPUs (AMD's; Intel's with the microcode against Gather Data
 * Sampling). */
INLINE void eight_pairs(const float *first, ptrdiff_t step, const int64_t two[4], __m256 *even, __m256 *odd)
{
#define AT(k) (first + step * ((k) % 2 ? two[(k) / 2] >> 32 : (int32_t)two[(k) / 2]))
    *even = four_pairs(AT(0), AT(1), AT(4), AT(5));
    *odd = four_pairs(AT(2), AT(3), AT(6), AT(7));
#undef AT
}

/* Their first floats, and their second ones. */
INLINE void parts_of_pairs(const float *first, ptrdiff_t step, const int64_t two[4], __m256 part[2])
{
    __m256 even, odd;
    eight_pairs(first, step, two, &even, &odd);
    part[0] = _mm256_shuffle_ps(even, odd, 0x88);
    part[1] = _mm256_shuffle_ps(even, odd, 0xdd);
}

#endif
