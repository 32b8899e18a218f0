/* The NEON level of AArch64, which every such CPU has. Codes are looked up in the encoder's cells: loads of single
 * lanes are so cheap here that this is faster than arithmetic. */
#if defined(__aarch64__)

#include "neon.h"
#include "vector_formats.h"

#if defined(__clang__)
#define FOR_TWO(i) for (int i = 0; i < 2; i++)
#else
#define FOR_TWO(i) _Pragma("GCC unroll 2") for (int i = 0; i < 2; i++)
#endif

static const format rgba32f = {.bytes = 16, .vector = load4_rgba32f};
static const format rgb32f = {.bytes = 12, .vector = load4_rgb32f};

/* --- formats of 16 bits, eight pixels at a time --- */

/* As 16-bit numbers, halves have the order that floats have as 32-bit numbers: the largest is found before they are
 * widened. */
INLINE ints top_halves(ints top)
{
    const uint16x8_t t = vreinterpretq_u16_u32(top);
    return v_bits(vcvt_f32_f16(vreinterpret_f16_u16(vmax_u16(vget_low_u16(t), vget_high_u16(t)))));
}

INLINE ints top_sixteens(ints top)
{
    const uint16x8_t t = vreinterpretq_u16_u32(top);
    return v_bits(vmulq_n_f32(vcvtq_f32_u32(vmovl_u16(vmax_u16(vget_low_u16(t), vget_high_u16(t)))), 1.0f / 65535.0f));
}

/* How eight pixels are loaded, widened, and tested for opacity. */
typedef struct eights {
    words (*load)(const uint8_t *source, int eighth);
    void (*convert)(uint16x8_t words, floats to[2]);
    mask (*opaque)(uint16x8_t alpha);
    ints (*top)(ints top);
} eights;

INLINE void sum_eights(const eights *f, const uint8_t *source, const meter_constants *c, lanes *s, extremes *e)
{
    FOR_TWO(h)
    {
        const words w = f->load(source, h);
        floats r[2], g[2], b[2], l[2];
        f->convert(w.r, r);
        f->convert(w.g, g);
        f->convert(w.b, b);
        e->top = larger_words(e->top, &w);
        FOR_TWO(k)
        {
            l[k] = luminance(r[k], g[k], b[k], c);
            s->product[2 * h + k] = v_mul(s->product[2 * h + k], l[k]);
        }
        e->least = v_min(e->least, v_min(l[0], l[1]));
    }
}

INLINE ints scale_eights(const eights *f, const uint8_t *source, const meter_constants *c, const scale_constants *d,
                         size_t i, pupil_planes *planes, mask *beyond, mask *opaque, float *lum)
{
    ints top = v_all_ints(0);
    FOR_TWO(h)
    {
        const words w = f->load(source, h);
        floats r[2], g[2], b[2];
        f->convert(w.r, r);
        f->convert(w.g, g);
        f->convert(w.b, b);
        top = larger_words(top, &w);
        *opaque = v_both(*opaque, f->opaque(w.a));
        FOR_TWO(k)
        beyond[2 * h + k] = scale_vector(r[k], g[k], b[k], luminance(r[k], g[k], b[k], c), d,
                                         i + (size_t)(2 * h + k) * WIDTH, planes, lum, 1);
    }
    return top;
}

INLINE void group_eights(const eights *f, const uint8_t *source, group *p)
{
    ints top = v_all_ints(0);
    p->opaque = v_all_ints(~0u);
    FOR_TWO(h)
    {
        const words w = f->load(source, h);
        f->convert(w.r, p->r + 2 * h);
        f->convert(w.g, p->g + 2 * h);
        f->convert(w.b, p->b + 2 * h);
        top = larger_words(top, &w);
        p->opaque = v_both(p->opaque, f->opaque(w.a));
    }
    p->top = f->top(top);
}

/* The functions of a format that is read so. */
#define FORMAT_OF_EIGHTS(NAME, BYTES, LOAD, CONVERT, OPAQUE, TOP)                                                      \
    static const eights NAME##_eights = {LOAD, CONVERT, OPAQUE, TOP};                                                  \
    INLINE void sum_##NAME(const uint8_t *source, const meter_constants *c, lanes *s, extremes *e)                     \
    {                                                                                                                  \
        sum_eights(&NAME##_eights, source, c, s, e);                                                                   \
    }                                                                                                                  \
    INLINE ints scale16_##NAME(const uint8_t *source, const meter_constants *c, const scale_constants *d, size_t i,    \
                               pupil_planes *planes, mask *beyond, mask *opaque, float *lum)                           \
    {                                                                                                                  \
        return scale_eights(&NAME##_eights, source, c, d, i, planes, beyond, opaque, lum);                             \
    }                                                                                                                  \
    INLINE void group_##NAME(const uint8_t *source, group *p)                                                          \
    {                                                                                                                  \
        group_eights(&NAME##_eights, source, p);                                                                       \
    }                                                                                                                  \
    static const format NAME = {                                                                                       \
        .bytes = BYTES, .group = group_##NAME, .sum = sum_##NAME, .scale = scale16_##NAME, .top = TOP};

FORMAT_OF_EIGHTS(rgba16f, 8, load8_four, halves_to, opaque_halves, top_halves)
FORMAT_OF_EIGHTS(rgba16, 8, load8_four, sixteens_to, all_ones, top_sixteens)
FORMAT_OF_EIGHTS(rgb16, 6, load8_three, sixteens_to, all_ones, top_sixteens)
FORMAT_OF_EIGHTS(rgb16f, 6, load8_three, halves_to, all_ones, top_halves)

/* --- store --- */

/* The encoder's words, indexed by each number's upper half. */
INLINE ints words_at(const uint32_t *cell, ints at)
{
    const uint16x8_t i = vreinterpretq_u16_u32(at);
    const ints c = {cell[vgetq_lane_u16(i, 1)], cell[vgetq_lane_u16(i, 3)], cell[vgetq_lane_u16(i, 5)],
                    cell[vgetq_lane_u16(i, 7)]};
    return c;
}

/* The codes of eight samples from 0 to a little more than 1, which is in the cell of 1 (kernels.h). Samples below the
 * first cell get its first code, 0: base is a power of two, whose lower half is 0. */
INLINE uint16x8_t codes_of(const float *x, const uint32_t *cell, ints base)
{
    const ints low = vqsubq_u32(v_bits(v_load(x)), base), high = vqsubq_u32(v_bits(v_load(x + 4)), base);
    const ints half = v_all_ints(0xffff);
    return vaddhn_high_u32(vaddhn_u32(words_at(cell, low), v_and(low, half)), words_at(cell, high), v_and(high, half));
}

INLINE void store_vectors(const pupil_planes *planes, const float *first, const float *second, const float *third,
                          uint32_t n, const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    (void)planes;
    const uint32_t *cell = e->cell;
    const ints base = v_all_ints(e->base_bits);
    const uint32_t whole = n / 8 * 8;
    for (size_t i = 0; i < whole; i += 8) {
        const uint16x8_t x = codes_of(first + i, cell, base), y = codes_of(second + i, cell, base);
        const uint16x8_t z = codes_of(third + i, cell, base);
        if (bytes == 4) {
            const uint16x8_t xy = vsliq_n_u16(x, y, 8), za = vorrq_u16(z, vdupq_n_u16(0xff00));
            vst1q_u8(target + i * 4, vreinterpretq_u8_u16(vzip1q_u16(xy, za)));
            vst1q_u8(target + i * 4 + 16, vreinterpretq_u8_u16(vzip2q_u16(xy, za)));
        } else {
            vst3_u8(target + i * 3, ((uint8x8x3_t){{vmovn_u16(x), vmovn_u16(y), vmovn_u16(z)}}));
        }
    }
    store_rest(first, second, third, whole, n, e, target, bytes);
}

#include "neon_luma.h"

#include "vector_table.h"

#include "neon_raw10.h"

const pupil_kernels pupil_kernels_neon = {VECTOR_PIECES, .meter_quads = {[PUPIL_PIXEL_BAYER10P] = meter_bayer10p}};

#else
typedef int pupil_no_neon; /* a C file must not be empty */
#endif
