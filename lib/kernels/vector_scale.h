/* lib/kernels/vector_scale.h: Reinhard by luminance in vectors, as scalar.c's tone() and fit_gamut(); the codes of
 * pixels that are too few for a vector. */
#ifndef PUPIL_KERNELS_VECTOR_SCALE_H
#define PUPIL_KERNELS_VECTOR_SCALE_H

#include "vector.h"

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

/* One vector to planes, from pixel `at` on. Bounded: there is nothing to clamp. The luminances are kept in lum unless
 * it is NULL. */
INLINE mask scale_vector(floats r, floats g, floats b, floats l, const scale_constants *c, size_t at,
                         pupil_planes *planes, float *lum, int bounded)
{
    const floats one = v_all(1.0f);
    if (lum)
        v_store(lum + at, l);
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
    beyond[k] = scale_vector(p->r[k], p->g[k], p->b[k], p->l[k], c, i + (size_t)k * WIDTH, planes, 0, 0);
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
