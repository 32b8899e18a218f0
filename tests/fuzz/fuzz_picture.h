/* fuzz_picture.h: numbers, and pictures of every format with their codings, chosen by the input's bytes. Inputs have no
 * byte outside their rows, so that a sanitizer sees reads beyond; outputs also have guards between their rows.
 */
#ifndef PUPIL_TESTS_FUZZ_PICTURE_H
#define PUPIL_TESTS_FUZZ_PICTURE_H

#include "pupil/pupil.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SIDE  64
#define GUARD 32

static const uint8_t *input;
static size_t input_left;

/* Fails as a sanitizer would, so that libFuzzer keeps the input. */
#define MUST(condition) ((condition) ? (void)0 : abort())

static void take(void *into, size_t bytes)
{
    const size_t n = bytes < input_left ? bytes : input_left;
    memset(into, 0, bytes);
    memcpy(into, input, n);
    input += n;
    input_left -= n;
}

static uint32_t take_below(uint32_t n)
{
    uint16_t u;
    take(&u, sizeof u);
    return n ? u % n : 0;
}

/* Mostly values near interesting ones; sometimes any bits. */
static double take_double(double low, double high)
{
    static const double odd[] = {0, -1, NAN, INFINITY, -INFINITY, 1e300, 1e-300, 1};
    const uint32_t kind = take_below(16);
    double any;
    if (kind == 0)
        return odd[take_below(8)];
    if (kind == 1) {
        take(&any, sizeof any);
        return any;
    }
    return low + (high - low) * take_below(1025) / 1024;
}

typedef struct plane {
    uint8_t *memory;
    size_t guard, row_bytes, stride, rows;
} plane;

typedef struct picture {
    pupil_image image;
    plane data, chroma, cr;
    int refused; /* the coding is */
} picture;

static int is_mosaic(uint32_t pixel)
{
    return pupil_pixel_is_mosaic(pixel);
}

static size_t sample_bytes(uint32_t pixel)
{
    static const uint8_t bytes[PUPIL_PIXEL_BAYER16 + 1] = {1, 4, 4, 2, 2, 2, 1, 1, 1, 1, 1, 1, 2, 2, 2, 1, 2, 2, 2, 2};
    if (pixel == PUPIL_PIXEL_BGR32F || pixel == PUPIL_PIXEL_RGB10A2)
        return 4;
    if (pixel == PUPIL_PIXEL_RGB16F || pixel == PUPIL_PIXEL_P010 || pixel == PUPIL_PIXEL_I420_10 ||
        pixel == PUPIL_PIXEL_I444_16)
        return 2;
    return pixel <= PUPIL_PIXEL_BAYER16 ? bytes[pixel] : 1;
}

static size_t plane_bytes(const plane *p)
{
    return p->rows ? p->stride * (p->rows - 1) + p->row_bytes + 2 * p->guard : 0;
}

/* The top row of a new plane. */
static uint8_t *plane_make(plane *p, size_t row_bytes, size_t rows, size_t padding, size_t guard, ptrdiff_t *stride)
{
    const int upside_down = take_below(2) != 0;
    *p = (plane){NULL, guard, row_bytes, row_bytes + padding, rows};
    p->memory = malloc(plane_bytes(p));
    MUST(p->memory != NULL);
    memset(p->memory, 0xee, plane_bytes(p));
    *stride = upside_down ? -(ptrdiff_t)p->stride : (ptrdiff_t)p->stride;
    return p->memory + guard + (upside_down ? p->stride * (rows - 1) : 0);
}

static void plane_guarded(const plane *p)
{
    for (size_t i = 0; i < plane_bytes(p); i++)
        if (i < p->guard || i >= plane_bytes(p) - p->guard || (i - p->guard) % p->stride >= p->row_bytes)
            MUST(p->memory[i] == 0xee);
}

/* A few bytes of the input, over and over: enough for every kind of pixel next to every other. */
static void plane_fill(plane *p)
{
    uint8_t pattern[97];
    const uint32_t n = 1 + take_below(sizeof pattern);
    take(pattern, n);
    for (size_t i = 0; i < plane_bytes(p); i++)
        p->memory[i] = pattern[i % n];
}

static picture picture_make(uint32_t width, uint32_t height, uint32_t pixel, size_t guard)
{
    picture p;
    memset(&p, 0, sizeof p);
    p.image.width = width;
    p.image.height = height;
    p.image.pixel = pixel;
    p.image.data = plane_make(&p.data, pupil_row_bytes(pixel, width), height, sample_bytes(pixel) * take_below(4),
                              guard, &p.image.stride_bytes);
    const size_t chroma_row = pupil_chroma_row_bytes(pixel, width), rows = pupil_chroma_rows(pixel, height);
    if (pupil_pixel_planes(pixel) > 1)
        p.image.chroma = plane_make(&p.chroma, chroma_row, rows, sample_bytes(pixel) * take_below(4), guard,
                                    &p.image.chroma_stride_bytes);
    if (pupil_pixel_planes(pixel) > 2)
        p.image.cr =
            plane_make(&p.cr, chroma_row, rows, sample_bytes(pixel) * take_below(4), guard, &p.image.cr_stride_bytes);
    return p;
}

static void picture_free(picture *p)
{
    free(p->data.memory);
    free(p->chroma.memory);
    free(p->cr.memory);
}

static void picture_guarded(const picture *p)
{
    plane_guarded(&p->data);
    plane_guarded(&p->chroma);
    plane_guarded(&p->cr);
}

/* Another picture of the same shape, empty. */
static picture picture_like(const picture *p)
{
    picture q = *p;
    q.data.memory = malloc(plane_bytes(&q.data));
    q.chroma.memory = malloc(plane_bytes(&q.chroma));
    q.cr.memory = malloc(plane_bytes(&q.cr));
    MUST(q.data.memory != NULL);
    memset(q.data.memory, 0xee, plane_bytes(&q.data));
    q.image.data = q.data.memory + ((uint8_t *)p->image.data - p->data.memory);
    if (p->image.chroma) {
        MUST(q.chroma.memory != NULL);
        memset(q.chroma.memory, 0xee, plane_bytes(&q.chroma));
        q.image.chroma = q.chroma.memory + ((uint8_t *)p->image.chroma - p->chroma.memory);
    }
    if (p->image.cr) {
        MUST(q.cr.memory != NULL);
        memset(q.cr.memory, 0xee, plane_bytes(&q.cr));
        q.image.cr = q.cr.memory + ((uint8_t *)p->image.cr - p->cr.memory);
    }
    return q;
}

static int picture_same(const picture *a, const picture *b)
{
    return memcmp(a->data.memory, b->data.memory, plane_bytes(&a->data)) == 0 &&
           (!a->image.chroma || memcmp(a->chroma.memory, b->chroma.memory, plane_bytes(&a->chroma)) == 0) &&
           (!a->image.cr || memcmp(a->cr.memory, b->cr.memory, plane_bytes(&a->cr)) == 0);
}

/* Mostly one that is valid for the format. */
static pupil_coding take_coding(uint32_t pixel)
{
    const uint32_t bits = pupil_pixel_bits(pixel);
    pupil_coding c;
    memset(&c, 0, sizeof c);
    const int words = sample_bytes(pixel) == 2;
    const double top = (double)(1u << bits) - 1;
    c.matrix = take_below(PUPIL_MATRIX_COUNT + !take_below(50));
    c.range = take_below(PUPIL_RANGE_COUNT + !take_below(50));
    c.light = take_below(is_mosaic(pixel) ? 2 + !take_below(50) : PUPIL_LIGHT_COUNT);
    c.bayer = take_below(PUPIL_BAYER_COUNT + !take_below(50));
    c.shift = words && bits ? take_below(17u - bits) : !take_below(50);
    c.black = take_below(2) ? 0 : (float)take_double(0, top - 1);
    c.white = take_below(2) ? 0 : (float)take_double((double)c.black + 1, 65535);
    for (int i = 0; i < 3 && take_below(4); i++)
        c.balance[0] = c.balance[0] > 0 ? c.balance[0] : 1, c.balance[i] = (float)take_double(1, 4);
    for (int i = 0; i < 9 && take_below(4); i++)
        c.rgb_from_camera[i] = (float)take_double(-16, 16);
    if (bits && take_below(4) == 0) {
        double code = (double)c.black, light = 0.001;
        c.light = take_below(8) ? c.light % 2 : c.light;
        c.knees = take_below(PUPIL_KNEES + 1 + !take_below(50));
        for (uint32_t i = 0; i < c.knees && i < PUPIL_KNEES; i++) {
            c.knee_code[i] = (float)(code = take_double(code + 1, code + top / 9));
            c.knee_light[i] = (float)(light = take_double(light, light + 0.12));
        }
    }
    return c;
}

/* Any input of about this size; the width is kept if its format allows it. */
static inline picture picture_in(uint32_t width, uint32_t height)
{
    const uint32_t pixel = PUPIL_PIXEL_RGBA32F + take_below(PUPIL_PIXEL_COUNT - 1);
    if (is_mosaic(pixel)) {
        width = (width + 3) / 4 * 4;
        height = (height + 1) / 2 * 2;
    }
    picture p = picture_make(width, height, pixel, 0);
    plane_fill(&p.data);
    if (p.image.chroma)
        plane_fill(&p.chroma);
    if (p.image.cr)
        plane_fill(&p.cr);
    return p;
}

/* Any output for it, sometimes of half its size if possible; and the codings of both, which live as long as they. */
static inline picture picture_out(picture *in)
{
    static const uint32_t pixel[] = {PUPIL_PIXEL_RGBA8,   PUPIL_PIXEL_RGB8,   PUPIL_PIXEL_BGRX8,   PUPIL_PIXEL_NV12,
                                     PUPIL_PIXEL_BGR8,    PUPIL_PIXEL_I420,   PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F,
                                     PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGB16F, PUPIL_PIXEL_BGR32F};
    const uint32_t smaller = is_mosaic(in->image.pixel) && take_below(2) ? 2 : 1;
    picture out = picture_make(in->image.width / smaller, in->image.height / smaller,
                               pixel[take_below(sizeof pixel / sizeof *pixel)], GUARD);
    static pupil_coding coding[2]; /* of the last pictures made */
    coding[0] = take_coding(in->image.pixel);
    coding[1] = take_coding(PUPIL_PIXEL_NV12);
    coding[1].shift = 0;
    in->image.coding = take_below(4) ? &coding[0] : NULL;
    out.image.coding = take_below(4) ? &coding[1] : NULL;
    in->refused = (in->image.coding && pupil_coding_check(&coding[0], in->image.pixel, NULL)) ||
                  (out.image.coding && pupil_coding_check(&coding[1], out.image.pixel, NULL));
    return out;
}

#endif
