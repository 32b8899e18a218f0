/* lib/base/exact.h: what a compiler must do for the same bits everywhere, checked when the library is compiled.
 * cmake/flags.cmake asks for all of it; other build systems find out here.
 */
#ifndef PUPIL_BASE_EXACT_H
#define PUPIL_BASE_EXACT_H

#include <float.h>

/* C11, 5.2.4.2.2: 0: each operation rounds to its own type. x87 has 2, s390x with -std=c11 has 1. */
#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0
#error "pupil: float operations keep more digits than float (FLT_EVAL_METHOD is not 0), so the bits would be others. \
On x86 of 32 bits compile with -msse2 -mfpmath=sse, on s390x with -fexcess-precision=fast"
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) ||                               \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error                                                                                                                 \
    "pupil: compiled with -ffast-math, -Ofast or a part of it: NaN and infinity count here, and the order of sums. \
Compile without it"
#endif

/* A product and a sum round twice. GCC contracts them unless it is given -std=c11 or the like, or -ffp-contract=off,
 * which no macro reports. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && !defined(__STRICT_ANSI__) && !defined(PUPIL_NO_CONTRACTION) &&                              \
    (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#error "pupil: this compiler may fuse products and sums. Compile with -std=c11, or with -ffp-contract=off and \
-DPUPIL_NO_CONTRACTION"
#endif

#endif
