/* lib/kernels/vector_formats.h: the kernels of a level by format: how a group of pixels is loaded, and the loops over
 * groups that meter and map. Almost every group is ordinary (vector.h); one that is not is done once more, by the hard
 * way. */
#ifndef PUPIL_KERNELS_VECTOR_FORMATS_H
#define PUPIL_KERNELS_VECTOR_FORMATS_H

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

/* group_NAME from LOAD(source, r, g, b, a), which loads WIDTH pixels of BYTES each. */
#define GROUP_OF_VECTORS(NAME, LOAD, BYTES)                                                                            \
    INLINE void group_##NAME(const uint8_t *source, group *p)                                                          \
    {                                                                                                                  \
        floats a[WAYS];                                                                                                \
        FOR_EACH_WAY(k) LOAD(source + k * WIDTH * (BYTES), &p->r[k], &p->g[k], &p->b[k], &a[k]);                       \
        p->top = top_of(p->r, p->g, p->b);                                                                             \
        p->opaque = opaque_of(a);                                                                                      \
    }

INLINE ints as_it_is(ints top)
{
    return top;
}

/* What the loops over ordinary groups do with one: sum_NAME meters it, scale16_NAME maps it to planes. From LOAD,
 * vector by vector, or from the group as a whole where it is loaded so. top_NAME makes the bits of floats out of what
 * they have found to be the largest bits. */
#define ORDINARY_VECTORS(NAME, LOAD, BYTES)                                                                            \
    INLINE ints top_##NAME(ints top)                                                                                   \
    {                                                                                                                  \
        return top;                                                                                                    \
    }                                                                                                                  \
    INLINE void sum_##NAME(const uint8_t *source, const meter_constants *c, lanes *s, extremes *e)                     \
    {                                                                                                                  \
        FOR_EACH_WAY(k)                                                                                                \
        {                                                                                                              \
            floats r, g, b, a;                                                                                         \
            LOAD(source + k * WIDTH * (BYTES), &r, &g, &b, &a);                                                        \
            sum_vector(r, g, b, c, &s->product[k], e);                                                                 \
        }                                                                                                              \
    }                                                                                                                  \
    INLINE ints scale16_##NAME(const uint8_t *source, const meter_constants *c, const scale_constants *d, size_t i,    \
                               pupil_planes *planes, mask *beyond, mask *opaque, float *lum)                           \
    {                                                                                                                  \
        ints top = v_all_ints(0);                                                                                      \
        FOR_EACH_WAY(k)                                                                                                \
        {                                                                                                              \
            floats r, g, b, a;                                                                                         \
            LOAD(source + k * WIDTH * (BYTES), &r, &g, &b, &a);                                                        \
            *opaque = v_both(*opaque, v_at_least(a, v_all(1.0f)));                                                     \
            top = v_max_unsigned(top, v_max_unsigned(v_max_unsigned(v_bits(r), v_bits(g)), v_bits(b)));                \
            beyond[k] = scale_vector(r, g, b, luminance(r, g, b, c), d, i + (size_t)k * WIDTH, planes, lum, 1);        \
        }                                                                                                              \
        return top;                                                                                                    \
    }

#define ORDINARY_GROUP(NAME)                                                                                           \
    INLINE ints top_##NAME(ints top)                                                                                   \
    {                                                                                                                  \
        return top;                                                                                                    \
    }                                                                                                                  \
    INLINE void sum_##NAME(const uint8_t *source, const meter_constants *c, lanes *s, extremes *e)                     \
    {                                                                                                                  \
        group p;                                                                                                       \
        group_##NAME(source, &p);                                                                                      \
        sum_group(&p, c, s, e);                                                                                        \
    }                                                                                                                  \
    INLINE ints scale16_##NAME(const uint8_t *source, const meter_constants *c, const scale_constants *d, size_t i,    \
                               pupil_planes *planes, mask *beyond, mask *opaque, float *lum)                           \
    {                                                                                                                  \
        group p;                                                                                                       \
        group_##NAME(source, &p);                                                                                      \
        luminance_of(&p, c);                                                                                           \
        *opaque = v_both(*opaque, p.opaque);                                                                           \
        FOR_EACH_WAY(k)                                                                                                \
        beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, lum, 1);            \
        return p.top;                                                                                                  \
    }

/* What is left of a run, as a whole group: the pixels behind it repeat the first. */
#define REST_BYTES (PUPIL_LANES * 16)

static void copy_rest(uint8_t rest[REST_BYTES], const uint8_t *source, size_t bytes, size_t pixel_bytes)
{
    for (size_t i = 0; i < PUPIL_LANES * pixel_bytes; i++)
        rest[i] = source[i < bytes ? i : i % pixel_bytes];
}

INLINE void load_planes(const float *r, const float *g, const float *b, group *p)
{
    FOR_EACH_WAY(k)
    {
        p->r[k] = v_load(r + k * WIDTH);
        p->g[k] = v_load(g + k * WIDTH);
        p->b[k] = v_load(b + k * WIDTH);
    }
    p->top = top_of(p->r, p->g, p->b);
    p->opaque = v_greater(v_all(0.0f), v_all(0.0f)); /* of alpha nothing is known */
}

INLINE void store_planes(const group *p, size_t i, pupil_planes *planes)
{
    FOR_EACH_WAY(k)
    {
        v_store(planes->r + i + k * WIDTH, p->r[k]);
        v_store(planes->g + i + k * WIDTH, p->g[k]);
        v_store(planes->b + i + k * WIDTH, p->b[k]);
    }
}

/* The body of a kernel that loops over groups. LOAD fills the group p with the pixels from i on, LOAD_REST with those
 * that are left. After each 64 pixels the exponents are moved, and before those that are left, because up to four
 * factors may be in the products. */
#define METER_BODY(SUM, TOP, HARD)                                                                                     \
    const meter_constants c = meter_constants_of(job);                                                                 \
    lanes s = lanes_of(run);                                                                                           \
    size_t i = 0;                                                                                                      \
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {                                                           \
        extremes e = {v_all_ints(0), v_all(PUPIL_CEILING)};                                                            \
        FOR_FOUR(j)                                                                                                    \
        {                                                                                                              \
            const size_t k = i + (size_t)j * PUPIL_LANES;                                                              \
            SUM;                                                                                                       \
        }                                                                                                              \
        e.top = TOP(e.top);                                                                                            \
        if (__builtin_expect(!is_ordinary(&e, &c), 0)) {                                                               \
            HARD(job, source, planes, i, i + 4 * PUPIL_LANES, run);                                                    \
            s = lanes_of(run);                                                                                         \
        } else {                                                                                                       \
            move_exponents(&s, run);                                                                                   \
        }                                                                                                              \
    }                                                                                                                  \
    if (i < n)                                                                                                         \
        HARD(job, source, planes, i, n, run);

#define HARD_BODY(LOAD, LOAD_REST)                                                                                     \
    const meter_constants c = meter_constants_of(job);                                                                 \
    lanes s = lanes_of(run);                                                                                           \
    group p;                                                                                                           \
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {                                                                   \
        LOAD;                                                                                                          \
        luminance_of(&p, &c);                                                                                          \
        meter_hard(&p, &c, &s, PUPIL_LANES, run);                                                                      \
    }                                                                                                                  \
    move_exponents(&s, run);                                                                                           \
    if (i < n) {                                                                                                       \
        LOAD_REST;                                                                                                     \
        luminance_of(&p, &c);                                                                                          \
        meter_hard(&p, &c, &s, (uint32_t)(n - i), run);                                                                \
        move_exponents(&s, run);                                                                                       \
    }

/* SCALE16 maps the group from i on as if it were ordinary; LOAD and LOAD_REST as above. */
#define SCALE_BODY(SCALE16, TOP, LOAD, LOAD_REST)                                                                      \
    const meter_constants c = meter_constants_of(job);                                                                 \
    const scale_constants d = scale_constants_of(job->curve);                                                          \
    group_list over;                                                                                                   \
    mask opaque = v_at_least(v_all(1.0f), v_all(1.0f));                                                                \
    size_t i = 0;                                                                                                      \
    over.any = 0;                                                                                                      \
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {                                                                   \
        mask beyond[WAYS];                                                                                             \
        const ints top = TOP(SCALE16);                                                                                 \
        if (__builtin_expect(v_every(v_at_most(top, c.bounded)), 1)) {                                                 \
            over.any |= over.vectors[i / PUPIL_LANES] = v_group_bits(beyond);                                          \
        } else {                                                                                                       \
            group p;                                                                                                   \
            LOAD;                                                                                                      \
            luminance_of(&p, &c);                                                                                      \
            scale_hard(&p, &d, i, planes, &over);                                                                      \
        }                                                                                                              \
    }                                                                                                                  \
    if (i < n) {                                                                                                       \
        group p;                                                                                                       \
        LOAD_REST;                                                                                                     \
        luminance_of(&p, &c);                                                                                          \
        opaque = v_both(opaque, p.opaque);                                                                             \
        scale_hard(&p, &d, i, planes, &over);                                                                          \
    }                                                                                                                  \
    if (over.any)                                                                                                      \
        fit_listed(&over, n, &d, planes);

/* What scaling has found of a block, metered: the luminances, and the largest bits of each 64 pixels. Chunks that are
 * not ordinary go the hard way, from their source. */
typedef void hard_meter(const pupil_row_job *job, const void *source, const pupil_planes *planes, size_t i, size_t n,
                        pupil_run *run);

INLINE ints keep_top(ints *tops, size_t i, ints top)
{
    ints *kept = &tops[i / (4 * PUPIL_LANES)];
    *kept = i % (4 * PUPIL_LANES) ? v_max_unsigned(*kept, top) : top;
    return top;
}

INLINE void meter_kept(const pupil_row_job *job, const float *lum, const ints *tops, uint32_t n, hard_meter *hard,
                       const void *source, pupil_run *run)
{
    const meter_constants c = meter_constants_of(job);
    lanes s = lanes_of(run);
    size_t i = 0;
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {
        extremes e = {tops[i / (4 * PUPIL_LANES)], v_all(PUPIL_CEILING)};
        FOR_FOUR(j)
        {
            FOR_EACH_WAY(k)
            {
                const floats l = v_load(lum + i + (size_t)j * PUPIL_LANES + (size_t)k * WIDTH);
                e.least = v_min(e.least, l);
                s.product[k] = v_mul(s.product[k], l);
            }
        }
        if (__builtin_expect(is_ordinary(&e, &c), 1)) {
            move_exponents(&s, run);
        } else {
            hard(job, source, 0, i, i + 4 * PUPIL_LANES, run);
            s = lanes_of(run);
        }
    }
    if (i < n)
        hard(job, source, 0, i, n, run);
}

/* From group_NAME(source, group), which loads 16 pixels of BYTES each. */
#define FORMAT_KERNELS(NAME, BYTES)                                                                                    \
    INLINE void rest_##NAME(const uint8_t *source, size_t n, group *p)                                                 \
    {                                                                                                                  \
        uint8_t rest[REST_BYTES];                                                                                      \
        copy_rest(rest, source, n *(BYTES), BYTES);                                                                    \
        group_##NAME(rest, p);                                                                                         \
    }                                                                                                                  \
    static int load_##NAME(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n,                     \
                           pupil_planes *planes)                                                                       \
    {                                                                                                                  \
        const uint8_t *at = row->data + x * (size_t)(BYTES);                                                           \
        (void)coder;                                                                                                   \
        mask opaque = v_at_least(v_all(1.0f), v_all(1.0f));                                                            \
        for (uint32_t i = 0; i < n; i += PUPIL_LANES) {                                                                \
            group p;                                                                                                   \
            if (i + PUPIL_LANES <= n)                                                                                  \
                group_##NAME(at + i * (BYTES), &p);                                                                    \
            else                                                                                                       \
                rest_##NAME(at + i * (BYTES), n - i, &p);                                                              \
            store_planes(&p, i, planes);                                                                               \
            opaque = v_both(opaque, p.opaque);                                                                         \
        }                                                                                                              \
        return v_every(opaque);                                                                                        \
    }                                                                                                                  \
    static __attribute__((noinline)) void hard_##NAME(const pupil_row_job *job, const void *source,                    \
                                                      const pupil_planes *planes, size_t i, size_t n, pupil_run *run)  \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        (void)planes;                                                                                                  \
        HARD_BODY(group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                        \
    }                                                                                                                  \
    static void meter_##NAME(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,     \
                             pupil_run *run)                                                                           \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        METER_BODY(sum_##NAME(at + k * (BYTES), &c, &s, &e), top_##NAME, hard_##NAME)                                  \
    }                                                                                                                  \
    static __attribute__((noinline)) int fused_##NAME(const pupil_row_job *job, const void *source, uint32_t n,        \
                                                      pupil_planes *planes, pupil_run *run)                            \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        float lum[PUPIL_BLOCK];                                                                                        \
        ints tops[PUPIL_BLOCK / (4 * PUPIL_LANES)];                                                                    \
        SCALE_BODY(                                                                                                    \
            keep_top(tops, i, top_##NAME(scale16_##NAME(at + i * (BYTES), &c, &d, i, planes, beyond, &opaque, lum))),  \
            as_it_is, group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                    \
        meter_kept(job, lum, tops, n, hard_##NAME, source, run);                                                       \
        return v_every(opaque);                                                                                        \
    }                                                                                                                  \
    static int scale_##NAME(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,            \
                            pupil_run *run)                                                                            \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        if (run)                                                                                                       \
            return fused_##NAME(job, source, n, planes, run);                                                          \
        SCALE_BODY(scale16_##NAME(at + i * (BYTES), &c, &d, i, planes, beyond, &opaque, 0), top_##NAME,                \
                   group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                       \
        return v_every(opaque);                                                                                        \
    }

#define FROM_PLANES load_planes(planes->r + i, planes->g + i, planes->b + i, &p)

INLINE void rest_planes(const pupil_planes *planes, size_t i, size_t n, group *p)
{
    float rest[3][PUPIL_LANES];
    for (uint32_t j = 0; j < PUPIL_LANES; j++) {
        rest[0][j] = j < n ? planes->r[i + j] : 0.0f;
        rest[1][j] = j < n ? planes->g[i + j] : 0.0f;
        rest[2][j] = j < n ? planes->b[i + j] : 0.0f;
    }
    load_planes(rest[0], rest[1], rest[2], p);
}

INLINE void sum_planes(const pupil_planes *planes, size_t i, const meter_constants *c, lanes *s, extremes *e)
{
    FOR_EACH_WAY(k)
    sum_vector(v_load(planes->r + i + k * WIDTH), v_load(planes->g + i + k * WIDTH), v_load(planes->b + i + k * WIDTH),
               c, &s->product[k], e);
}

static __attribute__((noinline)) void hard_planes(const pupil_row_job *job, const void *source,
                                                  const pupil_planes *planes, size_t i, size_t n, pupil_run *run)
{
    (void)source;
    HARD_BODY(FROM_PLANES, rest_planes(planes, i, n - i, &p))
}

static void meter_planes(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,
                         pupil_run *run){METER_BODY(sum_planes(planes, k, &c, &s, &e), as_it_is, hard_planes)}

/* Leaves what is not ordinary as it is: source and target are one. */
INLINE ints
    scale16_planes(pupil_planes *planes, const meter_constants *c, const scale_constants *d, size_t i, mask *beyond)
{
    group p;
    FROM_PLANES;
    luminance_of(&p, c);
    if (!v_every(v_at_most(p.top, c->bounded)))
        return p.top;
    FOR_EACH_WAY(k)
    beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, 0, 1);
    return p.top;
}

static int scale_planes(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, pupil_run *run)
{
    (void)source;
    if (run)
        meter_planes(job, source, planes, n, run);
    SCALE_BODY(scale16_planes(planes, &c, &d, i, beyond), as_it_is, FROM_PLANES, rest_planes(planes, i, n - i, &p))
    return v_every(opaque);
}

#endif
