/* tests/gles/same.h: a frame on the GPU and on the CPU, and how much they differ. In a header, so that its checks count
 * as the test's own. */
#ifndef PUPIL_TESTS_SAME_H
#define PUPIL_TESTS_SAME_H

#include <math.h>

#include "gl_test.h"
#include "pupil/error.h"
#include "pupil/gles.h"

/* Of all frames compared so far. */
typedef struct same_figures {
    double metering;       /* the log-average, relative; the largest */
    uint64_t samples, off; /* of mapped frames: 8-bit samples, and how many differ */
    int most_codes;        /* by how much at most */
} same_figures;

#define SECOND_NS UINT64_C(1000000000)

static double stats_mean(const pupil_stats *stats)
{
    double log2_luminance = 0.0;
    CHECK(pupil_stats_mean(stats, 0.0, 1.0, &log2_luminance) == PUPIL_OK);
    return log2_luminance;
}

static uint64_t total(const uint64_t *bins, int count)
{
    uint64_t sum = 0;
    for (int i = 0; i < count; i++)
        sum += bins[i];
    return sum;
}

/* A luminance at the floor, or at a bin's edge, may fall on the other side: GPUs round differently. */
static int about(uint64_t a, uint64_t b, uint64_t pixels)
{
    return (a > b ? a - b : b - a) <= 2 + pixels / 1000;
}

static void compare_stats(const pupil_stats *gpu, const pupil_stats *cpu, same_figures *figures, const char *what)
{
    CHECK_MSG(gpu->pixels == cpu->pixels && gpu->weight == cpu->weight && gpu->rows == cpu->rows &&
                  gpu->frame_height == cpu->frame_height && gpu->has_histogram == cpu->has_histogram,
              "%s: pixels %llu and %llu", what, (unsigned long long)gpu->pixels, (unsigned long long)cpu->pixels);
    CHECK_MSG(gpu->bad == cpu->bad, "%s: bad %llu and %llu", what, (unsigned long long)gpu->bad,
              (unsigned long long)cpu->bad);
    CHECK_MSG(gpu->clipped == cpu->clipped, "%s: clipped %llu and %llu", what, (unsigned long long)gpu->clipped,
              (unsigned long long)cpu->clipped);
    CHECK_MSG(about(gpu->black, cpu->black, cpu->pixels), "%s: black %llu and %llu", what,
              (unsigned long long)gpu->black, (unsigned long long)cpu->black);
    for (int i = 0; i < PUPIL_BANDS; i++) {
        CHECK_MSG(gpu->band_pixels[i] == cpu->band_pixels[i], "%s: band %d: %u and %u pixels", what, i,
                  gpu->band_pixels[i], cpu->band_pixels[i]);
        const double off = (double)(gpu->band_log2_sum[i] - cpu->band_log2_sum[i]) * 0x1p-24;
        CHECK_MSG(fabs(off) <= 1.5e-5 * (double)cpu->band_pixels[i], "%s: band %d: %g stops a pixel", what, i,
                  off / (double)cpu->band_pixels[i]);
    }
    CHECK(!gpu->has_histogram || total(gpu->bin, PUPIL_HISTOGRAM_BINS) == gpu->weight);
    CHECK(!gpu->has_histogram || total(gpu->peak_bin, PUPIL_PEAK_BINS) == gpu->weight);
    CHECK_MSG(fabsf(gpu->peak - cpu->peak) <= 1e-6f * cpu->peak, "%s: peak %g and %g", what, (double)gpu->peak,
              (double)cpu->peak);
    if (!cpu->weight)
        return;
    const double off = fabs(exp2(stats_mean(gpu) - stats_mean(cpu)) - 1.0);
    CHECK_MSG(off <= 1e-5, "%s: the log-average is off by %g", what, off);
    figures->metering = off > figures->metering ? off : figures->metering;
}

static void compare_codes(const uint8_t *gpu, const uint8_t *cpu, size_t count, same_figures *figures, const char *what)
{
    int most = 0;
    for (size_t i = 0; i < count; i++) {
        const int off = abs(gpu[i] - cpu[i]);
        figures->off += off != 0;
        most = off > most ? off : most;
    }
    figures->samples += count;
    figures->most_codes = most > figures->most_codes ? most : figures->most_codes;
    CHECK_MSG(most <= 1, "%s: a sample is %d codes off", what, most);
}

static void compare_pictures(gl_test *test, pupil_gles *gles, const pupil_t *pupil, const pupil_image_const *image,
                             same_figures *figures, const char *what)
{
    const size_t bytes = (size_t)image->width * image->height * 4;
    uint8_t *gpu = malloc(bytes), *cpu = malloc(bytes);
    const pupil_image out = {.data = cpu,
                             .stride_bytes = (ptrdiff_t)image->width * 4,
                             .width = image->width,
                             .height = image->height,
                             .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_gles_target target = {.framebuffer = gl_test_framebuffer(test, image->width, image->height),
                                      .width = image->width,
                                      .height = image->height,
                                      .top_first = 1};
    pupil_curve curve = {.scale = 1.0f, .inverse_white_squared = 0.25f, .gamut = 2.0f};
    pupil_get_curve(pupil, NULL, &curve);
    curve.dither = image->width / 4 % 2;
    CHECK(pupil_map_rows(pupil, &curve, image, &out) == PUPIL_OK);
    CHECK(pupil_gles_map(gles, &curve, &target) == PUPIL_OK);
    gl_test_read(test, gpu);
    compare_codes(gpu, cpu, bytes, figures, what);
    free(gpu);
    free(cpu);
}

/* Meters and maps one frame both ways and checks everything that must be equal: numbers of pixels, weights, totals of
 * the histogram, counts of odd pixels; one code at most. same_judge checks the figures. `what` is for messages. Returns
 * 0 if the GPU refuses the object (config.h: no histogram in ES 3.0), and checks that it should. */
static int same_frame(gl_test *test, const pupil_image_const *image, const pupil_config *config, same_figures *figures,
                      const char *what)
{
    static pupil_gles gles;
    static pupil_t pupil;
    pupil_gles_config gles_config;
    pupil_stats gpu, cpu;
    pupil_frame_info info = {.sequence = 7};
    pupil_why why = {""};
    pupil_config every = *config;
    every.histogram_step = 1; /* as the GPU does: gles.h */

    CHECK(pupil_init(&pupil, &every) == PUPIL_OK);
    pupil_gles_config_default(&gles_config);
    gles_config.pixel = image->pixel;
    gles_config.width = image->width;
    gles_config.height = image->height;
    gles_config.coding = image->coding;
    int error = pupil_gles_init(&gles, &gles_config, &pupil, pupil_egl_get_proc, &why);
    if (error == PUPIL_ERR_CONFIG && strstr(why.text, "no histogram"))
        return 0;
    CHECK_MSG(error == PUPIL_OK, "%s: %s", what, why.text);
    if (error)
        return 0;

    CHECK(pupil_gles_upload(&gles, image) == PUPIL_OK);
    CHECK(pupil_gles_meter(&gles, &info) == PUPIL_OK);
    CHECK(pupil_gles_collect(&gles, 60 * SECOND_NS, &gpu, &info) == PUPIL_OK);
    CHECK(info.sequence == 7);
    pupil_stats_clear(&cpu);
    CHECK(pupil_meter_rows(&pupil, image, 0, image->height, &cpu) == PUPIL_OK);
    compare_stats(&gpu, &cpu, figures, what);
    CHECK(pupil_adapt(&pupil, &gpu, NULL) == PUPIL_OK);
    compare_pictures(test, &gles, &pupil, image, figures, what);
    pupil_gles_close(&gles);
    return 1;
}

static inline void same_add(same_figures *sum, const same_figures *figures)
{
    sum->samples += figures->samples;
    sum->off += figures->off;
    sum->metering = figures->metering > sum->metering ? figures->metering : sum->metering;
    sum->most_codes = figures->most_codes > sum->most_codes ? figures->most_codes : sum->most_codes;
}

static void same_print(const same_figures *figures, const char *what)
{
    printf("%-24s metering %.1e relative; %llu of %llu samples off, by %d at most\n", what, figures->metering,
           (unsigned long long)figures->off, (unsigned long long)figures->samples, figures->most_codes);
}

/* Prints the figures, and checks them against the tolerances of docs/gpu.md: metering 1e-5, a sample of 10,000. */
static void same_judge(const same_figures *figures, const char *what)
{
    same_print(figures, what);
    CHECK_MSG(figures->metering <= 1e-5, "%s: %g", what, figures->metering);
    CHECK_MSG((double)figures->off <= 1e-4 * (double)figures->samples, "%s: %llu of %llu", what,
              (unsigned long long)figures->off, (unsigned long long)figures->samples);
}

#endif
