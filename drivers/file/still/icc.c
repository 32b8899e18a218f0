#include "icc.h"

#include <lcms2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "jpeg_segments.h"
#include "tiff_tags.h"

/* Steps of a table of light, indexed by the square root of light. */
#define STEPS 4096
/* A curve whose codes are within this of sRGB's counts as sRGB's: one 8-bit code. */
#define SAME_CODE (1 / 255.0)

typedef struct bytes_of {
    const uint8_t *at;
    size_t size;
} bytes_of;

/* --- where the profile is --- */

/* ICC.1:2010, B.4: an APP2 segment, "ICC_PROFILE", its number and how many there are. */
static bytes_of in_jpeg(bytes_of file)
{
    static const char mark[] = "ICC_PROFILE";
    enum { MARK_BYTES = sizeof mark + 2 };
    pupil_jpeg_segment s;
    for (size_t at = 0; pupil_jpeg_next_segment(file.at, file.size, &at, &s);)
        if (s.size >= MARK_BYTES && pupil_jpeg_segment_is(&s, PUPIL_JPEG_APP2, mark, sizeof mark))
            return s.at[sizeof mark + 1] == 1 ? (bytes_of){s.at + MARK_BYTES, s.size - MARK_BYTES}
                                              : (bytes_of){NULL, 0};
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
    if (pupil_is_jpeg(file.at, file.size))
        return in_jpeg(file);
    if (file.size >= 12 && memcmp(file.at, "RIFF", 4) == 0 && memcmp(file.at + 8, "WEBP", 4) == 0)
        return in_webp(file);
    return in_tiff(file);
}

/* --- what it says --- */

/* The three primaries as columns, under D50 as profiles have them. */
static int read_primaries(cmsHPROFILE p, double to_xyz[9])
{
    static const cmsTagSignature names[3] = {cmsSigRedColorantTag, cmsSigGreenColorantTag, cmsSigBlueColorantTag};
    for (int c = 0; c < 3; c++) {
        const cmsCIEXYZ *primary = cmsReadTag(p, names[c]);
        if (!primary)
            return 0;
        to_xyz[c] = primary->X;
        to_xyz[3 + c] = primary->Y;
        to_xyz[6 + c] = primary->Z;
    }
    return 1;
}

/* IEC 61966-2-1. */
static double srgb_signal(double light)
{
    return light <= 0.0031308 ? light * 12.92 : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* Maps light decoded with sRGB's curve to light by the profile's curve. 1: they differ; 0: they are the same; -1: the
 * curve is not usable. */
static int make_table(const cmsToneCurve *curve, float table[STEPS + 1])
{
    int differs = 0;
    for (int i = 0; i <= STEPS; i++) {
        const double root = i / (double)STEPS, signal = srgb_signal(root * root);
        const double light = cmsEvalToneCurveFloat(curve, (float)fmin(signal, 1));
        if (!(light > -0.1 && light < 1.1))
            return -1;
        if (i == STEPS && fabs(light - 1) > 0.1) /* white is not white */
            return -1;
        table[i] = (float)light;
        differs |= fabs(srgb_signal(fmin(fmax(light, 0), 1)) - signal) > SAME_CODE;
    }
    return differs;
}

/* Tables of the three channels. 1: at least one differs from sRGB's; 0: all are sRGB's; -1: not usable. */
static int make_tables(cmsHPROFILE p, float (*table)[STEPS + 1])
{
    static const cmsTagSignature names[3] = {cmsSigRedTRCTag, cmsSigGreenTRCTag, cmsSigBlueTRCTag};
    int differs = 0;
    for (int c = 0; c < 3; c++) {
        const cmsToneCurve *curve = cmsReadTag(p, names[c]);
        const int one = curve ? make_table(curve, table[c]) : -1;
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

/* Applies the curves alone. 1: at least one differs from sRGB's; 0: they are the same, or the profile is ignored; -1:
 * no memory. */
static int apply_curves(cmsHPROFILE p, float *rgb, uint64_t pixels, pupil_still_colour *colour, pupil_why *why)
{
    double to_xyz[9];
    if (cmsGetColorSpace(p) != cmsSigRgbData || cmsGetPCS(p) != cmsSigXYZData || !read_primaries(p, to_xyz) ||
        !pupil_still_colour_from_icc(to_xyz, colour)) {
        *colour = (pupil_still_colour){.convert = 0};
        return 0;
    }
    float(*table)[STEPS + 1] = malloc(3 * sizeof *table);
    if (!table)
        return pupil_still_fail(why, "no memory for the curves of its ICC profile");
    const int curves = make_tables(p, table);
    if (curves > 0)
        apply_tables(table, rgb, pixels);
    if (curves < 0)
        *colour = (pupil_still_colour){.convert = 0};
    free(table);
    return curves > 0;
}

static int curves_of(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_still_colour *colour,
                     pupil_why *why)
{
    cmsHPROFILE p = cmsOpenProfileFromMem(profile, (cmsUInt32Number)size);
    *colour = (pupil_still_colour){.convert = 0};
    const int result = p ? apply_curves(p, rgb, pixels, colour, why) : 0;
    if (p)
        cmsCloseProfile(p);
    return result;
}

int pupil_icc_apply_profile(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_why *why)
{
    pupil_still_colour colour;
    const int curves = curves_of(profile, size, rgb, pixels, &colour, why);
    if (curves >= 0)
        pupil_still_colour_apply(&colour, rgb, pixels);
    return curves < 0 ? -1 : curves || colour.convert;
}

int pupil_icc_apply_curves(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_still_colour *colour,
                           pupil_why *why)
{
    const bytes_of profile = profile_of((bytes_of){bytes, size});
    *colour = (pupil_still_colour){.convert = 0};
    return profile.at && curves_of(profile.at, profile.size, rgb, pixels, colour, why) < 0 ? -1 : 0;
}
