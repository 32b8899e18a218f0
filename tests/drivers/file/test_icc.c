/* ICC profiles of JPEG, TIFF and WebP, made tag by tag: P3 and other primaries, curves of all kinds, what is left out,
 * and damage. */
#include "file/still/icc.h"

#include <math.h>

#include "check.h"
#include "write_icc.h"

static pupil_why why;

/* Curves and primaries, as pupil_read_libav applies them. */
static int apply(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels)
{
    pupil_still_colour colour;
    const int failed = pupil_icc_apply_curves(bytes, size, rgb, pixels, &colour, &why);
    pupil_still_colour_apply(&colour, rgb, pixels);
    return failed;
}

typedef enum place { IN_JPEG, IN_WEBP, IN_TIFF, PLACES } place;

static text file_of(const text *profile, place where)
{
    text f = {.size = 0};
    if (where == IN_JPEG) { /* behind another segment */
        put(&f, 0xffd8ffe0, 4);
        put(&f, 4, 2);
        put(&f, 0, 2);
        put(&f, 0xffe2, 2);
        put(&f, (uint32_t)profile->size + 16, 2);
        put_name(&f, "ICC_PROFILE");
        put(&f, 0x000101, 3);
    } else if (where == IN_WEBP) {
        put_name(&f, "RIFF....WEBPVP8X\1");
        put(&f, 0, 4); /* the rest of its length, and a byte of content and one of filling */
        f.at[f.size++] = 0;
        put_name(&f, "ICCP");
        for (int i = 0; i < 4; i++)
            put(&f, (uint32_t)profile->size >> 8 * i & 255, 1);
    } else {
        put_name(&f, "MM");
        put(&f, 42, 2);
        put(&f, 8, 4);
        put(&f, 1, 2);
        put(&f, 34675, 2);
        put(&f, 7, 2);
        put(&f, (uint32_t)profile->size, 4);
        put(&f, 26, 4);
        put(&f, 0, 4);
    }
    memcpy(f.at + f.size, profile->at, profile->size);
    f.size += profile->size;
    if (where == IN_JPEG)
        put(&f, 0xffda0002, 4);
    return f;
}

static void check_pixel(const double xyz[9], const curve *c, const float in[3], const double out[3], double slack)
{
    const text profile = profile_of(xyz, c);
    for (int where = 0; where < PLACES; where++) {
        const text file = file_of(&profile, where);
        float rgb[6] = {in[0], in[1], in[2], 1, 1, 1};
        CHECK(apply(file.at, file.size, rgb, 2) == 0);
        for (int i = 0; i < 3; i++)
            CHECK_MSG(fabs(rgb[i] - out[i]) <= slack, "in %d: channel %d is %g, not %g", where, i, (double)rgb[i],
                      out[i]);
        CHECK_MSG(fabsf(rgb[3] - rgb[4]) < 2e-7f && fabsf(rgb[4] - rgb[5]) < 2e-7f, "in %d: white is %g %g %g", where,
                  (double)rgb[3], (double)rgb[4], (double)rgb[5]);
    }
}

static void test_primaries(void)
{
    const float red[3] = {1, 0, 0}, some[3] = {0.3f, 0.2f, 0.7f};
    check_pixel(p3, &of_srgb, red, (const double[3]){1.2249, -0.0420, -0.0197}, 1e-3);
    check_pixel(srgb, &of_srgb, some, (const double[3]){some[0], some[1], some[2]}, 0); /* to the bit */
}

/* Light that the sRGB curve made of the signal 0.5, and that of the profile's. */
static void test_curves(void)
{
    static const struct {
        curve c;
        double light;
    } cases[] = {{{-1, {0}, 0}, 0.5},
                 {{-1, {2.19921875}, 1}, 0.217755},
                 {{-1, {0, 0.1, 1}, 3}, 0.1},
                 {{-1, {0, 1}, 2}, 0.5},
                 {{0, {2}, 1}, 0.25},
                 {{1, {2, 0.8, 0.2}, 3}, 0.36},
                 {{2, {2, 0.7, 0.2, 0.1}, 4}, 0.4025},
                 {{3, {1, 1, 0, 0.4, 0.6}, 5}, 0.2},
                 {{4, {1, 0.9, 0, 0.5, 0.6, 0.1, 0.05}, 7}, 0.3}};
    const float in = 0.21404114f;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const text profile = profile_of(srgb, &cases[i].c), file = file_of(&profile, IN_JPEG);
        float rgb[3] = {in, in, in};
        CHECK(apply(file.at, file.size, rgb, 1) == 0);
        for (int c = 0; c < 3; c++)
            CHECK_MSG(fabs(rgb[c] - cases[i].light) < 2e-4, "case %zu: %g, not %g", i, (double)rgb[c], cases[i].light);
    }
}

/* What cannot be taken leaves the pixels as they are. */
static void test_left_out(void)
{
    static const double none[9] = {0.5, 0.3, 0.1, 0.2, 0.7, 0.1, 0, 0, 0};
    static const curve wrong[] = {{5, {1}, 1}, {1, {1, 0, 0}, 3}, {0, {-1}, 1}, {-1, {0, 1}, 2}};
    const float in[3] = {0.3f, 0.2f, 0.7f};
    for (size_t k = 0; k < 7; k++) {
        text profile = profile_of(k == 0 ? none : p3, k >= 1 && k <= 4 ? &wrong[k - 1] : &of_srgb);
        if (k == 4)
            profile.at[132 + 12 * 3 + 4] = 0x7f; /* a curve beyond the end */
        if (k == 5)
            memcpy(profile.at + 16, "CMYK", 4);
        text file = file_of(&profile, IN_JPEG);
        if (k == 6)
            file.at[8 + 4 + 12 + 1] = 2; /* of two segments */
        float rgb[3] = {in[0], in[1], in[2]};
        CHECK(apply(file.at, file.size, rgb, 1) == 0);
        CHECK_MSG(memcmp(rgb, in, sizeof rgb) == 0, "case %zu: %g %g %g", k, (double)rgb[0], (double)rgb[1],
                  (double)rgb[2]);
    }
}

/* Cut anywhere, and with any byte changed: no read beyond, and finite pixels. */
static void test_damage(void)
{
    const text profile = profile_of(p3, &of_srgb);
    for (int where = 0; where < PLACES; where++) {
        const text file = file_of(&profile, where);
        for (size_t k = 0; k < 4 * file.size; k++) {
            const size_t size = k < file.size ? k : file.size;
            uint8_t *copy = malloc(size ? size : 1); /* of that size, for the sanitizer */
            float rgb[3] = {0.3f, 0.2f, 0.7f};
            memcpy(copy, file.at, size);
            if (k >= file.size)
                copy[k % file.size] = (uint8_t)(check_uniform() * 256);
            CHECK(apply(copy, size, rgb, 1) == 0);
            CHECK(isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]));
            free(copy);
        }
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_primaries();
    test_curves();
    test_left_out();
    test_damage();
    return check_end();
}
