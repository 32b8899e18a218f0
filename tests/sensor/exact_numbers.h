/* log2, exp2 and sine by sums, products and quotients alone, so that they are the same to the last bit everywhere: the
 * C library's are not. Good to 1e-14, for sensible numbers. */
#ifndef PUPIL_TESTS_EXACT_NUMBERS_H
#define PUPIL_TESTS_EXACT_NUMBERS_H

#include <math.h>

/* By the series of artanh. */
static inline double exact_log2(double x)
{
    int exponent;
    double part = frexp(x, &exponent), sum = 0.0; /* frexp and ldexp are exact */
    if (part < 0.7071067811865476) {
        part *= 2.0;
        exponent--;
    }
    const double s = (part - 1.0) / (part + 1.0);
    for (int i = 23; i > 0; i -= 2)
        sum = sum * s * s + 1.0 / i;
    return exponent + 2.8853900817779268 * s * sum; /* 2 / ln 2 */
}

/* By the series of exp. */
static inline double exact_exp2(double x)
{
    const double whole = floor(x + 0.5), y = 0.6931471805599453 * (x - whole);
    double sum = 1.0;
    for (int i = 16; i > 0; i--)
        sum = 1.0 + sum * y / i;
    return ldexp(sum, (int)whole);
}

/* The sine of x full turns. */
static inline double exact_sine(double x)
{
    const double y = 6.283185307179586 * (x - floor(x + 0.5));
    double sum = 1.0;
    for (int i = 26; i > 0; i -= 2)
        sum = 1.0 - sum * y * y / (i * (i + 1));
    return sum * y;
}

#endif
