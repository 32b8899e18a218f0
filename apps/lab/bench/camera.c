#include "camera.h"

#include <math.h>
#include <string.h>

#include "common/pixel_light.h"

/* A sensor with its black at 64 of 1023 or the like, a daylight balance, and a matrix of the usual size, whose rows sum
 * up to 1 so that white stays white. */
#define SENSOR(bits)                                                                                                   \
    {                                                                                                                  \
        .bayer = PUPIL_BAYER_RGGB, .black = (float)(1u << ((bits)-4)), .balance = {1.9f, 1.0f, 1.5f},                  \
        .rgb_from_camera = {                                                                                           \
            1.6f,                                                                                                      \
            -0.5f,                                                                                                     \
            -0.1f,                                                                                                     \
            -0.25f,                                                                                                    \
            1.5f,                                                                                                      \
            -0.25f,                                                                                                    \
            0.0f,                                                                                                      \
            -0.5f,                                                                                                     \
            1.5f                                                                                                       \
        }                                                                                                              \
    }

static const pupil_coding video = {.matrix = PUPIL_MATRIX_BT709, .range = PUPIL_RANGE_LIMITED};
static const pupil_coding sensor[5] = {SENSOR(8), SENSOR(10), SENSOR(12), SENSOR(14), SENSOR(16)};

static int is_packed_yuv(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
}

int bench_is_yuv(uint32_t pixel)
{
    return pupil_pixel_planes(pixel) > 1 || is_packed_yuv(pixel);
}

const pupil_coding *bench_coding(uint32_t pixel)
{
    return pupil_pixel_is_mosaic(pixel) ? &sensor[pupil_pixel_bits(pixel) / 2 - 4]
           : bench_is_yuv(pixel)        ? &video
                                        : NULL;
}

static double clamped(double value)
{
    return value > 0.0 ? value < 1.0 ? value : 1.0 : 0.0;
}

static double srgb(double light) /* IEC 61966-2-1 */
{
    light = clamped(light);
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

static unsigned char *row_of(const pupil_image_const *image, uint32_t y)
{
    return (unsigned char *)(uintptr_t)image->data + (ptrdiff_t)y * image->stride_bytes;
}

static unsigned char *luma_of(const pupil_image_const *image, uint32_t x, uint32_t y)
{
    unsigned char *row = row_of(image, y);
    return is_packed_yuv(image->pixel) ? row + 2 * (size_t)x + (image->pixel == PUPIL_PIXEL_UYVY)
                                       : row + pupil_pixel_bytes(image->pixel) * x;
}

/* Rows of a plane of chroma, 1: Cb, 2: Cr where it has its own. */
static unsigned char *chroma_row_of(const pupil_image_const *image, uint32_t row, int plane)
{
    const ptrdiff_t stride = plane == 2 ? image->cr_stride_bytes : image->chroma_stride_bytes;
    return (unsigned char *)(uintptr_t)(plane == 2 ? image->cr : image->chroma) + (ptrdiff_t)row * stride;
}

/* Cb (0) or Cr (1) of the pair that x is in. */
static unsigned char *chroma_of(const pupil_image_const *image, uint32_t x, uint32_t y, uint32_t which)
{
    const uint32_t row = (uint32_t)pupil_chroma_row_of(image->pixel, y);
    if (is_packed_yuv(image->pixel))
        return row_of(image, y) + x / 2 * 4 + 2 * which + (image->pixel == PUPIL_PIXEL_YUYV);
    const size_t bytes = pupil_pixel_bytes(image->pixel);
    if (image->pixel == PUPIL_PIXEL_I444_16)
        return chroma_row_of(image, row, which ? 2 : 1) + x * bytes;
    if (pupil_pixel_planes(image->pixel) > 2)
        return chroma_row_of(image, row, which ? 2 : 1) + x / 2 * bytes;
    return chroma_row_of(image, row, 1) + (x / 2 * 2 + (image->pixel == PUPIL_PIXEL_NV21 ? 1 - which : which)) * bytes;
}

/* --- a frame like a camera's --- */

/* A code of 8 bits, not yet rounded, or 4 or 256 times it in a word. */
static void store_code(uint32_t pixel, unsigned char *at, double code)
{
    const int is_16 = pixel == PUPIL_PIXEL_I444_16;
    const unsigned up = pixel == PUPIL_PIXEL_P010 ? 6 : 0;
    const uint16_t word = (uint16_t)((unsigned)((is_16 ? 256.0 : 4.0) * code + 0.5) << up);
    if (pixel == PUPIL_PIXEL_P010 || pixel == PUPIL_PIXEL_I420_10 || is_16)
        memcpy(at, &word, sizeof word);
    else
        *at = (unsigned char)(code + 0.5);
}

/* BT.709, limited range (Rec. ITU-R BT.709-6, items 3.2 to 3.5): the chroma of a pair or a quad is that of its mean. */
static void store_yuv(const pupil_image_const *image, uint32_t x, uint32_t y, const float rgba[4][4])
{
    const int each = image->pixel == PUPIL_PIXEL_I444_16; /* pixel has its own chroma */
    const int each_row = pupil_chroma_rows(image->pixel, 2) != 1;
    double blue = 0.0, red = 0.0;
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t at_x = x + i % 2, at_y = y + i / 2;
        const double r = srgb((double)rgba[i][0]), g = srgb((double)rgba[i][1]), b = srgb((double)rgba[i][2]);
        const double luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if (at_y >= image->height)
            break;
        if (at_x < image->width)
            store_code(image->pixel, luma_of(image, at_x, at_y), 16.0 + 219.0 * luma);
        blue += (b - luma) / (2.0 * (1.0 - 0.0722));
        red += (r - luma) / (2.0 * (1.0 - 0.2126));
        if (each || (i % 2 && (each_row || i == 3 || at_y + 1 == image->height))) {
            const double samples = each ? 1.0 : each_row || i == 1 ? 2.0 : 4.0;
            if (!each || at_x < image->width) {
                store_code(image->pixel, chroma_of(image, at_x, at_y, 0), 128.0 + 224.0 * blue / samples);
                store_code(image->pixel, chroma_of(image, at_x, at_y, 1), 128.0 + 224.0 * red / samples);
            }
            blue = red = 0.0;
        }
    }
}

/* The memory is zeroed: samples that share a byte are combined by or. */
static void store_sample(const pupil_image_const *image, uint32_t x, uint32_t y, unsigned code)
{
    unsigned char *row = row_of(image, y);
    const uint16_t word = (uint16_t)code;
    if (image->pixel == PUPIL_PIXEL_BAYER10P || image->pixel == PUPIL_PIXEL_GREY10P) {
        row[x / 4 * 5 + x % 4] = (unsigned char)(code >> 2);
        row[x / 4 * 5 + 4] |= (unsigned char)((code & 3u) << 2 * (x % 4));
    } else if (image->pixel == PUPIL_PIXEL_BAYER12P || image->pixel == PUPIL_PIXEL_GREY12P) {
        row[x / 2 * 3 + x % 2] = (unsigned char)(code >> 4);
        row[x / 2 * 3 + 2] |= (unsigned char)((code & 15u) << 4 * (x % 2));
    } else if (pupil_pixel_bits(image->pixel) == 8)
        row[x] = (unsigned char)code;
    else
        memcpy(row + 2 * (size_t)x, &word, sizeof word);
}

static unsigned full_of(uint32_t pixel)
{
    return (1u << pupil_pixel_bits(pixel)) - 1;
}

void bench_store_quad(const pupil_image_const *image, uint32_t x, uint32_t y, const float rgba[4][4])
{
    const pupil_coding *c = bench_coding(image->pixel);
    const double full = full_of(image->pixel);
    if (bench_is_yuv(image->pixel)) {
        store_yuv(image, x, y, rgba);
        return;
    }
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t at_x = x + i % 2, at_y = y + i / 2;
        double light = 0.2126 * (double)rgba[i][0] + 0.7152 * (double)rgba[i][1] + 0.0722 * (double)rgba[i][2];
        double black = 0.0;
        if (at_x >= image->width || at_y >= image->height)
            continue;
        if (c) {
            const unsigned colour = pixel_colour(c->bayer, at_x, at_y);
            light = (double)rgba[i][colour] / (double)c->balance[colour];
            black = (double)c->black;
        }
        store_sample(image, at_x, at_y, (unsigned)(black + (full - black) * clamped(light) + 0.5));
    }
}

/* --- any frame --- */

static unsigned any_sample(uint32_t pixel, double (*random)(uint64_t *state), uint64_t *state)
{
    const pupil_coding *c = bench_coding(pixel);
    const unsigned full = full_of(pixel), black = c ? (unsigned)c->black : 0;
    const double kind = 16.0 * random(state), value = random(state);
    if (kind < 2.0)
        return full;
    if (kind < 5.0)
        return (unsigned)(value * (black + 1));
    if (kind < 8.0 && pupil_pixel_bytes(pixel) == 2)
        return (unsigned)(value * 65536.0);
    return (unsigned)(value * (full + 1.0));
}

void bench_store_any(const pupil_image_const *image, double (*random)(uint64_t *state), uint64_t *state)
{
    const uint32_t chroma_rows = pupil_chroma_rows(image->pixel, image->height);
    const size_t row = pupil_row_bytes(image->pixel, image->width);
    if (!bench_is_yuv(image->pixel)) {
        for (uint32_t y = 0; y < image->height; y++)
            for (uint32_t x = 0; x < image->width; x++)
                store_sample(image, x, y, any_sample(image->pixel, random, state));
        return;
    }
    for (uint32_t y = 0; y < image->height; y++)
        for (size_t i = 0; i < row; i++)
            row_of(image, y)[i] = (unsigned char)(256.0 * random(state));
    for (int plane = 1; plane < (int)pupil_pixel_planes(image->pixel); plane++)
        for (uint32_t y = 0; y < chroma_rows; y++)
            for (size_t i = 0; i < pupil_chroma_row_bytes(image->pixel, image->width); i++)
                chroma_row_of(image, y, plane)[i] = (unsigned char)(256.0 * random(state));
}
