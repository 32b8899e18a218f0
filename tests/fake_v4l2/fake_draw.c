/* tests/fake_v4l2/fake_draw.c: the fake camera's picture, in each format. */
#include "fake_v4l2.h"

#include <linux/videodev2.h>
#include <math.h>
#include <string.h>

#include "pupil/image.h"
#include "v4l2/format.h"

/* Smooth moving ramps and some noise; in integers, so the same on every machine. */
uint32_t fake_v4l2_scene(uint64_t seed, uint32_t sequence, uint32_t x, uint32_t y, uint32_t channel)
{
    const uint32_t qx = x / 2, qy = y / 2;
    uint64_t z = seed + UINT64_C(0x9e3779b97f4a7c15) * (1 + qx + ((uint64_t)qy << 16) + ((uint64_t)channel << 32));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9); /* SplitMix64's mixing, as tests/check.h */
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    const uint32_t ramp = (qx * (5 + 2 * channel) + qy * 3 + sequence * 11) % 896;
    return 64 + ramp + (uint32_t)(z >> 58);
}

double fake_v4l2_lamp(const fake_v4l2_picture *p, uint32_t y)
{
    const double pi = 3.14159265358979324, half = pi * p->lamp_hz * p->exposure_s;
    const double middle_s = p->end_s - p->readout_s * (1.0 - (y + 0.5) / p->height) - 0.5 * p->exposure_s;
    const double left = half > 0.0 ? sin(half) / half : 1.0; /* the part of a wave that the exposure averages */
    return 1.0 + p->modulation * left * cos(2.0 * pi * p->lamp_hz * middle_s);
}

typedef struct drawing {
    const fake_v4l2_picture *p;
    uint32_t first, end; /* rows */
    double lamp;         /* the light on them */
    unsigned char *data, *chroma, *cr;
    uint32_t code[3][1024];  /* of a channel's value of the scene */
    double encoded[3][1024]; /* the same before rounding, 0..1 */
    uint32_t bits, red_x, red_y;
} drawing;

static double encode(uint32_t xfer_func, double light)
{
    if (xfer_func == V4L2_XFER_FUNC_NONE)
        return light;
    if (xfer_func == V4L2_XFER_FUNC_709) /* Rec. ITU-R BT.709-6, item 1.2 */
        return light < 0.018 ? 4.5 * light : 1.099 * pow(light, 0.45) - 0.099;
    if (xfer_func == V4L2_XFER_FUNC_SMPTE2084) { /* Rec. ITU-R BT.2100-2, table 4; 1.0 is 100 of 10000 cd/m2 */
        const double power = pow(light / 100.0, 2610.0 / 16384.0);
        return pow((3424.0 / 4096.0 + 2413.0 / 128.0 * power) / (1.0 + 2392.0 / 128.0 * power), 2523.0 / 32.0);
    }
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055; /* IEC 61966-2-1 */
}

static double light_of(const drawing *d, uint32_t channel, uint32_t scene)
{
    const fake_v4l2_picture *p = d->p;
    const int white = !(p->colour[0] > 0.0 || p->colour[1] > 0.0 || p->colour[2] > 0.0);
    const double light =
        p->black + scene * (d->lamp * p->scale * (white ? 1.0 : p->colour[channel])) / FAKE_SCENE_WHITE;
    return light < 1.0 ? light : 1.0;
}

static uint32_t at(const drawing *d, uint32_t x, uint32_t y, uint32_t channel)
{
    return d->p->flat ? d->p->flat : fake_v4l2_scene(d->p->seed, d->p->sequence, x, y, channel);
}

/* The channel that a mosaic has at a pixel. */
static uint32_t channel_at(const drawing *d, uint32_t x, uint32_t y)
{
    const uint32_t is_red_x = x % 2 == d->red_x, is_red_y = y % 2 == d->red_y;
    return is_red_x && is_red_y ? 0 : !is_red_x && !is_red_y ? 2 : 1;
}

static unsigned char *row_of(const drawing *d, uint32_t y)
{
    return d->data + (size_t)y * d->p->stride_bytes[0];
}

/* One channel per pixel, packed, in bytes or in words; `colours`: a mosaic. */
static void draw_samples(const drawing *d, int colours, int packed)
{
    for (uint32_t y = d->first; y < d->end; y++) {
        unsigned char *row = row_of(d, y);
        const uint32_t group = d->bits == 10 ? 4 : 2;
        for (uint32_t x = 0; x < d->p->width; x++) {
            const uint32_t channel = colours ? channel_at(d, x, y) : 1, code = d->code[channel][at(d, x, y, channel)];
            if (packed) { /* the upper eight bits of each, then the lower ones of all */
                unsigned char *low = row + x / group * (group + 1) + group;
                const uint32_t few = d->bits - 8, shift = x % group * few;
                row[x / group * (group + 1) + x % group] = (unsigned char)(code >> few);
                *low = (unsigned char)((x % group ? *low : 0) | (code & ((1u << few) - 1)) << shift);
            } else if (d->bits == 8) {
                row[x] = (unsigned char)code;
            } else {
                const uint16_t word = (uint16_t)code;
                memcpy(row + 2 * x, &word, 2);
            }
        }
    }
}

static void to_yuv(const drawing *d, uint32_t x, uint32_t y, uint32_t yuv[3])
{
    const fake_v4l2_picture *p = d->p;
    const double kr = p->ycbcr_enc == V4L2_YCBCR_ENC_709      ? 0.2126
                      : p->ycbcr_enc == V4L2_YCBCR_ENC_BT2020 ? 0.2627
                                                              : 0.299;
    const double kb = p->ycbcr_enc == V4L2_YCBCR_ENC_709      ? 0.0722
                      : p->ycbcr_enc == V4L2_YCBCR_ENC_BT2020 ? 0.0593
                                                              : 0.114;
    const int full = p->quantization == V4L2_QUANTIZATION_FULL_RANGE;
    const double one = 1u << (d->bits - 8), all = (1u << d->bits) - 1; /* one of 8 bits; the largest code */
    double rgb[3];
    for (uint32_t c = 0; c < 3; c++)
        rgb[c] = d->encoded[c][at(d, x, y, c)];
    const double luma = kr * rgb[0] + (1 - kr - kb) * rgb[1] + kb * rgb[2];
    const double cb = (rgb[2] - luma) / (2 * (1 - kb)), cr = (rgb[0] - luma) / (2 * (1 - kr));
    yuv[0] = (uint32_t)(full ? all * luma + 0.5 : one * (16 + 219 * luma) + 0.5);
    yuv[1] = (uint32_t)fmin(all, 128 * one + (full ? all : 224 * one) * cb + 0.5);
    yuv[2] = (uint32_t)fmin(all, 128 * one + (full ? all : 224 * one) * cr + 0.5);
}

/* Y' in the first or in the second of each two bytes. */
static void draw_packed_yuv(const drawing *d, uint32_t luma_at)
{
    for (uint32_t y = d->first; y < d->end; y++) {
        unsigned char *row = row_of(d, y);
        for (uint32_t x = 0; x < d->p->width; x++) {
            uint32_t yuv[3];
            to_yuv(d, x, y, yuv);
            row[2 * x + luma_at] = (unsigned char)yuv[0];
            row[x / 2 * 4 + 1 - luma_at] = (unsigned char)yuv[1];
            row[x / 2 * 4 + 3 - luma_at] = (unsigned char)yuv[2];
            if (x % 2 == 0) /* for an odd width the last pixel counts twice */
                row[2 * x + 2 + luma_at] = (unsigned char)yuv[0];
        }
    }
}

/* A sample in a byte, or in the upper bits of a word. */
static void put(const drawing *d, unsigned char *row, uint32_t i, uint32_t code)
{
    const uint16_t word = (uint16_t)(code << (16 - d->bits));
    if (d->bits == 8)
        row[i] = (unsigned char)code;
    else
        memcpy(row + 2 * i, &word, 2);
}

static void draw_planes(const drawing *d, uint32_t pixel)
{
    const int planar = pupil_pixel_planes(pixel) == 3, turned = pixel == PUPIL_PIXEL_NV21;
    for (uint32_t y = d->first; y < d->end; y++) {
        const size_t chroma_row = (size_t)pupil_chroma_row_of(pixel, y);
        unsigned char *chroma = d->chroma + chroma_row * d->p->stride_bytes[1];
        unsigned char *cr = planar ? d->cr + chroma_row * d->p->stride_bytes[2] : chroma;
        for (uint32_t x = 0; x < d->p->width; x++) {
            uint32_t yuv[3];
            to_yuv(d, x, y, yuv);
            put(d, row_of(d, y), x, yuv[0]);
            put(d, chroma, planar ? x / 2 : x / 2 * 2 + turned, yuv[1]);
            put(d, cr, planar ? x / 2 : x / 2 * 2 + !turned, yuv[2]);
        }
    }
}

static void draw_rgb(const drawing *d, uint32_t bytes, uint32_t red)
{
    for (uint32_t y = d->first; y < d->end; y++)
        for (uint32_t x = 0; x < d->p->width; x++) {
            unsigned char *pixel = row_of(d, y) + bytes * x;
            for (uint32_t c = 0; c < 3; c++)
                pixel[red ? 2 - c : c] = (unsigned char)d->code[c][at(d, x, y, c)];
            if (bytes == 4)
                pixel[3] = 255;
        }
}

static void make_codes(drawing *d, uint32_t bits, uint32_t xfer_func)
{
    d->bits = bits;
    const uint32_t flat = d->p->flat, first = flat ? flat : 0, end = flat ? flat + 1 : 1024;
    for (uint32_t c = 0; c < 3; c++)
        for (uint32_t v = first; v < end; v++) {
            d->encoded[c][v] = encode(xfer_func, light_of(d, c, v));
            d->code[c][v] = (uint32_t)(d->encoded[c][v] * ((1u << bits) - 1) + 0.5);
        }
}

static void draw_mosaic(drawing *d, uint32_t fourcc)
{
    static const struct {
        uint32_t fourcc[7]; /* 8, 10, 12, 14, 16, 10P, 12P */
    } orders[] = {
#define ORDER(o, a, b, c)                                                                                              \
    {                                                                                                                  \
        {                                                                                                              \
            V4L2_PIX_FMT_##o##8, V4L2_PIX_FMT_##o##10, V4L2_PIX_FMT_##o##12, a, V4L2_PIX_FMT_##o##16, b, c             \
        }                                                                                                              \
    }
        ORDER(SRGGB, v4l2_fourcc('R', 'G', '1', '4'), V4L2_PIX_FMT_SRGGB10P, v4l2_fourcc('p', 'R', 'C', 'C')),
        ORDER(SGRBG, v4l2_fourcc('G', 'R', '1', '4'), V4L2_PIX_FMT_SGRBG10P, v4l2_fourcc('p', 'g', 'C', 'C')),
        ORDER(SGBRG, v4l2_fourcc('G', 'B', '1', '4'), V4L2_PIX_FMT_SGBRG10P, v4l2_fourcc('p', 'G', 'C', 'C')),
        ORDER(SBGGR, v4l2_fourcc('B', 'G', '1', '4'), V4L2_PIX_FMT_SBGGR10P, v4l2_fourcc('p', 'B', 'C', 'C')),
    };
    static const uint32_t bits[] = {8, 10, 12, 14, 16, 10, 12};
    for (uint32_t order = 0; order < 4; order++)
        for (uint32_t i = 0; i < 7; i++)
            if (orders[order].fourcc[i] == fourcc) {
                d->red_x = order == 1 || order == 3; /* GR.., BG..: red in the second column */
                d->red_y = order >= 2;               /* GB.., BG..: red in the second row */
                make_codes(d, bits[i], V4L2_XFER_FUNC_NONE);
                draw_samples(d, 1, i >= 5);
            }
}

static void draw_rows(drawing *d)
{
    const uint32_t pixel = pupil_v4l2_pixel_of(d->p->fourcc), bits = pupil_pixel_bits(pixel);
    if (pupil_pixel_is_mosaic(pixel)) {
        draw_mosaic(d, d->p->fourcc);
    } else if (bits) {
        make_codes(d, bits, d->p->xfer_func);
        draw_samples(d, 0, pixel == PUPIL_PIXEL_GREY10P || pixel == PUPIL_PIXEL_GREY12P);
    } else if (pupil_pixel_planes(pixel) > 1) {
        make_codes(d, pixel == PUPIL_PIXEL_P010 ? 10 : 8, d->p->xfer_func);
        draw_planes(d, pixel);
    } else if (pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY) {
        make_codes(d, 8, d->p->xfer_func);
        draw_packed_yuv(d, pixel == PUPIL_PIXEL_UYVY);
    } else {
        make_codes(d, 8, V4L2_XFER_FUNC_SRGB);
        draw_rgb(d, (uint32_t)pupil_pixel_bytes(pixel),
                 pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGRX8 ? 2 : 0);
    }
}

void fake_v4l2_draw(const fake_v4l2_picture *picture, void *data, void *chroma, void *cr)
{
    drawing d = {.p = picture, .end = picture->height, .lamp = 1.0, .data = data, .chroma = chroma, .cr = cr};
    if (!(picture->lamp_hz > 0.0))
        draw_rows(&d);
    for (uint32_t y = 0; y < picture->height && picture->lamp_hz > 0.0; y++) {
        d.first = y;
        d.end = y + 1;
        d.lamp = fake_v4l2_lamp(picture, y);
        draw_rows(&d);
    }
}
