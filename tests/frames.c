#include "frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GUARD 64

int frame_is_rgb(uint32_t pixel)
{
    return pupil_pixel_planes(pixel) == 1 && !pupil_pixel_bits(pixel) && pixel != PUPIL_PIXEL_YUYV &&
           pixel != PUPIL_PIXEL_UYVY;
}

int frame_blue_first(uint32_t pixel)
{
    return pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGRX8 || pixel == PUPIL_PIXEL_BGR32F;
}

void frame_fit(uint32_t pixel, uint32_t *width, uint32_t *height)
{
    if (pupil_pixel_is_mosaic(pixel)) {
        *width = (*width + 3) / 4 * 4;
        *height = (*height + 1) / 2 * 2;
    }
}

static unsigned char *filled(size_t bytes)
{
    unsigned char *memory = malloc(bytes);
    if (!memory)
        abort();
    memset(memory, 0xff, bytes);
    return memory;
}

frame frame_make(uint32_t width, uint32_t height, uint32_t pixel, size_t padding, int upside_down)
{
    frame f = {.image = {.width = width, .height = height, .pixel = pixel}};
    const size_t stride = pupil_row_bytes(pixel, width) + padding;
    f.bytes = stride * height + 2 * GUARD;
    f.memory = filled(f.bytes);
    f.image.data = f.memory + GUARD + (upside_down ? stride * (height - 1) : 0);
    f.image.stride_bytes = upside_down ? -(ptrdiff_t)stride : (ptrdiff_t)stride;
    const size_t chroma_stride = pupil_chroma_row_bytes(pixel, width) + padding;
    const uint32_t rows = pupil_chroma_rows(pixel, height), planes = pupil_pixel_planes(pixel);
    f.chroma_bytes = chroma_stride * rows + 2 * GUARD;
    for (uint32_t plane = 1; plane < planes; plane++) {
        unsigned char *memory = filled(f.chroma_bytes);
        const unsigned char *top = memory + GUARD + (upside_down ? chroma_stride * (rows - 1) : 0);
        const ptrdiff_t to_next = upside_down ? -(ptrdiff_t)chroma_stride : (ptrdiff_t)chroma_stride;
        *(plane == 1 ? &f.chroma_memory : &f.cr_memory) = memory;
        *(plane == 1 ? &f.image.chroma : &f.image.cr) = top;
        *(plane == 1 ? &f.image.chroma_stride_bytes : &f.image.cr_stride_bytes) = to_next;
    }
    return f;
}

void frame_free(frame *f)
{
    free(f->memory);
    free(f->chroma_memory);
    free(f->cr_memory);
    f->memory = f->chroma_memory = f->cr_memory = NULL;
}

pupil_image frame_writable(const frame *f)
{
    pupil_image image = {.data = f->memory + ((const unsigned char *)f->image.data - f->memory),
                         .stride_bytes = f->image.stride_bytes,
                         .width = f->image.width,
                         .height = f->image.height,
                         .pixel = f->image.pixel,
                         .chroma_stride_bytes = f->image.chroma_stride_bytes,
                         .coding = f->image.coding,
                         .cr_stride_bytes = f->image.cr_stride_bytes};
    if (f->cr_memory)
        image.cr = f->cr_memory + ((const unsigned char *)f->image.cr - f->cr_memory);
    if (f->chroma_memory)
        image.chroma = f->chroma_memory + ((const unsigned char *)f->image.chroma - f->chroma_memory);
    return image;
}

int frame_equal(const frame *a, const frame *b)
{
    return a->bytes == b->bytes && a->chroma_bytes == b->chroma_bytes && memcmp(a->memory, b->memory, a->bytes) == 0 &&
           (!a->chroma_memory || memcmp(a->chroma_memory, b->chroma_memory, a->chroma_bytes) == 0) &&
           (!a->cr_memory || memcmp(a->cr_memory, b->cr_memory, a->chroma_bytes) == 0);
}

static int untouched(const unsigned char *memory, size_t bytes, ptrdiff_t stride_bytes, size_t row)
{
    const size_t stride = (size_t)llabs((long long)stride_bytes);
    for (size_t i = 0; i < bytes; i++) {
        const int inside = i >= GUARD && i < bytes - GUARD && (i - GUARD) % stride < row;
        if (!inside && memory[i] != 0xff)
            return 0;
    }
    return 1;
}

int frame_guards_intact(const frame *f)
{
    const pupil_image_const *i = &f->image;
    return untouched(f->memory, f->bytes, i->stride_bytes, pupil_row_bytes(i->pixel, i->width)) &&
           (!f->chroma_memory || untouched(f->chroma_memory, f->chroma_bytes, i->chroma_stride_bytes,
                                           pupil_chroma_row_bytes(i->pixel, i->width))) &&
           (!f->cr_memory ||
            untouched(f->cr_memory, f->chroma_bytes, i->cr_stride_bytes, pupil_chroma_row_bytes(i->pixel, i->width)));
}

uint16_t frame_half(double value)
{
    const uint16_t sign = signbit(value) ? 0x8000 : 0;
    const double size = fabs(value);
    int exponent;
    if (isnan(value))
        return sign | 0x7e00;
    if (size >= 65520)
        return sign | 0x7c00;
    if (size < 0x1p-14)
        return sign | (uint16_t)nearbyint(size * 0x1p24);
    frexp(size, &exponent);
    exponent--; /* size is in [2^exponent, 2^(exponent+1)) */
    return (uint16_t)(sign + ((exponent + 14) << 10) + (int)nearbyint(ldexp(size, 10 - exponent)));
}

static unsigned to_code(double value, double top)
{
    return value > 0 ? (unsigned)floor(fmin(value, 1) * top + 0.5) : 0;
}

static double srgb(double light)
{
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* Formats of a camera: one sample a pixel, and colour only in the neighbours. */
static void set_sample(frame *f, uint32_t x, uint32_t y, double r, double g, double b)
{
    static const unsigned char bits[PUPIL_PIXEL_COUNT] = {
        [PUPIL_PIXEL_GREY10] = 10,  [PUPIL_PIXEL_GREY12] = 12,  [PUPIL_PIXEL_GREY16] = 16, [PUPIL_PIXEL_BAYER10] = 10,
        [PUPIL_PIXEL_BAYER12] = 12, [PUPIL_PIXEL_BAYER14] = 14, [PUPIL_PIXEL_BAYER16] = 16};
    const pupil_image image = frame_writable(f);
    const uint32_t pixel = f->image.pixel;
    unsigned char *row = (unsigned char *)image.data + (ptrdiff_t)y * image.stride_bytes;
    const double mine = !pupil_pixel_is_mosaic(pixel) ? (r + g + b) / 3 : x % 2 == y % 2 ? x % 2 ? b : r : g;
    const unsigned char colour = (unsigned char)to_code(0.5 + 0.4 * (x % 2 ? r - g : b - g) / (r + g + b), 255);
    const ptrdiff_t chroma_row = pupil_chroma_row_of(pixel, y);
    if (pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY) {
        row[2 * x + (pixel == PUPIL_PIXEL_UYVY)] = (unsigned char)to_code(srgb(mine), 255);
        row[2 * x + (pixel == PUPIL_PIXEL_YUYV)] = colour;
    } else if (pixel == PUPIL_PIXEL_P010 || pixel == PUPIL_PIXEL_I420_10) {
        const int up = pixel == PUPIL_PIXEL_P010 ? 6 : 0;
        const uint16_t luma = (uint16_t)(to_code(srgb(mine), 1023) << up), word = (uint16_t)(4 * colour << up);
        unsigned char *to = (unsigned char *)(image.cr && x % 2 ? image.cr : image.chroma);
        memcpy(row + 2 * x, &luma, 2);
        memcpy(to + chroma_row * image.chroma_stride_bytes + (image.cr ? x / 2 * 2 : 2 * x), &word, 2);
    } else if (pixel == PUPIL_PIXEL_I444_16) {
        const uint16_t luma = (uint16_t)to_code(srgb(mine), 65535);
        const uint16_t cb = (uint16_t)to_code(0.5 + 0.4 * (b - g) / (r + g + b), 65535);
        const uint16_t cr = (uint16_t)to_code(0.5 + 0.4 * (r - g) / (r + g + b), 65535);
        memcpy(row + 2 * x, &luma, 2);
        memcpy((unsigned char *)image.chroma + chroma_row * image.chroma_stride_bytes + 2 * x, &cb, 2);
        memcpy((unsigned char *)image.cr + chroma_row * image.cr_stride_bytes + 2 * x, &cr, 2);
    } else if (image.cr) {
        row[x] = (unsigned char)to_code(srgb(mine), 255);
        ((unsigned char *)(x % 2 ? image.cr : image.chroma))[chroma_row * image.chroma_stride_bytes + x / 2] = colour;
    } else if (image.chroma) {
        row[x] = (unsigned char)to_code(srgb(mine), 255);
        ((unsigned char *)image.chroma)[chroma_row * image.chroma_stride_bytes + x] = colour;
    } else if (pixel == PUPIL_PIXEL_BAYER10P || pixel == PUPIL_PIXEL_GREY10P) {
        const unsigned code = to_code(mine, 1023), at = x / 4 * 5;
        row[at + x % 4] = (unsigned char)(code >> 2);
        row[at + 4] = (unsigned char)((row[at + 4] & ~(3u << 2 * (x % 4))) | (code & 3) << 2 * (x % 4));
    } else if (pixel == PUPIL_PIXEL_BAYER12P || pixel == PUPIL_PIXEL_GREY12P) {
        const unsigned code = to_code(mine, 4095), at = x / 2 * 3;
        row[at + x % 2] = (unsigned char)(code >> 4);
        row[at + 2] = (unsigned char)((row[at + 2] & ~(15u << 4 * (x % 2))) | (code & 15) << 4 * (x % 2));
    } else if (bits[pixel]) {
        const uint16_t word = (uint16_t)to_code(mine, (1 << bits[pixel]) - 1);
        memcpy(row + 2 * x, &word, 2);
    } else {
        row[x] = (unsigned char)to_code(mine, 255);
    }
}

void frame_set(frame *f, uint32_t x, uint32_t y, double r, double g, double b, double a)
{
    if (!frame_is_rgb(f->image.pixel)) {
        set_sample(f, x, y, r, g, b);
        return;
    }
    const double value[4] = {r, g, b, a};
    const size_t pixel_bytes = pupil_pixel_bytes(f->image.pixel);
    unsigned char *at =
        (unsigned char *)frame_writable(f).data + (ptrdiff_t)y * f->image.stride_bytes + x * pixel_bytes;
    uint32_t word = 0;
    for (int c = 0; c < 4; c++) {
        const float single = (float)value[c];
        uint16_t half, code;
        switch (f->image.pixel) {
        case PUPIL_PIXEL_RGBA32F:
        case PUPIL_PIXEL_RGB32F:
        case PUPIL_PIXEL_BGR32F:
            if (c < (int)(pixel_bytes / 4))
                memcpy(at + 4 * (frame_blue_first(f->image.pixel) ? 2 - c : c), &single, 4);
            break;
        case PUPIL_PIXEL_RGB10A2: /* once for all four, of which alpha is the last */
            word |= c < 3 ? (uint32_t)to_code(srgb(value[c]), 1023) << 10 * c : (uint32_t)to_code(value[3], 3) << 30;
            memcpy(at, &word, 4);
            break;
        case PUPIL_PIXEL_RGBA16F:
        case PUPIL_PIXEL_RGB16F:
            half = frame_half(value[c]);
            if (c < (int)(pixel_bytes / 2))
                memcpy(at + 2 * c, &half, 2);
            break;
        case PUPIL_PIXEL_RGBA16:
        case PUPIL_PIXEL_RGB16:
            code = (uint16_t)to_code(value[c], 65535);
            if (c < (int)(pixel_bytes / 2))
                memcpy(at + 2 * c, &code, 2);
            break;
        default:
            if (c < (int)pixel_bytes)
                at[c < 3 && frame_blue_first(f->image.pixel) ? 2 - c : c] =
                    (unsigned char)to_code(c < 3 ? srgb(value[c]) : value[c], 255);
        }
    }
}

void frame_fill(frame *f, double r, double g, double b)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++)
            frame_set(f, x, y, r, g, b, 1);
}

static double gauss(frame_random *random) /* Box and Muller 1958 */
{
    const double radius = sqrt(-2 * log(1 - random()));
    return radius * cos(6.283185307179586 * random());
}

void frame_lognormal(frame *f, double middle, double sigma_stops, frame_random *random)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = middle * exp2(sigma_stops * gauss(random));
            frame_set(f, x, y, light * (0.5 + random()), light * (0.5 + random()), light * (0.5 + random()), random());
        }
}

void frame_gradient(frame *f, double from, double to)
{
    const double end = (double)f->image.width + f->image.height;
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = from * pow(to / from, (x + y + 0.5) / end);
            frame_set(f, x, y, light * 1.2, light, light * 0.7, (double)x / f->image.width);
        }
}

void frame_checker(frame *f, double a, double b)
{
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            const double light = (x + y) & 1 ? a : b;
            frame_set(f, x, y, light, light, light, 1);
        }
}

void frame_one(frame *f, double background, double bright, frame_random *random)
{
    frame_fill(f, background, background, background);
    frame_set(f, (uint32_t)(random() * f->image.width), (uint32_t)(random() * f->image.height), bright, bright, bright,
              1);
}

void frame_odd(frame *f, frame_random *random)
{
    static const double odd[] = {NAN,     INFINITY, -INFINITY, -1,     -0.0,  0,      0x1p-149, 0x1p-127,
                                 0x1p-24, 0x1p-14,  0.18,      1,      65504, 0x1p29, 0x1p30,   0x1.fffffep127,
                                 0.02,    3,        -1e30,     0x1p31, 0.5,   0x1p-30};
    const unsigned n = sizeof odd / sizeof *odd;
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            /* half of them grey, half with odd values in single channels */
            const double a = odd[(unsigned)(random() * n)], b = odd[(unsigned)(random() * n)];
            const int grey = random() < 0.5;
            frame_set(f, x, y, a, grey ? a : b, grey ? a : odd[(unsigned)(random() * n)], b);
        }
}

static void any_bits(unsigned char *at, ptrdiff_t stride, uint32_t rows, size_t row, frame_random *random)
{
    for (uint32_t y = 0; y < rows; y++)
        for (size_t i = 0; i < row; i++)
            at[(ptrdiff_t)y * stride + (ptrdiff_t)i] = (unsigned char)(random() * 256);
}

void frame_bits(frame *f, frame_random *random)
{
    const pupil_image image = frame_writable(f);
    any_bits(image.data, image.stride_bytes, image.height, pupil_row_bytes(image.pixel, image.width), random);
    if (image.chroma)
        any_bits(image.chroma, image.chroma_stride_bytes, pupil_chroma_rows(image.pixel, image.height),
                 pupil_chroma_row_bytes(image.pixel, image.width), random);
    if (image.cr)
        any_bits(image.cr, image.cr_stride_bytes, pupil_chroma_rows(image.pixel, image.height),
                 pupil_chroma_row_bytes(image.pixel, image.width), random);
}
