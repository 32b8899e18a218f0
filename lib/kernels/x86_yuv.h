/* lib/kernels/x86_yuv.h: Y'CbCr of 8 bits to light, for the levels of x86. The same results as groups_of_yuv of
 * pixels_to_linear.h, in another order. No code is clamped: the table has entries for all codes that there can be.
 *
 * Most of the time goes to three look-ups a pixel: 8 of them are 27 instructions, of which the CPU can do 6 a cycle.
 * Look-ups wait for the codes of the same pixels, and the instructions that a CPU has in flight are not much more than
 * 16 pixels' worth. So the codes of a group of 16 pixels are computed between the look-ups of the group before,
 * channel by channel, and overwrite that group's. Indices go through memory: taking them out of a vector's lanes
 * would use the units that the arithmetic needs.
 */
#ifndef PUPIL_KERNELS_X86_YUV_H
#define PUPIL_KERNELS_X86_YUV_H

#include "kernels.h"
#include "vector.h"

#define LEVEL_HAS_GROUPS_OF_YUV_BEYOND

typedef struct yuv_factors {
    const float *light;
    floats y_zero, y_unit, red_v, green_u, green_v, blue_u;
} yuv_factors;

INLINE yuv_factors yuv_factors_of(const pupil_coder *c)
{
    return (yuv_factors){.light = c->light[0],
                         .y_zero = v_all(c->y_zero),
                         .y_unit = v_all(c->y_unit),
                         .red_v = v_all(c->red_v * CHROMA_UNIT),
                         .green_u = v_all(c->green_u * CHROMA_UNIT),
                         .green_v = v_all(c->green_v * CHROMA_UNIT),
                         .blue_u = v_all(c->blue_u * CHROMA_UNIT)};
}

/* Splits a vector of codes into the table entries below them, and the rests. */
INLINE void part_codes(floats code, int32_t *index, float *rest)
{
    const floats below = v_floor(code);
    v_store_ints(index, v_to_ints(below));
    v_store(rest, v_sub(code, below));
}

/* The light of 16 pixels, which overwrites their rests. */
INLINE void look_up_parts(const float *light, const int32_t *index, float *rest)
{
    for (int i = 0; i < PUPIL_LANES; i += 8) {
        int64_t two[4];
        __m256 part[2];
        __builtin_memcpy(two, index + i, sizeof two);
        parts_of_pairs(light, 2, two, part);
        _mm256_storeu_ps(rest + i, _mm256_add_ps(part[0], _mm256_mul_ps(_mm256_loadu_ps(rest + i), part[1])));
    }
}

/* Samples of a row: luma, and pairs of Cb and Cr; or all of them in `luma`, packed as YUYV or UYVY. */
typedef struct yuv_row {
    const uint8_t *luma, *chroma;
    int packed;
    int32_t luma_at; /* of v_of_packed */
} yuv_row;

INLINE void load_yuv_samples(const yuv_row *row, size_t i, floats y[WAYS], floats u[WAYS], floats v[WAYS])
{
    if (row->packed) {
        v_of_packed(row->luma + 2 * i, row->luma_at, y, u, v);
    } else {
        v_of_bytes(row->luma + i, y);
        v_of_chroma(row->chroma + i, u, v);
    }
}

/* The light of the group before pixel i (`end`), to `old`, and the codes of the group at i (`begin`), to `new`. */
INLINE void step_of_yuv(const yuv_factors *f, const yuv_row *row, size_t i, int begin, int end,
                        int32_t index[3][PUPIL_LANES], pupil_planes *new, pupil_planes *old)
{
    floats y[WAYS], u[WAYS], v[WAYS];
    if (begin) {
        load_yuv_samples(row, i, y, u, v);
        FOR_EACH_WAY(k) y[k] = v_mul(v_sub(y[k], f->y_zero), f->y_unit);
    }
    if (end)
        look_up_parts(f->light, index[0], old->r);
    FOR_EACH_WAY(k)
    {
        const size_t w = (size_t)k * WIDTH;
        if (begin)
            part_codes(v_add(y[k], v_mul(f->red_v, v[k])), index[0] + w, new->r + w);
    }
    if (end)
        look_up_parts(f->light, index[1], old->g);
    FOR_EACH_WAY(k)
    {
        const size_t w = (size_t)k * WIDTH;
        if (begin)
            part_codes(v_add(v_add(y[k], v_mul(f->green_u, u[k])), v_mul(f->green_v, v[k])), index[1] + w, new->g + w);
    }
    if (end)
        look_up_parts(f->light, index[2], old->b);
    FOR_EACH_WAY(k)
    {
        const size_t w = (size_t)k * WIDTH;
        if (begin)
            part_codes(v_add(y[k], v_mul(f->blue_u, u[k])), index[2] + w, new->b + w);
    }
}

/* Whole groups of 16 pixels; returns the first pixel that is left. */
INLINE uint32_t groups_of_row(const pupil_coder *c, const yuv_row *row, uint32_t n, pupil_planes *p)
{
    const yuv_factors f = yuv_factors_of(c);
    const size_t whole = n - n % PUPIL_LANES;
    int32_t index[3][PUPIL_LANES];
    if (!whole)
        return 0;
    step_of_yuv(&f, row, 0, 1, 0, index, p, 0);
    for (size_t i = PUPIL_LANES; i < whole; i += PUPIL_LANES) {
        pupil_planes *old = planes_from(p, i - PUPIL_LANES);
        step_of_yuv(&f, row, i, 1, 1, index, planes_at(old, PUPIL_LANES), old);
    }
    step_of_yuv(&f, row, whole, 0, 1, index, 0, planes_from(p, whole - PUPIL_LANES));
    return (uint32_t)whole;
}

static uint32_t groups_of_yuv_beyond(const pupil_coder *c, const uint8_t *luma, const uint8_t *chroma, uint32_t n,
                                     pupil_planes *p)
{
    const yuv_row row = {.luma = luma, .chroma = chroma};
    return groups_of_row(c, &row, n, p);
}

static uint32_t groups_of_packed_yuv(const pupil_coder *c, const uint8_t *source, uint32_t luma_at, uint32_t n,
                                     pupil_planes *p)
{
    const yuv_row row = {.luma = source, .packed = 1, .luma_at = (int32_t)luma_at};
    return groups_of_row(c, &row, n, p);
}

#endif
