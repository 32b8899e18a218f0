/* lib/base/numeric.h: the few functions of real numbers that the core needs, without libm: the same bits everywhere,
 * because each is a fixed sequence of IEEE additions, multiplications and divisions.
 */
#ifndef PUPIL_BASE_NUMERIC_H
#define PUPIL_BASE_NUMERIC_H

#include "base/exact.h"

#include <stdint.h>

/* Bit casts: a freestanding build has no memcpy to inline. */
typedef union pupil_bits {
    double d;
    uint64_t of_d;
    float f;
    uint32_t of_f;
} pupil_bits;

static inline uint64_t pupil_bits_of_double(double x)
{
    return (pupil_bits){.d = x}.of_d;
}

static inline double pupil_double_of_bits(uint64_t u)
{
    return (pupil_bits){.of_d = u}.d;
}

static inline uint32_t pupil_bits_of_float(float x)
{
    return (pupil_bits){.f = x}.of_f;
}

static inline float pupil_float_of_bits(uint32_t u)
{
    return (pupil_bits){.of_f = u}.f;
}

/* NaN and both infinities have all exponent bits set. */
static inline int pupil_is_finite(double x)
{
    return (pupil_bits_of_double(x) >> 52 & 0x7ff) != 0x7ff;
}

static inline double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* log2 of a normal x > 0; absolute error below 4e-16 + 2e-16 |log2 x|. */
double pupil_log2(double x);

/* 2^x for |x| <= 1000; relative error below 4e-16. */
double pupil_exp2(double x);

/* The square root and exp(-x), of x >= 0; relative errors below 1e-15 and 1.2e-14 where x is at most 100. From 690 on
 * exp(-x) is 0. */
double pupil_root(double x);
double pupil_decay(double x);

/* 1 - exp(-x) for x >= 0; relative error below 4e-16 also where x is tiny. */
double pupil_one_minus_exp(double x);

/* The cosine and the sine of 2 pi x, for |x| < 2^31; absolute error below 1e-8 (at half a turn). */
void pupil_turn(double x, double cos_sin[2]);

/* The same to 1e-15, but slower: |turns| < 2^50. */
void pupil_circle(double turns, double *cosine, double *sine);

/* The nearest integer; |x| < 2^62. */
double pupil_nearest(double x);

#endif
