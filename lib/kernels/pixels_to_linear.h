/* lib/kernels/pixels_to_linear.h: loading (and, for NV12, storing) the formats for which a level has no vector code:
 * plain C loops, written once and compiled in each level's file, for its instructions. All levels give the same
 * results. */
#ifndef PUPIL_KERNELS_PIXELS_TO_LINEAR_H
#define PUPIL_KERNELS_PIXELS_TO_LINEAR_H

#include "by_luma.h"
#include "kernels.h"

#include "base/numeric.h"

/* --- codes to light --- */

/* Coded values, clamped to 0..top (NaN is impossible), to light, which is interpolated between two codes, and exact on
 * one. With vectors the samples after n are computed too. */
static void look_up_light(float *restrict v, uint32_t n, const float (*restrict light)[2], float top)
{
#if defined(WIDTH)
    for (uint32_t i = 0; i < n; i += WIDTH) {
        const floats code = v_min(v_max(v_load(v + i), v_all(0.0f)), v_all(top));
        const ints below = v_to_ints(code);
        v_store(v + i, v_interpolate(light, below, v_sub(code, v_from_ints(below))));
    }
#else
    for (uint32_t i = 0; i < n; i++) {
        float code = v[i] > 0.0f ? v[i] : 0.0f;
        code = code < top ? code : top;
        const int32_t below = (int32_t)code;
        v[i] = light[below][0] + (code - (float)below) * light[below][1];
    }
#endif
}

static void plain_light(float *restrict v, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        float code = v[i] > 0.0f ? v[i] : 0.0f;
        code = code < 255.0f ? code : 255.0f;
        v[i] = code * (1.0f / 255.0f);
    }
}

static void codes_to_light(const pupil_coder *c, float *v, uint32_t n)
{
    if (c->light)
        look_up_light(v, n, c->light, c->top);
    else
        plain_light(v, n);
}

/* Companded codes to light. With vectors the samples after n are computed too. */
static void expand_codes(const pupil_coder *c, float *restrict v, uint32_t n)
{
    const uint32_t lines = c->lines;
#if defined(WIDTH)
    for (uint32_t i = 0; i < n; i += WIDTH) {
        const floats code = v_load(v + i);
        floats from = v_all(c->line[0].from), light = v_all(c->line[0].light), slope = v_all(c->line[0].slope);
        for (uint32_t k = 1; k < lines; k++) {
            const mask on = v_at_least(code, v_all(c->line[k].from));
            from = v_select(on, v_all(c->line[k].from), from);
            light = v_select(on, v_all(c->line[k].light), light);
            slope = v_select(on, v_all(c->line[k].slope), slope);
        }
        v_store(v + i, v_add(light, v_mul(v_sub(code, from), slope)));
    }
#else
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = 0;
        while (k + 1 < lines && v[i] >= c->line[k + 1].from)
            k++;
        v[i] = c->line[k].light + (v[i] - c->line[k].from) * c->line[k].slope;
    }
#endif
}

/* --- 8-bit RGB, through its table --- */

static inline void load_codes(const uint8_t *restrict s, uint32_t n, uint32_t bytes, uint32_t red, uint32_t blue,
                              pupil_planes *restrict p)
{
    for (uint32_t i = 0; i < n; i++) {
        p->r[i] = pupil_srgb8_to_linear[s[bytes * i + red]];
        p->g[i] = pupil_srgb8_to_linear[s[bytes * i + 1]];
        p->b[i] = pupil_srgb8_to_linear[s[bytes * i + blue]];
        PUPIL_ONE_BY_ONE;
    }
}

/* A macro so that the layout is a constant in each. */
#define LOAD_CODES(NAME, BYTES, RED, BLUE, OPAQUE)                                                                     \
    static int NAME(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)      \
    {                                                                                                                  \
        (void)coder;                                                                                                   \
        load_codes(row->data + BYTES * (size_t)x, n, BYTES, RED, BLUE, planes);                                        \
        return OPAQUE;                                                                                                 \
    }

LOAD_CODES(load_rgba8, 4, 0, 2, 0)
LOAD_CODES(load_rgbx8, 4, 0, 2, 1)
LOAD_CODES(load_bgrx8, 4, 2, 0, 1)
LOAD_CODES(load_rgb8, 3, 0, 2, 1)
LOAD_CODES(load_bgr8, 3, 2, 0, 1)

/* --- Y'CbCr --- */

static inline void pixel_of_yuv(const pupil_coder *c, uint8_t luma, const uint8_t uv[2], float *r, float *g, float *b)
{
    const float y = ((float)luma - c->y_zero) * c->y_unit, u = (float)uv[0] - 128.0f, v = (float)uv[1] - 128.0f;
    *r = y + c->red_v * v;
    *g = (y + c->green_u * u) + c->green_v * v;
    *b = y + c->blue_u * u;
}

/* Pairs of pixels, each with its Cb and Cr. */
static void pairs_of_yuv(const pupil_coder *coder, const uint8_t *restrict luma, const uint8_t *restrict chroma,
                         uint32_t pairs, float *restrict r, float *restrict g, float *restrict b)
{
    const pupil_coder c = *coder;
    for (uint32_t k = 0; k < pairs; k++) {
        const float u = (float)chroma[2 * k] - 128.0f, v = (float)chroma[2 * k + 1] - 128.0f;
        const float first = ((float)luma[2 * k] - c.y_zero) * c.y_unit;
        const float second = ((float)luma[2 * k + 1] - c.y_zero) * c.y_unit;
        r[2 * k] = first + c.red_v * v;
        r[2 * k + 1] = second + c.red_v * v;
        g[2 * k] = (first + c.green_u * u) + c.green_v * v;
        g[2 * k + 1] = (second + c.green_u * u) + c.green_v * v;
        b[2 * k] = first + c.blue_u * u;
        b[2 * k + 1] = second + c.blue_u * u;
    }
}

#if defined(WIDTH)
#ifndef CHROMA_UNIT
#define CHROMA_UNIT 1.0f /* the unit of v_of_chroma's Cb and Cr */
#endif

/* As look_up_light, of one vector. */
INLINE floats light_of_codes(floats code, const float (*light)[2], floats top)
{
    const floats inside = v_min(v_max(code, v_all(0.0f)), top);
    const ints below = v_to_ints(inside);
    return v_interpolate(light, below, v_sub(inside, v_from_ints(below)));
}

/* Whole groups of 16 pixels, from samples to light in registers; returns the first pixel that is left. */
static uint32_t groups_of_yuv(const pupil_coder *c, const uint8_t *luma, const uint8_t *chroma, uint32_t n,
                              pupil_planes *p)
{
    const float(*const light)[2] = c->light;
    const floats y_zero = v_all(c->y_zero), y_unit = v_all(c->y_unit), top = v_all(c->top);
    const floats red_v = v_all(c->red_v * CHROMA_UNIT), blue_u = v_all(c->blue_u * CHROMA_UNIT);
    const floats green_u = v_all(c->green_u * CHROMA_UNIT), green_v = v_all(c->green_v * CHROMA_UNIT);
    uint32_t i = 0;
    for (; i + PUPIL_LANES <= n; i += PUPIL_LANES) {
        floats y[WAYS], u[WAYS], v[WAYS];
        v_of_bytes(luma + i, y);
        v_of_chroma(chroma + i, u, v);
        FOR_EACH_WAY(k)
        {
            const uint32_t at = i + (uint32_t)k * WIDTH;
            y[k] = v_mul(v_sub(y[k], y_zero), y_unit);
            v_store(p->r + at, light_of_codes(v_add(y[k], v_mul(red_v, v[k])), light, top));
            v_store(p->g + at,
                    light_of_codes(v_add(v_add(y[k], v_mul(green_u, u[k])), v_mul(green_v, v[k])), light, top));
            v_store(p->b + at, light_of_codes(v_add(y[k], v_mul(blue_u, u[k])), light, top));
        }
    }
    return i;
}
#endif

/* n pixels from luma on; chroma: of the first one's pair. odd: the first one is the second of its pair. */
static void single_yuv(const pupil_coder *c, const uint8_t *luma, const uint8_t *chroma, uint32_t odd, uint32_t n,
                       float *r, float *g, float *b)
{
    const uint32_t pairs = (n - odd) / 2, last = odd + 2 * pairs; /* n is at least 1 */
    if (odd)
        pixel_of_yuv(c, luma[0], chroma, r, g, b);
    pairs_of_yuv(c, luma + odd, chroma + 2 * odd, pairs, r + odd, g + odd, b + odd);
    if (last < n)
        pixel_of_yuv(c, luma[last], chroma + odd + last, r + last, g + last, b + last);
    codes_to_light(c, r, n);
    codes_to_light(c, g, n);
    codes_to_light(c, b, n);
}

/* Whether its table of light goes beyond the codes 0 and 255. */
static inline int has_light_beyond(const pupil_coder *c)
{
    return c->light && c->top == 255.0f;
}

/* Pixels from `done` on. */
static void load_rest_of_yuv(const pupil_coder *c, const uint8_t *luma, const uint8_t *chroma, uint32_t odd,
                             uint32_t done, uint32_t n, pupil_planes *p)
{
#if defined(WIDTH)
    if (!odd && c->light && !done)
        done = groups_of_yuv(c, luma, chroma, n, p);
#endif
    if (done < n)
        single_yuv(c, luma + done, chroma + done, odd, n - done, p->r + done, p->g + done, p->b + done);
}

static void load_yuv(const pupil_coder *c, const uint8_t *luma, const uint8_t *chroma, uint32_t odd, uint32_t n,
                     pupil_planes *p)
{
    uint32_t done = 0;
#if defined(LEVEL_HAS_GROUPS_OF_YUV_BEYOND)
    if (!odd && has_light_beyond(c))
        done = groups_of_yuv_beyond(c, luma, chroma, n, p);
#endif
    load_rest_of_yuv(c, luma, chroma, odd, done, n, p);
}

static int load_nv12(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    load_yuv(coder, row->data + x, row->chroma + x - x % 2, x % 2, n, planes);
    return 1;
}

/* Other formats, or the rest of a packed row, are put in NV12's order first, in whole pairs: cheap compared with the
 * look-ups of light. */

static int load_nv21(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    uint8_t chroma[PUPIL_BLOCK + 2];
    const uint32_t odd = x % 2, pairs = (n + odd + 1) / 2;
    const uint8_t *restrict s = row->chroma + x - odd;
    for (uint32_t i = 0; i < pairs; i++) {
        chroma[2 * i] = s[2 * i + 1];
        chroma[2 * i + 1] = s[2 * i];
    }
    load_yuv(coder, row->data + x, chroma, odd, n, planes);
    return 1;
}

static int load_i420(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    uint8_t chroma[PUPIL_BLOCK + 2];
    const uint32_t odd = x % 2, pairs = (n + odd + 1) / 2;
    const uint8_t *restrict cb = row->chroma + x / 2, *restrict cr = row->cr + x / 2;
    for (uint32_t i = 0; i < pairs; i++) {
        chroma[2 * i] = cb[i];
        chroma[2 * i + 1] = cr[i];
    }
    load_yuv(coder, row->data + x, chroma, odd, n, planes);
    return 1;
}

/* luma_at: 0 or 1, where Y' is in each two bytes. */
static inline void load_packed_yuv(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n,
                                   uint32_t luma_at, pupil_planes *planes)
{
    uint8_t luma[PUPIL_BLOCK + 2], chroma[PUPIL_BLOCK + 2];
    const uint32_t odd = x % 2, all = (n + odd + 1) / 2 * 2;
    const uint8_t *restrict s = row->data + 2 * (size_t)(x - odd);
    uint32_t done = 0;
#if defined(LEVEL_HAS_GROUPS_OF_YUV_BEYOND)
    if (!odd && has_light_beyond(coder))
        done = groups_of_packed_yuv(coder, s, luma_at, n, planes);
#endif
    for (uint32_t i = done; i < all; i++) {
        luma[i] = s[2 * i + luma_at];
        chroma[i] = s[2 * i + 1 - luma_at];
    }
    load_rest_of_yuv(coder, luma + odd, chroma, odd, done, n, planes);
}

static int load_yuyv(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    load_packed_yuv(coder, row, x, n, 0, planes);
    return 1;
}

static int load_uyvy(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    load_packed_yuv(coder, row, x, n, 1, planes);
    return 1;
}

/* --- 10 and 16 bits --- */

/* Each pixel has its own Cb and Cr: the callers double those of 4:2:0. `none`: the code of no colour. y_unit alone,
 * rounded, would move the level of PQ, where a change of code by 1e-7 of itself changes light by ten times that. */
static void load_yuv_words(const pupil_coder *coder, const uint16_t *restrict luma, const uint16_t *restrict cb,
                           const uint16_t *restrict cr, float none, uint32_t n, pupil_planes *restrict p)
{
    const pupil_coder c = *coder;
    for (uint32_t i = 0; i < n; i++) {
        const float code = (float)luma[i] - c.y_zero, u = (float)cb[i] - none, v = (float)cr[i] - none;
        const float y = code * c.y_coarse + code * c.y_fine;
        p->r[i] = y + c.red_v * v;
        p->g[i] = (y + c.green_u * u) + c.green_v * v;
        p->b[i] = y + c.blue_u * u;
    }
    codes_to_light(coder, p->r, n);
    codes_to_light(coder, p->g, n);
    codes_to_light(coder, p->b, n);
}

static int load_p010(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    uint16_t luma[PUPIL_BLOCK], cb[PUPIL_BLOCK + 2], cr[PUPIL_BLOCK + 2];
    const uint32_t odd = x % 2, pairs = (n + odd + 1) / 2;
    const uint16_t *restrict s = (const uint16_t *)(const void *)row->data + x;
    const uint16_t *restrict uv = (const uint16_t *)(const void *)row->chroma + x - odd;
    for (uint32_t i = 0; i < n; i++)
        luma[i] = s[i] >> 6;
    for (uint32_t i = 0; i < pairs; i++) {
        cb[2 * i] = cb[2 * i + 1] = uv[2 * i] >> 6;
        cr[2 * i] = cr[2 * i + 1] = uv[2 * i + 1] >> 6;
    }
    load_yuv_words(coder, luma, cb + odd, cr + odd, 512.0f, n, planes);
    return 1;
}

static int load_i420_10(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    uint16_t cb[PUPIL_BLOCK + 2], cr[PUPIL_BLOCK + 2];
    const uint32_t odd = x % 2, pairs = (n + odd + 1) / 2;
    const uint16_t *luma = (const uint16_t *)(const void *)row->data + x;
    const uint16_t *restrict u = (const uint16_t *)(const void *)row->chroma + x / 2;
    const uint16_t *restrict v = (const uint16_t *)(const void *)row->cr + x / 2;
    for (uint32_t i = 0; i < pairs; i++) {
        cb[2 * i] = cb[2 * i + 1] = u[i];
        cr[2 * i] = cr[2 * i + 1] = v[i];
    }
    load_yuv_words(coder, luma, cb + odd, cr + odd, 512.0f, n, planes);
    return 1;
}

static int load_i444_16(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    const uint16_t *luma = (const uint16_t *)(const void *)row->data + x;
    const uint16_t *cb = (const uint16_t *)(const void *)row->chroma + x;
    const uint16_t *cr = (const uint16_t *)(const void *)row->cr + x;
    load_yuv_words(coder, luma, cb, cr, 32768.0f, n, planes);
    return 1;
}

static int load_rgb10a2(const pupil_coder *c, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)
{
    const uint32_t *restrict s = (const uint32_t *)(const void *)row->data + x;
    const float unit = c->unit;
    for (uint32_t i = 0; i < n; i++) {
        p->r[i] = (float)(int32_t)(s[i] & 1023) * unit;
        p->g[i] = (float)(int32_t)(s[i] >> 10 & 1023) * unit;
        p->b[i] = (float)(int32_t)(s[i] >> 20 & 1023) * unit;
    }
    codes_to_light(c, p->r, n);
    codes_to_light(c, p->g, n);
    codes_to_light(c, p->b, n);
    return 0;
}

/* --- grey --- */

static inline void grey_to_planes(const pupil_coder *c, uint32_t n, pupil_planes *restrict p)
{
    if (c->lines)
        expand_codes(c, p->r, n);
    if (c->light) {
        for (uint32_t i = 0; i < n; i++)
            p->r[i] *= c->top;
        look_up_light(p->r, n, c->light, c->top);
    }
    for (uint32_t i = 0; i < n; i++)
        p->g[i] = p->b[i] = p->r[i];
}

static int load_grey8(const pupil_coder *c, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)
{
    const uint8_t *restrict s = row->data + x;
    for (uint32_t i = 0; i < n; i++)
        p->r[i] = ((float)s[i] - c->zero) * c->unit;
    grey_to_planes(c, n, p);
    return 1;
}

static int load_grey16(const pupil_coder *c, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)
{
    const uint16_t *restrict s = (const uint16_t *)(const void *)row->data + x;
    const uint32_t shift = c->shift;
    for (uint32_t i = 0; i < n; i++)
        p->r[i] = ((float)(s[i] >> shift) - c->zero) * c->unit;
    grey_to_planes(c, n, p);
    return 1;
}

/* --- mosaics --- */

static void unpack_bayer8(const uint8_t *row, uint32_t shift, uint32_t x, uint32_t n, uint16_t *restrict to)
{
    const uint8_t *restrict s = row + x;
    (void)shift;
    for (uint32_t i = 0; i < n; i++)
        to[i] = s[i];
}

static void unpack_bayer16(const uint8_t *row, uint32_t shift, uint32_t x, uint32_t n, uint16_t *restrict to)
{
    const uint16_t *restrict s = (const uint16_t *)(const void *)row + x;
    for (uint32_t i = 0; i < n; i++)
        to[i] = (uint16_t)(s[i] >> shift);
}

static inline uint16_t sample_10p(const uint8_t *row, uint32_t x)
{
    const uint8_t *packed = row + (size_t)(x / 4) * 5;
    return (uint16_t)(packed[x % 4] << 2 | (packed[4] >> 2 * (x % 4) & 3));
}

static void unpack_bayer10p(const uint8_t *row, uint32_t shift, uint32_t x, uint32_t n, uint16_t *restrict to)
{
    uint32_t i = 0;
    (void)shift;
    for (; i < n && (x + i) % 4; i++)
        to[i] = sample_10p(row, x + i);
    const uint8_t *restrict s = row + (size_t)((x + i) / 4) * 5;
    for (; i + 4 <= n; i += 4, s += 5) {
        to[i] = (uint16_t)(s[0] << 2 | (s[4] & 3));
        to[i + 1] = (uint16_t)(s[1] << 2 | (s[4] >> 2 & 3));
        to[i + 2] = (uint16_t)(s[2] << 2 | (s[4] >> 4 & 3));
        to[i + 3] = (uint16_t)(s[3] << 2 | s[4] >> 6);
    }
    for (; i < n; i++)
        to[i] = sample_10p(row, x + i);
}

static inline uint16_t sample_12p(const uint8_t *row, uint32_t x)
{
    const uint8_t *packed = row + (size_t)(x / 2) * 3;
    return (uint16_t)(packed[x % 2] << 4 | (packed[2] >> 4 * (x % 2) & 15));
}

static void unpack_bayer12p(const uint8_t *row, uint32_t shift, uint32_t x, uint32_t n, uint16_t *restrict to)
{
    uint32_t i = 0;
    (void)shift;
    for (; i < n && (x + i) % 2; i++)
        to[i] = sample_12p(row, x + i);
    const uint8_t *restrict s = row + (size_t)((x + i) / 2) * 3;
    for (; i + 2 <= n; i += 2, s += 3) {
        to[i] = (uint16_t)(s[0] << 4 | (s[2] & 15));
        to[i + 1] = (uint16_t)(s[1] << 4 | s[2] >> 4);
    }
    for (; i < n; i++)
        to[i] = sample_12p(row, x + i);
}

/* --- packed grey, unpacked as a mosaic --- */

static void load_samples(const pupil_coder *c, const uint16_t *restrict s, uint32_t n, pupil_planes *restrict p)
{
    for (uint32_t i = 0; i < n; i++)
        p->r[i] = ((float)s[i] - c->zero) * c->unit;
    grey_to_planes(c, n, p);
}

static int load_grey10p(const pupil_coder *c, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *p)
{
    uint16_t samples[PUPIL_BLOCK];
    unpack_bayer10p(row->data, 0, x, n, samples);
    load_samples(c, samples, n, p);
    return 1;
}

static int load_grey12p(const pupil_coder *c, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *p)
{
    uint16_t samples[PUPIL_BLOCK];
    unpack_bayer12p(row->data, 0, x, n, samples);
    load_samples(c, samples, n, p);
    return 1;
}

/* --- mosaics to pixels --- */

/* Four times a channel's sample, or the sum of four, to balanced light. */
static inline float develop(uint32_t sum4, const pupil_coder *c, int channel)
{
    const float v = ((float)(int32_t)sum4 - c->zero4) * c->unit4[channel];
    return v < c->most ? v : c->most;
}

static inline void bin_rows(const pupil_coder *c, const uint16_t *restrict red, const uint16_t *restrict green_r,
                            const uint16_t *restrict green_b, const uint16_t *restrict blue, uint32_t n,
                            pupil_planes *restrict p)
{
    for (uint32_t i = 0; i < n; i++) {
        p->r[i] = develop(4u * red[2 * i], c, 0);
        p->g[i] = develop(2u * ((uint32_t)green_r[2 * i] + green_b[2 * i]), c, 1);
        p->b[i] = develop(4u * blue[2 * i], c, 2);
    }
}

static void binned(const pupil_coder *c, const uint16_t *upper, const uint16_t *lower, uint32_t n, pupil_planes *p)
{
    const uint16_t *red = c->red_y ? lower : upper, *blue = c->red_y ? upper : lower;
    bin_rows(c, red + c->red_x, red + 1 - c->red_x, blue + c->red_x, blue + 1 - c->red_x, n, p);
}

/* A row has its own colour, red or blue, in every second pixel, and green in the others; `own_odd`: its own is in the
 * second, the fourth and so on. Each pixel is computed both ways, and one result is taken: no faster way for vectors
 * was found. */
static inline void interpolate(const pupil_coder *c, const uint16_t *restrict up, const uint16_t *restrict at,
                               const uint16_t *restrict down, uint32_t own_odd, int own, uint32_t n,
                               pupil_planes *restrict p)
{
    float *restrict mine = own ? p->b : p->r, *restrict other = own ? p->r : p->b, *restrict green = p->g;
    const int mine_channel = own ? 2 : 0, other_channel = 2 - mine_channel;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t is_own = 0u - ((i & 1) == own_odd);
        const uint32_t left = at[(int64_t)i - 1], here = at[i], right = at[i + 1];
        const uint32_t above = up[i], below = down[i];
        const uint32_t corners = (uint32_t)up[(int64_t)i - 1] + up[i + 1] + down[(int64_t)i - 1] + down[i + 1];
        mine[i] = develop((4u * here & is_own) | (2u * (left + right) & ~is_own), c, mine_channel);
        green[i] = develop(((left + right + above + below) & is_own) | (4u * here & ~is_own), c, 1);
        other[i] = develop((corners & is_own) | (2u * (above + below) & ~is_own), c, other_channel);
    }
}

static void bilinear(const pupil_coder *c, const uint16_t *const rows[3], int red_x, int red_y, uint32_t n,
                     pupil_planes *p)
{
    const uint16_t *up = rows[0] + 1, *at = rows[1] + 1, *down = rows[2] + 1;
    /* in a row of red samples the first is red if red_x; in a row of blue ones it is blue if not red_x */
    if (red_y)
        interpolate(c, up, at, down, !red_x, 0, n, p);
    else
        interpolate(c, up, at, down, red_x != 0, 1, n, p);
}

/* --- companded mosaics to pixels: the same of light --- */

static void expand(const pupil_coder *c, const uint16_t *restrict samples, uint32_t n, float *restrict light)
{
    for (uint32_t i = 0; i < n; i++)
        light[i] = (float)samples[i];
    for (uint32_t i = n; i % PUPIL_LANES; i++)
        light[i] = 0.0f;
    expand_codes(c, light, n);
}

static inline float balanced(float light, const pupil_coder *c, int channel)
{
    const float v = light * c->unit4[channel];
    return v < c->most ? v : c->most;
}

static void binned_light(const pupil_coder *c, const float *upper, const float *lower, uint32_t at, uint32_t n,
                         pupil_planes *restrict p)
{
    const float *red_row = c->red_y ? lower : upper, *blue_row = c->red_y ? upper : lower;
    const float *restrict red = red_row + c->red_x, *restrict green_r = red_row + 1 - c->red_x;
    const float *restrict green_b = blue_row + c->red_x, *restrict blue = blue_row + 1 - c->red_x;
    for (uint32_t i = 0; i < n; i++) {
        p->r[at + i] = balanced(red[2 * i], c, 0);
        p->g[at + i] = balanced(0.5f * (green_r[2 * i] + green_b[2 * i]), c, 1);
        p->b[at + i] = balanced(blue[2 * i], c, 2);
    }
}

/* As interpolate. */
static void bilinear_light(const pupil_coder *c, const float *const rows[3], int red_x, int red_y, uint32_t n,
                           pupil_planes *restrict p)
{
    const float *restrict up = rows[0] + 1, *restrict at = rows[1] + 1, *restrict down = rows[2] + 1;
    float *restrict mine = red_y ? p->r : p->b, *restrict other = red_y ? p->b : p->r, *restrict green = p->g;
    const int mine_channel = red_y ? 0 : 2, other_channel = 2 - mine_channel;
    const uint32_t own_odd = (red_x != 0) != (red_y != 0);
    for (uint32_t i = 0; i < n; i++) {
        const int is_own = (i & 1) == own_odd;
        const float across = at[(int64_t)i - 1] + at[i + 1], along = up[i] + down[i], here = at[i];
        const float corners = (up[(int64_t)i - 1] + up[i + 1]) + (down[(int64_t)i - 1] + down[i + 1]);
        mine[i] = balanced(is_own ? here : 0.5f * across, c, mine_channel);
        green[i] = balanced(is_own ? 0.25f * (across + along) : here, c, 1);
        other[i] = balanced(is_own ? 0.25f * corners : 0.5f * along, c, other_channel);
    }
}

static void matrix(const float m[9], uint32_t n, pupil_planes *restrict p)
{
    for (uint32_t i = 0; i < n; i++) {
        const float r = p->r[i], g = p->g[i], b = p->b[i];
        p->r[i] = (m[0] * r + m[1] * g) + m[2] * b;
        p->g[i] = (m[3] * r + m[4] * g) + m[5] * b;
        p->b[i] = (m[6] * r + m[7] * g) + m[8] * b;
    }
}

/* Clamps a number that is far outside the range that is mapped; NaN remains. */
static inline float within_brightest(float v)
{
    v = v > PUPIL_BRIGHTEST ? PUPIL_BRIGHTEST : v;
    return v < -PUPIL_BRIGHTEST ? -PUPIL_BRIGHTEST : v;
}

static inline float not_negative(float v)
{
    return v > 0.0f ? v : 0.0f;
}

static void to_picture(const float m[9], uint32_t n, pupil_planes *restrict p)
{
    for (uint32_t i = 0; i < n; i++) {
        const float r = within_brightest(p->r[i]), g = within_brightest(p->g[i]), b = within_brightest(p->b[i]);
        p->r[i] = not_negative((m[0] * r + m[1] * g) + m[2] * b);
        p->g[i] = not_negative((m[3] * r + m[4] * g) + m[5] * b);
        p->b[i] = not_negative((m[6] * r + m[7] * g) + m[8] * b);
    }
}

/* --- display light, as floats and halves --- */

/* What scale left, clamped to 0..1; no zero is negative. */
static inline float display_light(float v)
{
    v = v > 0.0f ? v : 0.0f;
    return v < 1.0f ? v : 1.0f;
}

/* From 0 to 1, to nearest even. In [0.5, 1) a float's ulp is that of subnormal halves: adding 0.5 rounds these. */
static inline uint16_t half_of_light(float v)
{
    const uint32_t bits = pupil_bits_of_float(v), small = pupil_bits_of_float(v + 0.5f) - pupil_bits_of_float(0.5f);
    const uint32_t rounded = (bits + 0xfff + (bits >> 13 & 1)) >> 13;
    return (uint16_t)(v < 0x1p-14f ? small : rounded - ((127 - 15) << 10));
}

#define FLOAT_OF_LIGHT(x) (x)
#define STORE_LIGHT(NAME, TYPE, SAMPLES, RED, BLUE, CONVERT, ONE)                                                      \
    static void NAME(const pupil_planes *restrict p, uint32_t n, const pupil_encoder *encoder, void *target)           \
    {                                                                                                                  \
        TYPE *restrict t = target;                                                                                     \
        (void)encoder;                                                                                                 \
        for (uint32_t i = 0; i < n; i++) {                                                                             \
            t[SAMPLES * i + RED] = CONVERT(display_light(p->r[i]));                                                    \
            t[SAMPLES * i + 1] = CONVERT(display_light(p->g[i]));                                                      \
            t[SAMPLES * i + BLUE] = CONVERT(display_light(p->b[i]));                                                   \
            if (SAMPLES == 4)                                                                                          \
                t[SAMPLES * i + SAMPLES - 1] = ONE;                                                                    \
        }                                                                                                              \
    }

STORE_LIGHT(store_rgba32f, float, 4, 0, 2, FLOAT_OF_LIGHT, 1.0f)
STORE_LIGHT(store_rgb32f, float, 3, 0, 2, FLOAT_OF_LIGHT, 1.0f)
STORE_LIGHT(store_bgr32f, float, 3, 2, 0, FLOAT_OF_LIGHT, 1.0f)
STORE_LIGHT(store_rgba16f, uint16_t, 4, 0, 2, half_of_light, 0x3c00)
STORE_LIGHT(store_rgb16f, uint16_t, 3, 0, 2, half_of_light, 0x3c00)

/* --- display codes to Y' Cb Cr 4:2:0 --- */

static inline uint32_t word_at(const uint8_t *p)
{
    uint32_t w;
    __builtin_memcpy(&w, p, sizeof w);
    return w;
}

static inline int32_t byte_of(uint32_t word, uint32_t which)
{
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    which = 3 - which;
#endif
    return (int32_t)(word >> 8 * which & 255);
}

static void luma_of_codes(const pupil_chroma_coder *c, const uint8_t *restrict rgba, uint32_t n, uint8_t *restrict luma)
{
    const int32_t r = c->y[0], g = c->y[1], b = c->y[2], zero = c->y_zero;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t w = word_at(rgba + 4 * (size_t)i);
        luma[i] = (uint8_t)((r * byte_of(w, 0) + g * byte_of(w, 1) + b * byte_of(w, 2) + zero) >> 16);
    }
}

/* Of the sums of four pixels: adds (128 and a half) * 4 in 2^-16, and takes a quarter. */
static inline uint8_t chroma_of(const int32_t factor[3], int32_t r, int32_t g, int32_t b)
{
    const int32_t x = (factor[0] * r + factor[1] * g + factor[2] * b + (257 << 17)) >> 18;
    return (uint8_t)(x < 0 ? 0 : x > 255 ? 255 : x);
}

static inline void chroma_of_quad(const pupil_chroma_coder *c, uint32_t w0, uint32_t w1, uint32_t w2, uint32_t w3,
                                  uint8_t *chroma)
{
    const int32_t r = byte_of(w0, 0) + byte_of(w1, 0) + byte_of(w2, 0) + byte_of(w3, 0);
    const int32_t g = byte_of(w0, 1) + byte_of(w1, 1) + byte_of(w2, 1) + byte_of(w3, 1);
    const int32_t b = byte_of(w0, 2) + byte_of(w1, 2) + byte_of(w2, 2) + byte_of(w3, 2);
    chroma[0] = chroma_of(c->cb, r, g, b);
    chroma[1] = chroma_of(c->cr, r, g, b);
}

static void chroma_of_codes(const pupil_chroma_coder *coder, const uint8_t *restrict upper,
                            const uint8_t *restrict lower, uint32_t n, uint8_t *restrict chroma)
{
    const pupil_chroma_coder c = *coder;
    for (uint32_t i = 0; i < n / 2; i++) {
        const uint8_t *up = upper + 8 * (size_t)i, *down = lower + 8 * (size_t)i;
        chroma_of_quad(&c, word_at(up), word_at(up + 4), word_at(down), word_at(down + 4), chroma + 2 * (size_t)i);
    }
    if (n % 2) { /* the last column counts twice */
        const uint32_t up = word_at(upper + 4 * (size_t)(n - 1)), down = word_at(lower + 4 * (size_t)(n - 1));
        chroma_of_quad(&c, up, up, down, down, chroma + n - 1);
    }
}

/* --- as entries of a level's table --- */

#define LOADS_BY_FORMAT                                                                                                \
    [PUPIL_PIXEL_RGBA8] = load_rgba8, [PUPIL_PIXEL_RGB8] = load_rgb8, [PUPIL_PIXEL_RGBX8] = load_rgbx8,                \
    [PUPIL_PIXEL_BGRX8] = load_bgrx8, [PUPIL_PIXEL_BGR8] = load_bgr8, [PUPIL_PIXEL_RGB10A2] = load_rgb10a2,            \
    [PUPIL_PIXEL_YUYV] = load_yuyv, [PUPIL_PIXEL_UYVY] = load_uyvy, [PUPIL_PIXEL_NV12] = load_nv12,                    \
    [PUPIL_PIXEL_NV16] = load_nv12, [PUPIL_PIXEL_NV21] = load_nv21, [PUPIL_PIXEL_I420] = load_i420,                    \
    [PUPIL_PIXEL_P010] = load_p010, [PUPIL_PIXEL_I420_10] = load_i420_10, [PUPIL_PIXEL_GREY8] = load_grey8,            \
    [PUPIL_PIXEL_GREY10] = load_grey16, [PUPIL_PIXEL_GREY12] = load_grey16, [PUPIL_PIXEL_GREY16] = load_grey16,        \
    [PUPIL_PIXEL_GREY10P] = load_grey10p, [PUPIL_PIXEL_GREY12P] = load_grey12p, [PUPIL_PIXEL_I444_16] = load_i444_16

#define STORES_OF_LIGHT                                                                                                \
    [PUPIL_PIXEL_RGBA32F] = store_rgba32f, [PUPIL_PIXEL_RGB32F] = store_rgb32f, [PUPIL_PIXEL_RGBA16F] = store_rgba16f, \
    [PUPIL_PIXEL_RGB16F] = store_rgb16f, [PUPIL_PIXEL_BGR32F] = store_bgr32f

#define CAMERA_PIECES                                                                                                  \
    .unpack =                                                                                                          \
        {                                                                                                              \
            [PUPIL_PIXEL_BAYER8] = unpack_bayer8,     [PUPIL_PIXEL_BAYER10] = unpack_bayer16,                          \
            [PUPIL_PIXEL_BAYER12] = unpack_bayer16,   [PUPIL_PIXEL_BAYER14] = unpack_bayer16,                          \
            [PUPIL_PIXEL_BAYER16] = unpack_bayer16,   [PUPIL_PIXEL_BAYER10P] = unpack_bayer10p,                        \
            [PUPIL_PIXEL_BAYER12P] = unpack_bayer12p,                                                                  \
    },                                                                                                                 \
    .binned = binned, .bilinear = bilinear, .expand = expand, .binned_light = binned_light,                            \
    .bilinear_light = bilinear_light, .matrix = matrix, .to_picture = to_picture, .luma_of_codes = luma_of_codes,      \
    .chroma_of_codes = chroma_of_codes

#endif
