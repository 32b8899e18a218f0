/* lib/kernels/loads.h: loading what has no vectors of its own in a level: plain C loops, written once and compiled in
 * each level's file for its instructions. No result depends on which: nothing here is rounded differently by them.
 */
#ifndef PUPIL_KERNELS_LOADS_H
#define PUPIL_KERNELS_LOADS_H

#include "kernels.h"

/* ---- codes to light ------------------------------------------------------------------------------------------------
 */

/* `code` is clamped to 0..255 here (NaN is impossible), between codes light is interpolated; on one it is the code's.
 */
static inline float light_of(float code, const float *light)
{
    code = code > 0.0f ? code : 0.0f;
    code = code < 255.0f ? code : 255.0f;
    const int32_t i = (int32_t)code;
    const float below = light[i];
    return below + (code - (float)i) * (light[i + 1] - below);
}

/* linear light of a code 0..255 */
static inline float plain_light_of(float code)
{
    code = code > 0.0f ? code : 0.0f;
    code = code < 255.0f ? code : 255.0f;
    return code * (1.0f / 255.0f);
}

static void codes_to_light(pupil_planes *restrict p, uint32_t n, const float *light)
{
    if (!light) {
        for (uint32_t i = 0; i < n; i++) {
            p->r[i] = plain_light_of(p->r[i]);
            p->g[i] = plain_light_of(p->g[i]);
            p->b[i] = plain_light_of(p->b[i]);
        }
        return;
    }
    for (uint32_t i = 0; i < n; i++)
        p->r[i] = light_of(p->r[i], light);
    for (uint32_t i = 0; i < n; i++)
        p->g[i] = light_of(p->g[i], light);
    for (uint32_t i = 0; i < n; i++)
        p->b[i] = light_of(p->b[i], light);
}

/* ---- 8-bit RGB, through its table ----------------------------------------------------------------------------------
 */

static int load_rgba8(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)
{
    const uint8_t *restrict s = row->data + 4 * (size_t)x;
    (void)coder;
    for (uint32_t i = 0; i < n; i++) {
        p->r[i] = pupil_srgb8_to_linear[s[4 * i]];
        p->g[i] = pupil_srgb8_to_linear[s[4 * i + 1]];
        p->b[i] = pupil_srgb8_to_linear[s[4 * i + 2]];
    }
    return 0;
}

static int load_rgb8(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *restrict p)
{
    const uint8_t *restrict s = row->data + 3 * (size_t)x;
    (void)coder;
    for (uint32_t i = 0; i < n; i++) {
        p->r[i] = pupil_srgb8_to_linear[s[3 * i]];
        p->g[i] = pupil_srgb8_to_linear[s[3 * i + 1]];
        p->b[i] = pupil_srgb8_to_linear[s[3 * i + 2]];
    }
    return 1;
}

/* ---- Y'CbCr --------------------------------------------------------------------------------------------------------
 */

static inline void pixel_of_yuv(const pupil_coder *c, float luma, float u, float v, uint32_t i, pupil_planes *p)
{
    const float y = (luma - c->y_zero) * c->y_unit;
    p->r[i] = y + c->red_v * v;
    p->g[i] = (y + c->green_u * u) + c->green_v * v;
    p->b[i] = y + c->blue_u * u;
}

/* Y' is every `step`th byte from luma on, Cb and Cr every `pair`th from chroma on: for each two pixels one. */
static inline void load_yuv(const pupil_coder *c, const uint8_t *restrict luma, const uint8_t *restrict chroma,
                            uint32_t step, uint32_t apart, uint32_t pair, uint32_t x, uint32_t n,
                            pupil_planes *restrict p)
{
    uint32_t i = 0;
    if (x % 2 && n) { /* the second pixel of a pair */
        const uint8_t *uv = chroma + (size_t)(x / 2) * pair;
        pixel_of_yuv(c, (float)luma[(size_t)x * step], (float)uv[0] - 128.0f, (float)uv[apart] - 128.0f, 0, p);
        i = 1;
    }
    luma += (size_t)(x + i) * step;
    chroma += (size_t)((x + i) / 2) * pair;
    for (uint32_t k = 0; k < (n - i) / 2; k++) {
        const float u = (float)chroma[k * pair] - 128.0f, v = (float)chroma[k * pair + apart] - 128.0f;
        pixel_of_yuv(c, (float)luma[2 * k * step], u, v, i + 2 * k, p);
        pixel_of_yuv(c, (float)luma[(2 * k + 1) * step], u, v, i + 2 * k + 1, p);
    }
    if ((n - i) % 2) {
        const uint32_t k = (n - i) / 2;
        const float u = (float)chroma[k * pair] - 128.0f, v = (float)chroma[k * pair + apart] - 128.0f;
        pixel_of_yuv(c, (float)luma[2 * k * step], u, v, n - 1, p);
    }
    codes_to_light(p, n, c->light);
}

static int load_yuyv(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    load_yuv(coder, row->data, row->data + 1, 2, 2, 4, x, n, planes);
    return 1;
}

static int load_nv12(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n, pupil_planes *planes)
{
    load_yuv(coder, row->data, row->chroma, 1, 1, 2, x, n, planes);
    return 1;
}

/* ---- grey ----------------------------------------------------------------------------------------------------------
 */

static inline void grey_to_planes(const pupil_coder *c, uint32_t n, pupil_planes *restrict p)
{
    if (c->light)
        for (uint32_t i = 0; i < n; i++)
            p->r[i] = light_of(p->r[i] * 255.0f, c->light);
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

/* ---- mosaics -------------------------------------------------------------------------------------------------------
 */

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
    const uint8_t *group = row + (size_t)(x / 4) * 5;
    return (uint16_t)(group[x % 4] << 2 | (group[4] >> 2 * (x % 4) & 3));
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
    const uint8_t *group = row + (size_t)(x / 2) * 3;
    return (uint16_t)(group[x % 2] << 4 | (group[2] >> 4 * (x % 2) & 15));
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

/* Two pixels of a row from pixel i on: first one where the row's own colour (red or blue) is, then a green one. In
 * `own` and `other` go the row's colour and the one of the rows beside. */
static inline void interpolate_own(const uint16_t *up, const uint16_t *at, const uint16_t *down, uint32_t sum4[3])
{
    sum4[0] = 4u * at[0];
    sum4[1] = (uint32_t)at[-1] + at[1] + up[0] + down[0];
    sum4[2] = (uint32_t)up[-1] + up[1] + down[-1] + down[1];
}

static inline void interpolate_green(const uint16_t *up, const uint16_t *at, const uint16_t *down, uint32_t sum4[3])
{
    sum4[0] = 2u * ((uint32_t)at[-1] + at[1]);
    sum4[1] = 4u * at[0];
    sum4[2] = 2u * ((uint32_t)up[0] + down[0]);
}

static inline void interpolate(const pupil_coder *c, const uint16_t *up, const uint16_t *at, const uint16_t *down,
                               int own_first, int own, uint32_t n, pupil_planes *restrict p)
{
    float *restrict mine = own ? p->b : p->r, *restrict other = own ? p->r : p->b, *restrict green = p->g;
    const int mine_channel = own ? 2 : 0, other_channel = 2 - mine_channel;
    uint32_t sum4[3];
    for (uint32_t half = 0; half < 2; half++) { /* every second pixel, then the others */
        const int is_own = (half == 0) == own_first;
        for (uint32_t i = half; i < n; i += 2) {
            if (is_own)
                interpolate_own(up + i, at + i, down + i, sum4);
            else
                interpolate_green(up + i, at + i, down + i, sum4);
            mine[i] = develop(sum4[0], c, mine_channel);
            green[i] = develop(sum4[1], c, 1);
            other[i] = develop(sum4[2], c, other_channel);
        }
    }
}

static void bilinear(const pupil_coder *c, const uint16_t *const rows[3], int red_x, int red_y, uint32_t n,
                     pupil_planes *p)
{
    const uint16_t *up = rows[0] + 1, *at = rows[1] + 1, *down = rows[2] + 1;
    /* in a row of red samples the first is red where red_x says so; in one of blue, blue where it does not */
    if (red_y)
        interpolate(c, up, at, down, red_x, 0, n, p);
    else
        interpolate(c, up, at, down, !red_x, 1, n, p);
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

/* ---- as entries of a level's table ---------------------------------------------------------------------------------
 */

#define LOADS_BY_FORMAT                                                                                                \
    [PUPIL_PIXEL_RGBA8] = load_rgba8, [PUPIL_PIXEL_RGB8] = load_rgb8, [PUPIL_PIXEL_YUYV] = load_yuyv,                  \
    [PUPIL_PIXEL_NV12] = load_nv12, [PUPIL_PIXEL_GREY8] = load_grey8, [PUPIL_PIXEL_GREY10] = load_grey16,              \
    [PUPIL_PIXEL_GREY12] = load_grey16, [PUPIL_PIXEL_GREY16] = load_grey16

#define UNPACK_AND_DEVELOP                                                                                             \
    .unpack =                                                                                                          \
        {                                                                                                              \
            [PUPIL_PIXEL_BAYER8] = unpack_bayer8,     [PUPIL_PIXEL_BAYER10] = unpack_bayer16,                          \
            [PUPIL_PIXEL_BAYER12] = unpack_bayer16,   [PUPIL_PIXEL_BAYER14] = unpack_bayer16,                          \
            [PUPIL_PIXEL_BAYER16] = unpack_bayer16,   [PUPIL_PIXEL_BAYER10P] = unpack_bayer10p,                        \
            [PUPIL_PIXEL_BAYER12P] = unpack_bayer12p,                                                                  \
    },                                                                                                                 \
    .binned = binned, .bilinear = bilinear, .matrix = matrix

#endif
