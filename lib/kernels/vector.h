/* lib/kernels/vector.h: the kernels of a level with vectors, written once. A level's file includes its own header
 * (avx2.h, avx512.h, neon.h: WIDTH, the types floats, ints and mask, and the v_ functions), then this one, which makes
 *
 *     meter_FORMAT, scale_FORMAT       for each format in VECTOR_FORMATS, and for planes
 *     store_rgba8, store_bgrx8, ...    where the level has VECTOR_STORE
 *
 * Pixels go by groups of 16: WAYS vectors, one or more for each lane of a run. What is left of a run goes through the
 * scalar level. The operations of a pixel are those of scalar.c, one by one, so that the bits are the same.
 */
#include "kernels.h"

#include "../core/numeric.h"

#define WAYS (PUPIL_LANES / WIDTH)
/* gcc -O2 wants to be told, so that what a loop carries stays in registers; clang does so by itself. */
#if defined(__clang__)
#define FOR_EACH_WAY(k) for (int k = 0; k < WAYS; k++)
#else
#define FOR_EACH_WAY(k) _Pragma("GCC unroll 4") for (int k = 0; k < WAYS; k++)
#endif

typedef struct group { /* 16 pixels */
    floats r[WAYS], g[WAYS], b[WAYS], a[WAYS], l[WAYS];
} group;

typedef struct lanes {
    floats product[WAYS];
    ints exponent[WAYS];
} lanes;

typedef struct meter_constants {
    floats weight[3], floor, clip, near_clip, ceiling;
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
    c.near_clip = v_all(job->clip < 0x1p126f ? job->clip : 0x1p126f);
    return c;
}

INLINE lanes lanes_of(const pupil_run *run)
{
    lanes s;
    FOR_EACH_WAY(k)
    {
        s.product[k] = v_load(run->product + k * WIDTH);
        s.exponent[k] = v_load_ints(run->exponent + k * WIDTH);
    }
    return s;
}

INLINE void lanes_to(const lanes *s, pupil_run *run)
{
    FOR_EACH_WAY(k)
    {
        v_store(run->product + k * WIDTH, s->product[k]);
        v_store_ints(run->exponent + k * WIDTH, s->exponent[k]);
    }
}

INLINE void luminance_of(group *p, const meter_constants *c)
{
    FOR_EACH_WAY(k)
    p->l[k] = v_add(v_add(v_mul(c->weight[0], p->r[k]), v_mul(c->weight[1], p->g[k])), v_mul(c->weight[2], p->b[k]));
}

INLINE uint32_t bits_set(uint32_t bits)
{
    return (uint32_t)__builtin_popcount(bits);
}

/* Of the pixels in `valid` (a bit each). An L above the floor, and no channel near the clip: nothing to count, as
 * almost everywhere. A NaN and a negative infinity make an L that is not above the floor, and a positive infinity is
 * beyond every clip. */
INLINE void count_of(const group *p, const meter_constants *c, uint32_t valid, pupil_run *run)
{
    mask light[WAYS];
    floats top[WAYS];
    uint32_t nothing = 0;
    FOR_EACH_WAY(k)
    {
        top[k] = max_of_3(p->r[k], p->g[k], p->b[k]);
        light[k] = v_greater(p->l[k], c->floor);
        nothing |= v_mask_bits(v_both(light[k], v_less(top[k], c->near_clip))) << k * WIDTH;
    }
    if ((nothing & valid) == valid)
        return;
    FOR_EACH_WAY(k)
    {
        const uint32_t here = valid >> k * WIDTH & ((1u << WIDTH) - 1);
        const uint32_t finite = v_mask_bits(
            v_both(v_less(p->l[k], v_all((float)__builtin_inf())), v_greater(p->l[k], v_all(-(float)__builtin_inf()))));
        run->bad += bits_set(~finite & here);
        run->black += bits_set(finite & ~v_mask_bits(light[k]) & here);
        run->clipped += bits_set(finite & ~v_mask_bits(v_less(top[k], c->clip)) & here);
    }
}

INLINE void meter_group(const group *p, const meter_constants *c, lanes *s)
{
    FOR_EACH_WAY(k)
    s->product[k] = v_mul(s->product[k], v_min(v_max(p->l[k], c->floor), c->ceiling));
}

INLINE void move_exponents(lanes *s)
{
    FOR_EACH_WAY(k)
    {
        const ints bits = v_bits(s->product[k]);
        s->exponent[k] = v_plus(s->exponent[k], v_minus(v_right(bits, 23), v_all_ints(127)));
        s->product[k] = v_of_bits(v_or(v_and(bits, v_all_ints(0x007fffff)), v_all_ints(0x3f800000)));
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
    if (n == WIDTH && v_none(v_not(v_equal_ints(index, v_all_ints((uint32_t)at[0]))))) {
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

/* From a loaded group to planes. */
INLINE void scale_group(const group *p, const scale_constants *c, uint32_t i, pupil_planes *planes, vector_list *over)
{
    const floats one = v_all(1.0f);
    FOR_EACH_WAY(k)
    {
        const uint32_t at = i + (uint32_t)k * WIDTH;
        const floats y = v_min(v_max(p->l[k], v_all(0.0f)), v_all(PUPIL_CEILING));
        const floats u = v_mul(c->scale, y);
        floats s = v_div(v_add(one, v_mul(u, c->inverse_white_squared)), v_add(one, u));
        s = v_where(v_is_number(p->l[k]), v_mul(c->scale, s));
        const floats r = v_mul(clamp_channel(p->r[k]), s);
        const floats g = v_mul(clamp_channel(p->g[k]), s);
        const floats b = v_mul(clamp_channel(p->b[k]), s);
        const floats grey = v_mul(y, s), limit = v_add(c->knee, v_mul(c->above_knee, grey));
        v_store(planes->r + at, r);
        v_store(planes->g + at, g);
        v_store(planes->b + at, b);
        v_store(planes->grey + at, grey);
        list_some(over, at, v_mask_bits(v_greater(max_of_3(r, g, b), limit)));
    }
}

static void fit_listed(const vector_list *over, const scale_constants *c, pupil_planes *planes)
{
    for (uint32_t j = 0; j < over->count; j++) {
        const uint32_t i = over->vector[j] * WIDTH;
        fit_gamut(planes->r + i, planes->g + i, planes->b + i, planes->grey + i, c);
    }
}

/* ---- kernels by format ---------------------------------------------------------------------------------------------
 */

/* group_NAME from LOAD(source, r, g, b, a), which loads WIDTH pixels of BYTES each. */
#define GROUP_OF_VECTORS(NAME, LOAD, BYTES)                                                                            \
    INLINE void group_##NAME(const uint8_t *source, group *p)                                                          \
    {                                                                                                                  \
        FOR_EACH_WAY(k) LOAD(source + k * WIDTH * (BYTES), &p->r[k], &p->g[k], &p->b[k], &p->a[k]);                    \
    }

/* What is left of a run, as a whole group: the bytes behind it are 0. */
#define REST_BYTES (PUPIL_LANES * 16)

static void copy_rest(uint8_t rest[REST_BYTES], const uint8_t *source, size_t bytes)
{
    for (size_t i = 0; i < REST_BYTES; i++)
        rest[i] = i < bytes ? source[i] : 0;
}

/* Pixels that are not there count as L = 1, which changes no product, and as opaque. */
INLINE void only_first(group *p, uint32_t n)
{
    static const float ramp[2 * PUPIL_LANES] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    FOR_EACH_WAY(k)
    {
        const mask there = v_greater(v_load(ramp + PUPIL_LANES - n + k * WIDTH), v_all(0.0f));
        p->l[k] = v_select(there, p->l[k], v_all(1.0f));
        p->a[k] = v_select(there, p->a[k], v_all(1.0f));
    }
}

INLINE void load_planes(const float *r, const float *g, const float *b, group *p)
{
    FOR_EACH_WAY(k)
    {
        p->r[k] = v_load(r + k * WIDTH);
        p->g[k] = v_load(g + k * WIDTH);
        p->b[k] = v_load(b + k * WIDTH);
        p->a[k] = v_all(0.0f); /* of alpha nothing is known */
    }
}

INLINE void store_planes(const group *p, uint32_t i, pupil_planes *planes)
{
    FOR_EACH_WAY(k)
    {
        v_store(planes->r + i + k * WIDTH, p->r[k]);
        v_store(planes->g + i + k * WIDTH, p->g[k]);
        v_store(planes->b + i + k * WIDTH, p->b[k]);
    }
}

INLINE void meter_loaded(group *p, const meter_constants *c, lanes *s, uint32_t i, pupil_run *run)
{
    luminance_of(p, c);
    count_of(p, c, 0xffff, run);
    meter_group(p, c, s);
    if ((i & 3 * PUPIL_LANES) == 3 * PUPIL_LANES)
        move_exponents(s);
}

/* The last n pixels; alone with its exponents, because up to four factors may already be in the products. */
INLINE void meter_rest(group *p, const meter_constants *c, lanes *s, uint32_t n, pupil_run *run)
{
    luminance_of(p, c);
    only_first(p, n);
    count_of(p, c, (1u << n) - 1, run);
    meter_group(p, c, s);
}

/* LOAD(i) fills the group p with the pixels from i on, LOAD_REST with those that are left. */
#define METER_BODY(LOAD, LOAD_REST)                                                                                    \
    const meter_constants c = meter_constants_of(job);                                                                 \
    lanes s = lanes_of(run);                                                                                           \
    uint32_t i = 0;                                                                                                    \
    group p;                                                                                                           \
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {                                                                   \
        LOAD;                                                                                                          \
        meter_loaded(&p, &c, &s, i, run);                                                                              \
    }                                                                                                                  \
    move_exponents(&s);                                                                                                \
    if (i < n) {                                                                                                       \
        LOAD_REST;                                                                                                     \
        meter_rest(&p, &c, &s, n - i, run);                                                                            \
        move_exponents(&s);                                                                                            \
    }                                                                                                                  \
    lanes_to(&s, run);

#define SCALE_BODY(LOAD, LOAD_REST)                                                                                    \
    const meter_constants c = meter_constants_of(job);                                                                 \
    const scale_constants d = scale_constants_of(job->curve);                                                          \
    const floats one = v_all(1.0f);                                                                                    \
    vector_list over = {.count = 0};                                                                                   \
    mask opaque = v_at_least(one, one);                                                                                \
    uint32_t i = 0;                                                                                                    \
    group p;                                                                                                           \
    if (run) {                                                                                                         \
        lanes s = lanes_of(run);                                                                                       \
        for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {                                                               \
            LOAD;                                                                                                      \
            meter_loaded(&p, &c, &s, i, run);                                                                          \
            scale_group(&p, &d, i, planes, &over);                                                                     \
            FOR_EACH_WAY(k) opaque = v_both(opaque, v_at_least(p.a[k], one));                                          \
        }                                                                                                              \
        move_exponents(&s);                                                                                            \
        if (i < n) {                                                                                                   \
            LOAD_REST;                                                                                                 \
            meter_rest(&p, &c, &s, n - i, run);                                                                        \
            move_exponents(&s);                                                                                        \
            scale_group(&p, &d, i, planes, &over);                                                                     \
            FOR_EACH_WAY(k)                                                                                            \
            opaque = v_both(opaque, v_at_least(p.a[k], one));                                                          \
        }                                                                                                              \
        lanes_to(&s, run);                                                                                             \
    } else {                                                                                                           \
        for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {                                                               \
            LOAD;                                                                                                      \
            luminance_of(&p, &c);                                                                                      \
            scale_group(&p, &d, i, planes, &over);                                                                     \
            FOR_EACH_WAY(k) opaque = v_both(opaque, v_at_least(p.a[k], one));                                          \
        }                                                                                                              \
        if (i < n) {                                                                                                   \
            LOAD_REST;                                                                                                 \
            luminance_of(&p, &c);                                                                                      \
            only_first(&p, n - i);                                                                                     \
            scale_group(&p, &d, i, planes, &over);                                                                     \
            FOR_EACH_WAY(k)                                                                                            \
            opaque = v_both(opaque, v_at_least(p.a[k], one));                                                          \
        }                                                                                                              \
    }                                                                                                                  \
    fit_listed(&over, &d, planes);                                                                                     \
    return v_none(v_not(opaque));

/* From group_NAME(source, group), which loads 16 pixels of BYTES each. */
#define FORMAT_KERNELS(NAME, BYTES)                                                                                    \
    INLINE void rest_##NAME(const uint8_t *source, uint32_t n, group *p)                                               \
    {                                                                                                                  \
        uint8_t rest[REST_BYTES];                                                                                      \
        copy_rest(rest, source, n *(BYTES));                                                                           \
        group_##NAME(rest, p);                                                                                         \
    }                                                                                                                  \
    static int load_##NAME(const void *source, uint32_t n, pupil_planes *planes)                                       \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        mask opaque = v_at_least(v_all(1.0f), v_all(1.0f));                                                            \
        for (uint32_t i = 0; i < n; i += PUPIL_LANES) {                                                                \
            group p;                                                                                                   \
            if (i + PUPIL_LANES <= n)                                                                                  \
                group_##NAME(at + i * (BYTES), &p);                                                                    \
            else                                                                                                       \
                rest_##NAME(at + i * (BYTES), n - i, &p);                                                              \
            store_planes(&p, i, planes);                                                                               \
            FOR_EACH_WAY(k) opaque = v_both(opaque, v_at_least(p.a[k], v_all(1.0f)));                                  \
        }                                                                                                              \
        return v_none(v_not(opaque));                                                                                  \
    }                                                                                                                  \
    static void meter_##NAME(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,     \
                             pupil_run *run)                                                                           \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        (void)planes;                                                                                                  \
        METER_BODY(group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                       \
    }                                                                                                                  \
    static int scale_##NAME(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,            \
                            pupil_run *run)                                                                            \
    {                                                                                                                  \
        const uint8_t *at = source;                                                                                    \
        SCALE_BODY(group_##NAME(at + i * (BYTES), &p), rest_##NAME(at + i * (BYTES), n - i, &p))                       \
    }

#define FROM_PLANES load_planes(planes->r + i, planes->g + i, planes->b + i, &p)

INLINE void rest_planes(const pupil_planes *planes, uint32_t i, uint32_t n, group *p)
{
    float rest[3][PUPIL_LANES];
    for (uint32_t j = 0; j < PUPIL_LANES; j++) {
        rest[0][j] = j < n ? planes->r[i + j] : 0.0f;
        rest[1][j] = j < n ? planes->g[i + j] : 0.0f;
        rest[2][j] = j < n ? planes->b[i + j] : 0.0f;
    }
    load_planes(rest[0], rest[1], rest[2], p);
}

static void meter_planes(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,
                         pupil_run *run)
{
    (void)source;
    METER_BODY(FROM_PLANES, rest_planes(planes, i, n - i, &p))
}

static int scale_planes(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, pupil_run *run)
{
    (void)source;
    SCALE_BODY(FROM_PLANES, rest_planes(planes, i, n - i, &p))
}
