/* lib/kernels/vector.h: metering by vectors, written once for all levels. A level's file includes its own header
 * (avx2.h, avx512.h, neon.h: WIDTH, the types floats, ints and mask, and the v_ functions), then
 *
 *     vector_formats.h    which makes meter_FORMAT, scale_FORMAT and load_FORMAT out of this one and vector_scale.h
 *     vector_store.h      store_vectors, for x86
 *     vector_table.h      the level's kernels, and the entries of its table
 *
 * Pixels are processed in groups of 16, one for each lane of a run, in WAYS vectors. The operations of a pixel are
 * those of scalar.c, one by one, so that the bits are the same.
 */
#ifndef PUPIL_KERNELS_VECTOR_H
#define PUPIL_KERNELS_VECTOR_H

#include "bins.h"

#define WAYS (PUPIL_LANES / WIDTH)
#ifndef DENORMALS_ARE_SLOW
#define DENORMALS_ARE_SLOW 0
#endif
/* How far ahead a loop prefetches; 0: the CPU does so by itself. */
#ifndef FETCH_AHEAD_BYTES
#define FETCH_AHEAD_BYTES 0
#endif
/* gcc -O2 needs this to keep a loop's state in registers; clang does so by itself. */
#if defined(__clang__)
#define FOR_EACH_WAY(k) for (int k = 0; k < WAYS; k++)
#define FOR_FOUR(k)     for (int k = 0; k < 4; k++)
#else
#define FOR_FOUR(k)     _Pragma("GCC unroll 4") for (int k = 0; k < 4; k++)
#define FOR_EACH_WAY(k) _Pragma("GCC unroll 4") for (int k = 0; k < WAYS; k++)
#endif

/* Prefetches the cache lines that are `ahead` of `bytes` from p on, one of each `step` bytes, to be read or written.
 * Any address is allowed: as a rule it is in the same row, or the next one. */
INLINE void fetch_each(const void *p, size_t bytes, size_t ahead, size_t step)
{
    for (size_t line = 0; FETCH_AHEAD_BYTES && line < bytes; line += step)
        __builtin_prefetch((const void *)((uintptr_t)p + ahead + line));
}

INLINE void fetch(const void *p, size_t bytes, size_t ahead)
{
    fetch_each(p, bytes, ahead, 64);
}

/* Planes as if they began at pixel i; planes_from also makes the compiler compute that address, instead of adding i in
 * each access, which takes more instructions. */
INLINE pupil_planes *planes_at(pupil_planes *p, size_t i)
{
    return (pupil_planes *)(void *)(p->r + i);
}

INLINE pupil_planes *planes_from(pupil_planes *p, size_t i)
{
    pupil_planes *from = planes_at(p, i);
    __asm__("" : "+r"(from));
    return from;
}

typedef struct group { /* 16 pixels */
    floats r[WAYS], g[WAYS], b[WAYS], l[WAYS];
    ints top;    /* the largest bits of any channel, as unsigned numbers, are in one of its lanes */
    mask opaque; /* all true: every alpha is at least 1 */
} group;

typedef struct lanes {
    floats product[WAYS];
} lanes;

/* A float whose bits, as an unsigned number, are at most a limit's is not negative, not NaN, and at most the limit.
 * Pixels whose channels all pass this test (almost all do) need not be clamped, or counted one by one. */
typedef struct meter_constants {
    floats weight[3], floor, clip, ceiling;
    ints bounded;  /* channels up to this give no luminance above PUPIL_CEILING */
    ints ordinary; /* and below the clip */
} meter_constants;

INLINE floats max_of_3(floats a, floats b, floats c)
{
    return v_max(v_max(a, b), c);
}

/* --- meter --- */

INLINE meter_constants meter_constants_of(const pupil_row_job *job)
{
    meter_constants c;
    for (int i = 0; i < 3; i++)
        c.weight[i] = v_all(job->luma[i]);
    c.floor = v_all(job->floor);
    c.clip = v_all(job->clip);
    c.ceiling = v_all(PUPIL_CEILING);
    /* The weights' sum is 1. An imaginary primary has a negative one: then only a channel of 0 is bounded. */
    const int positive = job->luma[0] >= 0.0f && job->luma[1] >= 0.0f && job->luma[2] >= 0.0f;
    const float bound = positive ? PUPIL_CEILING / 2 : 0x1p-149f;
    c.bounded = v_all_ints(pupil_bits_of_float(bound) - 1);
    c.ordinary = v_all_ints(pupil_bits_of_float(bound < job->clip ? bound : job->clip) - 1);
    return c;
}

INLINE lanes lanes_of(const pupil_run *run)
{
    lanes s;
    FOR_EACH_WAY(k) s.product[k] = v_load(run->product + k * WIDTH);
    return s;
}

INLINE floats luminance(floats r, floats g, floats b, const meter_constants *c)
{
    return v_add(v_add(v_mul(c->weight[0], r), v_mul(c->weight[1], g)), v_mul(c->weight[2], b));
}

INLINE void luminance_of(group *p, const meter_constants *c)
{
    FOR_EACH_WAY(k) p->l[k] = luminance(p->r[k], p->g[k], p->b[k], c);
}

/* Denormals do not change a sum that is above any floor. */
INLINE floats without_denormals(floats v)
{
    if (!DENORMALS_ARE_SLOW)
        return v;
    const floats size = v_of_bits(v_and(v_bits(v), v_all_ints(0x7fffffff)));
    return v_select(v_less(size, v_all(0x1p-126f)), v_all(0.0f), v);
}

/* Of a group with any values. */
INLINE void luminance_of_any(group *p, const meter_constants *c)
{
    FOR_EACH_WAY(k)
    p->l[k] = luminance(without_denormals(p->r[k]), without_denormals(p->g[k]), without_denormals(p->b[k]), c);
}

/* Of 64 pixels, so that one test shows whether any of them must be clamped or counted. */
typedef struct extremes {
    ints top;
    floats least;
} extremes;

/* One vector of an ordinary group. */
INLINE void sum_vector(floats r, floats g, floats b, const meter_constants *c, floats *product, extremes *e)
{
    const floats l = luminance(r, g, b, c);
    e->top = v_max_unsigned(e->top, v_max_unsigned(v_max_unsigned(v_bits(r), v_bits(g)), v_bits(b)));
    e->least = v_min(e->least, l);
    *product = v_mul(*product, l);
}

INLINE void sum_group(group *p, const meter_constants *c, lanes *s, extremes *e)
{
    luminance_of(p, c);
    floats least = p->l[0];
    for (int k = 1; k < WAYS; k++)
        least = v_min(least, p->l[k]);
    e->top = v_max_unsigned(e->top, p->top);
    e->least = v_min(e->least, least);
    FOR_EACH_WAY(k) s->product[k] = v_mul(s->product[k], p->l[k]);
}

INLINE int is_ordinary(const extremes *e, const meter_constants *c)
{
    return v_every(v_both(v_at_most(e->top, c->ordinary), v_greater(e->least, c->floor)));
}

/* Whether pixel k * WIDTH + lane is one of the first n. */
INLINE mask first_of(uint32_t n, int k)
{
    static const float ramp[2 * PUPIL_LANES] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    return v_greater(v_load(ramp + PUPIL_LANES - n + k * WIDTH), v_all(0.0f));
}

/* Of the first n pixels. Where L is finite, so are the channels. */
INLINE void count_of(const group *p, const meter_constants *c, uint32_t n, pupil_run *run)
{
    const floats infinity = v_all((float)__builtin_inf()), below_all = v_all(-(float)__builtin_inf());
    tally finite = v_no_tally(), black = v_no_tally(), clipped = v_no_tally();
    FOR_EACH_WAY(k)
    {
        mask here = v_both(v_less(p->l[k], infinity), v_greater(p->l[k], below_all));
        if (n < PUPIL_LANES)
            here = v_both(here, first_of(n, k));
        finite = v_tally(finite, here);
        black = v_tally(black, v_both(here, v_at_least(c->floor, p->l[k])));
        clipped = v_tally(clipped, v_both(here, v_at_least(max_of_3(p->r[k], p->g[k], p->b[k]), c->clip)));
    }
    run->bad += n - v_tallied(finite);
    run->black += v_tallied(black);
    run->clipped += v_tallied(clipped);
}

/* The first n pixels, of any values. */
INLINE void meter_hard(const group *p, const meter_constants *c, lanes *s, uint32_t n, pupil_run *run)
{
    count_of(p, c, n, run);
    FOR_EACH_WAY(k)
    {
        const floats factor = v_min(v_max(p->l[k], c->floor), c->ceiling);
        s->product[k] = v_mul(s->product[k], n < PUPIL_LANES ? v_select(first_of(n, k), factor, v_all(1.0f)) : factor);
    }
}

/* Also stores all of s in the run. */
INLINE void move_exponents(lanes *s, pupil_run *run)
{
    FOR_EACH_WAY(k)
    {
        const ints bits = v_bits(s->product[k]), exponent = v_load_ints(run->exponent + k * WIDTH);
        v_store_ints(run->exponent + k * WIDTH, v_minus(v_plus(exponent, v_right(bits, 23)), v_all_ints(127)));
        s->product[k] = v_fraction(s->product[k]);
        v_store(run->product + k * WIDTH, s->product[k]);
    }
}

#endif
