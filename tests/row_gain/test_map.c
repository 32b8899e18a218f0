/* pupil_map_rows_with_gains: each row, or group of rows that belong together, is mapped as by pupil_map_rows with its
 * own scale; for every format in and out.
 */
#include "check.h"
#include "frames.h"
#include "pupil/row_gain.h"

#include <math.h>

enum { MOST_ROWS = 64 };

static const pupil_curve curve = {.scale = 2.0f, .inverse_white_squared = 0.0625f, .gamut = 3.7f};

/* The same, computed here: `together` rows of `in` at a time, with the mean of their gains. */
static void map_by_hand(const pupil_t *pupil, const pupil_image_const *in, const float *gain, const pupil_image *out,
                        uint32_t together)
{
    const uint32_t halved = in->width != out->width ? 2 : 1;
    for (uint32_t y = 0; y < in->height; y += together) {
        const uint32_t count = in->height - y < together ? in->height - y : together;
        float sum = 0;
        for (uint32_t i = 0; i < count; i++)
            sum += gain[y + i];
        pupil_curve scaled = curve;
        scaled.scale = (float)((double)curve.scale * (sum / (float)count));
        const pupil_image_const rows = pupil_image_rows(*in, y, count);
        const pupil_image to = pupil_image_out_rows(*out, y / halved, count / halved);
        CHECK(pupil_map_rows(pupil, &scaled, &rows, &to) == PUPIL_OK);
    }
}

static void check_pair(uint32_t from, uint32_t to, int halved)
{
    pupil_config config;
    pupil_t pupil;
    float gain[MOST_ROWS], one[MOST_ROWS];
    uint32_t width = 8 + (uint32_t)(check_random() % 60), height = 8 + (uint32_t)(check_random() % 50);
    const int pairs = pupil_chroma_rows(from, 2) == 1 || pupil_pixel_is_mosaic(from);
    frame_fit(from, &width, &height);
    const uint32_t out_width = halved ? width / 2 : width, out_height = halved ? height / 2 : height;
    frame in = frame_make(width, height, from, 0, (int)(check_random() & 1));
    frame a = frame_make(out_width, out_height, to, 0, 0), b = frame_make(out_width, out_height, to, 0, 0);
    const pupil_image to_a = frame_writable(&a), to_b = frame_writable(&b);
    frame_lognormal(&in, 0.1, 2, check_uniform);
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int i = 0; i < MOST_ROWS; i++) {
        gain[i] = (float)exp2(2 * check_uniform() - 1);
        one[i] = 1;
    }
    const uint32_t together = pupil_pixel_planes(to) > 1 && halved ? 4 : pupil_pixel_planes(to) > 1 || pairs ? 2 : 1;
    map_by_hand(&pupil, &in.image, gain, &to_a, together);
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, gain, &to_b) == PUPIL_OK);
    CHECK_MSG(frame_equal(&a, &b), "format %u to %u, halved %d, %u x %u", from, to, halved, width, height);
    CHECK(frame_guards_intact(&b));

    CHECK(pupil_map_rows(&pupil, &curve, &in.image, &to_a) == PUPIL_OK); /* gains of 1 are none */
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, one, &to_b) == PUPIL_OK);
    CHECK_MSG(frame_equal(&a, &b), "gains of 1: format %u to %u, halved %d, %u x %u", from, to, halved, width, height);
    frame_free(&in);
    frame_free(&a);
    frame_free(&b);
}

static void check_refusals(void)
{
    pupil_config config;
    pupil_t pupil;
    frame in = frame_make(8, 8, PUPIL_PIXEL_RGB8, 0, 0), out = frame_make(8, 8, PUPIL_PIXEL_RGBA8, 0, 0);
    frame before = frame_make(8, 8, PUPIL_PIXEL_RGBA8, 0, 0), small = frame_make(8, 7, PUPIL_PIXEL_RGBA8, 0, 0);
    pupil_image to = frame_writable(&out), to_small = frame_writable(&small);
    float gain[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int i = 0; i < 5; i++) { /* detected before anything is written */
        static const float bad[] = {0, -1, NAN, INFINITY, -INFINITY};
        gain[7] = bad[i];
        CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, gain, &to) == PUPIL_ERR_VALUE);
        CHECK(frame_equal(&out, &before));
    }
    gain[7] = 1;
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, gain, &to_small) == PUPIL_ERR_SIZE);
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, NULL, &to) == PUPIL_ERR_NULL);
    CHECK(pupil_map_rows_with_gains(&pupil, NULL, &in.image, gain, &to) == PUPIL_ERR_NULL);
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, NULL, gain, &to) == PUPIL_ERR_NULL);
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, gain, NULL) == PUPIL_ERR_NULL);
    to.stride_bytes = 4; /* a single row has no stride: the whole image is checked */
    CHECK(pupil_map_rows_with_gains(&pupil, &curve, &in.image, gain, &to) == PUPIL_ERR_STRIDE);
    CHECK(frame_equal(&out, &before));
    to = frame_writable(&out);
    pupil_curve brightest = {.scale = 0x1p60f};
    for (int i = 0; i < 8; i++)
        gain[i] = 0x1p100f;
    CHECK(pupil_map_rows_with_gains(&pupil, &brightest, &in.image, gain, &to) == PUPIL_OK);
    frame_free(&in);
    frame_free(&out);
    frame_free(&before);
    frame_free(&small);
}

/* A wall of columns of several colours under lamps of 100 Hz, in any format: the wave is found. */
static void check_metering(uint32_t pixel)
{
    static pupil_row_gain lamps;
    pupil_row_gain_config config;
    pupil_row_gain_result result;
    uint32_t width = 64, height = 64;
    frame_fit(pixel, &width, &height);
    frame in = frame_make(width, height, pixel, 0, (int)(check_random() & 1));
    pupil_row_gain_config_default(&config);
    config.readout_s = 0.025;
    CHECK(pupil_row_gain_init(&lamps, &config) == PUPIL_OK);
    for (int i = 1; i <= 30; i++) {
        const pupil_frame_info info = {.timestamp_ns = i * INT64_C(33333333), .exposure_s = 1e-3, .gain = 1};
        for (uint32_t y = 0; y < height; y++) {
            const double t = 1e-9 * (double)info.timestamp_ns + config.readout_s * (y + 0.5) / height;
            const double light = 0.2 * (1 + 0.3 * cos(2 * 3.14159265358979 * 100 * t));
            for (uint32_t x = 0; x < width; x++)
                frame_set(&in, x, y, light * (1 + x % 3), light, light * (1 + x % 2), 1);
        }
        CHECK(pupil_row_gain_frame(&lamps, &in.image, &info) == PUPIL_OK);
    }
    CHECK(pupil_row_gain_get(&lamps, &result) == PUPIL_OK);
    printf("format %2u: wave of %.3f EV, strength %.2f, disagreement %.3f, reason %u\n", pixel, result.flicker_ev,
           result.strength, result.disagreement, result.reason);
    CHECK_MSG(result.strength > 0.9 && result.flicker_ev > 0.3, "format %u: strength %g, wave %g, reason %u", pixel,
              result.strength, result.flicker_ev, result.reason);
    CHECK(frame_guards_intact(&in));
    frame_free(&in);
}

/* The largest possible gains, on pairs of rows: 0 times them is 0. */
static void check_largest(void)
{
    static const pupil_curve black = {0};
    pupil_config config;
    pupil_t pupil;
    frame in = frame_make(8, 8, PUPIL_PIXEL_BAYER8, 0, 0), a = frame_make(8, 8, PUPIL_PIXEL_RGBA8, 0, 0);
    frame b = frame_make(8, 8, PUPIL_PIXEL_RGBA8, 0, 0);
    const pupil_image to_a = frame_writable(&a), to_b = frame_writable(&b);
    float gain[8];
    for (int i = 0; i < 8; i++)
        gain[i] = 0x1.fffffep+127f;
    frame_lognormal(&in, 0.1, 2, check_uniform);
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, &black, &in.image, &to_a) == PUPIL_OK);
    CHECK(pupil_map_rows_with_gains(&pupil, &black, &in.image, gain, &to_b) == PUPIL_OK && frame_equal(&a, &b));
    frame_free(&in);
    frame_free(&a);
    frame_free(&b);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t from = PUPIL_PIXEL_RGBA32F; from < PUPIL_PIXEL_COUNT; from++) {
        check_metering(from);
        for (int i = 0; i < 6; i++) {
            static const uint32_t to[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_NV12,
                                          PUPIL_PIXEL_BGR8,  PUPIL_PIXEL_I420,  PUPIL_PIXEL_RGBA16F};
            check_pair(from, to[i], 0);
            if (pupil_pixel_is_mosaic(from))
                check_pair(from, to[i], 1);
        }
    }
    check_refusals();
    check_largest();
    return check_end();
}
