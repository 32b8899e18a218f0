/* Counts, histogram and bands are checked pixel for pixel; quantiles and trimmed means against sorted luminances. */
#include "check.h"
#include "frames.h"
#include "reference.h"

#include <math.h>

static double worst_band, worst_trim, worst_quantile;

static void meter(const pupil_config *config, const pupil_image_const *image, pupil_stats *stats)
{
    pupil_t pupil;
    pupil_stats_clear(stats);
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    CHECK(pupil_meter_rows(&pupil, image, 0, image->height, stats) == PUPIL_OK);
}

static void compare(const char *name, const pupil_config *config, const pupil_image_const *image)
{
    pupil_stats stats;
    ref_meter reference;
    uint64_t total = 0;
    unsigned wrong = 0;
    meter(config, image, &stats);
    ref_meter_frame(config, image, &reference);
    CHECK_MSG(stats.pixels == reference.pixels && stats.weight == reference.weight, "%s: pixels, weight", name);
    CHECK_MSG(stats.black == reference.black, "%s, format %u: black %llu, reference %llu", name, image->pixel,
              (unsigned long long)stats.black, (unsigned long long)reference.black);
    CHECK_MSG(stats.clipped == reference.clipped, "%s, format %u: clipped %llu, reference %llu", name, image->pixel,
              (unsigned long long)stats.clipped, (unsigned long long)reference.clipped);
    CHECK_MSG(stats.bad == reference.bad, "%s, format %u: bad %llu, reference %llu", name, image->pixel,
              (unsigned long long)stats.bad, (unsigned long long)reference.bad);
    CHECK(stats.rows == image->height && stats.frame_height == image->height);
    CHECK(stats.has_histogram == 1 && stats.log2_frac < UINT64_C(1) << 40);
    for (unsigned b = 0; b < PUPIL_HISTOGRAM_BINS; b++) {
        total += stats.bin[b];
        wrong += stats.bin[b] != reference.bin[b];
    }
    for (unsigned b = 0; b < PUPIL_PEAK_BINS; b++)
        wrong += stats.peak_bin[b] != reference.peak_bin[b];
    CHECK_MSG(stats.peak == reference.peak, "%s, format %u: peak %g, reference %g", name, image->pixel, stats.peak,
              reference.peak);
    CHECK_MSG(wrong == 0, "%s, format %u: %u bins differ", name, image->pixel, wrong);
    CHECK(total == stats.weight);
    for (unsigned b = 0; b < PUPIL_BANDS; b++) {
        const long double off = fabsl(stats.band_log2_sum[b] * 0x1p-24L - reference.band_sum[b]);
        /* a row's sum is rounded to 2^-24 once, and the products are off by up to 4e-8 stops a pixel (see the
         * log-average's bound of 5e-8 relative) */
        const long double bound = (image->height / PUPIL_BANDS + 1) * 0x1p-24L + 7.3e-8L * reference.band_pixels[b];
        worst_band = fmax(worst_band, (double)(off / bound));
        CHECK_MSG(off <= bound, "%s: band %u off by %Lg, bound %Lg", name, b, off, bound);
        CHECK(stats.band_pixels[b] == reference.band_pixels[b]);
    }
}

static void check_all_kinds(void)
{
    static const uint32_t size[][2] = {{1, 1}, {3, 5}, {17, 63}, {33, 64}, {20, 130}, {16, 1000}};
    pupil_config config;
    for (unsigned i = 0; i < sizeof size / sizeof *size; i++)
        for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel <= PUPIL_PIXEL_RGB8; pixel++) {
            frame f = frame_make(size[i][0], size[i][1], pixel, 8 * (check_random() & 1), (int)(check_random() & 1));
            pupil_config_default(&config);
            config.histogram = 1;
            frame_odd(&f, check_uniform);
            compare("odd", &config, &f.image);
            frame_bits(&f, check_uniform);
            compare("any bits", &config, &f.image);
            config.floor = 0x1p-30f;
            config.primaries = PUPIL_PRIMARIES_BT2020;
            compare("any bits, low floor", &config, &f.image);
            config.floor = 1;
            config.clip = 0.5f;
            compare("any bits, high floor, low clip", &config, &f.image);
            for (unsigned cell = 0; cell < 256; cell++)
                config.weight[cell / 16][cell % 16] = (uint8_t)(check_random() % 3 ? check_random() : 0);
            config.weight[8][8] = 1;
            compare("any bits, weighted", &config, &f.image);
            frame_fill(&f, 0, 0, 0);
            compare("black", &config, &f.image);
            frame_fill(&f, INFINITY, INFINITY, INFINITY);
            compare("white", &config, &f.image);
            frame_free(&f);
        }
}

/* Which values fall into which count or bin, by example, without the reference. */
static void check_examples(void)
{
    static const struct {
        double rgb[3];
        unsigned black, clipped, bad;
    } example[] = {{{0.18, 0.18, 0.18}, 0, 0, 0},      {{0, 0, 0}, 1, 0, 0},
                   {{-0.0, -0.0, -0.0}, 1, 0, 0},      {{-5, 1, 1}, 1, 0, 0},
                   {{0x1p-140, 0, 0}, 1, 0, 0},        {{0x1p-15, 0x1p-15, 0x1p-15}, 1, 0, 0},
                   {{0x1p30, 0, 0}, 0, 1, 0},          {{0, 0, 0x1.fffffep29}, 0, 0, 0},
                   {{1e38, 1e38, 1e38}, 0, 1, 0},      {{NAN, 1, 1}, 0, 0, 1},
                   {{1, 1, INFINITY}, 0, 0, 1},        {{-INFINITY, 1, 1}, 0, 0, 1},
                   {{INFINITY, -INFINITY, 0}, 0, 0, 1}};
    pupil_config config;
    pupil_config_default(&config);
    for (unsigned i = 0; i < sizeof example / sizeof *example; i++) {
        pupil_stats stats;
        frame f = frame_make(1, 1, PUPIL_PIXEL_RGB32F, 0, 0);
        frame_fill(&f, example[i].rgb[0], example[i].rgb[1], example[i].rgb[2]);
        meter(&config, &f.image, &stats);
        CHECK_MSG(stats.black == example[i].black && stats.clipped == example[i].clipped && stats.bad == example[i].bad,
                  "example %u: black %u, clipped %u, bad %u", i, (unsigned)stats.black, (unsigned)stats.clipped,
                  (unsigned)stats.bad);
        frame_free(&f);
    }
}

static void check_histogram_choice(void)
{
    pupil_config config;
    pupil_stats stats;
    double value = 7;
    frame f = frame_make(8, 8, PUPIL_PIXEL_RGB8, 0, 0);
    frame_fill(&f, 0.2, 0.2, 0.2);
    for (int wanted = 0; wanted < 4; wanted++) {
        pupil_config_default(&config);
        config.white_mode = wanted == 1 ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
        config.trim_high = wanted == 2 ? 0.95f : 1;
        config.histogram = wanted == 3;
        meter(&config, &f.image, &stats);
        CHECK(stats.has_histogram == (wanted != 0));
        if (!wanted) {
            CHECK(pupil_stats_quantile(&stats, 0.5, &value) == PUPIL_ERR_NO_HISTOGRAM && value == 7);
            CHECK(pupil_stats_mean(&stats, 0.1, 1, &value) == PUPIL_ERR_NO_HISTOGRAM && value == 7);
            CHECK(pupil_stats_mean(&stats, 0, 1, &value) == PUPIL_OK);
        }
    }
    frame_free(&f);
}

/* Returns the width in stops of the bin that holds a luminance. */
static double bin_stops(long double log2_luminance)
{
    const double eighth = floor((exp2((double)(log2_luminance - floorl(log2_luminance))) - 1) * 8);
    return log2((9 + eighth) / (8 + eighth));
}

static void compare_order(const char *name, const pupil_config *config, const frame *f, double trim_bound)
{
    static const double trim[][2] = {{0, 1}, {0.05, 0.95}, {0, 0.9}, {0.25, 0.75}, {0.001, 0.999}, {0.1, 1}};
    pupil_stats stats;
    ref_order order;
    double before = -1e9, value = NAN;
    meter(config, &f->image, &stats);
    ref_order_make(config, &f->image, &order);
    for (int i = 0; i <= 100; i++) {
        long double left, right;
        CHECK(pupil_stats_quantile(&stats, i / 100.0, &value) == PUPIL_OK);
        ref_quantile(&order, i / 100.0, &left, &right);
        const double low = (double)left - value, high = value - (double)right;
        const double off = low > high ? low / bin_stops(left) : high / bin_stops(right);
        CHECK_MSG(off <= 1 + 1e-9, "%s: quantile %d is %g, from %Lg to %Lg", name, i, value, left, right);
        CHECK_MSG(value >= before, "%s: quantile %d is below the one before", name, i);
        worst_quantile = fmax(worst_quantile, off);
        before = value;
    }
    for (unsigned i = 0; i < sizeof trim / sizeof *trim; i++) {
        CHECK(pupil_stats_mean(&stats, trim[i][0], trim[i][1], &value) == PUPIL_OK);
        const double off = fabs(value - (double)ref_trimmed(&order, trim[i][0], trim[i][1]));
        CHECK_MSG(off <= trim_bound, "%s: mean trimmed to %g..%g off by %g stops", name, trim[i][0], trim[i][1], off);
        if (trim_bound < 0.01)
            worst_trim = fmax(worst_trim, off);
    }
    ref_order_free(&order);
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Quantiles of the brightest channel: within one of its bins (a quarter of a stop), never above the peak. */
static void compare_peaks(const pupil_config *config, const frame *f)
{
    const uint32_t pixels = f->image.width * f->image.height;
    float *sorted = malloc(pixels * sizeof *sorted);
    pupil_stats stats;
    double before = -1e9, value = NAN, worst = 0;
    if (!sorted)
        abort();
    meter(config, &f->image, &stats);
    for (uint32_t i = 0; i < pixels; i++) {
        long double rgba[4];
        ref_light(&f->image, i % f->image.width, i / f->image.width, 0, rgba);
        const long double most = fmaxl(rgba[0], fmaxl(rgba[1], rgba[2]));
        sorted[i] = (float)fminl(fmaxl(most, config->floor), REF_TOP);
    }
    qsort(sorted, pixels, sizeof *sorted, by_value);
    for (int i = 0; i <= 1000; i++) {
        const uint32_t at = (uint32_t)((double)i / 1000 * pixels);
        CHECK(pupil_stats_peak_quantile(&stats, i / 1000.0, &value) == PUPIL_OK);
        const double low = log2(sorted[at > 0 ? at - 1 : 0]), high = log2(sorted[at < pixels ? at : pixels - 1]);
        worst = fmax(worst, fmax(low - value, value - high));
        CHECK_MSG(value >= before && value <= log2(sorted[pixels - 1]) + 1e-12, "peak quantile %d: %g", i, value);
        before = value;
    }
    CHECK_MSG(worst <= log2(1.25) + 1e-9, "peak quantiles off by %g stops", worst);
    CHECK(value == log2(sorted[pixels - 1]) || fabs(value - log2(sorted[pixels - 1])) < 1e-12);
    free(sorted);
}

static void check_order(void)
{
    pupil_config config;
    frame f = frame_make(640, 360, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_config_default(&config);
    config.histogram = config.histogram_step = 1;
    for (int sigma = 1; sigma <= 3; sigma++) {
        frame_lognormal(&f, 0.18, sigma, check_uniform);
        compare_order("log-normal", &config, &f, 1.5e-3);
        compare_peaks(&config, &f);
        CHECK(pupil_metering_centre(&config) == PUPIL_OK);
        compare_order("log-normal, centre", &config, &f, 1.5e-3);
        CHECK(pupil_metering_uniform(&config) == PUPIL_OK);
    }
    frame_gradient(&f, 1e-4, 10);
    compare_order("gradient", &config, &f, 1.5e-3);
    frame_free(&f);
    /* Hard frames: the histogram only promises the bin. */
    f = frame_make(31, 17, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_odd(&f, check_uniform);
    compare_order("odd", &config, &f, 0.17);
    frame_checker(&f, 1e-9, 1e9);
    compare_order("checkerboard", &config, &f, 0.17);
    frame_fill(&f, 0.3, 0.3, 0.3);
    compare_order("constant", &config, &f, 0.17);
    frame_free(&f);
}

/* As the trim goes to 0 the trimmed mean goes to the untrimmed one. */
static void check_trim_limit(void)
{
    pupil_config config;
    pupil_stats stats;
    double whole, trimmed, off = 0;
    frame f = frame_make(320, 180, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_config_default(&config);
    frame_lognormal(&f, 0.18, 2, check_uniform);
    meter(&config, &f.image, &stats);
    CHECK(pupil_stats_mean(&stats, 0, 1, &whole) == PUPIL_OK);
    for (double trim = 1e-3; trim > 1e-13; trim /= 10) {
        CHECK(pupil_stats_mean(&stats, trim, 1 - trim, &trimmed) == PUPIL_OK);
        off = fabs(trimmed - whole);
        CHECK_MSG(off <= 64 * trim + 1e-10, "trim %g: off by %g", trim, off);
    }
    printf("trimmed mean at a trim of 1e-12: %g stops from the untrimmed one\n", off);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_all_kinds();
    check_examples();
    check_histogram_choice();
    check_order();
    check_trim_limit();
    printf("trimmed mean of natural frames: within %.2g stops (<= 1.5e-3); quantiles: within %.3g bins (<= 1); "
           "bands: %.2g of their bound\n",
           worst_trim, worst_quantile, worst_band);
    return check_end();
}
