/* The keys of raw:FILE,... */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "number.h"
#include "raw_source.h"
#include "refuse.h"
#include "v4l2/format.h"

enum { MOST_NUMBERS = 2 * PUPIL_KNEES + 1 };

/* Numbers with one of the separators between; how many, or -1. */
static int numbers(const char *text, const char *separators, double *number)
{
    int count = 0;
    for (;;) {
        char *end;
        if (count == MOST_NUMBERS)
            return -1;
        number[count] = pupil_parse_double(text, &end);
        if (end == text || !isfinite(number[count]))
            return -1;
        count++;
        if (!*end)
            return count;
        if (!strchr(separators, *end))
            return -1;
        text = end + 1;
    }
}

static int whole(double number, double low, double high)
{
    return number >= low && number <= high && number == floor(number);
}

static const char *set_format(pupil_raw_layout *l, const char *text)
{
    static const char right[] = "a V4L2 format such as RG10, pRAA, pRCC, GREY, Y10P, YUYV or NV12 was expected";
    const uint32_t fourcc = pupil_v4l2_fourcc(text);
    l->pixel = pupil_v4l2_pixel_of(fourcc);
    if (!fourcc || l->pixel == PUPIL_PIXEL_NONE || strlen(text) >= sizeof l->format || strcmp(text, "YV12") == 0)
        return right;
    l->bayer = pupil_v4l2_bayer_of(fourcc);
    snprintf(l->format, sizeof l->format, "%s", text);
    return NULL;
}

static const char *set_size(pupil_raw_layout *l, const char *text)
{
    double n[MOST_NUMBERS];
    if (numbers(text, "x", n) != 2 || !whole(n[0], 1, PUPIL_MAX_SIDE_PX) || !whole(n[1], 1, PUPIL_MAX_SIDE_PX))
        return "WIDTHxHEIGHT was expected, for example 1920x1080, each 1 to 16384";
    l->width = (uint32_t)n[0];
    l->height = (uint32_t)n[1];
    return NULL;
}

static const char *set_bytes(uint64_t *bytes, const char *text)
{
    double n[MOST_NUMBERS];
    if (numbers(text, "", n) != 1 || !whole(n[0], 0, 1e9))
        return "a number of bytes was expected";
    *bytes = (uint64_t)n[0];
    return NULL;
}

static const char *set_code(float *code, const char *text)
{
    double n[MOST_NUMBERS];
    if (numbers(text, "", n) != 1 || !(n[0] >= 0 && n[0] <= 65535))
        return "a code from 0 to 65535 was expected";
    *code = (float)n[0];
    return NULL;
}

static const char *set_balance(pupil_colour_options *c, const char *text)
{
    double n[MOST_NUMBERS];
    c->balance = strcmp(text, "off") == 0 ? PUPIL_COLOUR_OFF : PUPIL_COLOUR_AUTO;
    if (c->balance == PUPIL_COLOUR_OFF || strcmp(text, "auto") == 0)
        return NULL;
    c->balance = PUPIL_COLOUR_GIVEN;
    if (numbers(text, "/", n) != 3)
        return "auto, off or R/G/B was expected, for example 1.9/1/1.6";
    for (int i = 0; i < 3; i++) {
        if (!(n[i] >= 0x1p-10 && n[i] <= 0x1p10))
            return "factors from 0.001 to 1024 were expected, for example 1.9/1/1.6";
        c->given_balance[i] = (float)n[i];
    }
    return NULL;
}

static const char *set_matrix(pupil_colour_options *c, const char *text)
{
    double n[MOST_NUMBERS];
    if (numbers(text, "/", n) != 9)
        return "nine numbers with / between were expected, row by row";
    c->matrix = PUPIL_COLOUR_GIVEN;
    for (int i = 0; i < 9; i++)
        c->given_matrix[i] = (float)n[i];
    return NULL;
}

static const char *set_knees(pupil_colour_options *c, const char *text)
{
    double n[MOST_NUMBERS];
    const int count = numbers(text, ":/", n);
    if (count < 2 || count % 2)
        return "up to 8 points CODE:LIGHT with / between were expected, both rising";
    c->knees = (uint32_t)count / 2;
    for (int i = 0; i < count / 2; i++) {
        c->knee_code[i] = (float)n[2 * i];
        c->knee_light[i] = (float)n[2 * i + 1];
    }
    return NULL;
}

/* Returns what would be right; NULL: the value is. */
static const char *set(pupil_raw_layout *l, const char *key, const char *value)
{
    uint64_t bits;
    if (strcmp(key, "format") == 0)
        return set_format(l, value);
    if (strcmp(key, "size") == 0)
        return set_size(l, value);
    if (strcmp(key, "stride") == 0)
        return set_bytes(&l->stride_bytes, value);
    if (strcmp(key, "skip") == 0)
        return set_bytes(&l->skip_bytes, value);
    if (strcmp(key, "black") == 0) {
        l->colour.black = PUPIL_COLOUR_GIVEN;
        return set_code(&l->colour.given_black, value);
    }
    if (strcmp(key, "white") == 0)
        return set_code(&l->coding.white, value);
    if (strcmp(key, "balance") == 0)
        return set_balance(&l->colour, value);
    if (strcmp(key, "matrix") == 0)
        return set_matrix(&l->colour, value);
    if (strcmp(key, "knees") == 0)
        return set_knees(&l->colour, value);
    if (strcmp(key, "shift") != 0)
        return "format, size, stride, skip, black, white, shift, knees, balance or matrix was expected";
    const char *wrong = set_bytes(&bits, value);
    l->coding.shift = wrong || bits > 8 ? 0 : (uint32_t)bits;
    return wrong || bits > 8 ? "a number of bits from 0 to 8 was expected" : NULL;
}

size_t pupil_raw_layout_image(const pupil_raw_layout *l, const void *bytes, pupil_image_const *image)
{
    const size_t row = pupil_row_bytes(l->pixel, l->width), stride = l->stride_bytes ? (size_t)l->stride_bytes : row;
    const uint32_t planes = pupil_pixel_planes(l->pixel), chroma_rows = pupil_chroma_rows(l->pixel, l->height);
    const size_t chroma = planes < 2        ? 0
                          : l->stride_bytes ? stride / (planes - 1)
                                            : pupil_chroma_row_bytes(l->pixel, l->width);
    const uint8_t *at = bytes;
    if (!row || stride < row || chroma < pupil_chroma_row_bytes(l->pixel, l->width))
        return 0;
    *image = (pupil_image_const){.pixel = l->pixel,
                                 .data = at,
                                 .stride_bytes = (ptrdiff_t)stride,
                                 .width = l->width,
                                 .height = l->height,
                                 .coding = &l->coding};
    if (at && planes > 1) {
        image->chroma = at + stride * l->height;
        image->chroma_stride_bytes = (ptrdiff_t)chroma;
    }
    if (at && planes > 2) {
        image->cr = at + stride * l->height + chroma * chroma_rows;
        image->cr_stride_bytes = (ptrdiff_t)chroma;
    }
    return stride * l->height + chroma * chroma_rows * (planes - 1);
}

/* A comma and a key; "a,b.raw" is a name. */
static int begins_key(const char *text)
{
    const size_t letters = strspn(text, "abcdefghijklmnopqrstuvwxyz");
    return letters && text[letters] == '=';
}

/* More than 8 bits, and not packed: each sample has two bytes. */
static int has_wide_samples(uint32_t pixel)
{
    return pupil_pixel_bytes(pixel) == 2 && (pupil_pixel_bits(pixel) || pupil_pixel_planes(pixel) > 1);
}

static int check(const pupil_raw_layout *l, pupil_why *why)
{
    pupil_image_const image;
    if (!*l->file)
        return pupil_refuse(why, "raw: needs a file: raw:FILE,format=RG10,size=1920x1080");
    if (!*l->format || !l->width)
        return pupil_refuse(why, "raw:%s: needs %s, for example raw:%s,format=RG10,size=1920x1080", l->file,
                            *l->format ? "size=" : "format= and size=", l->file);
    if (pupil_pixel_is_mosaic(l->pixel) && (l->width % 2 || l->height % 2))
        return pupil_refuse(why, "raw:%s: size %ux%u: a mosaic has even sides", l->file, l->width, l->height);
    if (l->pixel == PUPIL_PIXEL_BAYER10P && l->width % 4)
        return pupil_refuse(why, "raw:%s: size %ux%u: the width of %s is a multiple of 4", l->file, l->width, l->height,
                            l->format);
    if (!pupil_raw_layout_image(l, NULL, &image))
        return pupil_refuse(why, "raw:%s: stride %llu: a row of %u pixels of %s has %zu bytes", l->file,
                            (unsigned long long)l->stride_bytes, l->width, l->format,
                            pupil_row_bytes(l->pixel, l->width));
    if (has_wide_samples(l->pixel) && l->stride_bytes % 2)
        return pupil_refuse(why, "raw:%s: stride %llu: samples of %s have two bytes, so it must be even", l->file,
                            (unsigned long long)l->stride_bytes, l->format);
    return 0;
}

int pupil_raw_layout_read(pupil_raw_layout *l, const char *text, pupil_why *why)
{
    const char *end = text;
    *l = (pupil_raw_layout){0};
    while (*end && !(*end == ',' && begins_key(end + 1)))
        end++;
    if ((size_t)(end - text) >= sizeof l->file)
        return pupil_refuse(why, "raw: a path of over %zu bytes", sizeof l->file);
    memcpy(l->file, text, (size_t)(end - text));
    while (*end) {
        char pair[256], *equals;
        const char *from = end + 1;
        for (end = from; *end && *end != ',';)
            end++;
        if ((size_t)(end - from) >= sizeof pair)
            return pupil_refuse(why, "raw:%.500s: \"%.40s...\": a key of over %zu bytes", l->file, from,
                                sizeof pair - 1);
        snprintf(pair, sizeof pair, "%.*s", (int)(end - from), from);
        equals = strchr(pair, '=');
        if (!equals)
            return pupil_refuse(why, "raw:%.500s: \"%s\": a key and = were expected", l->file, pair);
        *equals = 0;
        const char *wrong = set(l, pair, equals + 1);
        if (wrong)
            return pupil_refuse(why, "raw:%.500s: %s=%s: %s", l->file, pair, equals + 1, wrong);
    }
    l->coding.bayer = l->bayer;
    return check(l, why);
}
