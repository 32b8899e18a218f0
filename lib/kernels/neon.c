/* The NEON level of AArch64, which every such CPU has. Codes are looked up in the encoder's cells: with loads of single
 * lanes as cheap as here that is faster than arithmetic. */
#if defined(__aarch64__)

#include "neon.h"
#include "vector.h"

GROUP_OF_VECTORS(rgba32f, load4_rgba32f, 16)
GROUP_OF_VECTORS(rgb32f, load4_rgb32f, 12)

#define GROUP_OF_EIGHTS(NAME, LOAD, BYTES)                                                                             \
    INLINE void group_##NAME(const uint8_t *source, group *p)                                                          \
    {                                                                                                                  \
        LOAD(source, p->r, p->g, p->b, p->a);                                                                          \
        LOAD(source + 8 * (BYTES), p->r + 2, p->g + 2, p->b + 2, p->a + 2);                                            \
    }

GROUP_OF_EIGHTS(rgba16f, load8_rgba16f, 8)
GROUP_OF_EIGHTS(rgba16, load8_rgba16, 8)
GROUP_OF_EIGHTS(rgb16, load8_rgb16, 6)

FORMAT_KERNELS(rgba32f, 16)
FORMAT_KERNELS(rgb32f, 12)
FORMAT_KERNELS(rgba16f, 8)
FORMAT_KERNELS(rgba16, 8)
FORMAT_KERNELS(rgb16, 6)

/* ---- store ----------------------------------------------------------------------------------------------------------
 */

/* The codes of four samples, in their words' third byte. */
INLINE ints codes_of(floats x, const uint32_t *cell, floats lowest)
{
    const ints bits = v_bits(v_min(v_max(x, lowest), v_all(1.0f)));
    const ints at = v_right(v_minus(bits, v_bits(lowest)), 16);
    ints c = vdupq_n_u32(cell[vgetq_lane_u32(at, 0)]);
    c = vld1q_lane_u32(cell + vgetq_lane_u32(at, 1), c, 1);
    c = vld1q_lane_u32(cell + vgetq_lane_u32(at, 2), c, 2);
    c = vld1q_lane_u32(cell + vgetq_lane_u32(at, 3), c, 3);
    return v_plus(c, v_and(bits, v_all_ints(0xffff)));
}

/* Of sixteen samples. */
INLINE uint8x16_t bytes_of(const float *x, const uint32_t *cell, floats lowest)
{
    const ints a = codes_of(v_load(x), cell, lowest), b = codes_of(v_load(x + 4), cell, lowest);
    const ints c = codes_of(v_load(x + 8), cell, lowest), d = codes_of(v_load(x + 12), cell, lowest);
    /* the upper halves of the words, which are the codes; then their lower bytes */
    const uint16x8_t low = vuzp2q_u16(vreinterpretq_u16_u32(a), vreinterpretq_u16_u32(b));
    const uint16x8_t high = vuzp2q_u16(vreinterpretq_u16_u32(c), vreinterpretq_u16_u32(d));
    return vuzp1q_u8(vreinterpretq_u8_u16(low), vreinterpretq_u8_u16(high));
}

INLINE uint8_t code_of(float x, const pupil_encoder *e)
{
    const float lowest = pupil_float_of_bits(e->base_bits);
    x = x > lowest ? x : lowest;
    x = x < 1.0f ? x : 1.0f;
    const uint32_t bits = pupil_bits_of_float(x);
    return (uint8_t)((e->cell[(bits - e->base_bits) >> 16] + (bits & 0xffff)) >> 16);
}

INLINE void store_vectors(const float *first, const float *second, const float *third, uint32_t n,
                          const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    const floats lowest = v_of_bits(v_all_ints(e->base_bits));
    uint32_t i = 0;
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {
        const uint8x16_t x = bytes_of(first + i, e->cell, lowest), y = bytes_of(second + i, e->cell, lowest);
        const uint8x16_t z = bytes_of(third + i, e->cell, lowest);
        if (bytes == 4)
            vst4q_u8(target + (size_t)i * 4, ((uint8x16x4_t){{x, y, z, vdupq_n_u8(255)}}));
        else
            vst3q_u8(target + (size_t)i * 3, ((uint8x16x3_t){{x, y, z}}));
    }
    for (; i < n; i++) {
        uint8_t *at = target + (size_t)i * bytes;
        at[0] = code_of(first[i], e);
        at[1] = code_of(second[i], e);
        at[2] = code_of(third[i], e);
        if (bytes == 4)
            at[3] = 255;
    }
}

static void store_rgba8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->r, p->g, p->b, n, e, target, 4);
}

static void store_bgrx8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->b, p->g, p->r, n, e, target, 4);
}

static void store_rgb8(const pupil_planes *p, uint32_t n, const pupil_encoder *e, void *target)
{
    store_vectors(p->r, p->g, p->b, n, e, target, 3);
}

const pupil_kernels pupil_kernels_neon = {
    .load =
        {
            [PUPIL_PIXEL_RGBA32F] = load_rgba32f,
            [PUPIL_PIXEL_RGB32F] = load_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = load_rgba16f,
            [PUPIL_PIXEL_RGBA16] = load_rgba16,
            [PUPIL_PIXEL_RGB16] = load_rgb16,
        },
    .meter =
        {
            [PUPIL_PLANES] = meter_planes,
            [PUPIL_PIXEL_RGBA32F] = meter_rgba32f,
            [PUPIL_PIXEL_RGB32F] = meter_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = meter_rgba16f,
            [PUPIL_PIXEL_RGBA16] = meter_rgba16,
            [PUPIL_PIXEL_RGB16] = meter_rgb16,
        },
    .scale =
        {
            [PUPIL_PLANES] = scale_planes,
            [PUPIL_PIXEL_RGBA32F] = scale_rgba32f,
            [PUPIL_PIXEL_RGB32F] = scale_rgb32f,
            [PUPIL_PIXEL_RGBA16F] = scale_rgba16f,
            [PUPIL_PIXEL_RGBA16] = scale_rgba16,
            [PUPIL_PIXEL_RGB16] = scale_rgb16,
        },
    .histogram = histogram,
    .store =
        {
            [PUPIL_PIXEL_RGBA8] = store_rgba8,
            [PUPIL_PIXEL_RGB8] = store_rgb8,
            [PUPIL_PIXEL_BGRX8] = store_bgrx8,
        },
};

#else
typedef int pupil_no_neon; /* a file of C needs something */
#endif
