/* The histogram of ES 3.0, which blending counts: with every row counted it equals the CPU's for all weights, widths
 * and formats; with one row in four it is close, and adds up to the same weight. */
#include <math.h>

#include "frames.h"
#include "gl_test.h"
#include "pupil/error.h"
#include "pupil/gles.h"

static uint64_t moved, counted; /* pixels in another bin; all pixels */

/* A luminance at a bin's edge may fall on the other side: half of the sum of differences has moved. */
static void compare_bins(const uint64_t *gpu, const uint64_t *cpu, int count, uint64_t weight, const char *what)
{
    uint64_t off = 0, total = 0;
    for (int i = 0; i < count; i++) {
        off += gpu[i] > cpu[i] ? gpu[i] - cpu[i] : cpu[i] - gpu[i];
        total += gpu[i];
    }
    moved += off / 2;
    counted += weight;
    CHECK_MSG(total == weight, "%s: %llu of %llu", what, (unsigned long long)total, (unsigned long long)weight);
    CHECK_MSG(off <= 2 * (weight / 10000), "%s: %llu of %llu in another bin", what, (unsigned long long)(off / 2),
              (unsigned long long)weight);
}

/* 0: this context has no histogram, and says so. */
static int meter(const frame *f, const pupil_config *config, const pupil_coding *coding, pupil_stats *gpu,
                 pupil_stats *cpu)
{
    static pupil_gles gles;
    static pupil_t pupil;
    pupil_gles_config c;
    pupil_why why = {""};
    pupil_gles_config_default(&c);
    c.version = PUPIL_GLES_ES30;
    c.pixel = f->image.pixel;
    c.width = f->image.width;
    c.height = f->image.height;
    c.coding = coding;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    const int error = pupil_gles_init(&gles, &c, &pupil, pupil_egl_get_proc, &why);
    if (error == PUPIL_ERR_CONFIG && strstr(why.text, "GL_EXT_color_buffer_half_float"))
        return 0;
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    if (error)
        return 0;
    CHECK(pupil_gles_upload(&gles, &f->image) == PUPIL_OK);
    CHECK(pupil_gles_meter(&gles, NULL) == PUPIL_OK);
    CHECK(pupil_gles_collect(&gles, UINT64_C(60000000000), gpu, NULL) == PUPIL_OK);
    pupil_gles_close(&gles);
    pupil_config every = *config;
    every.meter_rows = every.histogram_step = 1;
    CHECK(pupil_retune(&pupil, &every) == PUPIL_OK);
    pupil_image_const in = f->image;
    in.coding = coding;
    pupil_stats_clear(cpu);
    CHECK(pupil_meter_rows(&pupil, &in, 0, in.height, cpu) == PUPIL_OK);
    return 1;
}

static int check_every_row(uint32_t pixel, uint32_t width, uint32_t height, int weights, int kind)
{
    const pupil_coding coding = {.black = pupil_pixel_is_mosaic(pixel) ? 16.0f : 0.0f};
    pupil_stats gpu, cpu;
    pupil_config config;
    char what[99];
    frame f = frame_make(width, height, pixel, 0, 0);
    snprintf(what, sizeof what, "format %u, %ux%u, weights %d, kind %d", pixel, width, height, weights, kind);
    if (kind == 0)
        frame_lognormal(&f, 0.2, 3, check_uniform);
    else if (kind == 1)
        frame_fill(&f, 0.3, 0.3, 0.3); /* a row of one value is the most that a half must count */
    else
        frame_odd(&f, check_uniform);
    pupil_config_default(&config);
    config.meter_rows = 1;
    for (int i = 0; i < 256 && weights; i++)
        config.weight[i / 16][i % 16] = (uint8_t)(weights == 1   ? 200
                                                  : weights == 2 ? i / 16 * 17
                                                                 : (int)(check_random() % 256));
    const int has = meter(&f, &config, &coding, &gpu, &cpu);
    if (has) {
        CHECK_MSG(gpu.weight == cpu.weight && gpu.has_histogram, "%s", what);
        compare_bins(gpu.bin, cpu.bin, PUPIL_HISTOGRAM_BINS, cpu.weight, what);
        compare_bins(gpu.peak_bin, cpu.peak_bin, PUPIL_PEAK_BINS, cpu.weight, what);
        CHECK_MSG(fabsf(gpu.peak - cpu.peak) <= 1e-6f * cpu.peak, "%s: peak %g, %g", what, (double)gpu.peak,
                  (double)cpu.peak);
    }
    frame_free(&f);
    return has;
}

/* One of n rows: how far the quantiles are off, in stops. */
static double check_some_rows(uint32_t meter_rows, uint32_t height, int roi)
{
    pupil_stats gpu, cpu;
    pupil_config config;
    double most = 0.0;
    frame f = frame_make(640, height, PUPIL_PIXEL_RGBA16F, 0, 0);
    frame_lognormal(&f, 0.2, 2, check_uniform);
    pupil_config_default(&config);
    config.meter_rows = meter_rows;
    if (roi)
        CHECK(pupil_metering_roi(&config, 0.5, 0.5, 0.1, 0.001) == PUPIL_OK);
    CHECK(meter(&f, &config, NULL, &gpu, &cpu));
    CHECK(gpu.weight == cpu.weight && gpu.peak >= cpu.peak * 0.999999f && gpu.peak <= cpu.peak * 1.000001f);
    for (double q = 0.01; q < 1.0; q += 0.14) {
        double a = 0.0, b = 0.0;
        CHECK(pupil_stats_quantile(&gpu, q, &a) == PUPIL_OK && pupil_stats_quantile(&cpu, q, &b) == PUPIL_OK);
        most = fmax(most, fabs(a - b));
        CHECK(pupil_stats_peak_quantile(&gpu, q, &a) == PUPIL_OK && pupil_stats_peak_quantile(&cpu, q, &b) == PUPIL_OK);
        most = fmax(most, fabs(a - b));
    }
    frame_free(&f);
    return most;
}

int main(int argc, char **argv)
{
    static gl_test test;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_ES30);
    if (status)
        return status;
    if (!check_every_row(PUPIL_PIXEL_RGBA32F, 64, 48, 0, 0)) {
        printf("this context has no GL_EXT_color_buffer_half_float: skipped\n");
        gl_test_close(&test);
        return CHECK_SKIPPED;
    }
    for (int kind = 0; kind < 3; kind++)
        for (int weights = 0; weights < 4; weights++) {
            check_every_row(PUPIL_PIXEL_RGBA16F, 331, 97, weights, kind);
            check_every_row(PUPIL_PIXEL_NV12, 256, 130, weights, kind);
            check_every_row(PUPIL_PIXEL_BAYER10, 164, 66, weights, kind);
        }
    check_every_row(PUPIL_PIXEL_RGBA16F, 2049, 3, 0, 1); /* more than the largest count of a half */
    check_every_row(PUPIL_PIXEL_RGBA16F, 5000, 2, 1, 1);
    check_every_row(PUPIL_PIXEL_GREY8, PUPIL_MAX_SIDE_PX, 1, 1, 1);
    check_every_row(PUPIL_PIXEL_GREY8, 1, 1, 0, 0);
    check_every_row(PUPIL_PIXEL_GREY8, 2, 300, 3, 0);
    printf("every row: %llu of %llu in another bin\n", (unsigned long long)moved, (unsigned long long)counted);
    const double usual = check_some_rows(0, 360, 0), second = check_some_rows(2, 360, 0);
    printf("quantiles of one row in four: %.4f stops off, of one in two: %.4f\n", usual, second);
    CHECK(usual < 0.1 && second < 0.1);
    (void)check_some_rows(8, 20, 1); /* the region may be in none of the rows */
    gl_test_close(&test);
    return check_end();
}
