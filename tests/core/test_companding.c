/* Companded codes: a ramp of every code, and a mosaic of it, give the same results as their linear twins. */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <math.h>
#include <string.h>

/* A 12-bit ramp of 16 bits of light: slopes 1, 4, 16 and 30, as car sensors have them. The linear twin of each code is
 * an integer.
 */
#define WHITE 65506
static const uint32_t knee_code[3] = {1024, 1536, 2560}, knee_linear[3] = {1024, 3072, 19456};

static uint16_t linear_of(uint32_t code)
{
    uint32_t from = 0, linear = 0;
    static const uint32_t slope[4] = {1, 4, 16, 30};
    int k = 0;
    for (; k < 3 && code >= knee_code[k]; k++) {
        from = knee_code[k];
        linear = knee_linear[k];
    }
    return (uint16_t)(linear + (code - from) * slope[k]);
}

static pupil_coding companded_coding(void)
{
    pupil_coding c = {.knees = 3};
    for (int k = 0; k < 3; k++) {
        c.knee_code[k] = (float)knee_code[k];
        c.knee_light[k] = (float)knee_linear[k] / WHITE;
    }
    return c;
}

/* Metered and mapped alike, up to the rounding of a float. */
static void check_twins(const frame *companded, const frame *linear, const char *what)
{
    const uint32_t w = companded->image.width, h = companded->image.height;
    frame out[2] = {frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0), frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0)};
    const frame *const in[2] = {companded, linear};
    pupil_stats stats[2];
    double mean[2];
    int most = 0;
    unsigned off = 0;
    pupil_config config;
    pupil_config_default(&config);
    for (int i = 0; i < 2; i++) {
        const pupil_image to = frame_writable(&out[i]);
        pupil_t pupil;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_process(&pupil, &in[i]->image, NULL, &to) == PUPIL_OK);
        CHECK(pupil_get_stats(&pupil, &stats[i]) == PUPIL_OK);
        CHECK(pupil_stats_mean(&stats[i], 0, 1, &mean[i]) == PUPIL_OK);
    }
    const unsigned char *a = frame_writable(&out[0]).data, *b = frame_writable(&out[1]).data;
    for (uint32_t i = 0; i < w * h * 3; i++) {
        off += a[i] != b[i];
        most = abs(a[i] - b[i]) > most ? abs(a[i] - b[i]) : most;
    }
    printf("%s: %.2g EV, %u of %u codes differ, by at most %d\n", what, fabs(mean[0] - mean[1]), off, w * h * 3, most);
    CHECK_MSG(fabs(mean[0] - mean[1]) < 1e-6, "%s: %g and %g EV", what, mean[0], mean[1]);
    CHECK_MSG(stats[0].clipped == stats[1].clipped && stats[0].clipped > 0 && stats[0].black == stats[1].black,
              "%s: clipped %u and %u, black %u and %u", what, (unsigned)stats[0].clipped, (unsigned)stats[1].clipped,
              (unsigned)stats[0].black, (unsigned)stats[1].black);
    CHECK_MSG(most <= 1 && off * 1000 < w * h * 3, "%s: %u codes off, by at most %d", what, off, most);
    frame_free(&out[0]);
    frame_free(&out[1]);
}

static void check_ramp(uint32_t companded_pixel, uint32_t linear_pixel, const char *what)
{
    frame companded = frame_make(64, 64, companded_pixel, 0, 0), linear = frame_make(64, 64, linear_pixel, 0, 0);
    pupil_coding coding = companded_coding(), plain = {.white = WHITE};
    uint16_t *c = frame_writable(&companded).data, *l = frame_writable(&linear).data;
    for (uint32_t i = 0; i < 4096; i++) {
        c[i] = (uint16_t)i;
        l[i] = linear_of(i);
    }
    CHECK(linear_of(4095) == WHITE);
    companded.image.coding = &coding;
    linear.image.coding = &plain;
    check_twins(&companded, &linear, what);
    if (pupil_pixel_is_mosaic(companded_pixel)) { /* any neighbours, with a balance and a matrix */
        const float matrix[9] = {1.6f, -0.5f, -0.1f, -0.2f, 1.5f, -0.3f, 0.02f, -0.5f, 1.48f};
        for (uint32_t i = 0; i < 4096; i++) {
            c[i] = (uint16_t)(check_uniform() * 4096);
            l[i] = linear_of(c[i]);
        }
        c[0] = c[1] = c[64] = c[65] = 4095;
        l[0] = l[1] = l[64] = l[65] = WHITE;
        coding.balance[0] = plain.balance[0] = 1.9f;
        coding.balance[1] = plain.balance[1] = 1.0f;
        coding.balance[2] = plain.balance[2] = 1.4f;
        memcpy(coding.rgb_from_camera, matrix, sizeof matrix);
        memcpy(plain.rgb_from_camera, matrix, sizeof matrix);
        check_twins(&companded, &linear, "a mosaic of any codes");
    }
    frame_free(&companded);
    frame_free(&linear);
}

/* With any knees the largest code is light 1 and counts as clipped: rounding does not change that. */
static void white_is_full(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n < 400; n++) {
        pupil_coding coding = {.black = (float)(check_uniform() * 100.0), .knees = 1 + (uint32_t)n % 2};
        frame f = frame_make(2, 1, PUPIL_PIXEL_GREY12, 0, 0);
        pupil_stats stats;
        coding.knee_code[0] = 200.0f + (float)(check_uniform() * 1000.0);
        coding.knee_light[0] = 0.001f + (float)(check_uniform() * 0.1);
        coding.knee_code[1] = 2000.0f + (float)(check_uniform() * 2000.0);
        coding.knee_light[1] = 0.2f + (float)(check_uniform() * 0.7);
        f.image.coding = &coding;
        ((uint16_t *)frame_writable(&f).data)[0] = 4095;
        ((uint16_t *)frame_writable(&f).data)[1] = 4094;
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 1, &stats) == PUPIL_OK);
        CHECK_MSG(stats.clipped == 1, "knees at %a, %a of %a, %a: %d clipped", (double)coding.knee_code[0],
                  (double)coding.knee_code[1], (double)coding.knee_light[0], (double)coding.knee_light[1],
                  (int)stats.clipped);
        frame_free(&f);
    }
}

/* PQ with one code above black: its light, 100 times white, counts as white, the maximum in statistics. */
static void only_code(void)
{
    const pupil_coding coding = {.black = 254, .light = PUPIL_LIGHT_PQ};
    frame f = frame_make(2, 1, PUPIL_PIXEL_GREY8, 0, 0);
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    f.image.coding = &coding;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, 1, &stats) == PUPIL_OK && stats.code_light == 1.0f);
    CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_ramp(PUPIL_PIXEL_GREY12, PUPIL_PIXEL_GREY16, "a grey ramp");
    check_ramp(PUPIL_PIXEL_BAYER12, PUPIL_PIXEL_BAYER16, "a mosaic of a ramp");
    white_is_full();
    only_code();
    return check_end();
}
