/* The sums of a mosaic's channels, and the white balance computed from them. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

/* 0 red, 1 green, 2 blue */
static int colour_at(const pupil_coding *c, uint32_t x, uint32_t y)
{
    static const char order[PUPIL_BAYER_COUNT][5] = {"0112", "1021", "1201", "2110"};
    return order[c->bayer][y % 2 * 2 + x % 2] - '0';
}

/* The gains undo the cast of a grey scene, regardless of the balance that it was metered with. */
static void grey_world(void)
{
    for (int n = 0; n < 50; n++) {
        const double factor[3] = {0.3 + check_uniform(), 0.3 + check_uniform(), 0.3 + check_uniform()};
        const double most = fmax(fmax(factor[0], factor[1]), factor[2]);
        frame f = frame_make(64, 64, PUPIL_PIXEL_BAYER16, 0, 0);
        pupil_coding coding = {.bayer = (uint32_t)n % 4, .black = 256};
        pupil_config config;
        pupil_t pupil;
        pupil_stats stats;
        float balance[3], again[3];
        for (uint32_t y = 0; y < 64; y++)
            for (uint32_t x = 0; x < 64; x++) {
                const double light = 4000 * (1 + (double)(x / 2 * 7 + y / 2 * 3) / 100);
                ((uint16_t *)frame_writable(&f).data)[64 * y + x] =
                    (uint16_t)lround(256 + light * factor[colour_at(&coding, x, y)]);
            }
        f.image.coding = &coding;
        pupil_config_default(&config);
        config.grey_world = 1;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 64, &stats) == PUPIL_OK);
        CHECK(pupil_stats_grey_world(&stats, balance) == PUPIL_OK);
        for (int k = 0; k < 3; k++)
            CHECK_MSG(fabs(balance[k] * factor[k] / most - 1) < 1e-4, "channel %d: %g for %g", k, balance[k],
                      most / factor[k]);
        memcpy(coding.balance, balance, sizeof balance);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 64, &stats) == PUPIL_OK);
        CHECK(pupil_stats_grey_world(&stats, again) == PUPIL_OK && memcmp(balance, again, sizeof again) == 0);
        frame_free(&f);
    }
    pupil_stats none;
    float balance[3] = {5, 5, 5};
    pupil_stats_clear(&none);
    CHECK(pupil_stats_grey_world(&none, balance) == PUPIL_ERR_NO_LIGHT && balance[0] == 5);
    CHECK(pupil_stats_grey_world(NULL, balance) == PUPIL_ERR_NULL);
    CHECK(pupil_stats_grey_world(&none, NULL) == PUPIL_ERR_NULL);
    none.rows = none.frame_height = 1;
    none.pixels = none.weight = none.channel_quads = 4;
    for (int64_t blue = -1; blue <= 0; blue++) { /* no light, or less than black */
        const int64_t sum[3] = {4000, 4000, blue};
        memcpy(none.channel_sum, sum, sizeof sum);
        CHECK(pupil_stats_grey_world(&none, balance) == PUPIL_ERR_NO_LIGHT && balance[0] == 5);
    }
    none.channel_sum[2] = 3; /* beyond a coding's range */
    CHECK(pupil_stats_grey_world(&none, balance) == PUPIL_OK);
    CHECK(balance[0] == 1.0f && balance[1] == 1.0f && balance[2] == 1024.0f);
    none.black = 5;
    CHECK(pupil_stats_grey_world(&none, balance) == PUPIL_ERR_STATS && balance[2] == 1024.0f);
}

/* A colourful frame up to saturation, against its samples, with balances that clip many unsaturated samples. */
static void grey_world_sums(void)
{
    for (unsigned n = 0; n < 60; n++) {
        frame f = frame_make(64, 16, PUPIL_PIXEL_BAYER12, 0, 0);
        pupil_coding coding = {.bayer = n % 4, .black = 64.3f, .white = n % 2 ? 0 : 3000.5f};
        const double full = 4 * (double)(n % 2 ? 4095 : 3000.5f);
        int64_t sum[3] = {0, 0, 0};
        uint64_t quads = 0;
        pupil_config config;
        pupil_t pupil;
        pupil_stats stats;
        for (int k = 0; k < 3 && n % 3; k++)
            coding.balance[k] = k == (int)n % 3 ? 1 : (float)(1 + 7 * check_uniform());
        for (uint32_t i = 0; i < 64 * 16; i++)
            ((uint16_t *)frame_writable(&f).data)[i] = (uint16_t)fmin(4095, check_uniform() * 4300);
        f.image.coding = &coding;
        for (uint32_t y = 0; y < 16; y += 2)
            for (uint32_t x = 0; x < 64; x += 2) {
                double four[3];
                for (int k = 0; k < 3; k++)
                    four[k] = 0;
                for (uint32_t i = 0; i < 4; i++) {
                    const int k = colour_at(&coding, x + i % 2, y + i / 2);
                    four[k] += (k == 1 ? 2 : 4) * ((const uint16_t *)f.image.data)[64 * (y + i / 2) + x + i % 2];
                }
                if (four[0] >= full || four[1] >= full || four[2] >= full)
                    continue;
                quads++;
                for (int k = 0; k < 3; k++)
                    sum[k] += llround(four[k]) - 257; /* 4 * 64.3 */
            }
        pupil_config_default(&config);
        config.grey_world = 1;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 16, &stats) == PUPIL_OK);
        CHECK_MSG(stats.channel_quads == quads && memcmp(stats.channel_sum, sum, sizeof sum) == 0,
                  "frame %u: %u quads for %u", n, (unsigned)stats.channel_quads, (unsigned)quads);
        frame_free(&f);
    }
}

/* Companded samples far below black count as at most the largest light, negated. */
static void far_below_black(void)
{
    frame f = frame_make(4, 2, PUPIL_PIXEL_BAYER12, 0, 0);
    const pupil_coding coding = {.black = 2000, .white = 2500, .knees = 1, .knee_code = {2250}, .knee_light = {0.3f}};
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    memset(frame_writable(&f).data, 0, 2 * 4 * sizeof(uint16_t));
    f.image.coding = &coding;
    pupil_config_default(&config);
    config.grey_world = 1;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, 2, &stats) == PUPIL_OK);
    CHECK(stats.channel_quads == 2);
    for (int k = 0; k < 3; k++)
        CHECK_MSG(stats.channel_sum[k] == -2 * 4 * 65535, "channel %d: %lld", k, (long long)stats.channel_sum[k]);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    far_below_black();
    grey_world();
    grey_world_sums();
    return check_end();
}
