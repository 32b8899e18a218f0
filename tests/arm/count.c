/* Processes pixels with every kernel of 64-bit ARM, between marks; count_plugin.c counts the instructions between them.
 *
 *     count_arm kernels   a row of 1920 pixels, everything included that it adds to the statistics; "-rows": 16 rows by
 *                         a public call: level, what is done, input, output, kind of picture, pixels
 *     count_arm plain     one row of 2048 pixels and one of 4096, by a call that needs no option, by the kernels alone,
 *                         and with an option each: what is done, input, by what, pixels
 *
 * One line each; the plugin adds the number of instructions.
 */
#include "core/object.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 1920, ROWS = 16, WIDEST = 4096 };

/* How a sample is stored. */
typedef enum kind { FLOATS, HALVES, WORDS, BYTES } kind;

/* Every input format; check_formats checks that none is missing. A format whose kernels have a fast path for ordinary
 * pixels is also counted with hard pictures. */
static const struct format {
    const char *name;
    uint32_t pixel, samples; /* samples per pixel; the fourth is alpha */
    kind kind;
    uint32_t bits; /* of an integer sample */
    int has_hard;
} formats[] = {
    {"rgba32f", PUPIL_PIXEL_RGBA32F, 4, FLOATS, 0, 1},  {"rgb32f", PUPIL_PIXEL_RGB32F, 3, FLOATS, 0, 1},
    {"rgba16f", PUPIL_PIXEL_RGBA16F, 4, HALVES, 0, 1},  {"rgba16", PUPIL_PIXEL_RGBA16, 4, WORDS, 16, 1},
    {"rgb16", PUPIL_PIXEL_RGB16, 3, WORDS, 16, 1},      {"rgba8", PUPIL_PIXEL_RGBA8, 4, BYTES, 8, 0},
    {"rgb8", PUPIL_PIXEL_RGB8, 3, BYTES, 8, 0},         {"yuyv", PUPIL_PIXEL_YUYV, 2, BYTES, 8, 0},
    {"nv12", PUPIL_PIXEL_NV12, 1, BYTES, 8, 0},         {"grey8", PUPIL_PIXEL_GREY8, 1, BYTES, 8, 0},
    {"grey10", PUPIL_PIXEL_GREY10, 1, WORDS, 10, 0},    {"grey12", PUPIL_PIXEL_GREY12, 1, WORDS, 12, 0},
    {"grey16", PUPIL_PIXEL_GREY16, 1, WORDS, 16, 0},    {"bayer8", PUPIL_PIXEL_BAYER8, 1, BYTES, 8, 0},
    {"bayer10", PUPIL_PIXEL_BAYER10, 1, WORDS, 10, 0},  {"bayer12", PUPIL_PIXEL_BAYER12, 1, WORDS, 12, 0},
    {"bayer14", PUPIL_PIXEL_BAYER14, 1, WORDS, 14, 0},  {"bayer16", PUPIL_PIXEL_BAYER16, 1, WORDS, 16, 0},
    {"bayer10p", PUPIL_PIXEL_BAYER10P, 1, BYTES, 8, 0}, /* any bytes are valid */
    {"bayer12p", PUPIL_PIXEL_BAYER12P, 1, BYTES, 8, 0}, {"i420", PUPIL_PIXEL_I420, 1, BYTES, 8, 0},
    {"nv21", PUPIL_PIXEL_NV21, 1, BYTES, 8, 0},         {"nv16", PUPIL_PIXEL_NV16, 1, BYTES, 8, 0},
    {"uyvy", PUPIL_PIXEL_UYVY, 2, BYTES, 8, 0},         {"bgr8", PUPIL_PIXEL_BGR8, 3, BYTES, 8, 0},
    {"bgrx8", PUPIL_PIXEL_BGRX8, 4, BYTES, 8, 0},       {"rgbx8", PUPIL_PIXEL_RGBX8, 4, BYTES, 8, 0},
    {"grey10p", PUPIL_PIXEL_GREY10P, 1, BYTES, 8, 0},   {"grey12p", PUPIL_PIXEL_GREY12P, 1, BYTES, 8, 0},
    {"bgr32f", PUPIL_PIXEL_BGR32F, 3, FLOATS, 0, 0},    {"rgb16f", PUPIL_PIXEL_RGB16F, 3, HALVES, 0, 0},
    {"p010", PUPIL_PIXEL_P010, 1, WORDS, 16, 0},        {"i420-10", PUPIL_PIXEL_I420_10, 1, WORDS, 10, 0},
    {"rgb10a2", PUPIL_PIXEL_RGB10A2, 4, BYTES, 8, 0},   {"i444-16", PUPIL_PIXEL_I444_16, 1, WORDS, 16, 0},
};
#define FORMATS (sizeof formats / sizeof *formats)

/* Output formats. All inputs are mapped to the first. */
static const struct output {
    const char *name;
    uint32_t pixel;
} outputs[] = {
    {"rgba8", PUPIL_PIXEL_RGBA8}, {"bgrx8", PUPIL_PIXEL_BGRX8}, {"rgb8", PUPIL_PIXEL_RGB8}, {"nv12", PUPIL_PIXEL_NV12}};
#define OUTPUTS (sizeof outputs / sizeof *outputs)

/* Middle grey for an average of 1/8; no pixel of an ordinary picture exceeds white. */
static const pupil_curve curve = {.scale = 0.18f * 8};
static const pupil_tone tone = {.scale = 0.18f * 8};

static _Alignas(16) uint8_t source[ROWS * WIDTH * 16], source_chroma[ROWS * WIDTH * 2];
static _Alignas(16) uint8_t target[ROWS * WIDTH * 4], target_chroma[ROWS / 2 * WIDTH];
static uint32_t state;

static void fail(const char *what, const char *name)
{
    fprintf(stderr, "count_arm: %s: %s\n", name, what);
    exit(1);
}

static uint32_t random_below(uint32_t n) /* Numerical Recipes' generator */
{
    state = state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)state * n >> 32);
}

/* A channel in 1/256 of the clip level. An ordinary picture has most pixels dark, no strong colours, and nothing at the
 * clip level; in a hard one, one pixel in ten has a channel there. */
static uint32_t channel(uint32_t of_pixel, int hard)
{
    static uint32_t base;
    if (of_pixel == 0)
        base = 4 + random_below(250) * random_below(250) / 256;
    return hard && random_below(32) == 0 ? 256 : base * (192 + random_below(64)) / 256;
}

/* The channel v / 256 as a binary16; v is 1 to 256. */
static uint16_t half(uint32_t v)
{
    uint32_t exponent = 15, fraction = v << 2;
    for (; fraction < 1024; fraction *= 2)
        exponent--;
    return (uint16_t)(exponent << 10 | (fraction & 1023));
}

static void fill(const struct format *f, size_t bytes, int hard, uint32_t seed)
{
    static const size_t size_of_kind[] = {[FLOATS] = 4, [HALVES] = 2, [WORDS] = 2, [BYTES] = 1};
    void *const to = source;
    if (bytes > sizeof source)
        fail("its rows are longer than the buffer", f->name);
    state = seed;
    for (size_t i = 0; i < bytes / size_of_kind[f->kind]; i++) {
        const uint32_t of_pixel = (uint32_t)(i % f->samples);
        const uint32_t v = of_pixel == 3 ? 256 : channel(of_pixel, hard), all = (1u << f->bits) - 1;
        if (f->kind == FLOATS)
            ((float *)to)[i] = (float)v * 0x1p-8f;
        else if (f->kind == HALVES)
            ((uint16_t *)to)[i] = half(v);
        else if (f->kind == WORDS)
            ((uint16_t *)to)[i] = (uint16_t)(v * all / 256);
        else
            source[i] = (uint8_t)(v * all / 256);
    }
    const int words = f->kind == WORDS, planar = pupil_pixel_planes(f->pixel) > 1;
    const size_t luma_at = f->pixel == PUPIL_PIXEL_UYVY;
    for (size_t i = 0; (f->pixel == PUPIL_PIXEL_YUYV || luma_at) && i < bytes; i += 2) {
        source[i + luma_at] = (uint8_t)(16 + source[i + luma_at] * 219 / 255);
        source[i + 1 - luma_at] = (uint8_t)(128 + source[i + 1 - luma_at] % 8);
    }
    for (size_t i = 0; planar && !words && i < bytes; i++)
        source[i] = (uint8_t)(16 + source[i] * 219 / 255);
    for (size_t i = 0; planar && !words && i < sizeof source_chroma; i++)
        source_chroma[i] = (uint8_t)(128 + source[i] % 8);
    const int in_upper_bits = f->pixel == PUPIL_PIXEL_P010 || f->pixel == PUPIL_PIXEL_I444_16;
    for (size_t i = 0; planar && words && i < sizeof source_chroma / 2; i++)
        ((uint16_t *)(void *)source_chroma)[i] = (uint16_t)((512 + source[i] % 32) << (in_upper_bits ? 6 : 0));
}

typedef enum option { NO_OPTION, HISTOGRAM, TRIMMED, FOLLOWING_WHITE, MASK, OPTIONS, SAMPLED_WHITE, BY_LUMA } option;

static void make_pupil(pupil_t *pupil, option with)
{
    pupil_config config;
    pupil_config_default(&config);
    config.white_mode = with == FOLLOWING_WHITE || with >= SAMPLED_WHITE ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_FIXED;
    config.histogram = with == HISTOGRAM;
    config.trim_low = with == TRIMMED ? 0.05f : 0.0f;
    config.histogram_step = with == SAMPLED_WHITE ? 4 : 1;
    config.accuracy = with == BY_LUMA ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT;
    config.clip = 1.0f;
    if (with == MASK && pupil_metering_centre(&config))
        fail("refused", "pupil_metering_centre");
    if (pupil_init(pupil, &config))
        fail("pupil_init refuses the configuration", "pupil");
}

static pupil_image_const image_of(const struct format *f, uint32_t width, uint32_t rows)
{
    return (pupil_image_const){.data = source,
                               .stride_bytes = (ptrdiff_t)pupil_row_bytes(f->pixel, width),
                               .width = width,
                               .height = rows,
                               .pixel = f->pixel,
                               .chroma = source_chroma,
                               .chroma_stride_bytes = (ptrdiff_t)(width * 2),
                               .cr = source_chroma,
                               .cr_stride_bytes = (ptrdiff_t)(width * 2)};
}

static pupil_image target_of(const struct output *o, uint32_t width, uint32_t rows)
{
    return (pupil_image){.data = target,
                         .stride_bytes = (ptrdiff_t)pupil_row_bytes(o->pixel, width),
                         .width = width,
                         .height = rows,
                         .pixel = o->pixel,
                         .chroma = target_chroma,
                         .chroma_stride_bytes = (ptrdiff_t)width};
}

/* Between the marks: meters if stats is given, maps if out is. */
static void between_marks(const pupil_t *pupil, const pupil_image_const *in, const pupil_image *out, pupil_stats *stats,
                          const char *name)
{
    int error;
    fflush(stdout);
    (void)getppid();
    if (stats && out)
        error = pupil_fused_rows(pupil, &curve, in, 0, 1080, out, stats);
    else if (out)
        error = pupil_map_rows(pupil, &curve, in, out);
    else
        error = pupil_meter_rows(pupil, in, 0, in->height, stats);
    (void)getppid();
    if (error)
        fail(pupil_error_string(error), name);
}

/* --- kernels --- */

static uint32_t level_counted;
static const char *level_name;

static void print_work(const char *what, const struct format *f, const struct output *output, int hard, int pixels)
{
    printf("%s %s %s %s %s %d ", level_name, what, f->name, output ? output->name : "-", hard ? "hard" : "ordinary",
           pixels);
    fflush(stdout);
}

/* Oklab's cones of BT.709 and back (Ottosson 2020), as pupil_init derives them. */
static const pupil_cones bt709 = {.from_rgb = {0.412221462f, 0.536332548f, 0.0514459908f, 0.211903498f, 0.680699527f,
                                               0.107396953f, 0.0883024633f, 0.281718850f, 0.629978716f},
                                  .to_rgb = {4.07674170f, -3.30771160f, 0.230969921f, -1.26843798f, 2.60975742f,
                                             -0.341319382f, -0.00419608410f, -0.703418612f, 1.70761466f}};

/* One row, or the two rows of a mosaic's quads, including what is added to the statistics. output NULL: not mapped. */
static void count(const char *what, const struct format *f, const struct output *output, int hard, int meters,
                  int histogram, pupil_way way)
{
    static pupil_stats stats;
    const size_t stride = pupil_row_bytes(f->pixel, WIDTH);
    const uint32_t rows = way == PUPIL_WAY_BINNED ? 2 : 1;
    const pupil_row row = {.data = source + stride,
                           .chroma = source_chroma,
                           .cr = source_chroma,
                           .above = source,
                           .below = source + 2 * stride,
                           .width = WIDTH,
                           .bins_rows = 1};
    pupil_coder coder;
    pupil_coder_make(0, f->pixel, &coder);
    const pupil_row_job job = {.kernels = pupil_level_kernels(level_counted),
                               .encoder = &pupil_encoders[PUPIL_TRANSFER_SRGB],
                               .coder = &coder,
                               .curve = output ? &tone : 0,
                               .cones = &bt709,
                               .luma = {0.2126f, 0.7152f, 0.0722f},
                               .floor = 0x1p-14f,
                               .clip = 1.0f,
                               .in_pixel = f->pixel,
                               .out_pixel = output ? output->pixel : (uint32_t)PUPIL_PIXEL_NONE,
                               .way = way,
                               .histogram = (uint32_t)histogram};
    if (way == PUPIL_WAY_BINNED)
        pupil_coder_find_ordinary(&coder, &job);
    pupil_stats_clear(&stats);
    print_work(what, f, output, hard, WIDTH * (int)rows);
    (void)getppid();
    pupil_work_run(&job, &row, 0, WIDTH / rows, output ? target : 0, (uint32_t)meters, 0, &stats);
    (void)getppid();
}

/* The rows of a frame, by the public calls; fused: with the histogram of 1920x1080. */
static void count_rows(const char *what, const struct format *f, const struct output *output, int hard, option with)
{
    static pupil_t pupil;
    static pupil_stats stats;
    const pupil_image_const in = image_of(f, WIDTH, ROWS);
    const pupil_image out = target_of(output ? output : outputs, WIDTH, ROWS);
    make_pupil(&pupil, with);
    pupil_stats_clear(&stats);
    print_work(what, f, output, hard, WIDTH * ROWS);
    between_marks(&pupil, &in, output ? &out : 0, output && with == OPTIONS ? 0 : &stats, f->name);
}

/* NV12 as from a camera: similar neighbours, from dark to bright, with weak colours. */
static void fill_smooth(void)
{
    for (size_t i = 0; i < (size_t)ROWS * WIDTH; i++)
        source[i] = (uint8_t)(32 + i % WIDTH / 10 + random_below(4));
    for (size_t i = 0; i < sizeof source_chroma; i++)
        source_chroma[i] = (uint8_t)(124 + random_below(9));
}

static void count_format(const struct format *f, int hard)
{
    const int is_mosaic = pupil_kernels_scalar.unpack[f->pixel] != 0;
    const pupil_way metered = is_mosaic ? PUPIL_WAY_BINNED : PUPIL_WAY_PIXELS;
    fill(f, pupil_row_bytes(f->pixel, WIDTH) * ROWS, hard, 1);
    count("meter", f, 0, hard, 1, 0, metered);
    count("map", f, outputs, hard, 0, 0, is_mosaic ? PUPIL_WAY_BILINEAR : PUPIL_WAY_PIXELS);
    if (level_counted == PUPIL_LEVEL_SCALAR)
        return; /* the reference; kernels that other levels lack are among these */
    count("meter+histogram", f, 0, hard, 1, 1, metered);
    if (is_mosaic)
        count("halve", f, outputs, hard, 0, 0, PUPIL_WAY_BINNED);
    else
        count("fused", f, outputs, hard, 1, 0, PUPIL_WAY_PIXELS);
    for (const struct output *o = outputs + 1; f == formats && o->pixel != PUPIL_PIXEL_NV12; o++)
        count("map", f, o, hard, 0, 0, PUPIL_WAY_PIXELS);
    count_rows("meter-rows", f, 0, hard, NO_OPTION);
    count_rows("map-rows", f, outputs, hard, OPTIONS);
    if (f == formats || f->pixel == PUPIL_PIXEL_NV12) {
        count_rows("fused-rows", f, outputs, hard, NO_OPTION);
        count_rows("fused+white-rows", f, outputs, hard, SAMPLED_WHITE);
    }
    if (f == formats)
        count_rows("map-rows", f, &outputs[OUTPUTS - 1], hard, OPTIONS);
    if (f->pixel == PUPIL_PIXEL_NV12) {
        count_rows("fused+white-rows", f, &outputs[OUTPUTS - 1], hard, SAMPLED_WHITE);
        fill_smooth();
        count_rows("luma-rows", f, &outputs[OUTPUTS - 1], hard, BY_LUMA);
        count_rows("luma-rows", f, outputs, hard, BY_LUMA);
    }
}

static void count_level(uint32_t level, const char *name)
{
    level_counted = level, level_name = name;
    for (unsigned i = 0; i < FORMATS; i++) {
        count_format(&formats[i], 0);
        if (formats[i].has_hard && level != PUPIL_LEVEL_SCALAR)
            count_format(&formats[i], 1);
    }
}

static void check_formats(void)
{
    for (uint32_t pixel = 1; pixel < PUPIL_PIXEL_COUNT; pixel++) {
        int is_counted = !pupil_kernels_scalar.load[pixel] && !pupil_kernels_scalar.unpack[pixel];
        for (unsigned i = 0; i < FORMATS; i++)
            is_counted |= formats[i].pixel == pixel;
        if (!is_counted) {
            fprintf(stderr,
                    "count_arm: the input format %u (image.h: pupil_pixel) is missing in the table of count.c\n",
                    pixel);
            exit(1);
        }
    }
}

/* --- plain --- */

/* The kernels alone, block by block. */
static void bare(const struct format *f, int maps, uint32_t n)
{
    static pupil_planes planes;
    static pupil_run run;
    const pupil_kernels *k = &pupil_kernels_neon;
    const pupil_row_job job = {.kernels = k,
                               .curve = &tone,
                               .cones = &bt709,
                               .luma = {0.2126f, 0.7152f, 0.0722f},
                               .floor = 0x1p-14f,
                               .clip = 1.0f};
    const size_t bytes = pupil_pixel_bytes(f->pixel);
    for (int i = 0; i < PUPIL_LANES; i++)
        run.product[i] = 1.0f;
    fflush(stdout);
    (void)getppid();
    if (maps)
        for (uint32_t x = 0; x < n; x += PUPIL_BLOCK) {
            (void)k->scale[f->pixel](&job, source + x * bytes, PUPIL_BLOCK, &planes, 0);
            k->store[PUPIL_PIXEL_RGBA8](&planes, PUPIL_BLOCK, &pupil_encoders[PUPIL_TRANSFER_SRGB], target + x * 4);
        }
    else
        k->meter[f->pixel](&job, source, 0, n, &run);
    (void)getppid();
}

/* A row of n pixels whose mean has a fraction below half a stop: above that, pupil_log2, which runs once a row, takes
 * three more instructions, and rows could not be compared. */
static void fill_plain(const struct format *f, uint32_t n)
{
    static pupil_t pupil;
    static pupil_stats stats;
    const pupil_image_const in = image_of(f, n, 1);
    make_pupil(&pupil, NO_OPTION);
    for (uint32_t seed = 1; seed < 100; seed++) {
        fill(f, pupil_row_bytes(f->pixel, n), 0, seed);
        pupil_stats_clear(&stats);
        if (pupil_meter_rows(&pupil, &in, 0, 1, &stats) == PUPIL_OK && stats.log2_frac < UINT64_C(1) << 39)
            return;
    }
    fail("no row was found to compare with", f->name);
}

static void count_plain(const struct format *f, uint32_t n)
{
    static const char *const names[OPTIONS] = {"call", "histogram", "trimming", "following-white", "mask"};
    static pupil_t pupil;
    static pupil_stats stats;
    const pupil_image_const in = image_of(f, n, 1);
    const pupil_image out = target_of(&outputs[0], n, 1);
    fill_plain(f, n);
    for (int maps = 0; maps < 2; maps++) {
        const char *const what = maps ? "map" : "meter";
        printf("%s %s kernels %u ", what, f->name, n);
        bare(f, maps, n);
        for (int with = NO_OPTION; with < (maps ? HISTOGRAM : OPTIONS); with++) {
            make_pupil(&pupil, (option)with);
            pupil_stats_clear(&stats);
            printf("%s %s %s %u ", what, f->name, names[with], n);
            between_marks(&pupil, &in, maps ? &out : 0, maps ? 0 : &stats, f->name);
        }
    }
}

int main(int argc, char **argv)
{
    check_formats();
    if (argc == 2 && strcmp(argv[1], "kernels") == 0) {
        count_level(PUPIL_LEVEL_NEON, "neon");
        count_level(PUPIL_LEVEL_SCALAR, "scalar");
    } else if (argc == 2 && strcmp(argv[1], "plain") == 0) {
        for (unsigned i = 0; i < FORMATS; i++)
            if (pupil_kernels_neon.meter[formats[i].pixel] && pupil_kernels_neon.scale[formats[i].pixel])
                for (uint32_t n = WIDEST / 2; n <= WIDEST; n *= 2)
                    count_plain(&formats[i], n);
    } else {
        fail("kernels or plain", "what to count");
    }
    return 0;
}
