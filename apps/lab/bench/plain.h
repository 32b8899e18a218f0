/* apps/lab/bench/plain.h: the code that one writes without a library: a loop with logf and powf. One source is compiled
 * with the usual flags, another with -O3 -ffast-math. */
#ifndef PUPIL_APPS_LAB_BENCH_PLAIN_H
#define PUPIL_APPS_LAB_BENCH_PLAIN_H

#include <stddef.h>
#include <stdint.h>

/* RGBA float in, RGBA8 out: exp(mean(log(L))) in float, then Reinhard with a white point and sRGB. */
typedef float bench_plain(const float *rgba, size_t pixels, float white, uint8_t *out);

bench_plain bench_plain_usual, bench_plain_fast;

#endif
