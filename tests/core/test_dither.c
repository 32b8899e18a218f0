/* Ordered dither: the same in parts as in the whole; no change where light is exactly a code; and the mean over 8 x 8
 * pixels is the light, where plain rounding has bands.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

/* scale 1, white 1: light is not changed */
static const pupil_curve identity = {.scale = 1, .inverse_white_squared = 1, .dither = 1};

static void map(const pupil_config *config, const pupil_curve *curve, const frame *in, frame *out)
{
    const pupil_image to = frame_writable(out);
    pupil_t pupil;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &to) == PUPIL_OK);
}

/* Also of a mosaic mapped to half its size. */
static void check_parts(uint32_t pixel, uint32_t out_pixel, int halved, int level)
{
    enum { WIDTH = 70, HEIGHT = 24 };
    static const uint32_t cuts[] = {0, 4, 6, 16, 24};
    frame in = frame_make(WIDTH, HEIGHT, pixel, 0, 0);
    frame whole = frame_make(WIDTH / (halved ? 2 : 1), HEIGHT / (halved ? 2 : 1), out_pixel, 0, 0);
    frame parts = frame_make(whole.image.width, whole.image.height, out_pixel, 0, 0);
    frame fused = frame_make(whole.image.width, whole.image.height, out_pixel, 0, 0);
    pupil_config config;
    pupil_curve curve = {
        .size_bytes = sizeof curve, .scale = 0.7f, .inverse_white_squared = 0.1f, .gamut = 4, .dither = 1};
    pupil_stats stats;
    pupil_t pupil;
    frame_lognormal(&in, 0.2, 2, check_uniform);
    pupil_config_default(&config);
    pupil_metering_centre(&config); /* runs that begin anywhere */
    config.levels = level ? 0 : 1u << PUPIL_LEVEL_SCALAR;
    map(&config, &curve, &in, &whole);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    for (unsigned i = 0; i + 1 < sizeof cuts / sizeof *cuts; i++) {
        const uint32_t y = cuts[i], rows = cuts[i + 1] - y, by = halved ? 2 : 1;
        const pupil_image_const part = pupil_image_rows(in.image, y, rows);
        const pupil_image to = pupil_image_out_rows(frame_writable(&parts), y / by, rows / by);
        const pupil_image to_fused = pupil_image_out_rows(frame_writable(&fused), y / by, rows / by);
        curve.first_row = y;
        CHECK(pupil_map_rows(&pupil, &curve, &part, &to) == PUPIL_OK);
        CHECK(pupil_fused_rows(&pupil, &curve, &part, y, HEIGHT, &to_fused, &stats) == PUPIL_OK);
    }
    CHECK_MSG(frame_equal(&whole, &parts), "format %u to %u: parts", pixel, out_pixel);
    CHECK_MSG(frame_equal(&whole, &fused), "format %u to %u: fused", pixel, out_pixel);
    frame_free(&in);
    frame_free(&whole);
    frame_free(&parts);
    frame_free(&fused);
}

/* Every 8-bit code at every position, in three channels. */
static void check_codes_stay(void)
{
    pupil_config config;
    frame in = frame_make(256, 64, PUPIL_PIXEL_RGB8, 0, 0), out = frame_make(256, 64, PUPIL_PIXEL_RGB8, 0, 0);
    for (uint32_t y = 0; y < 64; y++)
        for (uint32_t i = 0; i < 768; i++)
            ((unsigned char *)frame_writable(&in).data)[768 * y + i] = (unsigned char)(i / 3 + y * 37);
    pupil_config_default(&config);
    map(&config, &identity, &in, &out);
    CHECK(frame_equal(&in, &out));
    frame_free(&in);
    frame_free(&out);
}

/* 8 x 8 pixels of one grey, at a position that is not a multiple of 8. */
static void check_means(uint32_t transfer)
{
    pupil_config config;
    double worst = 0;
    pupil_config_default(&config);
    config.transfer = transfer;
    for (int n = 0; n < 400; n++) {
        const double light = exp2(-12.0 * n / 400);
        frame in = frame_make(11, 8, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(11, 8, PUPIL_PIXEL_RGB8, 0, 0);
        const unsigned char *code = frame_writable(&out).data;
        double sum = 0;
        frame_fill(&in, light, light, light);
        map(&config, &identity, &in, &out);
        for (uint32_t i = 0; i < 88; i++) {
            CHECK(code[3 * i] == code[3 * i + 1] && code[3 * i] == code[3 * i + 2]);
            sum += i % 11 < 3 ? 0 : code[3 * i];
        }
        worst = fmax(worst, fabs(sum / 64 - (double)ref_encode(transfer, (float)light)));
        frame_free(&in);
        frame_free(&out);
    }
    printf("transfer %u: the mean of 8 x 8 pixels is at most %.3f codes from the light's\n", transfer, worst);
    CHECK(worst <= 0.1); /* plain rounding: 0.5 */
}

/* Off by default, and light is not dithered. */
static void check_off(void)
{
    pupil_config config;
    pupil_curve curve = identity, got;
    pupil_t pupil;
    frame in = frame_make(64, 8, PUPIL_PIXEL_RGB32F, 0, 0), a = frame_make(64, 8, PUPIL_PIXEL_RGB32F, 0, 0);
    frame b = frame_make(64, 8, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_config_default(&config);
    CHECK(config.dither == 0);
    frame_lognormal(&in, 0.2, 2, check_uniform);
    map(&config, &curve, &in, &a);
    curve.dither = 0;
    map(&config, &curve, &in, &b);
    CHECK(frame_equal(&a, &b));
    for (config.dither = 0; config.dither < 2; config.dither++) {
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_meter(&pupil, &in.image, NULL) == PUPIL_OK && pupil_get_curve(&pupil, NULL, &got) == PUPIL_OK);
        CHECK(got.dither == config.dither && got.first_row == 0);
    }
    frame_free(&in);
    frame_free(&a);
    frame_free(&b);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (int level = 0; level < 2; level++) {
        check_parts(PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGBA8, 0, level);
        check_parts(PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGR8, 0, level);
        check_parts(PUPIL_PIXEL_YUYV, PUPIL_PIXEL_NV12, 0, level);
        check_parts(PUPIL_PIXEL_BAYER10, PUPIL_PIXEL_RGB8, 1, level);
    }
    check_codes_stay();
    for (uint32_t transfer = 0; transfer < PUPIL_TRANSFER_COUNT; transfer++)
        check_means(transfer);
    check_off();
    return check_end();
}
