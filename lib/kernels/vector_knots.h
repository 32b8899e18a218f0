/* lib/kernels/vector_knots.h: a curve by its knots in vectors, as scalar.c's tone_by_knots(). For planes alone: a frame
 * with such a curve has a histogram too, and loads its pixels to planes for that. */
#ifndef PUPIL_KERNELS_VECTOR_KNOTS_H
#define PUPIL_KERNELS_VECTOR_KNOTS_H

#include "vector_formats.h"

typedef struct knot_constants {
    const float *knot;
    floats scale, levels, last, level;
    int in_levels;
} knot_constants;

INLINE knot_constants knot_constants_of(const pupil_tone *curve)
{
    const float levels = (float)(int32_t)curve->levels, last = levels - 1.0f;
    return (knot_constants){.knot = curve->knot,
                            .scale = v_all(curve->knot_scale),
                            .levels = v_all(levels),
                            .last = v_all(last),
                            .level = v_all(1.0f / last),
                            .in_levels = curve->levels != 0};
}

/* A vector of any values to planes, from pixel `at` on; returns which pixels are beyond the display's gamut. */
INLINE mask scale_vector_by_knots(floats r, floats g, floats b, floats l, const scale_constants *c,
                                  const knot_constants *k, size_t at, pupil_planes *planes)
{
    const floats y = v_min(v_max(l, v_all(0.0f)), v_all(PUPIL_CEILING));
    const floats t = v_max(v_mul(k->scale, y), v_all(1.0f));
    const ints bits = v_bits(v_min(t, v_all(KNOT_LAST)));
    const floats part = v_mul(v_from_ints(v_and(bits, v_all_ints(KNOT_PART))), v_all(KNOT_UNIT));
    floats root = v_between(k->knot, v_minus(v_right(bits, KNOT_BITS), v_all_ints(KNOT_ZERO)), part);
    if (k->in_levels)
        root = v_mul(v_min(v_from_ints(v_to_ints(v_mul(root, k->levels))), k->last), k->level);
    const floats s = v_where(v_is_number(l), v_mul(k->scale, v_div(v_mul(root, root), t)));
    r = v_mul(clamp_channel(r, c), s);
    g = v_mul(clamp_channel(g, c), s);
    b = v_mul(clamp_channel(b, c), s);
    const floats grey = v_mul(y, s), limit = v_add(c->knee, v_mul(c->above_knee, grey));
    v_store(planes->r + at, r);
    v_store(planes->g + at, g);
    v_store(planes->b + at, b);
    v_store(planes->grey + at, grey);
    return v_greater(max_of_3(r, g, b), limit);
}

static void scale_planes_by_knots(const pupil_row_job *job, uint32_t n, pupil_planes *planes)
{
    const meter_constants m = meter_constants_of(job);
    const scale_constants c = scale_constants_of(job->curve);
    const knot_constants k = knot_constants_of(job->curve);
    group_list over;
    over.any = 0;
    for (uint32_t i = 0; i < n; i += PUPIL_LANES) {
        const uint8_t *source = (const uint8_t *)(planes->r + i);
        mask beyond[WAYS];
        group p;
        if (i + PUPIL_LANES <= n)
            load_group(&in_planes, source, &p);
        else
            load_rest(&in_planes, source, n - i, &p);
        luminance_of(&p, &m);
        FOR_EACH_WAY(j)
        beyond[j] = scale_vector_by_knots(p.r[j], p.g[j], p.b[j], p.l[j], &c, &k, i + (size_t)j * WIDTH, planes);
        over.any |= over.vectors[i / PUPIL_LANES] = v_group_bits(beyond);
    }
    if (over.any)
        fit_listed(&over, n, &c, job->cones, planes);
    leave_lines(planes, 0);
}

#endif
