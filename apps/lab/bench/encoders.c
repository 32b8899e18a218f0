#include "encoders.h"

#include <math.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

INLINE uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

INLINE float of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* --- the tables --- */

static double curve(double light)
{
    return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055);
}

int bench_code_of(double light)
{
    return (int)floor(curve(light) + 0.5);
}

static int code_of_bits(uint32_t bits)
{
    return bench_code_of((double)of_bits(bits));
}

static uint32_t cell_of(uint32_t first)
{
    const uint32_t last = first + 0xffff;
    const int code = code_of_bits(first);
    uint32_t low = first, high = last;
    if (code_of_bits(last) == code)
        return (uint32_t)code << 16;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (code_of_bits(middle) == code)
            low = middle;
        else
            high = middle;
    }
    return ((uint32_t)code << 16) + 0x10000u - (high - first);
}

/* The line with the same error at its ends as within: the chord, raised by half of its largest error. The layout and
 * the number of entries are Fabian Giesen's (float to sRGB8 by table, 2012). */
static uint32_t segment_of(uint32_t first)
{
    const double from = curve((double)of_bits(first)), to = curve((double)of_bits(first + 0x100000u));
    double most = 0.0;
    for (int i = 0; i < 256; i++) {
        const double off = curve((double)of_bits(first + ((uint32_t)i << 12))) - (from + (to - from) * i / 256.0);
        most = off > most ? off : most;
    }
    const double bias = 128.0 * (from + 0.5 * most + 0.5), slope = (to - from) * 65536.0 / 256.0;
    return (uint32_t)(bias > 0.0 ? bias + 0.5 : 0.0) << 16 | (uint32_t)(slope + 0.5);
}

/* m^(5/12) through its values at the Chebyshev nodes of [1, 2): Newton's divided differences, then multiplied out. */
static void fit(float *coefficient, int count)
{
    double node[5], d[5], p[5] = {0.0};
    for (int i = 0; i < count; i++) {
        node[i] = 1.5 + 0.5 * cos(M_PI * (i + 0.5) / count);
        d[i] = pow(node[i], 5.0 / 12.0);
    }
    for (int order = 1; order < count; order++)
        for (int i = count - 1; i >= order; i--)
            d[i] = (d[i] - d[i - 1]) / (node[i] - node[i - order]);
    for (int i = count - 1; i >= 0; i--) {
        for (int k = count - 1; k > 0; k--)
            p[k] = p[k - 1] - node[i] * p[k];
        p[0] = d[i] - node[i] * p[0];
    }
    for (int i = 0; i < count; i++)
        coefficient[i] = (float)p[i];
}

static void make(bench_tables *t)
{
    for (uint32_t i = 0; i < BENCH_CELLS; i++)
        t->cell[i] = cell_of(BENCH_CELL_BASE + (i << 16));
    for (uint32_t i = 0; i < BENCH_NEAREST; i++)
        t->nearest[i] = (uint8_t)code_of_bits(BENCH_NEAREST_BASE + (i << 14) + 0x2000u);
    for (uint32_t i = 0; i < BENCH_SEGMENTS; i++)
        t->segment[i] = segment_of(BENCH_CELL_BASE + (i << 20));
    fit(t->cubic, 4);
    fit(t->quartic, 5);
}

/* --- the ways --- */

INLINE uint32_t bounded(float x, uint32_t base)
{
    x = x > of_bits(base) ? x : of_bits(base);
    x = x < of_bits(BENCH_TOP_BITS) ? x : of_bits(BENCH_TOP_BITS);
    return bits_of(x);
}

INLINE uint8_t by_cell(const bench_tables *t, float x)
{
    const uint32_t bits = bounded(x, BENCH_CELL_BASE);
    return (uint8_t)((t->cell[(bits - BENCH_CELL_BASE) >> 16] + (bits & 0xffffu)) >> 16);
}

INLINE void cells(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    for (size_t i = 0; i < n; i++)
        code[i] = by_cell(t, light[i]);
}

INLINE void nearest(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    for (size_t i = 0; i < n; i++)
        code[i] = t->nearest[(bounded(light[i], BENCH_NEAREST_BASE) - BENCH_NEAREST_BASE) >> 14];
}

INLINE void segments(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    for (size_t i = 0; i < n; i++) {
        const uint32_t bits = bounded(light[i], BENCH_CELL_BASE);
        const uint32_t s = t->segment[(bits - BENCH_CELL_BASE) >> 20];
        code[i] = (uint8_t)(((s >> 16 << 9) + (s & 0xffffu) * (bits >> 12 & 0xffu)) >> 16);
    }
}

/* 65536 times the code's value, plus a half. */
INLINE int32_t value_of(const bench_tables *t, float x, float clamped, int degree)
{
    const uint32_t bits = bits_of(clamped);
    const float m = of_bits((bits & 0x007fffffu) | 0x3f800000u), *c = degree == 3 ? t->cubic : t->quartic;
    /* by pairs, so that products do not wait for each other */
    const float low = c[0] + c[1] * m, high = degree == 3 ? c[2] + c[3] * m : (c[2] + c[3] * m) + c[4] * (m * m);
    const uint32_t k = 127u - (bits >> 23); /* 1..9: times 2^(-5/12 k), bit by bit, because these vectors cannot
                                             * gather */
    const float power = ((k & 1u ? 0x1.7f910d768cfbp-1f : 1.0f) * (k & 2u ? 0x1.1f59ac3c7d6cp-1f : 1.0f)) *
                        ((k & 4u ? 0x1.428a2f98d728bp-2f : 1.0f) * (k & 8u ? 0x1.965fea53d6e3cp-4f : 1.0f));
    const float bent =
        (low + high * (m * m)) * (power * (65536.0f * 1.055f * 255.0f)) + 65536.0f * (0.5f - 0.055f * 255.0f);
    const float line = 65536.0f * 12.92f * 255.0f * x + 32768.0f;
    return (int32_t)(x <= 0.0031308f ? line : bent);
}

/* In steps, each in its own loop: for a single loop gcc takes as many lanes as there are bytes in a vector, which do
 * not fit the registers, and makes a path for each side of each bound. */
INLINE void values(const bench_tables *t, const float *restrict light, int32_t *restrict value, int degree)
{
    float clamped[64];
    for (size_t i = 0; i < 64; i++) {
        const float x = light[i] < of_bits(BENCH_TOP_BITS) ? light[i] : of_bits(BENCH_TOP_BITS);
        clamped[i] = x > 0x1p-9f ? x : 0x1p-9f;
    }
    for (size_t i = 0; i < 64; i++)
        value[i] = value_of(t, light[i], clamped[i], degree);
}

INLINE void polynomial(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code, int degree)
{
    int32_t value[64];
    for (size_t from = 0; from < n; from += 64) {
        values(t, light + from, value, degree);
        for (size_t i = 0; i < 64; i++)
            code[from + i] = (uint8_t)(value[i] >> 16);
    }
}

INLINE void cubic(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    polynomial(t, light, n, code, 3);
}

INLINE void quartic(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    polynomial(t, light, n, code, 4);
}

/* The quartic; or the cell, if the quartic is nearer to a boundary than its error: 0.0045 code, from the polynomial
 * (1.2e-5 of 269) and from rounding of floats above 128. pupil does the same on x86. */
#define NEAR 295
INLINE void settled(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)
{
    int32_t value[64];
    for (size_t from = 0; from < n; from += 64) {
        uint32_t unsure = 0;
        values(t, light + from, value, 4);
        for (size_t i = 0; i < 64; i++)
            code[from + i] = (uint8_t)(value[i] >> 16);
        for (size_t i = 0; i < 64; i++)
            unsure |= (uint32_t)((((uint32_t)value[i] + NEAR) & 0xffffu) < 2u * NEAR);
        for (size_t i = 0; unsure && i < 64; i++)
            if ((((uint32_t)value[i] + NEAR) & 0xffffu) < 2u * NEAR)
                code[from + i] = by_cell(t, light[from + i]);
    }
}

/* Each is compiled twice if there may be AVX2. */
#define FOR_ANY(NAME)                                                                                                  \
    static void NAME##_any(const bench_tables *t, const float *restrict light, size_t n, uint8_t *restrict code)       \
    {                                                                                                                  \
        NAME(t, light, n, code);                                                                                       \
    }
#if defined(__x86_64__)
#define EACH(NAME)                                                                                                     \
    FOR_ANY(NAME)                                                                                                      \
    __attribute__((target("avx2"))) static void NAME##_avx2(const bench_tables *t, const float *restrict light,        \
                                                            size_t n, uint8_t *restrict code)                          \
    {                                                                                                                  \
        NAME(t, light, n, code);                                                                                       \
    }
#define CHOOSE(NAME) (__builtin_cpu_supports("avx2") ? NAME##_avx2 : NAME##_any)
#else
#define EACH(NAME)   FOR_ANY(NAME)
#define CHOOSE(NAME) NAME##_any
#endif

EACH(cells)
EACH(settled)
EACH(nearest)
EACH(segments)
EACH(cubic)
EACH(quartic)

void bench_encoders_open(bench_tables *t, bench_encoder list[BENCH_ENCODERS])
{
    make(t);
    list[0] = (bench_encoder){"cells", CHOOSE(cells)};
    list[1] = (bench_encoder){"quartic + cells", CHOOSE(settled)};
    list[2] = (bench_encoder){"8192-byte table", CHOOSE(nearest)};
    list[3] = (bench_encoder){"104 segments", CHOOSE(segments)};
    list[4] = (bench_encoder){"cubic", CHOOSE(cubic)};
    list[5] = (bench_encoder){"quartic", CHOOSE(quartic)};
}
