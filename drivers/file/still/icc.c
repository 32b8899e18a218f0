#include "icc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tiff_tags.h"

/* Steps of a table of light by the square root of light. */
#define STEPS 4096
/* A curve whose codes are this near to sRGB's is taken for it: one of 8 bits. */
#define SAME_CODE (1 / 255.0)

enum { HEADER_BYTES = 132, ENTRY_BYTES = 12 }; /* with the count of the tags */

typedef struct bytes_of {
    const uint8_t *at;
    size_t size;
} bytes_of;

/* --- where the profile is --- */

/* ICC.1:2010, B.4: an APP2 segment, "ICC_PROFILE", its number and how many there are. */
static bytes_of in_jpeg(bytes_of file)
{
    static const char mark[] = "ICC_PROFILE";
    enum { APP2 = 0xe2, FIRST_APP = 0xe0, COMMENT = 0xfe, MARK_BYTES = sizeof mark + 2 };
    for (size_t at = 2; file.size >= 4 && at <= file.size - 4;) {
        const uint8_t *segment = file.at + at;
        const size_t length = pupil_number_at(segment + 2, 2, 1);
        const int is_table = segment[1] == 0xdb || segment[1] == 0xc4 || segment[1] == 0xdd;
        if (segment[0] != 0xff || length < 2 || length > file.size - at - 2)
            break;
        if (segment[1] == APP2 && length >= 2 + MARK_BYTES && memcmp(segment + 4, mark, sizeof mark) == 0)
            return segment[4 + sizeof mark + 1] == 1 ? (bytes_of){segment + 4 + MARK_BYTES, length - 2 - MARK_BYTES}
                                                     : (bytes_of){NULL, 0};
        if (!is_table && segment[1] != COMMENT && (segment[1] & 0xf0) != FIRST_APP)
            break;
        at += 2 + length;
    }
    return (bytes_of){NULL, 0};
}

static bytes_of in_webp(bytes_of file)
{
    for (size_t at = 12; file.size >= 8 && at <= file.size - 8;) {
        const size_t length = pupil_number_at(file.at + at + 4, 4, 0), left = file.size - at - 8;
        if (length > left)
            break;
        if (memcmp(file.at + at, "ICCP", 4) == 0)
            return (bytes_of){file.at + at + 8, length};
        at += 8 + length + length % 2;
    }
    return (bytes_of){NULL, 0};
}

static bytes_of in_tiff(bytes_of file)
{
    enum { ICC_PROFILE = 34675 };
    uint32_t at = 0;
    if (!pupil_tiff_find(file.at, file.size, ICC_PROFILE, &at) || at >= file.size)
        return (bytes_of){NULL, 0};
    return (bytes_of){file.at + at, file.size - at};
}

static bytes_of profile_of(bytes_of file)
{
    if (file.size >= 2 && file.at[0] == 0xff && file.at[1] == 0xd8)
        return in_jpeg(file);
    if (file.size >= 12 && memcmp(file.at, "RIFF", 4) == 0 && memcmp(file.at + 8, "WEBP", 4) == 0)
        return in_webp(file);
    return in_tiff(file);
}

/* --- what it says --- */

static bytes_of tag_of(bytes_of p, const char name[4])
{
    const uint32_t count = pupil_number_at(p.at + 128, 4, 1);
    for (uint32_t i = 0; i < count && HEADER_BYTES + ENTRY_BYTES * (uint64_t)(i + 1) <= p.size; i++) {
        const uint8_t *entry = p.at + HEADER_BYTES + ENTRY_BYTES * (size_t)i;
        const size_t at = pupil_number_at(entry + 4, 4, 1), length = pupil_number_at(entry + 8, 4, 1);
        if (memcmp(entry, name, 4) == 0)
            return at <= p.size && length <= p.size - at && length >= 12 ? (bytes_of){p.at + at, length}
                                                                         : (bytes_of){NULL, 0};
    }
    return (bytes_of){NULL, 0};
}

static double fixed_at(const uint8_t *at) /* s15Fixed16Number */
{
    return (int32_t)pupil_number_at(at, 4, 1) / 65536.0;
}

/* The three primaries as columns, under D50 as profiles have them. */
static int read_primaries(bytes_of p, double to_xyz[9])
{
    static const char names[3][5] = {"rXYZ", "gXYZ", "bXYZ"};
    for (int c = 0; c < 3; c++) {
        const bytes_of tag = tag_of(p, names[c]);
        if (tag.size < 20 || memcmp(tag.at, "XYZ ", 4) != 0)
            return 0;
        for (int r = 0; r < 3; r++)
            to_xyz[3 * r + c] = fixed_at(tag.at + 8 + 4 * r);
    }
    return 1;
}

/* A power, a table, or the functions of a parametricCurveType: g, a, b, c, d, e, f (10.16). */
typedef struct curve {
    double g, a, b, c, d, e, f;
    const uint8_t *table;
    uint32_t count;
} curve;

static int read_curve(bytes_of tag, curve *k)
{
    static const uint8_t numbers[5] = {1, 3, 4, 5, 7};
    double n[7] = {0};
    if (tag.size >= 12 && memcmp(tag.at, "curv", 4) == 0) {
        k->count = pupil_number_at(tag.at + 8, 4, 1);
        if (k->count > (tag.size - 12) / 2)
            return 0;
        *k = (curve){.g = k->count == 1 ? pupil_number_at(tag.at + 12, 2, 1) / 256.0 : 1,
                     .a = 1,
                     .table = k->count > 1 ? tag.at + 12 : NULL,
                     .count = k->count};
        return 1;
    }
    const uint32_t kind = tag.size >= 12 ? pupil_number_at(tag.at + 8, 2, 1) : 5;
    if (kind > 4 || memcmp(tag.at, "para", 4) != 0 || tag.size < 12 + 4u * numbers[kind])
        return 0;
    for (int i = 0; i < numbers[kind]; i++)
        n[i] = fixed_at(tag.at + 12 + 4 * i);
    *k = (curve){.g = n[0], .a = 1};
    if (kind >= 1) { /* 1 and 2 change at -b / a, where 2 has c above and below */
        k->a = n[1];
        k->b = n[2];
        k->d = kind < 3 ? -n[2] / n[1] : n[4];
        k->c = kind < 3 ? 0 : n[3];
        k->e = kind == 2 ? n[3] : kind == 4 ? n[5] : 0;
        k->f = kind == 2 ? n[3] : kind == 4 ? n[6] : 0;
    }
    return 1;
}

static double light_of(const curve *k, double signal)
{
    if (!k->table)
        return signal >= k->d ? pow(fmax(k->a * signal + k->b, 0), k->g) + k->e : k->c * signal + k->f;
    const double at = signal * (k->count - 1);
    const uint32_t left = (uint32_t)fmin(at, k->count - 2.0);
    const double below = pupil_number_at(k->table + 2 * (size_t)left, 2, 1);
    const double above = pupil_number_at(k->table + 2 * (size_t)left + 2, 2, 1);
    return (below + (at - left) * (above - below)) / 65535;
}

/* IEC 61966-2-1. */
static double srgb_signal(double light)
{
    return light <= 0.0031308 ? light * 12.92 : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* Light by the profile for light by sRGB's curve. 1: it is another; 0: the same; -1: it is no curve. */
static int make_table(const curve *k, float table[STEPS + 1])
{
    int differs = 0;
    for (int i = 0; i <= STEPS; i++) {
        const double root = i / (double)STEPS, signal = srgb_signal(root * root);
        const double light = light_of(k, fmin(signal, 1));
        if (!(light > -0.1 && light < 1.1))
            return -1;
        if (i == STEPS && fabs(light - 1) > 0.1) /* white is not white */
            return -1;
        table[i] = (float)light;
        differs |= fabs(srgb_signal(fmin(fmax(light, 0), 1)) - signal) > SAME_CODE;
    }
    return differs;
}

/* Tables of the three channels. 1: they are to be used; 0: all are sRGB's; -1: they are none. */
static int make_tables(bytes_of p, float (*table)[STEPS + 1])
{
    static const char names[3][5] = {"rTRC", "gTRC", "bTRC"};
    int differs = 0;
    for (int c = 0; c < 3; c++) {
        curve k;
        const bytes_of tag = tag_of(p, names[c]);
        const int one = tag.at && read_curve(tag, &k) ? make_table(&k, table[c]) : -1;
        if (one < 0)
            return -1;
        differs |= one;
    }
    return differs;
}

static void apply_tables(float (*table)[STEPS + 1], float *rgb, uint64_t pixels)
{
    for (uint64_t i = 0; i < 3 * pixels; i++) {
        const float at = sqrtf(fminf(fmaxf(rgb[i], 0.0f), 1.0f)) * STEPS;
        const int left = at < STEPS ? (int)at : STEPS - 1;
        const float *of = table[i % 3] + left;
        rgb[i] = of[0] + (at - (float)left) * (of[1] - of[0]);
    }
}

int pupil_icc_apply(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_why *why)
{
    const bytes_of p = profile_of((bytes_of){bytes, size});
    double to_xyz[9];
    pupil_still_colour colour;
    if (p.size < HEADER_BYTES || memcmp(p.at + 36, "acsp", 4) != 0 || memcmp(p.at + 16, "RGB XYZ ", 8) != 0 ||
        !read_primaries(p, to_xyz) || !pupil_still_colour_from_icc(to_xyz, &colour))
        return 0;
    float(*table)[STEPS + 1] = malloc(3 * sizeof *table);
    if (!table)
        return pupil_still_fail(why, "no memory for the curves of its ICC profile");
    const int curves = make_tables(p, table);
    if (curves > 0)
        apply_tables(table, rgb, pixels);
    if (curves >= 0)
        pupil_still_colour_apply(&colour, rgb, pixels);
    free(table);
    return 0;
}
