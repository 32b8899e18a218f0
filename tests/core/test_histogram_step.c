/* config.histogram_step: which pixels are counted, with what weight, and that no split, level of splitting or kind of
 * grid changes that.
 */
#include <string.h>

#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

static pupil_t begin(uint32_t step, int centre, uint32_t meter_rows)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    config.histogram = 1;
    config.histogram_step = step;
    config.meter_rows = meter_rows;
    if (centre)
        CHECK(pupil_metering_centre(&config) == PUPIL_OK);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    return pupil;
}

static void meter(const pupil_t *pupil, const frame *f, pupil_stats *stats)
{
    pupil_stats_clear(stats);
    CHECK(pupil_meter_rows(pupil, &f->image, 0, f->image.height, stats) == PUPIL_OK);
}

static uint64_t sum_of(const uint64_t *bin, int count)
{
    uint64_t sum = 0;
    for (int i = 0; i < count; i++)
        sum += bin[i];
    return sum;
}

/* One bright pixel after the other: which are counted, and as how many. */
static void one_pixel_of_each_cell(uint32_t width, uint32_t height, uint32_t step)
{
    const pupil_t pupil = begin(step, 0, 0);
    const int bright = 8 * 32 + 8 * 3; /* the bin of 8 */
    uint64_t weights = 0;
    uint32_t counted = 0, rows = 0, used = 0, columns[16] = {0};
    frame f = frame_make(width, height, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_fill(&f, 0.25, 0.25, 0.25);
    for (uint32_t y = 0; y < height; y++) {
        uint32_t in_row = 0;
        for (uint32_t x = 0; x < width; x++) {
            pupil_stats stats;
            frame_set(&f, x, y, 8.5, 8.5, 8.5, 1);
            meter(&pupil, &f, &stats);
            CHECK(stats.bin[bright] == stats.peak_bin[bright / 2] && (stats.peak > 8) == (stats.bin[bright] > 0));
            CHECK(stats.pixels == width * height && stats.bin[bright] <= 2 * step * step);
            weights += stats.bin[bright];
            in_row += stats.bin[bright] > 0;
            columns[x % (2 * step)] += stats.bin[bright] > 0;
            frame_set(&f, x, y, 0.25, 0.25, 0.25, 1);
        }
        CHECK(in_row == 0 || in_row == (width + 2 * step - 1) / (2 * step));
        rows += in_row > 0;
        counted += in_row;
    }
    CHECK_MSG(weights == width * height, "step %u: %u pixels are counted for %lu", step, counted,
              (unsigned long)weights);
    CHECK(rows >= (height + step - 1) / step && rows < height);
    for (uint32_t i = 0; i < 2 * step; i++)
        used += columns[i] > 0;
    CHECK_MSG(used > step, "step %u: only %u of %u columns are ever counted", step, used, 2 * step);
    frame_free(&f);
}

/* The bins add up to the sum of the weights, and any split has the bits of the whole. */
static void any_split(uint32_t pixel, uint32_t width, uint32_t height)
{
    frame f = frame_make(width, height, pixel, 0, 0);
    frame_lognormal(&f, 0.1, 2, check_uniform);
    for (uint32_t step = 1; step <= 8; step *= 2)
        for (uint32_t meter_rows = 1; meter_rows <= 4; meter_rows *= 4) {
            const pupil_t pupil = begin(step, (int)(check_random() & 1), meter_rows);
            pupil_stats whole, sum, part;
            meter(&pupil, &f, &whole);
            CHECK(sum_of(whole.bin, PUPIL_HISTOGRAM_BINS) == whole.weight);
            CHECK(sum_of(whole.peak_bin, PUPIL_PEAK_BINS) == whole.weight);
            pupil_stats_clear(&sum);
            for (uint32_t y = height; y > 0;) {
                uint32_t rows = 2 * (1 + (uint32_t)(check_uniform() * 3));
                rows = rows < y ? rows : y;
                y -= rows;
                const pupil_image_const group = pupil_image_rows(f.image, y, rows);
                pupil_stats_clear(&part);
                CHECK(pupil_meter_rows(&pupil, &group, y, height, &part) == PUPIL_OK);
                CHECK(pupil_stats_add(&sum, &part) == PUPIL_OK);
            }
            CHECK_MSG(memcmp(&sum, &whole, sizeof sum) == 0, "format %u, step %u", pixel, step);
        }
    frame_free(&f);
}

/* Rows without a counted pixel: valid statistics, no quantiles. */
static void some_rows_alone(void)
{
    frame f = frame_make(64, 512, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_t pupil = begin(8, 0, 0);
    unsigned empty = 0, full = 0;
    frame_fill(&f, 0.25, 0.25, 0.25);
    for (uint32_t y = 0; y < 512; y++) {
        const pupil_image_const row = pupil_image_rows(f.image, y, 1);
        pupil_stats stats;
        double value = 5;
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &row, y, 512, &stats) == PUPIL_OK);
        CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_OK && value == -2);
        const int error = pupil_stats_quantile(&stats, 0.5, &value);
        empty += error == PUPIL_ERR_STATS;
        full += error == PUPIL_OK;
        CHECK(pupil_stats_mean(&stats, 0.1, 0.9, &value) == error);
        const pupil_t before = pupil;
        CHECK(pupil_adapt(&pupil, &stats, NULL) == error);
        CHECK(error == PUPIL_OK || memcmp(&before, &pupil, sizeof pupil) == 0);
    }
    CHECK(full == 64 && empty == 512 - 64);
    frame_free(&f);
}

/* The step by the frame's size, as config.h says. */
static void by_size(uint32_t width, uint32_t height, uint32_t expected)
{
    frame f = frame_make(width, height, PUPIL_PIXEL_GREY8, 0, 0);
    frame_lognormal(&f, 0.1, 2, check_uniform);
    const pupil_t automatic = begin(0, 0, 0), chosen = begin(expected, 0, 0);
    pupil_stats a, b;
    meter(&automatic, &f, &a);
    meter(&chosen, &f, &b);
    CHECK_MSG(memcmp(&a, &b, sizeof a) == 0, "%ux%u", width, height);
    frame_free(&f);
}

/* Bins are gathered only if something reads them, for every kind of frame. */
static void only_where_they_are_read(void)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_RGB8, PUPIL_PIXEL_NV12, PUPIL_PIXEL_BAYER12};
    for (int p = 0; p < 3; p++)
        for (int reason = 0; reason < 6; reason++) {
            frame f = frame_make(32, 32, pixels[p], 0, 0);
            pupil_config config;
            pupil_t pupil;
            pupil_stats stats;
            uint64_t sum = 0;
            frame_lognormal(&f, 0.1, 2, check_uniform);
            pupil_config_default(&config);
            config.white_mode = reason == 1 ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
            config.histogram = reason == 2;
            config.trim_low = reason == 3 ? 0.1f : 0.0f;
            config.trim_high = reason == 4 ? 0.9f : 1.0f;
            config.curve = reason == 5 ? PUPIL_CURVE_EQUALISE : PUPIL_CURVE_REINHARD;
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            meter(&pupil, &f, &stats);
            for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
                sum += stats.bin[i];
            CHECK_MSG(stats.has_histogram == (reason > 0) && sum == (reason ? stats.weight : 0), "format %u, reason %d",
                      pixels[p], reason);
            CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK);
            frame_free(&f);
        }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t step = 2; step <= 8; step *= 2)
        one_pixel_of_each_cell(21, 67 * (1 + step / 4), step);
    any_split(PUPIL_PIXEL_RGBA16F, 333, 92);
    any_split(PUPIL_PIXEL_BAYER12, 300, 90);
    any_split(PUPIL_PIXEL_NV12, 17, 34);
    any_split(PUPIL_PIXEL_YUYV, 1030, 16);
    some_rows_alone();
    by_size(1, 1, 1);
    by_size(640, 312, 1);
    by_size(640, 480, 2);
    by_size(1280, 720, 4);
    by_size(1920, 1080, 4);
    by_size(3840, 2160, 8);
    only_where_they_are_read();
    return check_end();
}
