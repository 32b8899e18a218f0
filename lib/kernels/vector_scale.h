/* lib/kernels/vector_scale.h: Reinhard by luminance in vectors, as scalar.c's tone() and gamut.h's fit_colour(); the
 * codes of pixels that are too few for a vector. */
#ifndef PUPIL_KERNELS_VECTOR_SCALE_H
#define PUPIL_KERNELS_VECTOR_SCALE_H

#include "dither.h"
#include "vector.h"

typedef struct scale_constants {
    floats scale, inverse_white_squared, gamut, knee, above_knee;
    floats faintest; /* where denormals are slow: the smallest channel that is not mapped as 0 */
} scale_constants;

INLINE scale_constants scale_constants_of(const pupil_tone *curve)
{
    scale_constants c;
    c.scale = v_all(curve->scale);
    c.inverse_white_squared = v_all(curve->inverse_white_squared);
    c.gamut = v_all(curve->gamut);
    c.knee = v_all(curve->gamut > 0.0f ? PUPIL_GAMUT_KNEE : 1.0f);
    c.above_knee = v_sub(v_all(1.0f), c.knee);
    c.faintest = v_all(0x1p-149f);
    return c;
}

INLINE floats clamp_channel(floats v, const scale_constants *c)
{
    const floats positive = DENORMALS_ARE_SLOW ? v_where(v_at_least(v, c->faintest), v) : v_max(v, v_all(0.0f));
    return v_min(positive, v_all(PUPIL_BRIGHTEST));
}

INLINE floats cube_root(floats x)
{
    const ints third = v_to_ints(v_mul(v_from_ints(v_bits(x)), v_all(ROOT_THIRD)));
    floats y = v_of_bits(v_minus(v_all_ints(ROOT_BITS), third));
    const floats c = v_mul(v_mul(v_mul(x, y), y), y);
    y = v_mul(y, v_sub(v_all(ROOT_0), v_mul(c, v_sub(v_all(ROOT_1), v_mul(v_all(ROOT_2), c)))));
    const floats root = v_mul(v_mul(x, y), y);
    return v_mul(root, v_sub(v_all(5.0f / 3.0f), v_mul(v_all(2.0f / 3.0f), v_mul(root, y))));
}

INLINE floats toward_grey(floats response, floats part)
{
    const floats p = cube_root(response), q = v_add(p, v_mul(part, v_sub(v_all(1.0f), p)));
    return v_mul(v_mul(q, q), q);
}

INLINE floats row_times(const float row[3], floats a, floats b, floats c)
{
    return v_add(v_add(v_mul(v_all(row[0]), a), v_mul(v_all(row[1]), b)), v_mul(v_all(row[2]), c));
}

/* The same where b is 1. */
INLINE floats row_times_cone(const float row[3], floats a, floats c)
{
    return v_add(v_add(v_mul(v_all(row[0]), a), v_all(row[1])), v_mul(v_all(row[2]), c));
}

/* Vectors at a time: each is a long chain of dependent instructions, and none waits for another. With an ARM board's
 * short vectors, keeping values between the steps takes more instructions. */
enum { IN_A_FIT = WIDTH > 4 ? 4 : 1 };
#if defined(__clang__)
#define FOR_EACH_FIT(k) for (int k = 0; k < IN_A_FIT; k++)
#else
#define FOR_EACH_FIT(k) _Pragma("GCC unroll 4") for (int k = 0; k < IN_A_FIT; k++)
#endif

/* gamut.h's fit_gamut, for vectors at[k] of a block, in each of which a pixel is beyond the display's gamut. Where grey
 * is white, room is 0, `most` and `part` are 1, and so is the result, except for its rounding, which `least` corrects.
 * Two of the vectors may be the same. */
INLINE void fit_gamut(const uint8_t at[IN_A_FIT], pupil_planes *planes, const scale_constants *c,
                      const pupil_cones *cones)
{
    const floats one = v_all(1.0f);
    floats most[IN_A_FIT], part[IN_A_FIT], l[IN_A_FIT], s[IN_A_FIT];
    mask over[IN_A_FIT];
    FOR_EACH_FIT(k)
    {
        const uint32_t i = WIDTH * at[k];
        const floats grey = v_load(planes->grey + i), room = v_max(v_sub(one, grey), v_all(0.0f));
        const floats largest = max_of_3(v_load(planes->r + i), v_load(planes->g + i), v_load(planes->b + i));
        const floats limit = v_add(c->knee, v_mul(c->above_knee, grey));
        const floats below = v_add(room, v_mul(c->gamut, v_sub(largest, v_mul(c->knee, room))));
        most[k] = v_min(v_add(limit, v_div(v_mul(v_sub(largest, limit), room), below)), one);
        const floats way = v_mul(most[k], v_max(v_sub(largest, grey), v_all(LEAST_DIVISOR)));
        const floats excess = v_div(v_sub(largest, most[k]), way);
        const floats dim = v_max(grey, v_all(LEAST_GREY));
        part[k] = v_min(v_mul(v_mul(v_mul(dim, dim), dim), excess), one);
        over[k] = v_greater(largest, limit);
    }
    FOR_EACH_FIT(k)
    {
        const uint32_t i = WIDTH * at[k];
        const floats r = v_max(v_load(planes->r + i), v_all(LEAST_VISIBLE)),
                     g = v_max(v_load(planes->g + i), v_all(LEAST_VISIBLE));
        const floats b = v_max(v_load(planes->b + i), v_all(LEAST_VISIBLE));
        const floats unit = v_div(one, row_times(cones->from_rgb + 3, r, g, b));
        l[k] = v_mul(row_times(cones->from_rgb, r, g, b), unit);
        s[k] = v_mul(row_times(cones->from_rgb + 6, r, g, b), unit);
    }
    FOR_EACH_FIT(k) l[k] = toward_grey(l[k], part[k]);
    FOR_EACH_FIT(k) s[k] = toward_grey(s[k], part[k]);
    FOR_EACH_FIT(k)
    {
        const uint32_t i = WIDTH * at[k];
        float *r = planes->r + i, *g = planes->g + i, *b = planes->b + i;
        const floats red = row_times_cone(cones->to_rgb, l[k], s[k]);
        const floats green = row_times_cone(cones->to_rgb + 3, l[k], s[k]);
        const floats blue = row_times_cone(cones->to_rgb + 6, l[k], s[k]);
        const floats scale = v_div(most[k], max_of_3(red, green, blue));
        const floats least = v_where(v_not(v_less(v_load(planes->grey + i), one)), one);
        v_store(r, v_select(over[k], v_max(v_mul(red, scale), least), v_load(r)));
        v_store(g, v_select(over[k], v_max(v_mul(green, scale), least), v_load(g)));
        v_store(b, v_select(over[k], v_max(v_mul(blue, scale), least), v_load(b)));
    }
}

/* --- dither, as dither.h's --- */

INLINE floats dither_vector(floats x, floats threshold, const pupil_code_width *of)
{
    const ints power = v_to_ints(v_mul(v_from_ints(v_bits(x)), v_all(of->power)));
    const floats step = v_mul(v_of_bits(v_plus(power, v_all_ints(of->offset))), v_all(of->scale));
    return v_max(v_add(x, v_mul(threshold, v_max(step, v_all(of->least)))), v_all(0.0f));
}

/* Up to the end of the last vector: planes have room. */
static void dither(uint32_t transfer, uint32_t x, uint32_t y, uint32_t n, pupil_planes *planes)
{
    const pupil_code_width of = pupil_code_widths[transfer];
    float thresholds[8 + PUPIL_LANES];
    for (uint32_t i = 0; i < 8 + PUPIL_LANES; i++)
        thresholds[i] = dither_threshold(x + i, y);
    for (uint32_t i = 0; i < n; i += WIDTH) {
        const floats t = v_load(thresholds + i % 8);
        v_store(planes->r + i, dither_vector(v_load(planes->r + i), t, &of));
        v_store(planes->g + i, dither_vector(v_load(planes->g + i), t, &of));
        v_store(planes->b + i, dither_vector(v_load(planes->b + i), t, &of));
    }
}

/* The vectors of a block that need a second pass, after the loop: a call or a mispredicted branch inside the loop would
 * cost more than the pass. 64 / WAYS bits for each vector, not all 0 if it needs one. */
typedef struct group_list {
    uint64_t vectors[PUPIL_BLOCK / PUPIL_LANES], any;
} group_list;

/* The factor of a pixel of the luminance y. */
INLINE floats tone_of(floats y, const scale_constants *c)
{
    const floats one = v_all(1.0f), u = v_mul(c->scale, y);
    return v_mul(c->scale, v_div(v_add(one, v_mul(u, c->inverse_white_squared)), v_add(one, u)));
}

/* One vector times its factors, to planes, from pixel `at` on. Returns the pixels beyond the display's gamut. */
INLINE mask store_scaled(floats r, floats g, floats b, floats y, floats s, const scale_constants *c, size_t at,
                         pupil_planes *planes)
{
    r = v_mul(r, s);
    g = v_mul(g, s);
    b = v_mul(b, s);
    const floats grey = v_mul(y, s), limit = v_add(c->knee, v_mul(c->above_knee, grey));
    v_store(planes->r + at, r);
    v_store(planes->g + at, g);
    v_store(planes->b + at, b);
    v_store(planes->grey + at, grey);
    return v_greater(max_of_3(r, g, b), limit);
}

/* One vector of the luminance l. Bounded: there is nothing to clamp. The luminances are kept in lum unless it is NULL.
 */
INLINE mask scale_vector(floats r, floats g, floats b, floats l, const scale_constants *c, size_t at,
                         pupil_planes *planes, float *lum, int bounded)
{
    if (lum)
        v_store(lum + at, l);
    if (bounded)
        return store_scaled(r, g, b, l, tone_of(l, c), c, at, planes);
    const floats y = v_min(v_max(l, v_all(0.0f)), v_all(PUPIL_CEILING));
    return store_scaled(clamp_channel(r, c), clamp_channel(g, c), clamp_channel(b, c), y,
                        v_where(v_is_number(l), tone_of(y, c)), c, at, planes);
}

/* A group with any values. */
INLINE void scale_hard(const group *p, const scale_constants *c, size_t i, pupil_planes *planes, float *lum,
                       group_list *over)
{
    mask beyond[WAYS];
    FOR_EACH_WAY(k)
    beyond[k] = scale_vector(p->r[k], p->g[k], p->b[k], p->l[k], c, i + (size_t)k * WIDTH, planes, lum, 0);
    over->any |= over->vectors[i / PUPIL_LANES] = v_group_bits(beyond);
}

static __attribute__((noinline)) void fit_listed(const group_list *over, uint32_t n, const scale_constants *c,
                                                 const pupil_cones *cones, pupil_planes *planes)
{
    uint8_t at[PUPIL_BLOCK / WIDTH + IN_A_FIT];
    uint32_t count = 0;
    for (uint32_t j = 0; j < n; j += PUPIL_LANES)
        for (uint64_t vectors = over->vectors[j / PUPIL_LANES]; vectors;) {
            const uint32_t k = (uint32_t)__builtin_ctzll(vectors) / (64 / WAYS);
            const uint8_t vector = (uint8_t)(j / WIDTH + k);
            if (IN_A_FIT == 1)
                fit_gamut(&vector, planes, c, cones);
            else
                at[count++] = vector;
            vectors &= WAYS == 1 ? 0 : ~(((UINT64_C(1) << (64 / WAYS) % 64) - 1) << k * (64 / WAYS));
        }
    for (uint32_t j = 1; count && j < IN_A_FIT; j++)
        at[count + j - 1] = at[count - 1];
    for (uint32_t j = 0; j < count; j += IN_A_FIT)
        fit_gamut(at + j, planes, c, cones);
}

/* The code of a sample, by its cell. */
INLINE uint8_t exact_code(float x, const pupil_encoder *e)
{
    const float lowest = pupil_float_of_bits(e->base_bits);
    x = x > lowest ? x : lowest;
    x = x < 1.0f ? x : 1.0f;
    const uint32_t bits = pupil_bits_of_float(x);
    return (uint8_t)((e->cell[(bits - e->base_bits) >> 16] + (bits & 0xffff)) >> 16);
}

/* The codes of pixels i to n, which are too few for a vector. */
INLINE void store_rest(const float *first, const float *second, const float *third, uint32_t i, uint32_t n,
                       const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    for (; i < n; i++) {
        uint8_t *at = target + (size_t)i * bytes;
        at[0] = exact_code(first[i], e);
        at[1] = exact_code(second[i], e);
        at[2] = exact_code(third[i], e);
        if (bytes == 4)
            at[3] = 255;
    }
}

#endif
