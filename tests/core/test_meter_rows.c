/* config.meter_rows: which rows are metered, that this changes from frame to frame, and what it costs in error. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

enum { WIDTH = 160, HEIGHT = 120 };

static pupil_t begin(uint32_t meter_rows)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    config.meter_rows = meter_rows;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    return pupil;
}

static double mean_of(const pupil_t *pupil, const frame *f, pupil_stats *stats)
{
    double mean = NAN;
    pupil_stats_clear(stats);
    CHECK(pupil_meter_rows(pupil, &f->image, 0, f->image.height, stats) == PUPIL_OK);
    CHECK(stats->rows == f->image.height);
    CHECK(pupil_stats_mean(stats, 0, 1, &mean) == PUPIL_OK);
    return mean;
}

/* Each row has its own light, so the statistics show which rows were metered. */
static void one_row_of_each_group(uint32_t height)
{
    for (uint32_t n = 2; n <= 8; n *= 2) {
        pupil_t pupil = begin(n);
        uint32_t changes = 0, times[8] = {0}, before = 99;
        for (unsigned k = 0; k < 64; k++) {
            pupil_stats stats;
            uint32_t groups = 0, this_frame = 0;
            for (uint32_t y = 0; y < height; y += n) {
                uint32_t found = 0;
                for (uint32_t i = 0; i < n && y + i < height; i++) {
                    frame f = frame_make(4, height, PUPIL_PIXEL_RGB32F, 0, 0);
                    frame_fill(&f, 0.25, 0.25, 0.25);
                    for (uint32_t x = 0; x < 4; x++)
                        frame_set(&f, x, y + i, 0, 0, 0, 1);
                    (void)mean_of(&pupil, &f, &stats);
                    if (stats.black) {
                        CHECK(stats.black == 4);
                        found++;
                        times[i]++;
                        this_frame = this_frame * 31 + i;
                    }
                    frame_free(&f);
                }
                CHECK_MSG(found == 1, "%u rows of a group of %u", found, n);
                groups++;
            }
            CHECK(stats.pixels == 4 * groups && stats.weight == 4 * groups);
            changes += this_frame != before;
            before = this_frame;
            CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK); /* the next frame */
        }
        CHECK_MSG(changes > 24, "one of %u rows: another choice in %u of 64 frames", n, changes);
        for (uint32_t i = 0; i < n && i < height; i++)
            CHECK_MSG(times[i] > 64 / n / 3, "row %u of %u: %u times", i, n, times[i]);
    }
}

/* Any split into rows meters the same ones. */
static void any_split(uint32_t pixel)
{
    frame f = frame_make(WIDTH, HEIGHT, pixel, 0, 0);
    frame_lognormal(&f, 0.1, 2, check_uniform);
    for (uint32_t n = 1; n <= 8; n *= 2) {
        const pupil_t pupil = begin(n);
        pupil_stats whole, sum, part;
        (void)mean_of(&pupil, &f, &whole);
        pupil_stats_clear(&sum);
        for (uint32_t y = HEIGHT; y > 0;) {
            uint32_t rows = 2 * (1 + (uint32_t)(check_uniform() * 6));
            rows = rows < y ? rows : y;
            y -= rows;
            const pupil_image_const group = pupil_image_rows(f.image, y, rows);
            pupil_stats_clear(&part);
            CHECK(pupil_meter_rows(&pupil, &group, y, HEIGHT, &part) == PUPIL_OK);
            CHECK(pupil_stats_add(&sum, &part) == PUPIL_OK);
        }
        CHECK(memcmp(&sum, &whole, sizeof sum) == 0);
    }
    frame_free(&f);
}

/* If only a few rows have weight, a frame may meter none: then the level is held, and a later one meters them. */
static void few_rows_with_weight(void)
{
    frame f = frame_make(32, 32, PUPIL_PIXEL_RGB32F, 0, 0), to = frame_make(32, 32, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image out = frame_writable(&to);
    uint32_t held = 0, seen = 0;
    frame_fill(&f, 0.5, 0.5, 0.5);
    for (uint32_t cell = 0; cell < PUPIL_GRID_SIDE; cell++) {
        pupil_config config;
        pupil_t pupil;
        pupil_exposure e;
        pupil_config_default(&config);
        config.meter_rows = 8;
        memset(config.weight, 0, sizeof config.weight);
        memset(config.weight[cell], 1, sizeof config.weight[cell]);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        for (int k = 0; k < 40; k++) { /* 2 of 8 rows: to meet none of them in 40 frames has a chance of 1 in 100000 */
            CHECK(pupil_process(&pupil, &f.image, NULL, &out) == PUPIL_OK);
            CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK);
            held += e.reason == PUPIL_REASON_NO_LIGHT;
            seen += e.reason != PUPIL_REASON_NO_LIGHT;
        }
        CHECK_MSG(e.frames > 0 && fabs(e.adapted_ev + 1) < 1e-6, "row %u of the grid is never metered", cell);
    }
    CHECK(held > seen && seen > 16 * 4);
    frame_free(&f);
    frame_free(&to);
}

/* The error, as in docs/numerics.md. */
static void error_of(const char *what, frame *f, const double limit[3])
{
    pupil_stats stats;
    pupil_t all = begin(1);
    const double exact = mean_of(&all, f, &stats);
    for (int k = 0; k < 3; k++) {
        pupil_t pupil = begin(2u << k);
        double worst = 0, sum = 0;
        for (int i = 0; i < 200; i++) {
            const double error = mean_of(&pupil, f, &stats) - exact;
            worst = fmax(worst, fabs(error));
            sum += error;
            CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK);
        }
        printf("%s, one of %d rows: at most %.4f EV in 200 frames, %.4f on average\n", what, 2 << k, worst,
               fabs(sum / 200));
        CHECK_MSG(worst < limit[k], "%s: %g EV", what, worst);
    }
}

/* Weights whose halves are the same, and not all equal. */
static void striped_weights(void)
{
    frame f = frame_make(64, 16, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_config_default(&config);
    for (uint32_t y = 0; y < 16; y++)
        for (uint32_t x = 0; x < 64; x++) {
            const double light = x / 4 % 2 ? 2.0 : 0.125;
            frame_set(&f, x, y, light, light, light, 1);
            config.weight[y][x / 4] = x / 4 % 2 ? 3 : 1;
        }
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    const double mean = mean_of(&pupil, &f, &stats);
    CHECK(stats.weight == 16 * 64 * 2 && stats.pixels == 16 * 64);
    CHECK_MSG(fabs(mean - (3.0 * 1.0 - 3.0) / 4.0) < 1e-6, "%g", mean);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    one_row_of_each_group(24);
    one_row_of_each_group(21);
    any_split(PUPIL_PIXEL_RGBA16F);
    any_split(PUPIL_PIXEL_BAYER12);
    any_split(PUPIL_PIXEL_NV12);
    few_rows_with_weight();
    frame f = frame_make(640, 480, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_lognormal(&f, 0.1, 2, check_uniform);
    error_of("noise of 2 stops", &f, (double[]){0.02, 0.03, 0.05});
    frame_gradient(&f, 1e-3, 10);
    error_of("a gradient of 13 stops", &f, (double[]){0.01, 0.02, 0.04});
    for (uint32_t y = 0; y < 480; y++) /* every second row 6 stops brighter: a fixed choice would miss all of them */
        for (uint32_t x = 0; x < 640; x++)
            frame_set(&f, x, y, y % 2 ? 0.64 : 0.01, y % 2 ? 0.64 : 0.01, y % 2 ? 0.64 : 0.01, 1);
    error_of("stripes of a row", &f, (double[]){0.7, 1.0, 1.4});
    frame_free(&f);
    striped_weights();
    return check_end();
}
