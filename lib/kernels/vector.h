/* lib/kernels/vector.h: the kernels of a level with vectors, written once. A level's file includes its own header
 * (avx2.h, avx512.h, neon.h: WIDTH, the types floats, ints and mask, and the v_ functions), then this one, which makes
 *
 *     meter_FORMAT, scale_FORMAT       for each format in VECTOR_FORMATS, and for planes
 *     store_rgba8, store_bgrx8, ...    where the level has VECTOR_STORE
 *
 * Pixels go by groups of 16: WAYS vectors, one or more for each lane of a run. What is left of a run goes through the
 * scalar level. The operations of a pixel are those of scalar.c, one by one, so that the bits are the same.
 */
#ifndef PUPIL_KERNELS_VECTOR_H
#define PUPIL_KERNELS_VECTOR_H

#include "kernels.h"

#include "../core/numeric.h"

#define WAYS (PUPIL_LANES / WIDTH)
/* gcc -O2 wants to be told, so that what a loop carries stays in registers; clang does so by itself. */
#if defined(__clang__)
#define FOR_EACH_WAY(k) for (int k = 0; k < WAYS; k++)
#define FOR_FOUR(k)     for (int k = 0; k < 4; k++)
#else
#define FOR_FOUR(k)     _Pragma("GCC unroll 4") for (int k = 0; k < 4; k++)
#define FOR_EACH_WAY(k) _Pragma("GCC unroll 4") for (int k = 0; k < WAYS; k++)
#endif

typedef struct group { /* 16 pixels */
    floats r[WAYS], g[WAYS], b[WAYS], l[WAYS];
    ints top;    /* the largest bits, as unsigned numbers, of any channel are those of one of these */
    mask opaque; /* all true: every alpha is at least 1 */
} group;

typedef struct lanes {
    floats product[WAYS];
} lanes;

/* Bits of a float that are at most a limit, as unsigned numbers, are a float that is not negative, not NaN, and at most
 * the limit. Pixels whose channels are all so need not be clamped, or counted one by one: almost all are. */
typedef struct meter_constants {
    floats weight[3], floor, clip, ceiling;
    ints bounded;  /* no luminance above PUPIL_CEILING comes from these */
    ints ordinary; /* and below the clip */
} meter_constants;

INLINE floats max_of_3(floats a, floats b, floats c)
{
    return v_max(v_max(a, b), c);
}

/* ---- meter ---------------------------------------------------------------------------------------------------------
 */

INLINE meter_constants meter_constants_of(const pupil_row_job *job)
{
    meter_constants c;
    for (int i = 0; i < 3; i++)
        c.weight[i] = v_all(job->luma[i]);
    c.floor = v_all(job->floor);
    c.clip = v_all(job->clip);
    c.ceiling = v_all(PUPIL_CEILING);
    /* The weights' sum is 1. A primary beyond all colours has a negative one: then no channel but 0 is bounded. */
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

/* Of 64 pixels, to see once whether there is anything to clamp or to count in them. */
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

/* The first n pixels, whatever they are. */
INLINE void meter_hard(const group *p, const meter_constants *c, lanes *s, uint32_t n, pupil_run *run)
{
    count_of(p, c, n, run);
    FOR_EACH_WAY(k)
    {
        const floats factor = v_min(v_max(p->l[k], c->floor), c->ceiling);
        s->product[k] = v_mul(s->product[k], n < PUPIL_LANES ? v_select(first_of(n, k), factor, v_all(1.0f)) : factor);
    }
}

/* And all of s goes to the run. */
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

/* ---- histogram, as scalar.c's
 * ---------------------------------------------------------------------------------------- */

#define FIRST_STOP (127 + PUPIL_HISTOGRAM_MIN_EV)

/* In smooth parts of a picture a whole vector falls into one bin. */
INLINE void add_bins(uint64_t *bin, ints index, uint32_t n, uint32_t weight)
{
    int32_t at[WIDTH];
    v_store_ints(at, index);
    if (n == WIDTH && v_every(v_equal_ints(index, v_all_ints((uint32_t)at[0])))) {
        bin[at[0]] += WIDTH * weight;
        return;
    }
    for (uint32_t j = 0; j < n; j++)
        bin[at[j]] += weight;
}

static void histogram(const pupil_row_job *job, const pupil_planes *planes, uint32_t n, uint32_t weight,
                      pupil_stats *stats)
{
    const meter_constants c = meter_constants_of(job);
    floats peak = v_all(stats->peak);
    for (uint32_t i = 0; i < n; i += WIDTH) {
        const uint32_t m = n - i < WIDTH ? n - i : WIDTH;
        float rest[3][WIDTH];
        const float *r_at = planes->r + i, *g_at = planes->g + i, *b_at = planes->b + i;
        if (m < WIDTH) { /* repeats its first pixel, so that the peak does not change */
            for (uint32_t j = 0; j < WIDTH; j++) {
                rest[0][j] = r_at[j < m ? j : 0];
                rest[1][j] = g_at[j < m ? j : 0];
                rest[2][j] = b_at[j < m ? j : 0];
            }
            r_at = rest[0], g_at = rest[1], b_at = rest[2];
        }
        const floats r = v_load(r_at), g = v_load(g_at), b = v_load(b_at);
        const floats l = v_add(v_add(v_mul(c.weight[0], r), v_mul(c.weight[1], g)), v_mul(c.weight[2], b));
        const floats largest = v_select(v_is_number(l), max_of_3(r, g, b), c.floor);
        const floats brightest = v_min(v_max(largest, c.floor), c.ceiling);
        const ints bits = v_bits(v_min(v_max(l, c.floor), c.ceiling));
        peak = v_max(brightest, peak);
        add_bins(stats->bin, v_minus(v_right(bits, 20), v_all_ints(FIRST_STOP * PUPIL_HISTOGRAM_BINS_PER_STOP)), m,
                 weight);
        add_bins(stats->peak_bin,
                 v_minus(v_right(v_bits(brightest), 21), v_all_ints(FIRST_STOP * PUPIL_PEAK_BINS_PER_STOP)), m, weight);
    }
    float peaks[WIDTH];
    v_store(peaks, peak);
    for (int j = 0; j < WIDTH; j++)
        stats->peak = peaks[j] > stats->peak ? peaks[j] : stats->peak;
}

/* ---- scale: Reinhard by luminance, as scalar.c's tone() and fit_gamut() --------------------------------------------
 */

typedef struct scale_constants {
    floats scale, inverse_white_squared, gamut, knee, above_knee;
    mask has_gamut;
} scale_constants;

INLINE scale_constants scale_constants_of(const pupil_curve *curve)
{
    scale_constants c;
    c.scale = v_all(curve->scale);
    c.inverse_white_squared = v_all(curve->inverse_white_squared);
    c.gamut = v_all(curve->gamut);
    c.knee = v_all(curve->gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f);
    c.above_knee = v_sub(v_all(1.0f), c.knee);
    c.has_gamut = v_greater(c.gamut, v_all(0.0f));
    return c;
}

INLINE floats clamp_channel(floats v)
{
    return v_min(v_max(v, v_all(0.0f)), v_all(PUPIL_BRIGHTEST));
}

INLINE floats fit_channel(floats v, floats grey, floats t, mask over, mask white)
{
    const floats one = v_all(1.0f);
    const floats fitted = v_add(grey, v_mul(v_sub(v, grey), t));
    return v_select(over, v_select(white, one, fitted), v);
}

/* WIDTH pixels, some of which are beyond the display's gamut. */
INLINE void fit_gamut(float *r_at, float *g_at, float *b_at, const float *grey_at, const scale_constants *c)
{
    const floats one = v_all(1.0f), r = v_load(r_at), g = v_load(g_at), b = v_load(b_at), grey = v_load(grey_at);
    const floats m = max_of_3(r, g, b), room = v_sub(one, grey);
    const mask over = v_greater(m, v_add(c->knee, v_mul(c->above_knee, grey))), white = v_not(v_less(grey, one));
    const floats x = v_div(v_sub(m, grey), room);
    const floats below = v_add(one, v_mul(c->gamut, v_sub(v_div(m, room), c->knee)));
    floats fitted = v_add(c->knee, v_div(v_sub(x, c->knee), below));
    fitted = v_select(v_both(c->has_gamut, v_less(fitted, one)), fitted, one);
    const floats t = v_div(fitted, x);
    v_store(r_at, fit_channel(r, grey, t, over, white));
    v_store(g_at, fit_channel(g, grey, t, over, white));
    v_store(b_at, fit_channel(b, grey, t, over, white));
}

/* The vectors of a block that want a second look, which they get after the loop: a call or an unforeseen branch inside
 * it would cost more than all of them. */
typedef struct vector_list {
    uint8_t vector[PUPIL_BLOCK / WIDTH + 1];
    uint16_t pixels[PUPIL_BLOCK / WIDTH + 1]; /* which ones of it, a bit each */
    uint32_t count;
} vector_list;

INLINE void list_some(vector_list *list, uint32_t i, uint32_t pixels)
{
    list->vector[list->count] = (uint8_t)(i / WIDTH);
    list->pixels[list->count] = (uint16_t)pixels;
    list->count += (uint32_t)(pixels != 0);
}

/* The same for whole groups: 64 / WAYS bits for each vector, not all 0 where it wants one. */
typedef struct group_list {
    uint64_t vectors[PUPIL_BLOCK / PUPIL_LANES], any;
} group_list;

/* One vector to planes, from pixel `at` on. Bounded: there is nothing to clamp. */
INLINE mask scale_vector(floats r, floats g, floats b, floats l, const scale_constants *c, size_t at,
                         pupil_planes *planes, int bounded)
{
    const floats one = v_all(1.0f);
    const floats y = bounded ? l : v_min(v_max(l, v_all(0.0f)), v_all(PUPIL_CEILING));
    const floats u = v_mul(c->scale, y);
    floats s = v_mul(c->scale, v_div(v_add(one, v_mul(u, c->inverse_white_squared)), v_add(one, u)));
    if (!bounded)
        s = v_where(v_is_number(l), s);
    r = v_mul(bounded ? r : clamp_channel(r), s);
    g = v_mul(bounded ? g : clamp_channel(g), s);
    b = v_mul(bounded ? b : clamp_channel(b), s);
    const floats grey = v_mul(y, s), limit = v_add(c->knee, v_mul(c->above_knee, grey));
    v_store(planes->r + at, r);
    v_store(planes->g + at, g);
    v_store(planes->b + at, b);
    v_store(planes->grey + at, grey);
    return v_greater(max_of_3(r, g, b), limit);
}

/* A group that may hold anything. Not inline: what is rare must not take registers from what is not. */
static __attribute__((noinline)) void scale_hard(const group *p, const scale_constants *c, size_t i,
                                                 pupil_planes *planes, group_list *over)
{
    mask beyond[WAYS];
    FOR_EACH_WAY(k)
    beyond[k] = scale_vector(p->r[k], p->g[k], p->b[k], p->l[k], c, i + (size_t)k * WIDTH, planes, 0);
    over->any |= over->vectors[i / PUPIL_LANES] = v_group_bits(beyond);
}

static void fit_listed(const group_list *over, uint32_t n, const scale_constants *c, pupil_planes *planes)
{
    for (uint32_t j = 0; j < n; j += PUPIL_LANES)
        for (uint64_t vectors = over->vectors[j / PUPIL_LANES]; vectors;) {
            const uint32_t k = (uint32_t)__builtin_ctzll(vectors) / (64 / WAYS), i = j + k * WIDTH;
            fit_gamut(planes->r + i, planes->g + i, planes->b + i, planes->grey + i, c);
            vectors &= WAYS == 1 ? 0 : ~(((UINT64_C(1) << (64 / WAYS) % 64) - 1) << k * (64 / WAYS));
        }
}

/* ---- kernels by format ---------------------------------------------------------------------------------------------
 */

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
                               pupil_planes *planes, mask *beyond, mask *opaque)                                       \
    {                                                                                                                  \
        ints top = v_all_ints(0);                                                                                      \
        FOR_EACH_WAY(k)                                                                                                \
        {                                                                                                              \
            floats r, g, b, a;                                                                                         \
            LOAD(source + k * WIDTH * (BYTES), &r, &g, &b, &a);                                                        \
            *opaque = v_both(*opaque, v_at_least(a, v_all(1.0f)));                                                     \
            top = v_max_unsigned(top, v_max_unsigned(v_max_unsigned(v_bits(r), v_bits(g)), v_bits(b)));                \
            beyond[k] = scale_vector(r, g, b, luminance(r, g, b, c), d, i + (size_t)k * WIDTH, planes, 1);             \
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
                               pupil_planes *planes, mask *beyond, mask *opaque)                                       \
    {                                                                                                                  \
        group p;                                                                                                       \
        group_##NAME(source, &p);                                                                                      \
        luminance_of(&p, c);                                                                                           \
        *opaque = v_both(*opaque, p.opaque);                                                                           \
        FOR_EACH_WAY(k)                                                                                                \
        beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, 1);                 \
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
        if (__builtin_expect(v_every(v_at_most(TOP(SCALE16), c.bounded)), 1)) {                                        \
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
        fit_listed(&over, n, &d, planes);                                                                              \
    return v_every(opaque);

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
    static int scale_##NAME(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,            \
                            pupil_run *run)                                                                            \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        if (run)                                                                                                       \
            meter_##NAME(job, source, planes, n, run);                                                                 \
        SCALE_BODY(scale16_##NAME(at + i * (BYTES), &c, &d, i, planes, beyond, &opaque), top_##NAME,                   \
                   group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                       \
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
    beyond[k] = scale_vector(p.r[k], p.g[k], p.b[k], p.l[k], d, i + (size_t)k * WIDTH, planes, 1);
    return p.top;
}

static int scale_planes(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, pupil_run *run)
{
    (void)source;
    if (run)
        meter_planes(job, source, planes, n, run);
    SCALE_BODY(scale16_planes(planes, &c, &d, i, beyond), as_it_is, FROM_PLANES, rest_planes(planes, i, n - i, &p))
}

#endif
