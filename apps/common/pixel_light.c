#include "pixel_light.h"

#include <math.h>
#include <string.h>

static const pupil_coding usual;

static const pupil_coding *coding_of(const pupil_image_const *image)
{
    return image->coding ? image->coding : &usual;
}

unsigned pixel_colour(uint32_t bayer, uint32_t x, uint32_t y)
{
    static const unsigned char order[PUPIL_BAYER_COUNT][2][2] = {
        {{0, 1}, {1, 2}}, {{1, 0}, {2, 1}}, {{1, 2}, {0, 1}}, {{2, 1}, {1, 0}}};
    return order[bayer][y % 2][x % 2];
}

static const unsigned char *row_at(const pupil_image_const *image, uint32_t y)
{
    return (const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes;
}

static unsigned sample_at(const pupil_image_const *image, uint32_t x, uint32_t y)
{
    const unsigned char *row = row_at(image, y), *group;
    uint16_t word;
    switch (image->pixel) {
    case PUPIL_PIXEL_GREY8:
    case PUPIL_PIXEL_BAYER8:
        return row[x];
    case PUPIL_PIXEL_GREY10P:
    case PUPIL_PIXEL_BAYER10P: /* MIPI CSI-2 RAW10: the fifth byte has the lowest two bits of each pixel, from the first
                                * up */
        group = row + x / 4 * 5;
        return (unsigned)group[x % 4] << 2 | (group[4] >> 2 * (x % 4) & 3u);
    case PUPIL_PIXEL_GREY12P:
    case PUPIL_PIXEL_BAYER12P: /* RAW12: the third byte has the lowest four bits */
        group = row + x / 2 * 3;
        return (unsigned)group[x % 2] << 4 | (group[2] >> 4 * (x % 2) & 15u);
    default:
        memcpy(&word, row + 2 * (size_t)x, sizeof word);
        return (unsigned)word >> coding_of(image)->shift;
    }
}

/* SMPTE ST 2084 as in Rec. ITU-R BT.2100-2, table 4: 10000 cd/m2 at 1, and 100 cd/m2 are 1.0. */
static double pq_light(double v)
{
    const double m1 = 2610.0 / 16384.0, m2 = 2523.0 / 4096.0 * 128.0;
    const double c1 = 3424.0 / 4096.0, c2 = 2413.0 / 4096.0 * 32.0, c3 = 2392.0 / 4096.0 * 32.0;
    const double p = pow(v, 1.0 / m2);
    return 100.0 * pow(fmax(p - c1, 0.0) / (c2 - c3 * p), 1.0 / m1);
}

/* The inverse OETF of Rec. ITU-R BT.2100-2, table 5. */
static double hlg_light(double v)
{
    const double a = 0.17883277, b = 1.0 - 4.0 * a, c = 0.5 - a * log(4.0 * a);
    return v <= 0.5 ? v * v / 3.0 : fmin((exp((v - c) / a) + b) / 12.0, 1.0);
}

/* A coded value to light. The caller resolves the default. */
static double decoded(double v, uint32_t light)
{
    if (light == PUPIL_LIGHT_LINEAR)
        return v;
    v = v > 0.0 ? v < 1.0 ? v : 1.0 : 0.0;
    if (light == PUPIL_LIGHT_BT709) /* Rec. ITU-R BT.709-6, item 1.2, backward */
        return v < 0.081 ? v / 4.5 : pow((v + 0.099) / 1.099, 1.0 / 0.45);
    if (light == PUPIL_LIGHT_PQ)
        return pq_light(v);
    if (light == PUPIL_LIGHT_HLG)
        return hlg_light(v);
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); /* IEC 61966-2-1 */
}

/* From 0 at black to 1 at white. */
static double between(const pupil_image_const *image, double code)
{
    const pupil_coding *c = coding_of(image);
    const double black = (double)c->black;
    const double white = c->white > 0.0f ? (double)c->white : (double)((1u << pupil_pixel_bits(image->pixel)) - 1);
    double from = black, light = 0.0;
    for (uint32_t k = 0; k < c->knees; k++) {
        const double to = (double)c->knee_code[k], there = (double)c->knee_light[k];
        if (code < to)
            return light + (code - from) * (there - light) / (to - from);
        from = to;
        light = there;
    }
    return light + (code - from) * (1.0 - light) / (white - from);
}

static int word_at(const void *plane, ptrdiff_t stride, uint32_t x, uint32_t y)
{
    uint16_t word;
    memcpy(&word, (const unsigned char *)plane + (ptrdiff_t)y * stride + 2 * (size_t)x, sizeof word);
    return word;
}

/* As yuv_at, of formats of 10 and 16 bits. */
static void yuv_words_at(const pupil_image_const *image, uint32_t x, uint32_t y, int code[3])
{
    const ptrdiff_t chroma_stride = image->chroma_stride_bytes;
    code[0] = word_at(image->data, image->stride_bytes, x, y);
    if (image->pixel == PUPIL_PIXEL_I444_16) {
        code[1] = word_at(image->chroma, chroma_stride, x, y);
        code[2] = word_at(image->cr, image->cr_stride_bytes, x, y);
        return;
    }
    if (image->pixel == PUPIL_PIXEL_I420_10) {
        code[1] = word_at(image->chroma, chroma_stride, x / 2, y / 2);
        code[2] = word_at(image->cr, image->cr_stride_bytes, x / 2, y / 2);
        return;
    }
    code[1] = word_at(image->chroma, chroma_stride, x / 2 * 2, y / 2);
    code[2] = word_at(image->chroma, chroma_stride, x / 2 * 2 + 1, y / 2);
    for (int k = 0; k < 3; k++)
        code[k] >>= 6;
}

/* Y', Cb and Cr of a pixel, as the format's comment in pupil/image.h has them. */
static void yuv_at(const pupil_image_const *image, uint32_t x, uint32_t y, int code[3])
{
    const unsigned char *row = row_at(image, y), *cb, *cr;
    const uint32_t chroma_y = image->pixel == PUPIL_PIXEL_NV16 ? y : y / 2;
    if (image->pixel == PUPIL_PIXEL_YUYV || image->pixel == PUPIL_PIXEL_UYVY) {
        const uint32_t luma_at = image->pixel == PUPIL_PIXEL_UYVY;
        const unsigned char *pair = row + x / 2 * 4;
        code[0] = pair[x % 2 * 2 + luma_at];
        code[1] = pair[1 - luma_at];
        code[2] = pair[3 - luma_at];
        return;
    }
    cb = (const unsigned char *)image->chroma + (ptrdiff_t)chroma_y * image->chroma_stride_bytes;
    if (image->pixel == PUPIL_PIXEL_I420) {
        cr = (const unsigned char *)image->cr + (ptrdiff_t)chroma_y * image->cr_stride_bytes + x / 2;
        cb += x / 2;
    } else {
        cb += x / 2 * 2;
        cr = cb + 1;
    }
    code[0] = row[x];
    code[1] = image->pixel == PUPIL_PIXEL_NV21 ? *cr : *cb;
    code[2] = image->pixel == PUPIL_PIXEL_NV21 ? *cb : *cr;
}

static void yuv_light(const pupil_image_const *image, uint32_t x, uint32_t y, double rgb[3])
{
    /* Kr and Kb of BT.601, BT.709 and BT.2020: coding.h */
    static const double kr_kb[PUPIL_MATRIX_COUNT][2] = {{0.299, 0.114}, {0.2126, 0.0722}, {0.2627, 0.0593}};
    const pupil_coding *c = coding_of(image);
    const double kr = kr_kb[c->matrix][0], kb = kr_kb[c->matrix][1];
    const int full = c->range == PUPIL_RANGE_FULL;
    int code[3];
    const int ten = image->pixel == PUPIL_PIXEL_P010 || image->pixel == PUPIL_PIXEL_I420_10;
    const int one = image->pixel == PUPIL_PIXEL_I444_16 ? 256 : ten ? 4 : 1; /* of 8 bits */
    if (one > 1)
        yuv_words_at(image, x, y, code);
    else
        yuv_at(image, x, y, code);
    const double all = 256.0 * one - 1.0, chroma = full ? all : 224.0 * one;
    const double l = full ? code[0] / all : (code[0] - 16 * one) / (219.0 * one);
    rgb[0] = l + 2.0 * (1.0 - kr) * (code[2] - 128 * one) / chroma;
    rgb[2] = l + 2.0 * (1.0 - kb) * (code[1] - 128 * one) / chroma;
    rgb[1] = (l - kr * rgb[0] - kb * rgb[2]) / (1.0 - kr - kb);
    for (int k = 0; k < 3; k++) {
        const double v = rgb[k] > 0.0 ? rgb[k] < 1.0 ? rgb[k] : 1.0 : 0.0;
        rgb[k] = decoded(v, c->light == PUPIL_LIGHT_DEFAULT ? PUPIL_LIGHT_SRGB : c->light);
    }
}

/* The mean light of a colour's samples in the quad, or in the 3 x 3 around a pixel of another colour. The frame is
 * mirrored at its edges. */
static double mean_of(const pupil_image_const *image, uint32_t x, uint32_t y, unsigned colour, int quad)
{
    const uint32_t bayer = coding_of(image)->bayer;
    double sum = 0.0;
    unsigned count = 0;
    if (!quad && pixel_colour(bayer, x, y) == colour)
        return between(image, sample_at(image, x, y));
    for (int64_t sy = (int64_t)y - !quad; sy <= (int64_t)y + 1; sy++)
        for (int64_t sx = (int64_t)x - !quad; sx <= (int64_t)x + 1; sx++) {
            const uint32_t inside_x = (uint32_t)(sx < 0 ? 1 : sx < image->width ? sx : image->width - 2);
            const uint32_t inside_y = (uint32_t)(sy < 0 ? 1 : sy < image->height ? sy : image->height - 2);
            if (pixel_colour(bayer, inside_x, inside_y) == colour) {
                sum += between(image, sample_at(image, inside_x, inside_y));
                count++;
            }
        }
    return sum / count;
}

static void mosaic_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, double rgb[3])
{
    const pupil_coding *c = coding_of(image);
    const float *m = c->rgb_from_camera;
    double balance[3] = {1.0, 1.0, 1.0}, v[3];
    int matrix = 0;
    for (int k = 0; k < 3 && c->balance[0] > 0.0f; k++)
        balance[k] = (double)c->balance[k];
    const double most = fmin(fmin(balance[0], balance[1]), balance[2]);
    for (unsigned k = 0; k < 3; k++)
        v[k] = fmin(mean_of(image, x, y, k, quad) * balance[k], most);
    for (int k = 0; k < 9; k++)
        matrix |= m[k] < 0.0f || m[k] > 0.0f;
    for (int k = 0; k < 3; k++)
        rgb[k] = matrix ? (double)m[3 * k] * v[0] + (double)m[3 * k + 1] * v[1] + (double)m[3 * k + 2] * v[2] : v[k];
}

static double half_to_double(uint16_t h)
{
    const int exponent = h >> 10 & 31, fraction = h & 1023;
    double magnitude = ldexp(1024 + fraction, exponent - 25);
    if (exponent == 31)
        magnitude = fraction ? (double)NAN : (double)INFINITY;
    else if (exponent == 0)
        magnitude = ldexp(fraction, -24);
    return h & 0x8000 ? -magnitude : magnitude;
}

/* One sample of a pixel that has its own red, green and blue; alpha is linear. */
static double component(uint32_t pixel, const unsigned char *row, size_t at, int is_alpha)
{
    float f;
    uint16_t word;
    switch (pixel) {
    case PUPIL_PIXEL_RGBA32F:
    case PUPIL_PIXEL_RGB32F:
    case PUPIL_PIXEL_BGR32F:
        memcpy(&f, row + 4 * at, sizeof f);
        return (double)f;
    case PUPIL_PIXEL_RGBA16F:
    case PUPIL_PIXEL_RGB16F:
        memcpy(&word, row + 2 * at, sizeof word);
        return half_to_double(word);
    case PUPIL_PIXEL_RGBA16:
    case PUPIL_PIXEL_RGB16:
        memcpy(&word, row + 2 * at, sizeof word);
        return word / 65535.0;
    default:
        return decoded(row[at] / 255.0, is_alpha ? PUPIL_LIGHT_LINEAR : PUPIL_LIGHT_SRGB);
    }
}

static void rgb_light(const pupil_image_const *image, uint32_t x, uint32_t y, double rgba[4])
{
    const uint32_t pixel = image->pixel;
    const int is_rgb = pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_RGB16 || pixel == PUPIL_PIXEL_RGB8 ||
                       pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGR32F || pixel == PUPIL_PIXEL_RGB16F;
    const int blue_first = pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGRX8 || pixel == PUPIL_PIXEL_BGR32F;
    const int ignored = pixel == PUPIL_PIXEL_BGRX8 || pixel == PUPIL_PIXEL_RGBX8;
    const size_t channels = is_rgb ? 3 : 4;
    for (size_t c = 0; c < (ignored ? 3 : channels); c++)
        rgba[blue_first ? 2 - c : c] = component(pixel, row_at(image, y), x * channels + c, c == 3);
}

static int is_yuv(uint32_t pixel)
{
    return pupil_pixel_planes(pixel) > 1 || pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
}

static void rgb10a2_light(const pupil_image_const *image, uint32_t x, uint32_t y, double rgba[4])
{
    const uint32_t light = coding_of(image)->light;
    uint32_t word;
    memcpy(&word, row_at(image, y) + 4 * (size_t)x, sizeof word);
    for (int k = 0; k < 3; k++)
        rgba[k] = decoded((word >> 10 * k & 1023) / 1023.0, light == PUPIL_LIGHT_DEFAULT ? PUPIL_LIGHT_SRGB : light);
    rgba[3] = (word >> 30) / 3.0;
}

void pixel_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, double rgba[4])
{
    const uint32_t light = coding_of(image)->light;
    rgba[3] = 1.0;
    if (pupil_pixel_is_mosaic(image->pixel))
        mosaic_light(image, x, y, quad, rgba);
    else if (pupil_pixel_bits(image->pixel))
        rgba[0] = rgba[1] = rgba[2] =
            decoded(between(image, sample_at(image, x, y)), light == PUPIL_LIGHT_DEFAULT ? PUPIL_LIGHT_LINEAR : light);
    else if (is_yuv(image->pixel))
        yuv_light(image, x, y, rgba);
    else if (image->pixel == PUPIL_PIXEL_RGB10A2)
        rgb10a2_light(image, x, y, rgba);
    else
        rgb_light(image, x, y, rgba);
}
