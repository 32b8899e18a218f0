/* lib/kernels/vector_formats.h: how a group of pixels of a format is loaded, and the loops over groups that meter and
 * map. Almost every group is ordinary (vector.h); one that is not is done again, by slower functions that take any
 * values.
 *
 * The loops are written once, for a `format` whose functions they call by pointer. All of them are inlined into a
 * kernel that has its format as a constant (vector_table.h), so that no pointer is left in the machine code. */
#ifndef PUPIL_KERNELS_VECTOR_FORMATS_H
#define PUPIL_KERNELS_VECTOR_FORMATS_H

#include <stddef.h>

#include "vector_scale.h"

INLINE ints top_of(const floats *r, const floats *g, const floats *b)
{
    ints top[WAYS];
    FOR_EACH_WAY(k)
    top[k] = v_max_unsigned(v_max_unsigned(v_bits(r[k]), v_bits(g[k])), v_bits(b[k]));
    for (int k = 1; k < WAYS; k++)
        top[0] = v_max_unsigned(top[0], top[k]);
    return top[0];
}

INLINE mask opaque_of(const floats *a)
{
    mask opaque = v_at_least(a[0], v_all(1.0f));
    for (int k = 1; k < WAYS; k++)
        opaque = v_both(opaque, v_at_least(a[k], v_all(1.0f)));
    return opaque;
}

/* WIDTH pixels from `source` on. */
typedef void vector_load(const void *source, floats *r, floats *g, floats *b, floats *a);

/* How a level reads a format. `vector` alone is enough. A level that loads a format faster in groups of 16 pixels has
 * `group` instead, and `sum` and `scale` where it also has a shorter way for ordinary groups. */
typedef struct format {
    size_t bytes; /* of a pixel */
    vector_load *vector;
    /* 16 pixels from `source` on */
    void (*group)(const uint8_t *source, group *p);
    /* ... of an ordinary group, to the products and extremes of a run */
    void (*sum)(const uint8_t *source, const meter_constants *c, lanes *s, extremes *e);
    /* ... to planes, from their pixel i on, as scale_vector; returns the largest bits */
    ints (*scale)(const uint8_t *source, const meter_constants *c, const scale_constants *d, size_t i,
                  pupil_planes *planes, mask *beyond, mask *opaque, float *lum);
    /* the last n pixels of a run, fewer than 16, as a whole group; NULL: pixels are contiguous */
    void (*rest)(const uint8_t *source, size_t n, group *p);
    /* the bits of a float from the largest bits that `sum` and `scale` have found; NULL: they are a float's already */
    ints (*top)(ints top);
} format;

INLINE void load_group(const format *f, const uint8_t *source, group *p)
{
    if (!f->vector) {
        f->group(source, p);
        return;
    }
    floats a[WAYS];
    FOR_EACH_WAY(k) f->vector(source + k * WIDTH * f->bytes, &p->r[k], &p->g[k], &p->b[k], &a[k]);
    p->top = top_of(p->r, p->g, p->b);
    p->opaque = opaque_of(a);
}

INLINE void sum_ordinary(const format *f, const uint8_t *source, const meter_constants *c, lanes *s, extremes *e)
{
    if (f->sum) {
        f->sum(source, c, s, e);
    } else if (f->vector) {
        FOR_EACH_WAY(k)
        {
            floats r, g, b, a;
            f->vector(source + k * WIDTH * f->bytes, &r, &g, &b, &a);
            sum_vector(r, g, b, c, &s->product[k], e);
        }
    } else {
        group p;
        f->group(source, &p);
        sum_group(&p, c, s, e);
    }
}

INLINE ints scale_ordinary(const format *f, const uint8_t *source, const meter_constants *c, const scale_constants *d,
                           size_t i, pupil_planes *planes, mask *beyond, mask *opaque, float *lum)
{
    if (f->scale)
        return f->scale(source, c, d, i, planes, beyond, opaque, lum);
    if (f->vector) {
        ints top = v_all_ints(0);
        FOR_EACH_WAY(k)
        {
            floats r, g, b, a;
            f->vector(source + k * WIDTH * f->bytes, &r, &g, &b, &a);
            *opaque = v_both(*opaque, v_at_least(a, v_all(1.0f)));
            top = v_max_unsigned(top, v_max_unsigned(v_max_unsigned(v_bits(r), v_bits(g)), v_bits(b)));
            beyond[k] = scale_vector(r, g, b, luminance(r, g, b, c), d, i + (size_t)k * WIDTH, planes, lum, 1);
        }
        return top;
    }
    group p;
    f->group(source, &p);
    luminance_of(&p, c);
    *opaque = v_both(*opaque, p.opaque);
    FOR_EACH_WAY(k)
    beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, lum, 1);
    return p.top;
}

/* Prefetches what follows these pixels; planes are in the cache already. */
INLINE void fetch_ahead(const format *f, const uint8_t *source, size_t pixels, int all_lines)
{
    if (f->rest)
        return;
    fetch_each(source, pixels * f->bytes, FETCH_AHEAD_BYTES, 128);
    if (all_lines)
        fetch_each(source, pixels * f->bytes, FETCH_AHEAD_BYTES + 64, 128);
}

INLINE ints top_bits(const format *f, ints top)
{
    return f->top ? f->top(top) : top;
}

/* Fills the last n pixels of a run up to a group, by repeating the first of them. */
static void copy_rest(uint8_t *rest, const uint8_t *source, size_t bytes, size_t pixel_bytes)
{
    for (size_t i = 0; i < PUPIL_LANES * pixel_bytes; i++)
        rest[i] = source[i < bytes ? i : i % pixel_bytes];
}

INLINE void load_rest(const format *f, const uint8_t *source, size_t n, group *p)
{
    uint8_t rest[PUPIL_LANES * 16];
    if (f->rest) {
        f->rest(source, n, p);
        return;
    }
    copy_rest(rest, source, n * f->bytes, f->bytes);
    load_group(f, rest, p);
}

/* --- load: to planes --- */

INLINE void store_planes(const group *p, size_t i, pupil_planes *planes)
{
    FOR_EACH_WAY(k)
    {
        v_store(planes->r + i + k * WIDTH, p->r[k]);
        v_store(planes->g + i + k * WIDTH, p->g[k]);
        v_store(planes->b + i + k * WIDTH, p->b[k]);
    }
}

INLINE int load_groups(const format *f, const uint8_t *source, uint32_t n, pupil_planes *planes)
{
    mask opaque = v_at_least(v_all(1.0f), v_all(1.0f));
    for (uint32_t i = 0; i < n; i += PUPIL_LANES) {
        group p;
        if (i + PUPIL_LANES <= n)
            load_group(f, source + i * f->bytes, &p);
        else
            load_rest(f, source + i * f->bytes, n - i, &p);
        store_planes(&p, i, planes);
        opaque = v_both(opaque, p.opaque);
    }
    return v_every(opaque);
}

/* --- meter --- */

/* Meters pixels from i on, of any values: 64 by 64 as long as some are counted, and the last ones, which are fewer.
 * Returns the first pixel that is left. Each format has its own that is not inlined: the rare path must not take
 * registers from the usual one. */
typedef size_t hard_meter(const pupil_row_job *job, const uint8_t *source, size_t i, size_t n, pupil_run *run);

/* Returns 1 if none of them was counted: the next ones may well be ordinary. */
INLINE int meter_64_hard(const format *f, const uint8_t *source, const meter_constants *c, lanes *s, pupil_run *run)
{
    const uint32_t before = run->black + run->clipped + run->bad;
    for (size_t i = 0; i < 4 * PUPIL_LANES; i += PUPIL_LANES) {
        group p;
        load_group(f, source + i * f->bytes, &p);
        luminance_of_any(&p, c);
        meter_hard(&p, c, s, PUPIL_LANES, run);
    }
    move_exponents(s, run);
    return run->black + run->clipped + run->bad == before;
}

INLINE size_t meter_groups_hard(const format *f, const pupil_row_job *job, const uint8_t *source, size_t i, size_t n,
                                pupil_run *run)
{
    const meter_constants c = meter_constants_of(job);
    lanes s = lanes_of(run);
    group p;
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES)
        if (meter_64_hard(f, source + i * f->bytes, &c, &s, run))
            return i + 4 * PUPIL_LANES;
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {
        load_group(f, source + i * f->bytes, &p);
        luminance_of_any(&p, &c);
        meter_hard(&p, &c, &s, PUPIL_LANES, run);
    }
    if (i < n) {
        load_rest(f, source + i * f->bytes, n - i, &p);
        luminance_of_any(&p, &c);
        meter_hard(&p, &c, &s, (uint32_t)(n - i), run);
    }
    move_exponents(&s, run);
    return n;
}

/* Pixels from i on, as long as all of the next 64 are ordinary. Returns the first pixel that is left. After each 64 the
 * exponents are moved, because the products have room for four factors. */
INLINE size_t meter_ordinary(const format *f, const meter_constants *c, const uint8_t *source, size_t i, size_t n,
                             pupil_run *run)
{
    lanes s = lanes_of(run);
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {
        extremes e = {v_all_ints(0), v_all(PUPIL_CEILING)};
        fetch_ahead(f, source + i * f->bytes, 4 * PUPIL_LANES, 1);
        FOR_FOUR(j)
        sum_ordinary(f, source + (i + (size_t)j * PUPIL_LANES) * f->bytes, c, &s, &e);
        e.top = top_bits(f, e.top);
        if (__builtin_expect(!is_ordinary(&e, c), 0))
            break;
        move_exponents(&s, run);
    }
    return i;
}

INLINE void meter_groups(const format *f, hard_meter *hard, const pupil_row_job *job, const uint8_t *source, size_t n,
                         pupil_run *run)
{
    const meter_constants c = meter_constants_of(job);
    size_t i = 0;
    do {
        i = meter_ordinary(f, &c, source, i, n, run);
        if (i < n)
            i = hard(job, source, i, n, run);
    } while (i < n);
}

/* --- scale: map to planes --- */

/* What scaling keeps of a block, so that metering need not read its source again: the luminances, and the largest bits
 * of each 64 pixels. */
typedef struct kept {
    float lum[PUPIL_BLOCK];
    ints tops[PUPIL_BLOCK / (4 * PUPIL_LANES)];
} kept;

INLINE void keep_top(kept *keep, size_t i, ints top)
{
    ints *of_64 = &keep->tops[i / (4 * PUPIL_LANES)];
    *of_64 = i % (4 * PUPIL_LANES) ? v_max_unsigned(*of_64, top) : top;
}

/* What scaling finds out about a block, besides its planes. */
typedef struct scaled_block {
    group_list over;
    mask opaque;
    kept *keep; /* NULL: the block is not metered */
} scaled_block;

/* Scales groups of pixels from i on, of any values, as long as they are not bounded; the last one may be less than a
 * group. Returns the first pixel that is left. Each format has its own, as with hard_meter. */
typedef size_t hard_scale(const pupil_row_job *job, const uint8_t *source, size_t i, size_t n, pupil_planes *planes,
                          scaled_block *to);

INLINE size_t scale_groups_hard(const format *f, const pupil_row_job *job, const uint8_t *source, size_t i, size_t n,
                                pupil_planes *planes, scaled_block *to)
{
    const meter_constants c = meter_constants_of(job);
    scale_constants d = scale_constants_of(job->curve);
    /* A denormal is code 0 at any scale, which is 2^60 at most; where light is stored, it remains. */
    if (pupil_pixel_bytes(job->out_pixel) <= 4)
        d.faintest = v_all(0x1p-126f);
    for (; i < n; i += PUPIL_LANES) {
        const int whole = i + PUPIL_LANES <= n;
        group p;
        if (whole)
            load_group(f, source + i * f->bytes, &p);
        else
            load_rest(f, source + i * f->bytes, n - i, &p);
        luminance_of_any(&p, &c);
        to->opaque = v_both(to->opaque, p.opaque);
        scale_hard(&p, &d, i, planes, to->keep ? to->keep->lum : 0, &to->over);
        if (to->keep)
            keep_top(to->keep, i, p.top);
        if (whole && v_every(v_at_most(p.top, c.bounded)))
            return i + PUPIL_LANES;
    }
    return n;
}

/* Leaves to store the pixels of 16 bytes of which it is to prefetch every second line, a page ahead; NULL: none. */
INLINE void leave_lines(pupil_planes *planes, const uint8_t *source)
{
    if (!FETCH_AHEAD_BYTES)
        return;
    planes->next.first = source ? (uintptr_t)source + FETCH_AHEAD_BYTES + 64 : (uintptr_t)planes->r;
    planes->next.pixel_bytes = source ? 16 : 0;
}

/* keep: NULL where the block is not metered. Returns whether every pixel is known to be opaque. */
INLINE int scale_groups(const format *f, hard_scale *hard, const pupil_row_job *job, const uint8_t *source, uint32_t n,
                        pupil_planes *planes, kept *keep)
{
    const meter_constants c = meter_constants_of(job);
    const scale_constants d = scale_constants_of(job->curve);
    mask opaque = v_at_least(v_all(1.0f), v_all(1.0f));
    scaled_block to; /* not cleared as a whole, which would take as long as a group */
    /* If all of a block of RGBA float were prefetched here, this loop would wait for it, and memory would be idle while
     * its codes are made: so store prefetches every second line. */
    const int all_lines = !FETCH_AHEAD_BYTES || f->bytes < 16 || pupil_pixel_bytes(job->out_pixel) > 4;
    uint64_t any = 0;
    size_t i = 0, done = 0; /* by `hard` */
    to.over.any = 0;
    to.opaque = opaque;
    to.keep = keep;
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {
        mask beyond[WAYS];
        fetch_ahead(f, source + i * f->bytes, PUPIL_LANES, all_lines);
        if (__builtin_expect(i < done, 0))
            continue;
        const ints top = top_bits(
            f, scale_ordinary(f, source + i * f->bytes, &c, &d, i, planes, beyond, &opaque, keep ? keep->lum : 0));
        if (__builtin_expect(v_every(v_at_most(top, c.bounded)), 1)) {
            any |= to.over.vectors[i / PUPIL_LANES] = v_group_bits(beyond);
            if (keep)
                keep_top(keep, i, top);
        } else {
            done = hard(job, source, i, n, planes, &to);
        }
    }
    if (i < n && done < n)
        hard(job, source, i, n, planes, &to);
    if (any | to.over.any)
        fit_listed(&to.over, n, &d, job->cones, planes);
    leave_lines(planes, all_lines ? 0 : source);
    return v_every(v_both(opaque, to.opaque));
}

/* Meters what scaling has kept, as meter_ordinary. */
INLINE size_t meter_kept_ordinary(const meter_constants *c, size_t i, size_t n, const kept *keep, pupil_run *run)
{
    lanes s = lanes_of(run);
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {
        extremes e = {keep->tops[i / (4 * PUPIL_LANES)], v_all(PUPIL_CEILING)};
        FOR_FOUR(j)
        {
            FOR_EACH_WAY(k)
            {
                const floats l = v_load(keep->lum + i + (size_t)j * PUPIL_LANES + (size_t)k * WIDTH);
                e.least = v_min(e.least, l);
                s.product[k] = v_mul(s.product[k], l);
            }
        }
        if (__builtin_expect(!is_ordinary(&e, c), 0))
            break;
        move_exponents(&s, run);
    }
    return i;
}

/* 64 pixels that are not ordinary are metered by `hard`, from their source. */
INLINE void meter_kept(hard_meter *hard, const pupil_row_job *job, const uint8_t *source, uint32_t n, const kept *keep,
                       pupil_run *run)
{
    const meter_constants c = meter_constants_of(job);
    size_t i = 0;
    do {
        i = meter_kept_ordinary(&c, i, n, keep, run);
        if (i < n)
            i = hard(job, source, i, n, run);
    } while (i < n);
}

/* The channels are at the offsets of pupil_planes; alpha is not known. */
INLINE void load_from_planes(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const uint8_t *at = source;
    *r = v_load((const float *)(const void *)at);
    *g = v_load((const float *)(const void *)(at + offsetof(pupil_planes, g)));
    *b = v_load((const float *)(const void *)(at + offsetof(pupil_planes, b)));
    *a = v_all(0.0f);
}

/* The lanes after the last n pixels are black. */
INLINE void rest_of_planes(const uint8_t *source, size_t n, group *p)
{
    static const size_t at[3] = {offsetof(pupil_planes, r), offsetof(pupil_planes, g), offsetof(pupil_planes, b)};
    float rest[3][PUPIL_LANES] = {{0.0f}};
    for (int plane = 0; plane < 3; plane++)
        for (size_t j = 0; j < n; j++)
            rest[plane][j] = ((const float *)(const void *)(source + at[plane]))[j];
    FOR_EACH_WAY(k)
    {
        p->r[k] = v_load(rest[0] + k * WIDTH);
        p->g[k] = v_load(rest[1] + k * WIDTH);
        p->b[k] = v_load(rest[2] + k * WIDTH);
    }
    p->top = top_of(p->r, p->g, p->b);
    p->opaque = v_greater(v_all(0.0f), v_all(0.0f));
}

/* Leaves a group that is not bounded as it is, because source and target are the same. */
INLINE ints scale_in_planes(const uint8_t *source, const meter_constants *c, const scale_constants *d, size_t i,
                            pupil_planes *planes, mask *beyond, mask *opaque, float *lum)
{
    group p;
    (void)opaque;
    FOR_EACH_WAY(k)
    {
        floats a;
        load_from_planes(source + k * WIDTH * sizeof(float), &p.r[k], &p.g[k], &p.b[k], &a);
    }
    p.top = top_of(p.r, p.g, p.b);
    luminance_of(&p, c);
    if (!v_every(v_at_most(p.top, c->bounded)))
        return p.top;
    FOR_EACH_WAY(k)
    beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, lum, 1);
    return p.top;
}

static const format in_planes = {
    .bytes = sizeof(float), .vector = load_from_planes, .scale = scale_in_planes, .rest = rest_of_planes};

/* --- planes scaled: factors are the end of a long chain of dependent instructions, and a CPU that waits for it has no
 * room for those of the next groups. So a group's are computed while the group before is multiplied by its own. --- */

typedef struct group_factors {
    floats y[WAYS], s[WAYS];
    int bounded;
} group_factors;

INLINE group_factors factors_of(const pupil_planes *planes, const meter_constants *c, const scale_constants *d)
{
    group_factors f;
    floats r[WAYS], g[WAYS], b[WAYS];
    FOR_EACH_WAY(k)
    {
        const size_t i = (size_t)k * WIDTH;
        r[k] = v_load(planes->r + i);
        g[k] = v_load(planes->g + i);
        b[k] = v_load(planes->b + i);
        f.y[k] = luminance(r[k], g[k], b[k], c);
        f.s[k] = tone_of(f.y[k], d);
    }
    f.bounded = v_every(v_at_most(top_of(r, g, b), c->bounded));
    return f;
}

INLINE uint64_t scale_by_factors(const group_factors *f, const scale_constants *d, pupil_planes *planes)
{
    mask beyond[WAYS];
    FOR_EACH_WAY(k)
    {
        const size_t i = (size_t)k * WIDTH;
        beyond[k] = store_scaled(v_load(planes->r + i), v_load(planes->g + i), v_load(planes->b + i), f->y[k], f->s[k],
                                 d, i, planes);
    }
    return v_group_bits(beyond);
}

/* Whole groups from pixel i on, as long as they are bounded. Returns the first pixel that is left. */
INLINE size_t scale_bounded(const meter_constants *c, const scale_constants *d, size_t i, size_t n,
                            pupil_planes *planes, group_list *over)
{
    if (i + PUPIL_LANES > n)
        return i;
    group_factors next = factors_of(planes_from(planes, i), c, d);
    while (next.bounded) {
        const group_factors now = next;
        pupil_planes *from = planes_from(planes, i);
        const size_t at = i / PUPIL_LANES;
        i += PUPIL_LANES;
        const int is_last = i + PUPIL_LANES > n;
        if (!is_last)
            next = factors_of(planes_at(from, PUPIL_LANES), c, d);
        over->any |= over->vectors[at] = scale_by_factors(&now, d, from);
        if (is_last)
            break;
    }
    return i;
}

/* As scale_groups, of planes. */
INLINE void scale_all_planes(hard_scale *hard, const pupil_row_job *job, uint32_t n, pupil_planes *planes)
{
    const meter_constants c = meter_constants_of(job);
    const scale_constants d = scale_constants_of(job->curve);
    scaled_block to; /* its list is filled below */
    to.over.any = 0;
    to.opaque = v_at_least(v_all(1.0f), v_all(1.0f));
    to.keep = 0;
    for (size_t i = 0; i < n;) {
        i = scale_bounded(&c, &d, i, n, planes, &to.over);
        if (i < n)
            i = hard(job, (const uint8_t *)planes, i, n, planes, &to);
    }
    if (to.over.any)
        fit_listed(&to.over, n, &d, job->cones, planes);
    leave_lines(planes, 0);
}

/* --- planes metered and scaled: 64 pixels are metered, then scaled in their place with the luminances of metering ---
 */

enum { IN_A_SUM = 4 * PUPIL_LANES };

/* 64 pixels from `at` on, as if they were ordinary. */
INLINE extremes sum_planes(const pupil_planes *planes, size_t at, const meter_constants *c, lanes *s, float *lum)
{
    extremes e = {v_all_ints(0), v_all(PUPIL_CEILING)};
    FOR_FOUR(j)
    {
        FOR_EACH_WAY(k)
        {
            const size_t i = (size_t)j * PUPIL_LANES + (size_t)k * WIDTH;
            const floats r = v_load(planes->r + at + i), g = v_load(planes->g + at + i), b = v_load(planes->b + at + i);
            const floats l = luminance(r, g, b, c);
            v_store(lum + i, l);
            e.top = v_max_unsigned(e.top, v_max_unsigned(v_max_unsigned(v_bits(r), v_bits(g)), v_bits(b)));
            e.least = v_min(e.least, l);
            s->product[k] = v_mul(s->product[k], l);
        }
    }
    return e;
}

/* 64 pixels that are bounded. */
INLINE void scale_summed(pupil_planes *planes, size_t at, const float *lum, const scale_constants *d, group_list *over)
{
    for (size_t i = at; i < at + IN_A_SUM; i += PUPIL_LANES) {
        mask beyond[WAYS];
        FOR_EACH_WAY(k)
        {
            const size_t j = i + (size_t)k * WIDTH;
            const floats r = v_load(planes->r + j), g = v_load(planes->g + j), b = v_load(planes->b + j);
            beyond[k] = scale_vector(r, g, b, v_load(lum + (j - at)), d, j, planes, 0, 1);
        }
        over->any |= over->vectors[i / PUPIL_LANES] = v_group_bits(beyond);
    }
}

/* Pixels from `at` to n, of any values. */
static __attribute__((noinline)) void scale_planes_hard(pupil_planes *planes, size_t at, size_t n,
                                                        const meter_constants *c, const scale_constants *d,
                                                        group_list *over)
{
    for (size_t i = at; i < n; i += PUPIL_LANES) {
        const uint8_t *source = (const uint8_t *)(planes->r + i);
        group p;
        if (i + PUPIL_LANES <= n)
            load_group(&in_planes, source, &p);
        else
            load_rest(&in_planes, source, n - i, &p);
        luminance_of_any(&p, c);
        scale_hard(&p, d, i, planes, 0, over);
    }
}

INLINE void meter_and_scale_planes(hard_meter *hard, const pupil_row_job *job, size_t n, pupil_planes *planes,
                                   pupil_run *run)
{
    const meter_constants c = meter_constants_of(job);
    const scale_constants d = scale_constants_of(job->curve);
    float lum[IN_A_SUM];
    group_list over;
    lanes s = lanes_of(run);
    size_t i = 0;
    over.any = 0;
    for (; i + IN_A_SUM <= n; i += IN_A_SUM) {
        const extremes e = sum_planes(planes, i, &c, &s, lum);
        if (__builtin_expect(is_ordinary(&e, &c), 1)) {
            move_exponents(&s, run);
        } else {
            hard(job, (const uint8_t *)planes, i, i + IN_A_SUM, run);
            s = lanes_of(run);
        }
        if (__builtin_expect(v_every(v_at_most(e.top, c.bounded)), 1))
            scale_summed(planes, i, lum, &d, &over);
        else
            scale_planes_hard(planes, i, i + IN_A_SUM, &c, &d, &over);
    }
    if (i < n) {
        hard(job, (const uint8_t *)planes, i, n, run);
        scale_planes_hard(planes, i, n, &c, &d, &over);
    }
    if (over.any)
        fit_listed(&over, (uint32_t)n, &d, job->cones, planes);
    leave_lines(planes, 0);
}

#endif
