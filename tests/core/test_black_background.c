/* The level of a frame of floats or halves is that of its light: pixels at or below the floor do not count while a 64th
 * of the frame is above it. A rendered background is exactly 0, and no camera's shadow is. In frames of codes black
 * counts as the floor.
 */
#include <math.h>
#include <string.h>

#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#define FLOOR_EV (-14.0)

static pupil_config config;

static double uniform(void)
{
    return check_uniform();
}

static void meter(const frame *f, pupil_stats *stats)
{
    pupil_t pupil;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(stats);
    CHECK(pupil_meter_rows(&pupil, &f->image, 0, f->image.height, stats) == PUPIL_OK);
}

static double level_of_stats(const pupil_stats *stats)
{
    pupil_exposure exposure;
    pupil_t pupil;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_adapt(&pupil, stats, NULL) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &exposure) == PUPIL_OK);
    return exposure.metered_ev;
}

static double level_of(const frame *f)
{
    pupil_stats stats;
    meter(f, &stats);
    return level_of_stats(&stats);
}

/* Greys from 2^-8 to 2^8 in a rectangle, exactly 0 around it. Returns the mean of log2 in the rectangle, weighted as
 * the grid says. */
static double object_on_black(frame *f, uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    long double sum = 0, weights = 0;
    frame_fill(f, 0, 0, 0);
    for (uint32_t v = y; v < y + height; v++)
        for (uint32_t u = x; u < x + width; u++) {
            const int stop = (int)(16 * uniform()) - 8;
            const uint32_t row = (2 * v + 1) * 16 / (2 * f->image.height),
                           column = (2 * u + 1) * 16 / (2 * f->image.width);
            frame_set(f, u, v, ldexp(1, stop), ldexp(1, stop), ldexp(1, stop), 1);
            sum += (long double)config.weight[row][column] * stop;
            weights += config.weight[row][column];
        }
    return (double)(sum / weights);
}

static int is_even(void)
{
    return config.weight[0][0] == config.weight[8][8];
}

static void a_background_of_0(uint32_t pixel)
{
    static const uint32_t size[][2] = {{1, 1}, {17, 5}, {64, 64}, {333, 77}, {1283, 13}};
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        const uint32_t width = size[i][0], height = size[i][1];
        frame f = frame_make(width, height, pixel, 0, i == 2);
        for (uint32_t share = 1; share <= (is_even() ? 8u : 4u); share *= 2) {
            const uint32_t w = (width + share - 1) / share, h = (height + share - 1) / share;
            const double expected = object_on_black(&f, width - w, (height - h) / 2, w, h), level = level_of(&f);
            CHECK_MSG(fabs(level - expected) < 1e-6, "%u x %u, format %u, 1/%u: %.9f, not %.9f", width, height, pixel,
                      share, level, expected); /* the weights of luminance add up to 1 within 1e-7 */
        }
        frame_fill(&f, 0, 0, 0);
        CHECK(level_of(&f) == FLOOR_EV);
        frame_set(&f, width / 2, height / 2, 4, 4, 4, 1); /* one bright pixel: black makes up for a 64th */
        if (is_even()) {
            const double least = ceil(width * height / 64.0), expected = (2 + (least - 1) * FLOOR_EV) / least;
            CHECK_MSG(fabs(level_of(&f) - expected) < 1e-6, "%g, not %g", level_of(&f), expected);
        }
        frame_free(&f);
    }
}

static void codes_count(uint32_t pixel)
{
    double mean = 0;
    pupil_stats stats;
    frame f = frame_make(64, 64, pixel, 0, 0);
    frame_fill(&f, 0, 0, 0);
    for (uint32_t x = 0; x < 64; x++)
        frame_set(&f, x, 7, 1, 1, 1, 1);
    meter(&f, &stats);
    CHECK(stats.black > 0 && stats.code_light > 0 && pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK);
    CHECK_MSG(fabs(level_of_stats(&stats) - mean) < 1e-12 && mean < -12, "format %u: a level of %g", pixel, mean);
    frame_free(&f);
}

/* What is at or below the floor is black. NaN counts as the floor, as ever. */
static void odd_pixels(void)
{
    static const struct {
        double value, level;
    } of[] = {
        {0.0, 0},  {-0.0, 0},       {-5.0, 0},     {0x1p-140, 0}, {0x1p-15, 0}, {0x1p-14, 0}, {0x1.8p-14, -6.7075},
        {NAN, -7}, {-INFINITY, -7}, {INFINITY, 15}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        frame f = frame_make(32, 2, PUPIL_PIXEL_RGB32F, 0, 0);
        frame_fill(&f, 1, 1, 1);
        for (uint32_t x = 0; x < 32; x++)
            frame_set(&f, x, 1, of[i].value, of[i].value, of[i].value, 1);
        const double level = level_of(&f);
        CHECK_MSG(fabs(level - of[i].level) < 1e-4, "%g: a level of %g, not %g", of[i].value, level, of[i].level);
        frame_free(&f);
    }
}

/* The trimmed mean is that of the object alone, apart from the errors of bins. */
static void trimmed(void)
{
    frame whole = frame_make(200, 100, PUPIL_PIXEL_RGB32F, 0, 0),
          object = frame_make(100, 100, PUPIL_PIXEL_RGB32F, 0, 0);
    config.trim_low = 0.1f;
    config.trim_high = 0.8f;
    frame_fill(&whole, 0, 0, 0);
    for (uint32_t y = 0; y < 100; y++)
        for (uint32_t x = 0; x < 100; x++) {
            const double light = exp2(8 * uniform() * uniform());
            frame_set(&whole, x + 50, y, light, light, light, 1);
            frame_set(&object, x, y, light, light, light, 1);
        }
    CHECK_MSG(fabs(level_of(&whole) - level_of(&object)) < 1.5e-3, "%g, not %g", level_of(&whole), level_of(&object));
    pupil_config_default(&config);
    frame_free(&whole);
    frame_free(&object);
}

/* What holds the level, and the white point, are those of the object alone, too: down to an eighth of the frame. */
static void highlights(void)
{
    enum { SIDE = 60 };
    frame object = frame_make(SIDE, SIDE, PUPIL_PIXEL_RGB32F, 0, 0);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const double light = exp2(uniform() < 0.06 ? 5 + uniform() : uniform() - 3);
            frame_set(&object, x, y, light, light, light, 1);
        }
    pupil_exposure alone = {0}, seen;
    for (uint32_t wide = 1; wide <= 16; wide *= 2) {
        pupil_t pupil;
        frame f = frame_make(SIDE * wide, SIDE, PUPIL_PIXEL_RGB32F, 0, 0);
        frame_fill(&f, 0, 0, 0);
        for (uint32_t y = 0; y < SIDE; y++)
            memcpy((void *)(uintptr_t)pupil_image_rows(f.image, y, 1).data, pupil_image_rows(object.image, y, 1).data,
                   SIDE * 3 * sizeof(float));
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_meter(&pupil, &f.image, NULL) == PUPIL_OK &&
              pupil_get_exposure(&pupil, &seen) == PUPIL_OK);
        if (wide == 1)
            alone = seen;
        const int alike =
            fabs(seen.held_back_ev - alone.held_back_ev) < 1e-6 && fabs(seen.white_ev - alone.white_ev) < 1e-6;
        CHECK_MSG(alone.held_back_ev > 0.5 && alike == (wide <= 8), "1/%u: held by %g, not %g; white at %g, not %g",
                  wide, seen.held_back_ev, alone.held_back_ev, seen.white_ev, alone.white_ev);
        frame_free(&f);
    }
    frame_free(&object);
}

/* A caller whose floats are decoded codes says so by code_light: black counts, and noise stays dark. */
static void decoded_codes(void)
{
    double mean = 0;
    pupil_stats stats;
    pupil_exposure exposure;
    pupil_t pupil;
    frame f = frame_make(160, 90, PUPIL_PIXEL_RGBA32F, 0, 0);
    const double light = object_on_black(&f, 20, 10, 60, 50);
    meter(&f, &stats);
    CHECK(!(stats.code_light > 0) && fabs(level_of_stats(&stats) - light) < 1e-6);
    stats.code_light = 0x1p-12f;
    CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK && mean < light - 5);
    CHECK(fabs(level_of_stats(&stats) - mean) < 1e-12);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK &&
          pupil_get_exposure(&pupil, &exposure) == PUPIL_OK);
    CHECK(exposure.reason == PUPIL_REASON_AMPLIFICATION && fabs(exposure.adapted_ev - (log2(0.18) - 4)) < 1e-9);
    frame_free(&f);
}

/* Groups of rows in any order, and statistics of a caller that does not know black_weight: there black counts. */
static void in_parts(void)
{
    frame f = frame_make(123, 60, PUPIL_PIXEL_RGBA32F, 0, 0);
    const double expected = object_on_black(&f, 60, 30, 40, 20);
    pupil_stats whole, sum, part;
    struct {
        pupil_stats stats;
        uint64_t beyond;
    } old, old_sum;
    const uint32_t old_bytes = (uint32_t)offsetof(pupil_stats, black_weight);
    pupil_t pupil;
    double mean = 0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    meter(&f, &whole);
    pupil_stats_clear(&sum);
    for (uint32_t first = 60; first > 0; first -= 20) {
        const pupil_image_const rows = pupil_image_rows(f.image, first - 20, 20);
        pupil_stats_clear(&part);
        CHECK(pupil_meter_rows(&pupil, &rows, first - 20, 60, &part) == PUPIL_OK);
        CHECK(pupil_stats_add(&sum, &part) == PUPIL_OK);
    }
    CHECK(memcmp(&sum, &whole, sizeof sum) == 0 && whole.black_weight == 123 * 60 - 800);
    CHECK(fabs(level_of_stats(&sum) - expected) < 1e-6);

    old.stats.black_weight = old.beyond = 77;
    pupil_stats_clear_sized(&old.stats, old_bytes);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, 60, &old.stats) == PUPIL_OK);
    CHECK(old.stats.black_weight == 77 && old.stats.size_bytes == old_bytes);
    CHECK(pupil_stats_mean(&whole, 0, 1, &mean) == PUPIL_OK && fabs(level_of_stats(&old.stats) - mean) < 1e-12);
    pupil_stats_clear(&sum);
    CHECK(pupil_stats_add(&sum, &old.stats) == PUPIL_OK && sum.black_weight == 0);
    old_sum.stats.black_weight = old_sum.beyond = 77;
    pupil_stats_clear_sized(&old_sum.stats, old_bytes);
    CHECK(pupil_stats_add(&old_sum.stats, &old.stats) == PUPIL_OK && old_sum.stats.weight == old.stats.weight);
    CHECK(old_sum.stats.black_weight == 77 && old_sum.beyond == 77);
    whole.black_weight = whole.weight + 1;
    CHECK(pupil_adapt(&pupil, &whole, NULL) == PUPIL_ERR_STATS);
    frame_free(&f);
}

/* A fade to black: as pixels reach the floor, the level does not jump, and does not rise by more than 0.05. */
static void fade(void)
{
    frame f = frame_make(160, 90, PUPIL_PIXEL_RGB32F, 0, 0), darker = frame_make(160, 90, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_lognormal(&f, 0.2, 3, uniform);
    double before = INFINITY;
    for (int step = 0; step < 30 * 8; step++) {
        for (uint32_t y = 0; y < 90; y++) {
            const float *from = pupil_image_rows(f.image, y, 1).data;
            for (uint32_t x = 0; x < 160; x++)
                frame_set(&darker, x, y, (double)from[3 * x] * exp2(-step / 8.0),
                          (double)from[3 * x + 1] * exp2(-step / 8.0), (double)from[3 * x + 2] * exp2(-step / 8.0), 1);
        }
        const double level = level_of(&darker);
        CHECK_MSG(level >= FLOOR_EV && level < before + 0.05 && (!step || level > before - 0.15),
                  "step %d: from %g to %g", step, before, level);
        before = level;
    }
    CHECK(before == FLOOR_EV);
    frame_free(&f);
    frame_free(&darker);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    pupil_config_default(&config);
    static const uint32_t floats[] = {PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_BGR32F, PUPIL_PIXEL_RGBA16F,
                                      PUPIL_PIXEL_RGB16F};
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        a_background_of_0(floats[i]);
    CHECK(pupil_metering_centre(&config) == PUPIL_OK);
    a_background_of_0(PUPIL_PIXEL_RGB32F);
    pupil_config_default(&config);
    codes_count(PUPIL_PIXEL_RGB8);
    codes_count(PUPIL_PIXEL_RGB16);
    codes_count(PUPIL_PIXEL_GREY8);
    odd_pixels();
    trimmed();
    highlights();
    decoded_codes();
    in_parts();
    fade();
    return check_end();
}
