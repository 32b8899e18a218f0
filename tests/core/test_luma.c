/* PUPIL_ACCURACY_LUMA: grey has the bits of exact mapping, other colours are near them, every split and CPU level gives
 * the same, and what cannot be mapped by luma is mapped exactly.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

static const uint32_t inputs[] = {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_NV21,
                                  PUPIL_PIXEL_NV16, PUPIL_PIXEL_YUYV, PUPIL_PIXEL_UYVY};
static const uint32_t outputs[] = {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGRX8};
enum { INPUTS = 6, OUTPUTS = 4 };

static pupil_t begin(uint32_t accuracy, uint32_t level)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    config.accuracy = accuracy;
    config.levels = 1u << level;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    return pupil;
}

static pupil_curve curve_of(float scale)
{
    pupil_curve c = {.scale = scale, .inverse_white_squared = 1.0f};
    const float white = scale > 1.0f ? scale : 1.0f;
    c.inverse_white_squared = 1.0f / (white * white);
    c.gamut = white > 1.0f ? 1.0f / (1.0f - PUPIL_GAMUT_KNEE) - 1.0f / (white - PUPIL_GAMUT_KNEE) : 0.0f;
    return c;
}

static frame map(const frame *f, uint32_t accuracy, uint32_t level, const pupil_curve *curve, uint32_t out)
{
    const pupil_t pupil = begin(accuracy, level);
    frame to = frame_make(f->image.width, f->image.height, out, 0, 0);
    const pupil_image target = frame_writable(&to);
    CHECK(pupil_map_rows(&pupil, curve, &f->image, &target) == PUPIL_OK);
    return to;
}

/* Random, or up and down. */
static uint8_t some_luma(uint32_t kind, uint32_t x, uint32_t y)
{
    const uint32_t turn = (x + 7 * y) % 510;
    return (uint8_t)(kind == 2 ? check_random() : turn < 256 ? turn : 510 - turn);
}

/* 0: grey, 1: weak colours, 2: any codes. */
static uint8_t some_chroma(uint32_t kind)
{
    return kind == 0 ? 128 : kind == 1 ? (uint8_t)(112 + check_random() % 33) : (uint8_t)check_random();
}

static void fill_packed(frame *f, uint32_t kind)
{
    uint8_t *data = (uint8_t *)(uintptr_t)f->image.data;
    const uint32_t luma_at = f->image.pixel == PUPIL_PIXEL_UYVY;
    for (uint32_t y = 0; y < f->image.height; y++)
        for (size_t x = 0; x < pupil_row_bytes(f->image.pixel, f->image.width); x++)
            data[(ptrdiff_t)y * f->image.stride_bytes + (ptrdiff_t)x] =
                x % 2 == luma_at ? some_luma(kind, (uint32_t)x / 2, y) : some_chroma(kind);
}

static void fill_planes(frame *f, uint32_t kind)
{
    uint8_t *luma = (uint8_t *)(uintptr_t)f->image.data, *chroma = (uint8_t *)(uintptr_t)f->image.chroma;
    const uint32_t rows = pupil_chroma_rows(f->image.pixel, f->image.height);
    const size_t row = pupil_chroma_row_bytes(f->image.pixel, f->image.width);
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++)
            luma[(ptrdiff_t)y * f->image.stride_bytes + x] = some_luma(kind, x, y);
    for (int plane = 0; plane < (f->image.cr ? 2 : 1); plane++)
        for (uint32_t y = 0; y < rows; y++)
            for (size_t x = 0; x < row; x++) {
                uint8_t *at = plane ? (uint8_t *)(uintptr_t)f->image.cr + (ptrdiff_t)y * f->image.cr_stride_bytes
                                    : chroma + (ptrdiff_t)y * f->image.chroma_stride_bytes;
                at[x] = some_chroma(kind);
            }
}

static void fill(frame *f, uint32_t kind)
{
    if (f->image.pixel == PUPIL_PIXEL_YUYV || f->image.pixel == PUPIL_PIXEL_UYVY)
        fill_packed(f, kind);
    else
        fill_planes(f, kind);
}

/* Maps a frame to a format at every CPU level; grey as by exact mapping. */
static void same_bits_of(const frame *f, uint32_t kind, const pupil_curve *curve, uint32_t out)
{
    frame luma = map(f, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, curve, out);
    frame exact = map(f, PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR, curve, out);
    CHECK_MSG(kind || frame_equal(&exact, &luma), "grey, format %u to %u, %ux%u", f->image.pixel, out, f->image.width,
              f->image.height);
    for (uint32_t level = 1; level < PUPIL_LEVEL_COUNT; level++) {
        frame other = map(f, PUPIL_ACCURACY_LUMA, level, curve, out);
        CHECK_MSG(frame_equal(&luma, &other), "level %u, format %u to %u, %ux%u", level, f->image.pixel, out,
                  f->image.width, f->image.height);
        frame_free(&other);
    }
    frame_free(&exact);
    frame_free(&luma);
}

static void same_bits(void)
{
    static const uint32_t size[][2] = {{1, 1}, {2, 2}, {3, 5}, {64, 4}, {65, 6}, {130, 7}, {333, 18}, {1100, 2}};
    for (int p = 0; p < INPUTS; p++)
        for (unsigned i = 0; i < sizeof size / sizeof *size; i++)
            for (uint32_t kind = 0; kind < 3; kind++) {
                frame f = frame_make(size[i][0], size[i][1], inputs[p], 0, 0);
                const pupil_curve curve = curve_of((float)exp2(6 * check_uniform() - 3));
                fill(&f, kind);
                for (int o = 0; o < OUTPUTS; o++)
                    same_bits_of(&f, kind, &curve, outputs[o]);
                frame rgb = map(&f, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, &curve, PUPIL_PIXEL_RGB8);
                frame rgb_exact = map(&f, PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR, &curve, PUPIL_PIXEL_RGB8);
                CHECK(frame_equal(&rgb, &rgb_exact));
                frame_free(&rgb);
                frame_free(&rgb_exact);
                frame_free(&f);
            }
}

/* Any split into pairs of rows, mapped and metered; an output that is mapped exactly is metered as one by luma. */
static void any_split(uint32_t out_pixel)
{
    const pupil_t pupil = begin(PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR);
    frame f = frame_make(640, 480, PUPIL_PIXEL_NV12, 0, 0), to = frame_make(640, 480, out_pixel, 0, 0);
    frame parts = frame_make(640, 480, out_pixel, 0, 0);
    const pupil_curve curve = curve_of(1.5f);
    const pupil_image out = frame_writable(&to), out_parts = frame_writable(&parts);
    pupil_stats whole, sum, part;
    fill(&f, 1);
    pupil_stats_clear(&whole);
    pupil_stats_clear(&sum);
    CHECK(pupil_fused_rows(&pupil, &curve, &f.image, 0, 480, &out, &whole) == PUPIL_OK);
    CHECK(whole.pixels >= 640 * 480 / 16 && whole.pixels <= 640 * 480 / 14 && whole.has_histogram);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, 480, &sum) == PUPIL_OK && memcmp(&sum, &whole, sizeof sum) == 0);
    CHECK(pupil_map_rows(&pupil, &curve, &f.image, &out_parts) == PUPIL_OK && frame_equal(&to, &parts));
    pupil_stats_clear(&sum);
    for (uint32_t y = 480; y > 0;) {
        uint32_t rows = 2 * (1 + (uint32_t)(check_random() % 20));
        rows = rows < y ? rows : y;
        y -= rows;
        const pupil_image_const in = pupil_image_rows(f.image, y, rows);
        const pupil_image target = pupil_image_out_rows(out_parts, y, rows);
        pupil_stats_clear(&part);
        CHECK(pupil_fused_rows(&pupil, &curve, &in, y, 480, &target, &part) == PUPIL_OK);
        CHECK(pupil_stats_add(&sum, &part) == PUPIL_OK);
    }
    CHECK(memcmp(&sum, &whole, sizeof sum) == 0 && frame_equal(&to, &parts));
    frame_free(&f);
    frame_free(&to);
    frame_free(&parts);
}

/* Widths that are not a whole number of samples, or less than one, with a single column at the end: any split gives the
 * same, and the level is that of all pixels. */
static void odd_sides(uint32_t pixel, uint32_t width, uint32_t height)
{
    const pupil_t pupil = begin(PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR);
    const pupil_t exactly = begin(PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR);
    frame f = frame_make(width, height, pixel, 0, 0);
    static pupil_stats whole, sum, all;
    double mean[2] = {0, 0};
    fill(&f, 1);
    pupil_stats_clear(&whole);
    pupil_stats_clear(&sum);
    pupil_stats_clear(&all);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, height, &whole) == PUPIL_OK);
    CHECK(pupil_meter_rows(&exactly, &f.image, 0, height, &all) == PUPIL_OK);
    for (uint32_t y = 0, rows; y < height; y += rows) {
        rows = 2 * (1 + (uint32_t)(check_random() % 60));
        rows = rows < height - y ? rows : height - y;
        const pupil_image_const in = pupil_image_rows(f.image, y, rows);
        CHECK(pupil_meter_rows(&pupil, &in, y, height, &sum) == PUPIL_OK);
    }
    CHECK(memcmp(&sum, &whole, sizeof sum) == 0 && whole.pixels > 10000 && whole.pixels < all.pixels);
    CHECK(pupil_stats_mean(&whole, 0.0, 1.0, &mean[0]) == PUPIL_OK);
    CHECK(pupil_stats_mean(&all, 0.0, 1.0, &mean[1]) == PUPIL_OK);
    CHECK_MSG(fabs(mean[0] - mean[1]) < 0.05, "format %u, %ux%u: %g and %g EV", pixel, width, height, mean[0], mean[1]);
    frame_free(&f);
}

static size_t bytes_of_rows(const frame *f, int plane)
{
    return plane ? pupil_chroma_row_bytes(f->image.pixel, f->image.width)
                 : pupil_row_bytes(f->image.pixel, f->image.width);
}

/* Errors in output codes, of colours as from cameras and of any colours. */
static void errors(uint32_t kind, uint32_t out, const char *what, double mean_limit, unsigned most_limit)
{
    frame f = frame_make(640, 480, PUPIL_PIXEL_NV12, 0, 0);
    fill(&f, kind);
    for (float scale = 0.5f; scale <= 2.0f; scale *= 2.0f) {
        const pupil_curve curve = curve_of(scale);
        frame exact = map(&f, PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR, &curve, out);
        frame luma = map(&f, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, &curve, out);
        unsigned off[256] = {0}, total = 0, at_99 = 0;
        double sum = 0;
        for (int plane = 0; plane < (int)pupil_pixel_planes(out); plane++)
            for (size_t i = 0; i < bytes_of_rows(&exact, plane) * (plane ? 240u : 480u); i++) {
                const uint8_t *a = plane ? exact.image.chroma : exact.image.data;
                const uint8_t *b = plane ? luma.image.chroma : luma.image.data;
                const int d = a[i] - b[i];
                off[d < 0 ? -d : d]++;
                sum += abs(d);
                total++;
            }
        for (unsigned below = 0; below + off[at_99] < total - total / 100; at_99++)
            below += off[at_99];
        printf("%s at a scale of %g: %.2f codes off on average, 99 %% of them by %u or less\n", what, (double)scale,
               sum / total, at_99);
        CHECK_MSG(sum / total <= mean_limit && at_99 <= most_limit, "%s: %g, %u", what, sum / total, at_99);
        frame_free(&exact);
        frame_free(&luma);
    }
    frame_free(&f);
}

static void level_of_a_sample(uint32_t pixel)
{
    const pupil_t exact = begin(PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR);
    const pupil_t luma = begin(PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR);
    frame f = frame_make(640, 480, pixel, 0, 0);
    pupil_stats a, b;
    double all = 0.0, some = 0.0;
    frame_lognormal(&f, 0.1, 2, check_uniform);
    pupil_stats_clear(&a);
    pupil_stats_clear(&b);
    CHECK(pupil_meter_rows(&exact, &f.image, 0, 480, &a) == PUPIL_OK && pupil_stats_mean(&a, 0, 1, &all) == PUPIL_OK);
    CHECK(pupil_meter_rows(&luma, &f.image, 0, 480, &b) == PUPIL_OK && pupil_stats_mean(&b, 0, 1, &some) == PUPIL_OK);
    CHECK(b.pixels >= a.pixels / 16 && b.pixels <= a.pixels / 14 && b.rows == 480);
    CHECK_MSG(fabs(all - some) < 0.05, "format %u: %g EV", pixel, some - all);
    frame_free(&f);
}

/* One frame at both accuracies, each with its own codings. */
static int differs(uint32_t in_pixel, const pupil_coding *from, const pupil_coding *into, pupil_curve curve,
                   uint32_t primaries, uint32_t transfer)
{
    frame f = frame_make(66, 6, in_pixel, 0, 0);
    frame to[2] = {frame_make(66, 6, PUPIL_PIXEL_NV12, 0, 0), frame_make(66, 6, PUPIL_PIXEL_NV12, 0, 0)};
    frame_lognormal(&f, 0.2, 2, check_uniform);
    f.image.coding = from;
    for (uint32_t accuracy = 0; accuracy < 2; accuracy++) {
        pupil_config config;
        pupil_t pupil;
        pupil_image out = frame_writable(&to[accuracy]);
        out.coding = into;
        pupil_config_default(&config);
        config.accuracy = accuracy ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT;
        config.primaries = primaries;
        config.transfer = transfer;
        config.output_primaries = primaries ? PUPIL_OUTPUT_BT709 : PUPIL_OUTPUT_AS_INPUT;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &out) == PUPIL_OK);
    }
    const int differ = !frame_equal(&to[0], &to[1]);
    frame_free(&f);
    frame_free(&to[0]);
    frame_free(&to[1]);
    return differ;
}

/* What cannot be mapped by luma, or is not configured to be, is exact. What can be has a different picture, so the test
 * would see it. */
static void exact_where_it_must(void)
{
    static const pupil_coding usual = {0}, full = {.range = PUPIL_RANGE_FULL}, linear = {.light = PUPIL_LIGHT_LINEAR},
                              bt2020 = {.matrix = PUPIL_MATRIX_BT2020}, bt709 = {.light = PUPIL_LIGHT_BT709};
    static const uint32_t formats[] = {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_NV21};
    const pupil_curve plain = curve_of(1.5f);
    pupil_curve dithered = plain;
    dithered.dither = 1;
    for (int p = 0; p < 3; p++) {
        CHECK(differs(formats[p], NULL, NULL, plain, 0, 0));
        CHECK(differs(formats[p], &usual, NULL, plain, 0, 0) && differs(formats[p], NULL, &usual, plain, 0, 0));
        CHECK(differs(formats[p], &full, &full, plain, 0, 0) && differs(formats[p], &bt2020, &bt2020, plain, 0, 0));
        CHECK(!differs(formats[p], &full, NULL, plain, 0, 0) && !differs(formats[p], NULL, &full, plain, 0, 0));
        CHECK(!differs(formats[p], &bt2020, NULL, plain, 0, 0) && !differs(formats[p], NULL, &bt2020, plain, 0, 0));
        CHECK(!differs(formats[p], &linear, NULL, plain, 0, 0));
        CHECK(differs(formats[p], &bt709, NULL, plain, 0, 0));
        CHECK(!differs(formats[p], NULL, NULL, plain, 0, PUPIL_TRANSFER_LINEAR));
        CHECK(!differs(formats[p], NULL, NULL, dithered, 0, 0));
        CHECK(!differs(formats[p], NULL, NULL, plain, PUPIL_PRIMARIES_BT2020, 0));
    }
    CHECK(!differs(PUPIL_PIXEL_P010, NULL, NULL, plain, 0, 0));
}

enum { TALL = 16384 }; /* rows of a frame; only the first are metered; a small frame is metered at every pixel */

/* If all pairs of pixels are alike, here bright and dark, so are the sampled ones, and the level is exact. */
static void both_pixels_of_a_pair(uint32_t width)
{
    frame f = frame_make(width, 64, PUPIL_PIXEL_NV12, 0, 0);
    double mean[2];
    fill(&f, 0);
    for (uint32_t y = 0; y < 64; y++)
        for (uint32_t x = 0; x < width; x++)
            ((uint8_t *)(uintptr_t)f.image.data)[(ptrdiff_t)y * f.image.stride_bytes + x] = x % 2 ? 200 : 40;
    for (uint32_t accuracy = 0; accuracy < 2; accuracy++) {
        const pupil_t pupil = begin(accuracy ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR);
        pupil_stats stats;
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, TALL, &stats) == PUPIL_OK &&
              (stats.pixels < 64 * width) == accuracy);
        CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &mean[accuracy]) == PUPIL_OK);
    }
    CHECK_MSG(fabs(mean[1] - mean[0]) < 1e-6, "%u pixels: %g EV", width, mean[1] - mean[0]);
    frame_free(&f);
}

/* Each plane ends at a page that cannot be read: sampling does not read beyond it. */
static void sample_at_the_end_of_memory(uint32_t width)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const pupil_t pupil = begin(PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR);
    uint8_t *end[3];
    pupil_stats stats;
    for (int plane = 0; plane < 3; plane++) {
        uint8_t *memory = mmap(NULL, 3 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        CHECK(memory != MAP_FAILED && mprotect(memory + 2 * page, page, PROT_NONE) == 0);
        end[plane] = memory + 2 * page;
    }
    const pupil_image_const image = {.data = end[0] - (size_t)2 * width,
                                     .stride_bytes = (ptrdiff_t)width,
                                     .width = width,
                                     .height = 2,
                                     .pixel = PUPIL_PIXEL_I420,
                                     .chroma = end[1] - width / 2,
                                     .cr = end[2] - width / 2};
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, &image, 0, TALL, &stats) == PUPIL_OK && stats.rows == 2);
    for (int plane = 0; plane < 3; plane++)
        munmap(end[plane] - 2 * page, 3 * page);
}

/* --- one picture in each format --- */

/* Byte `at` of a row of a plane. */
static uint8_t *byte_of(const frame *f, int plane, uint32_t y, size_t at)
{
    const void *const first[3] = {f->image.data, f->image.chroma, f->image.cr};
    const ptrdiff_t stride[3] = {f->image.stride_bytes, f->image.chroma_stride_bytes, f->image.cr_stride_bytes};
    return (uint8_t *)(uintptr_t)first[plane] + (ptrdiff_t)y * stride[plane] + at;
}

/* Where the Cb, or the Cr, of pixel x, y is. */
static uint8_t *chroma_of(const frame *f, int is_cr, uint32_t x, uint32_t y)
{
    const uint32_t pixel = f->image.pixel, pair = x / 2;
    if (pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY)
        return byte_of(f, 0, y, 4 * (size_t)pair + (is_cr ? 2 : 0) + (pixel == PUPIL_PIXEL_YUYV ? 1 : 0));
    if (pixel == PUPIL_PIXEL_I420)
        return byte_of(f, is_cr ? 2 : 1, y / 2, pair);
    return byte_of(f, 1, pixel == PUPIL_PIXEL_NV16 ? y : y / 2,
                   2 * (size_t)pair + (is_cr != (pixel == PUPIL_PIXEL_NV21) ? 1 : 0));
}

static uint8_t *luma_of(const frame *f, uint32_t x, uint32_t y)
{
    const int packed = f->image.pixel == PUPIL_PIXEL_YUYV || f->image.pixel == PUPIL_PIXEL_UYVY;
    return byte_of(f, 0, y, packed ? 2 * (size_t)x + (f->image.pixel == PUPIL_PIXEL_UYVY ? 1 : 0) : x);
}

static frame as_format(const frame *f, uint32_t pixel)
{
    frame to = frame_make(f->image.width, f->image.height, pixel, 0, 0);
    for (uint32_t y = 0; y < f->image.height; y++)
        for (uint32_t x = 0; x < f->image.width; x++) {
            *luma_of(&to, x, y) = *luma_of(f, x, y);
            *chroma_of(&to, 0, x, y) = *chroma_of(f, 0, x, y);
            *chroma_of(&to, 1, x, y) = *chroma_of(f, 1, x, y);
        }
    return to;
}

static int metered_alike(const frame *a, const frame *b)
{
    const pupil_t pupil = begin(PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR);
    pupil_stats of_a, of_b;
    pupil_stats_clear(&of_a);
    pupil_stats_clear(&of_b);
    CHECK(pupil_meter_rows(&pupil, &a->image, 0, a->image.height, &of_a) == PUPIL_OK);
    CHECK(pupil_meter_rows(&pupil, &b->image, 0, b->image.height, &of_b) == PUPIL_OK);
    return memcmp(&of_a, &of_b, sizeof of_a) == 0;
}

static int mapped_alike(const frame *a, const frame *b, uint32_t out)
{
    const pupil_curve curve = curve_of(1.5f);
    frame of_a = map(a, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, &curve, out);
    frame of_b = map(b, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, &curve, out);
    const int alike = frame_equal(&of_a, &of_b);
    frame_free(&of_a);
    frame_free(&of_b);
    return alike;
}

/* One picture has the same level and display frame in every layout. Formats with chroma in each row also give NV12's
 * result, except to RGB, where a row near the gamut's surface is mapped exactly by itself. */
static void one_picture(uint32_t width, uint32_t height)
{
    frame f = frame_make(width, height, PUPIL_PIXEL_NV12, 0, 0);
    fill(&f, 1);
    frame own = as_format(&f, PUPIL_PIXEL_NV16);
    for (int p = 1; p < INPUTS; p++) {
        frame other = as_format(&f, inputs[p]);
        CHECK_MSG(metered_alike(&f, &other), "format %u", inputs[p]);
        for (int o = 0; o < OUTPUTS; o++)
            CHECK_MSG(mapped_alike(p > 2 && o > 1 ? &own : &f, &other, outputs[o]), "format %u to %u", inputs[p],
                      outputs[o]);
        frame_free(&other);
    }
    frame_free(&own);
    frame_free(&f);
}

/* If both rows have chroma, a frame with half as many chroma rows has their mean. */
static void mean_of_rows(void)
{
    frame f = frame_make(646, 24, PUPIL_PIXEL_NV16, 0, 0), mean = frame_make(646, 24, PUPIL_PIXEL_NV16, 0, 0);
    fill(&f, 1);
    for (uint32_t y = 0; y < 24; y++)
        for (uint32_t x = 0; x < 646; x++) {
            *luma_of(&mean, x, y) = *luma_of(&f, x, y);
            for (int c = 0; c < 2; c++)
                *chroma_of(&mean, c, x, y) =
                    (uint8_t)((*chroma_of(&f, c, x, y / 2 * 2) + *chroma_of(&f, c, x, y / 2 * 2 + 1) + 1) / 2);
        }
    for (int p = 3; p < INPUTS; p++) {
        frame a = as_format(&f, inputs[p]), b = as_format(&mean, inputs[p]);
        CHECK_MSG(mapped_alike(&a, &b, PUPIL_PIXEL_NV12), "format %u", inputs[p]);
        CHECK_MSG(!mapped_alike(&a, &b, PUPIL_PIXEL_RGBA8), "format %u", inputs[p]); /* has chroma in each row */
        frame_free(&a);
        frame_free(&b);
    }
    frame_free(&f);
    frame_free(&mean);
}

/* Whether a picture of one colour, mapped without change, has the codes of exact mapping. */
static int unchanged_is_exact(int luma, int cr)
{
    const pupil_curve none = curve_of(1.0f);
    frame f = frame_make(16, 2, PUPIL_PIXEL_NV12, 0, 0);
    for (uint32_t y = 0; y < 2; y++)
        for (uint32_t x = 0; x < 16; x++) {
            *luma_of(&f, x, y) = (uint8_t)luma;
            *chroma_of(&f, 0, x, y) = 128;
            *chroma_of(&f, 1, x, y) = (uint8_t)cr;
        }
    frame exact = map(&f, PUPIL_ACCURACY_EXACT, PUPIL_LEVEL_SCALAR, &none, PUPIL_PIXEL_NV12);
    frame by_luma = map(&f, PUPIL_ACCURACY_LUMA, PUPIL_LEVEL_SCALAR, &none, PUPIL_PIXEL_NV12);
    const int same = frame_equal(&exact, &by_luma);
    frame_free(&exact);
    frame_free(&by_luma);
    frame_free(&f);
    return same;
}

/* Reds whose green and blue are below 0. In R'G'B' codes grey is 9 and the reds are 50 and 114 above it: up to eight
 * times grey they go by luma, beyond that they are exact. */
static void dark_and_far_from_grey(void)
{
    CHECK(!unchanged_is_exact(24, 156));
    CHECK(unchanged_is_exact(24, 192));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    same_bits();
    any_split(PUPIL_PIXEL_NV12);
    any_split(PUPIL_PIXEL_RGB8);
    one_picture(646, 24);
    one_picture(13, 90); /* narrower than one sample of it, or not a whole number of them */
    one_picture(3, 400);
    one_picture(8198, 2);
    mean_of_rows();
    for (int p = 0; p < INPUTS; p++) {
        odd_sides(inputs[p], 643, 481);
        odd_sides(inputs[p], 5, 16383);
    }
    exact_where_it_must();
    dark_and_far_from_grey();
    errors(1, PUPIL_PIXEL_NV12, "small colours", 1.5, 8);
    errors(1, PUPIL_PIXEL_RGBA8, "small colours, RGBA8", 1.5, 16); /* Cb and Cr are doubled in it */
    errors(2, PUPIL_PIXEL_NV12, "any codes", 1.5, 24); /* one neighbour of a pixel may be black and another white */
    both_pixels_of_a_pair(60);
    both_pixels_of_a_pair(640);
    for (uint32_t width = 2; width <= 200; width += 2)
        sample_at_the_end_of_memory(width);
    level_of_a_sample(PUPIL_PIXEL_NV12);
    level_of_a_sample(PUPIL_PIXEL_YUYV);
    level_of_a_sample(PUPIL_PIXEL_UYVY);
    level_of_a_sample(PUPIL_PIXEL_I420);
    level_of_a_sample(PUPIL_PIXEL_NV16);
    return check_end();
}
