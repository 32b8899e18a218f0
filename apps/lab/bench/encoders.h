/* apps/lab/bench/encoders.h: ways from linear light to 8-bit sRGB codes, as plain C for the compiler's vectors: two
 * that are exact, and approximations that exist only here, to show what exactness costs. */
#ifndef PUPIL_APPS_LAB_BENCH_ENCODERS_H
#define PUPIL_APPS_LAB_BENCH_ENCODERS_H

#include <stddef.h>
#include <stdint.h>

#define BENCH_TOP_BITS     0x3f7fffffu /* the float below 1 */
#define BENCH_CELL_BASE    0x39000000u /* 2^-13: below it the code is 0, for 0.5 / 255 / 12.92 is above it */
#define BENCH_NEAREST_BASE 0x37800000u /* 2^-16, so that 16 octaves of 512 make 8192 */
enum { BENCH_CELLS = 13 * 128, BENCH_NEAREST = 16 * 512, BENCH_SEGMENTS = 13 * 8 };

typedef struct bench_tables {
    uint32_t cell[BENCH_CELLS]; /* 65536 code + (65536 - the boundary's place in the cell), as pupil's own */
    uint8_t nearest[BENCH_NEAREST];
    uint32_t segment[BENCH_SEGMENTS]; /* upper half: code at its start, in 1/128; lower half: slope */
    float cubic[4], quartic[5];       /* m^(5/12) for m in [1, 2) */
} bench_tables;

/* Samples from 0 to 1 to codes. n is a multiple of 64. */
typedef void bench_encode(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code);

typedef struct bench_encoder {
    const char *name;
    bench_encode *run;
} bench_encoder;

enum { BENCH_ENCODERS = 6 };
/* With AVX2 where this CPU has it. */
void bench_encoders_open(bench_tables *t, bench_encoder list[BENCH_ENCODERS]);

/* The reference for all: IEC 61966-2-1 in double, rounded half up. */
int bench_code_of(double light);

#endif
