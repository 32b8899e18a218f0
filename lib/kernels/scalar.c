/* The reference level: plain C. Loops over planar floats, so that a compiler may use any vectors that it has; without
 * fused multiply-add (-ffp-contract=off) that changes no bit. */
#include "bins.h"
#include "bloom_loops.h"
#include "by_luma.h"
#include "dither.h"
#include "gamut.h"
#include "kernels.h"
#include "pixels_to_linear.h"
#include "veil_loops.h"

#include "base/numeric.h"

/* --- load: to planar linear floats --- */

/* A macro because TYPE differs: one function for all would have to look at the format in its loop. */
#define LOAD(NAME, TYPE, SAMPLES, RED, BLUE, CONVERT)                                                                  \
    static int NAME(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)  \
    {                                                                                                                  \
        const TYPE *restrict s = (const TYPE *)(const void *)row->data + SAMPLES * (size_t)x;                          \
        (void)coder;                                                                                                   \
        for (uint32_t i = 0; i < n; i++) {                                                                             \
            p->r[i] = CONVERT(s[SAMPLES * i + RED]);                                                                   \
            p->g[i] = CONVERT(s[SAMPLES * i + 1]);                                                                     \
            p->b[i] = CONVERT(s[SAMPLES * i + BLUE]);                                                                  \
        }                                                                                                              \
        return SAMPLES == 3;                                                                                           \
    }

/* binary16 to binary32, exact: shift exponent and fraction into place, then correct the exponent of normal numbers, of
 * Inf and NaN, and of subnormals (by a subtraction that is exact). */
static inline float half_to_float(uint16_t h)
{
    uint32_t magnitude = (uint32_t)(h & 0x7fff) << 13, exponent = magnitude & 0x0f800000u;
    uint32_t normal = magnitude + 0x38000000u; /* (127 - 15) << 23 */
    float subnormal = pupil_float_of_bits(magnitude + 0x38800000u) - 0x1p-14f;
    uint32_t special = normal + 0x38000000u; /* exponent 31 to 255 */
    uint32_t bits = exponent == 0x0f800000u ? special : exponent == 0 ? pupil_bits_of_float(subnormal) : normal;
    return pupil_float_of_bits(bits | (uint32_t)(h & 0x8000) << 16);
}

#define AS_IT_IS(x) (x)
#define FROM_16(x)  ((float)(x) * (1.0f / 65535.0f))

LOAD(load_rgba32f, float, 4, 0, 2, AS_IT_IS)
LOAD(load_rgb32f, float, 3, 0, 2, AS_IT_IS)
LOAD(load_bgr32f, float, 3, 2, 0, AS_IT_IS)
LOAD(load_rgba16f, uint16_t, 4, 0, 2, half_to_float)
LOAD(load_rgb16f, uint16_t, 3, 0, 2, half_to_float)
LOAD(load_rgba16, uint16_t, 4, 0, 2, FROM_16)
LOAD(load_rgb16, uint16_t, 3, 0, 2, FROM_16)

/* --- bloom --- */

static void bloom_bright(const pupil_planes *planes, uint32_t n, float threshold, float *const to[3])
{
    const float *const from[3] = {planes->r, planes->g, planes->b};
    for (int channel = 0; channel < 3; channel++)
        for (uint32_t i = 0; i < n; i++) {
            const float v = from[channel][i] > 0.0f ? from[channel][i] : 0.0f;
            to[channel][i] = v < PUPIL_CEILING ? v : PUPIL_CEILING;
        }
    if (threshold > 0.0f)
        bloom_above(n, threshold, to[0], to[1], to[2]);
}

static void bloom_up(const float *const row[4], const float tap[4], uint32_t n, float *to)
{
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i++)
        to[i] = (tap[0] * row[0][i] + tap[1] * row[1][i]) + (tap[2] * row[2][i] + tap[3] * row[3][i]);
}

static void bloom_columns(const float *const *row, size_t ahead, const pupil_bloom_taps *taps, uint32_t n,
                          pupil_bloom_room to)
{
    const float *t = taps->tap;
    (void)ahead;
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i++) {
        const float m = row[3][i], a = row[2][i] + row[4][i], b = row[1][i] + row[5][i], c = row[0][i] + row[6][i];
        to[0][i] = (t[0] * m + t[1] * a) + (t[3] * b + t[6] * c);
        to[1][i] = (t[1] * m + t[2] * a) + (t[4] * b + t[7] * c);
        to[2][i] = (t[3] * m + t[4] * a) + (t[5] * b + t[8] * c);
        to[3][i] = (t[6] * m + t[7] * a) + t[8] * b;
    }
}

static void bloom_rows(const pupil_bloom_room sums, uint32_t n, const float *with, float *to)
{
    for (uint32_t i = 0; i < (n + 15) / 16 * 16; i++) {
        const float *const at = sums[0] + PUPIL_BLOOM_SIDE + i, *const one = at + PUPIL_BLOOM_LINE;
        const float *const two = one + PUPIL_BLOOM_LINE, *const three = two + PUPIL_BLOOM_LINE;
        const float sum = (at[0] + (one[-1] + one[1])) + ((two[-2] + two[2]) + (three[-3] + three[3]));
        to[i] = with ? with[i] + sum : sum;
    }
}

#include "bloom_filters.h"

/* --- meter --- */

static void luminance(const float weight[3], const float *restrict r, const float *restrict g, const float *restrict b,
                      uint32_t n, float *restrict l)
{
    const float wr = weight[0], wg = weight[1], wb = weight[2];
    for (uint32_t i = 0; i < n; i++)
        l[i] = (wr * r[i] + wg * g[i]) + wb * b[i];
}

static void count(const float *restrict l, const pupil_planes *restrict p, uint32_t n, float floor, float clip,
                  pupil_run *run)
{
    uint32_t black = 0, clipped = 0, bad = 0;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t finite = (pupil_bits_of_float(l[i]) & 0x7f800000u) != 0x7f800000u;
        uint32_t full = (uint32_t)(p->r[i] >= clip) | (uint32_t)(p->g[i] >= clip) | (uint32_t)(p->b[i] >= clip);
        bad += 1u - finite;
        black += finite & (uint32_t)(l[i] <= floor);
        clipped += finite & full;
    }
    run->black += black;
    run->clipped += clipped;
    run->bad += bad;
}

/* Moves each product's exponent into the integer; exact, so how often it is done changes no bit. */
static inline void move_exponents(float *restrict product, int32_t *restrict exponent)
{
    for (int j = 0; j < PUPIL_LANES; j++) {
        uint32_t bits = pupil_bits_of_float(product[j]);
        exponent[j] += (int32_t)(bits >> 23) - 127;
        product[j] = pupil_float_of_bits((bits & 0x007fffffu) | 0x3f800000u);
    }
}

static void meter_luminance(const float *restrict l, uint32_t n, float floor, pupil_run *run)
{
    float product[PUPIL_LANES];
    int32_t exponent[PUPIL_LANES];
    uint32_t i = 0;

    for (int j = 0; j < PUPIL_LANES; j++) {
        product[j] = run->product[j];
        exponent[j] = run->exponent[j];
    }
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < PUPIL_LANES; j++)
                product[j] *= clamp_luminance(l[i + (uint32_t)(k * PUPIL_LANES + j)], floor);
        move_exponents(product, exponent);
    }
    for (; i < n; i++)
        product[i % PUPIL_LANES] *= clamp_luminance(l[i], floor); /* at most 4 a lane: i began at a multiple of 64 */
    move_exponents(product, exponent);
    for (int j = 0; j < PUPIL_LANES; j++) {
        run->product[j] = product[j];
        run->exponent[j] = exponent[j];
    }
}

static void meter(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n, pupil_run *run)
{
    float l[PUPIL_BLOCK];
    (void)source;
    luminance(job->luma, planes->r, planes->g, planes->b, n, l);
    count(l, planes, n, job->floor, job->clip, run);
    meter_luminance(l, n, job->floor, run);
}

static void histogram(const pupil_row_job *job, const pupil_channels *light, const pupil_channels *picture, uint32_t n,
                      uint32_t weight, pupil_stats *stats)
{
    const float *r = picture->r, *g = picture->g, *b = picture->b;
    const float floor = job->floor;
    float l[PUPIL_BLOCK];
    uint32_t peak_bits = pupil_bits_of_float(stats->peak);
    luminance(job->luma, light->r, light->g, light->b, n, l);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t bits = pupil_bits_of_float(clamp_luminance(l[i], floor));
        /* where no channel is NaN the largest does not depend on their order; where one is, so is L */
        float largest = l[i] == l[i] ? max3(r[i], g[i], b[i]) : floor;
        uint32_t brightest = pupil_bits_of_float(clamp_luminance(largest, floor));
        stats->bin[(bits >> BIN_BITS) - FIRST_BIN] += weight;
        stats->peak_bin[(brightest >> PEAK_BIN_BITS) - FIRST_PEAK_BIN] += weight;
        peak_bits = brightest > peak_bits ? brightest : peak_bits; /* positive floats are in the order of their bits */
    }
    stats->peak = pupil_float_of_bits(peak_bits);
}

/* --- tone: Reinhard by luminance --- */

static inline float clamp_channel(float v)
{
    v = v > 0.0f ? v : 0.0f;
    return v < PUPIL_BRIGHTEST ? v : PUPIL_BRIGHTEST;
}

/* l becomes the display luminance. */
static void tone(pupil_planes *restrict p, float *restrict l, uint32_t n, const pupil_row_job *job)
{
    const pupil_tone *curve = job->curve;
    const float x = curve->scale, iw2 = curve->inverse_white_squared, gamut = curve->gamut;
    float *restrict r = p->r, *restrict g = p->g, *restrict b = p->b;
    uint32_t over = 0;

    for (uint32_t i = 0; i < n; i++) {
        float y = l[i] > 0.0f ? l[i] : 0.0f;
        y = y < PUPIL_CEILING ? y : PUPIL_CEILING;
        float u = x * y;
        float s = x * ((1.0f + u * iw2) / (1.0f + u));
        s = l[i] == l[i] ? s : 0.0f; /* a NaN pixel is black, not a speckle of its other channels */
        r[i] = clamp_channel(r[i]) * s;
        g[i] = clamp_channel(g[i]) * s;
        b[i] = clamp_channel(b[i]) * s;
        l[i] = y * s;
        over |= (uint32_t)(max3(r[i], g[i], b[i]) > gamut_limit(l[i], gamut));
    }
    if (over)
        fit_gamut(p, l, n, gamut, job->cones);
}

/* A root of display light, at t times the first knot's luminance. */
static inline float root_at(const pupil_tone *curve, float t)
{
    const uint32_t bits = pupil_bits_of_float(t < KNOT_LAST ? t : KNOT_LAST);
    const float *knot = curve->knot + ((bits >> KNOT_BITS) - KNOT_ZERO);
    return knot[0] + (float)(int32_t)(bits & KNOT_PART) * KNOT_UNIT * (knot[1] - knot[0]);
}

/* The same by a table of knots. */
static void tone_by_knots(pupil_planes *restrict p, float *restrict l, uint32_t n, const pupil_row_job *job)
{
    const pupil_tone *curve = job->curve;
    const float k = curve->knot_scale, gamut = curve->gamut, levels = (float)(int32_t)curve->levels;
    const float last = levels - 1.0f, level = 1.0f / last;
    uint32_t over = 0;

    for (uint32_t i = 0; i < n; i++) {
        float y = l[i] > 0.0f ? l[i] : 0.0f;
        y = y < PUPIL_CEILING ? y : PUPIL_CEILING;
        const float t = k * y > 1.0f ? k * y : 1.0f;
        float root = root_at(curve, t);
        if (curve->levels) {
            const float steps = (float)(int32_t)(root * levels);
            root = (steps < last ? steps : last) * level;
        }
        float s = k * (root * root / t);
        s = l[i] == l[i] ? s : 0.0f;
        p->r[i] = clamp_channel(p->r[i]) * s;
        p->g[i] = clamp_channel(p->g[i]) * s;
        p->b[i] = clamp_channel(p->b[i]) * s;
        l[i] = y * s;
        over |= (uint32_t)(max3(p->r[i], p->g[i], p->b[i]) > gamut_limit(l[i], gamut));
    }
    if (over)
        fit_gamut(p, l, n, gamut, job->cones);
}

static inline int scale_planes(const pupil_row_job *job, uint32_t n, pupil_planes *planes, pupil_run *run, int by_knots)
{
    float *l = planes->grey;
    luminance(job->luma, planes->r, planes->g, planes->b, n, l);
    if (run) {
        count(l, planes, n, job->floor, job->clip, run);
        meter_luminance(l, n, job->floor, run);
    }
    if (by_knots)
        tone_by_knots(planes, l, n, job);
    else
        tone(planes, l, n, job);
    return 0;
}

static int scale(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes, pupil_run *run)
{
    (void)source;
    return scale_planes(job, n, planes, run, 0);
}

static int scale_by_knots(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,
                          pupil_run *run)
{
    (void)source;
    return scale_planes(job, n, planes, run, 1);
}

/* IEC 61966-2-1: 2.4 / (255 * 1.055) x^(1.4 / 2.4), and 1 / (255 * 12.92); 2.2 / 255 x^(1.2 / 2.2); 1 / 255. */
const pupil_code_width pupil_code_widths[PUPIL_TRANSFER_COUNT] = {
    [PUPIL_TRANSFER_SRGB] = {0.583333313f, 0.00892110029f, 0.000303526991f, 443739887u},
    [PUPIL_TRANSFER_GAMMA22] = {0.545454562f, 0.00862745103f, 0.0f, 484079877u},
    [PUPIL_TRANSFER_LINEAR] = {0.0f, 0.0f, 0.00392156886f, 0u}};

static void dither(uint32_t transfer, uint32_t x, uint32_t y, uint32_t n, pupil_planes *planes)
{
    const pupil_code_width of = pupil_code_widths[transfer];
    float threshold[8];
    for (uint32_t i = 0; i < 8; i++)
        threshold[i] = dither_threshold(x + i, y);
    for (uint32_t i = 0; i < n; i++) {
        planes->r[i] = dithered(planes->r[i], threshold[i % 8], &of);
        planes->g[i] = dithered(planes->g[i], threshold[i % 8], &of);
        planes->b[i] = dithered(planes->b[i], threshold[i % 8], &of);
    }
}

/* --- store: to 8-bit codes --- */

static inline uint8_t encode(const pupil_encoder *e, float x)
{
    const float lowest = pupil_float_of_bits(e->base_bits); /* and all below it, and NaN: code 0 */
    x = x > lowest ? x : lowest;
    x = x < 1.0f ? x : 1.0f;
    uint32_t bits = pupil_bits_of_float(x);
    return (uint8_t)((e->cell[(bits - e->base_bits) >> 16] + (bits & 0xffff)) >> 16);
}

static inline void store(const pupil_planes *p, uint32_t n, const pupil_encoder *e, uint8_t *t, int bytes, int red,
                         int blue)
{
    for (uint32_t i = 0; i < n; i++, t += bytes) {
        t[red] = encode(e, p->r[i]);
        t[1] = encode(e, p->g[i]);
        t[blue] = encode(e, p->b[i]);
        if (bytes == 4)
            t[3] = 255;
    }
}

#define STORE(NAME, BYTES, RED, BLUE)                                                                                  \
    static void NAME(const pupil_planes *planes, uint32_t n, const pupil_encoder *encoder, void *target)               \
    {                                                                                                                  \
        store(planes, n, encoder, target, BYTES, RED, BLUE);                                                           \
    }

STORE(store_rgba8, 4, 0, 2)
STORE(store_bgrx8, 4, 2, 0)
STORE(store_rgb8, 3, 0, 2)
STORE(store_bgr8, 3, 2, 0)

/* By its bits, without a branch: a frame's alphas may be noise, and half of the branches would be mispredicted. NaN,
 * negative alphas and those below 2^-10, a quarter of a code, become 0: a denormal factor is slow. */
static inline uint8_t alpha_of_float(float a)
{
    const uint32_t least = 0x3a800000u, one = 0x3f800000u, infinity = 0x7f800000u;
    uint32_t bits = pupil_bits_of_float(a);
    bits &= 0u - (uint32_t)(bits - least <= infinity - least);
    bits = bits < one ? bits : one;
    return (uint8_t)(pupil_float_of_bits(bits) * 255.0f + 0.5f);
}

/* As LOAD. */
#define ALPHA(NAME, TYPE, CONVERT)                                                                                     \
    static void NAME(const void *source, uint32_t n, uint8_t *rgba)                                                    \
    {                                                                                                                  \
        const TYPE *s = source;                                                                                        \
        for (uint32_t i = 0; i < n; i++)                                                                               \
            rgba[4 * i + 3] = CONVERT(s[4 * i + 3]);                                                                   \
    }

#define ALPHA_OF_HALF(h) alpha_of_float(half_to_float(h))
#define ALPHA_OF_16(a)   ((uint8_t)(((uint32_t)(a) + 128) / 257)) /* 65535 / 255 = 257: round(a / 257) */

ALPHA(alpha_rgba32f, float, alpha_of_float)
ALPHA(alpha_rgba16f, uint16_t, ALPHA_OF_HALF)
ALPHA(alpha_rgba16, uint16_t, ALPHA_OF_16)
ALPHA(alpha_rgba8, uint8_t, AS_IT_IS)

static void alpha_rgb10a2(const void *source, uint32_t n, uint8_t *rgba)
{
    const uint32_t *s = source;
    for (uint32_t i = 0; i < n; i++)
        rgba[4 * i + 3] = (uint8_t)((s[i] >> 30) * 85); /* 255 / 3 */
}

/* --- alpha as a number from 0 to 1 --- */

#define ALPHA_LIGHT(NAME, TYPE, CONVERT)                                                                               \
    static void NAME(const void *source, uint32_t n, float *alpha)                                                     \
    {                                                                                                                  \
        const TYPE *s = source;                                                                                        \
        for (uint32_t i = 0; i < n; i++)                                                                               \
            alpha[i] = CONVERT(s[4 * i + 3]);                                                                          \
    }

#define LIGHT_OF_HALF(h) display_light(half_to_float(h))
#define LIGHT_OF_16(a)   ((float)(a) / 65535.0f)
#define LIGHT_OF_8(a)    ((float)(a) / 255.0f)

ALPHA_LIGHT(alpha_light_rgba32f, float, display_light)
ALPHA_LIGHT(alpha_light_rgba16f, uint16_t, LIGHT_OF_HALF)
ALPHA_LIGHT(alpha_light_rgba16, uint16_t, LIGHT_OF_16)
ALPHA_LIGHT(alpha_light_rgba8, uint8_t, LIGHT_OF_8)

static void alpha_light_rgb10a2(const void *source, uint32_t n, float *alpha)
{
    const uint32_t *s = source;
    for (uint32_t i = 0; i < n; i++)
        alpha[i] = (float)(int32_t)(s[i] >> 30) / 3.0f;
}

static void store_alpha_32f(const float *alpha, uint32_t n, void *target)
{
    float *t = target;
    for (uint32_t i = 0; i < n; i++)
        t[4 * i + 3] = alpha[i];
}

static void store_alpha_16f(const float *alpha, uint32_t n, void *target)
{
    uint16_t *t = target;
    for (uint32_t i = 0; i < n; i++)
        t[4 * i + 3] = half_of_light(alpha[i]);
}

static uint32_t yuv_by_luma(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                            const pupil_luma_target *out, uint16_t *exact)
{
    return yuv_quads(t, in, 0, n, out, exact);
}

static uint32_t rgb_by_luma(const pupil_luma_tables *t, const pupil_luma_quads *in, uint32_t n,
                            const pupil_luma_target *out, uint16_t *exact)
{
    uint8_t grey[2][2 * PUPIL_LUMA_QUADS];
    return rgb_quads(t, in, 0, n, out, grey, exact);
}

const pupil_kernels pupil_kernels_scalar = {
    .load =
        {
            [PUPIL_PIXEL_RGBA32F] = load_rgba32f,
            [PUPIL_PIXEL_RGB32F] = load_rgb32f,
            [PUPIL_PIXEL_BGR32F] = load_bgr32f,
            [PUPIL_PIXEL_RGBA16F] = load_rgba16f,
            [PUPIL_PIXEL_RGB16F] = load_rgb16f,
            [PUPIL_PIXEL_RGBA16] = load_rgba16,
            [PUPIL_PIXEL_RGB16] = load_rgb16,
            LOADS_BY_FORMAT,
        },
    CAMERA_PIECES,
    VEIL_PIECES,
    BLOOM_PIECES,
    .yuv_by_luma = yuv_by_luma,
    .rgb_by_luma = rgb_by_luma,
    .meter = {[PUPIL_PLANES] = meter},
    .scale = {[PUPIL_PLANES] = scale},
    .scale_by_knots = scale_by_knots,
    .histogram = histogram,
    .dither = dither,
    .store =
        {
            [PUPIL_PIXEL_RGBA8] = store_rgba8,
            [PUPIL_PIXEL_RGB8] = store_rgb8,
            [PUPIL_PIXEL_BGRX8] = store_bgrx8,
            [PUPIL_PIXEL_BGR8] = store_bgr8,
            STORES_OF_LIGHT,
        },
    .alpha =
        {
            [PUPIL_PIXEL_RGBA32F] = alpha_rgba32f,
            [PUPIL_PIXEL_RGBA16F] = alpha_rgba16f,
            [PUPIL_PIXEL_RGBA16] = alpha_rgba16,
            [PUPIL_PIXEL_RGBA8] = alpha_rgba8,
            [PUPIL_PIXEL_RGB10A2] = alpha_rgb10a2,
        },
    .alpha_light =
        {
            [PUPIL_PIXEL_RGBA32F] = alpha_light_rgba32f,
            [PUPIL_PIXEL_RGBA16F] = alpha_light_rgba16f,
            [PUPIL_PIXEL_RGBA16] = alpha_light_rgba16,
            [PUPIL_PIXEL_RGBA8] = alpha_light_rgba8,
            [PUPIL_PIXEL_RGB10A2] = alpha_light_rgb10a2,
        },
    .store_alpha =
        {
            [PUPIL_PIXEL_RGBA32F] = store_alpha_32f,
            [PUPIL_PIXEL_RGBA16F] = store_alpha_16f,
        },
};
