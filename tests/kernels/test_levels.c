/* Every level that this build and CPU have against the scalar one, byte by byte: statistics and pictures. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "frames.h"
#include "kernels/kernels.h"

static const char *const level_name[PUPIL_LEVEL_COUNT] = {"scalar", "NEON", "AVX2", "AVX-512", "wasm128"};
static const char *const pixel_name[PUPIL_PIXEL_COUNT] = {
    "none",    "rgba32f", "rgb32f",   "rgba16f",  "rgba16", "rgb16",  "rgba8",   "rgb8",    "bgrx8",
    "yuyv",    "nv12",    "grey8",    "grey10",   "grey12", "grey16", "bayer8",  "bayer10", "bayer12",
    "bayer14", "bayer16", "bayer10p", "bayer12p", "i420",   "nv21",   "nv16",    "uyvy",    "bgr8",
    "rgbx8",   "grey10p", "grey12p",  "bgr32f",   "rgb16f", "p010",   "i420-10", "rgb10a2", "i444-16"};
static const uint32_t in_pixel[] = {
    PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F,  PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGBA16,   PUPIL_PIXEL_RGB16,
    PUPIL_PIXEL_RGBA8,   PUPIL_PIXEL_RGB8,    PUPIL_PIXEL_YUYV,    PUPIL_PIXEL_NV12,     PUPIL_PIXEL_GREY8,
    PUPIL_PIXEL_GREY10,  PUPIL_PIXEL_GREY12,  PUPIL_PIXEL_GREY16,  PUPIL_PIXEL_BAYER8,   PUPIL_PIXEL_BAYER10,
    PUPIL_PIXEL_BAYER12, PUPIL_PIXEL_BAYER14, PUPIL_PIXEL_BAYER16, PUPIL_PIXEL_BAYER10P, PUPIL_PIXEL_BAYER12P,
    PUPIL_PIXEL_I420,    PUPIL_PIXEL_NV21,    PUPIL_PIXEL_NV16,    PUPIL_PIXEL_UYVY,     PUPIL_PIXEL_BGR8,
    PUPIL_PIXEL_BGRX8,   PUPIL_PIXEL_RGBX8,   PUPIL_PIXEL_GREY10P, PUPIL_PIXEL_GREY12P,  PUPIL_PIXEL_BGR32F,
    PUPIL_PIXEL_RGB16F,  PUPIL_PIXEL_P010,    PUPIL_PIXEL_I420_10, PUPIL_PIXEL_RGB10A2,  PUPIL_PIXEL_I444_16};
static const uint32_t out_pixel[] = {PUPIL_PIXEL_RGBA8,   PUPIL_PIXEL_RGB8,   PUPIL_PIXEL_BGRX8,   PUPIL_PIXEL_NV12,
                                     PUPIL_PIXEL_BGR8,    PUPIL_PIXEL_I420,   PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F,
                                     PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGB16F, PUPIL_PIXEL_BGR32F};
#define INS  (sizeof in_pixel / sizeof *in_pixel)
#define OUTS (sizeof out_pixel / sizeof *out_pixel)

/* --- one frame at two levels --- */

typedef struct outcome {
    pupil_stats metered, fused;
    pupil_curve curve;
    frame mapped, fused_to;
} outcome;

/* `out`: a pixel format, plus HALVED for a mosaic mapped quad by quad. */
#define HALVED 0x100

static void work(const frame *in, const pupil_config *usual, const pupil_curve *curve, uint32_t level, uint32_t out,
                 size_t padding, int upside_down, outcome *o)
{
    pupil_config config = *usual;
    pupil_t pupil;
    uint32_t got = 99;
    const uint32_t h = in->image.height, smaller = out & HALVED ? 2 : 1, pixel = out & ~HALVED;
    config.levels = 1u << level;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_get_level(&pupil, &got) == PUPIL_OK && got == level);
    o->mapped = frame_make(in->image.width / smaller, h / smaller, pixel, padding, upside_down);
    o->fused_to = frame_make(in->image.width / smaller, h / smaller, pixel, padding, upside_down);
    o->mapped.image.coding = o->fused_to.image.coding = in->image.coding;
    if (pixel != PUPIL_PIXEL_NV12 && pixel != PUPIL_PIXEL_I420)
        o->mapped.image.coding = o->fused_to.image.coding = NULL;
    const pupil_image mapped = frame_writable(&o->mapped), fused = frame_writable(&o->fused_to);
    pupil_stats_clear(&o->metered);
    pupil_stats_clear(&o->fused);
    CHECK(pupil_meter_rows(&pupil, &in->image, 0, h, &o->metered) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &mapped) == PUPIL_OK);
    CHECK(pupil_fused_rows(&pupil, curve, &in->image, 0, h, &fused, &o->fused) == PUPIL_OK);
}

static void compare(const frame *in, const pupil_config *config, const pupil_curve *curve, uint32_t out, size_t padding,
                    int upside_down, const char *what)
{
    outcome expected;
    work(in, config, curve, PUPIL_LEVEL_SCALAR, out, padding, upside_down, &expected);
    for (uint32_t level = 1; level < PUPIL_LEVEL_COUNT; level++) {
        outcome got;
        if (pupil_level_choose(1u << level) != level)
            continue;
        work(in, config, curve, level, out, padding, upside_down, &got);
        CHECK_MSG(memcmp(&got.metered, &expected.metered, sizeof got.metered) == 0 &&
                      memcmp(&got.fused, &expected.fused, sizeof got.fused) == 0,
                  "%s: statistics of %s %s %ux%u", level_name[level], what, pixel_name[in->image.pixel],
                  in->image.width, in->image.height);
        CHECK_MSG(frame_equal(&got.mapped, &expected.mapped), "%s: %s of %s %s %ux%u, transfer %u, scale %g",
                  level_name[level], pixel_name[out & ~HALVED], what, pixel_name[in->image.pixel], in->image.width,
                  in->image.height, config->transfer, curve->scale);
        CHECK_MSG(frame_equal(&got.fused_to, &expected.fused_to) && frame_guards_intact(&got.mapped) &&
                      frame_guards_intact(&got.fused_to),
                  "%s: fused %s of %s %s %ux%u", level_name[level], pixel_name[out & ~HALVED], what,
                  pixel_name[in->image.pixel], in->image.width, in->image.height);
        frame_free(&got.mapped);
        frame_free(&got.fused_to);
    }
    frame_free(&expected.mapped);
    frame_free(&expected.fused_to);
}

/* --- frames to compare on --- */

static pupil_config any_config(void)
{
    pupil_config c;
    pupil_config_default(&c);
    c.histogram = check_uniform() < 0.5;
    c.white_mode = c.histogram ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
    c.transfer = (uint32_t)(check_uniform() * PUPIL_TRANSFER_COUNT);
    c.primaries = check_uniform() < 0.8 ? PUPIL_PRIMARIES_BT709 : PUPIL_PRIMARIES_BT2020;
    c.output_primaries =
        check_uniform() < 0.6 ? PUPIL_OUTPUT_AS_INPUT : (uint32_t)(check_uniform() * PUPIL_OUTPUT_COUNT);
    if (check_uniform() < 0.1) {
        c.primaries = PUPIL_PRIMARIES_MATRIX;
        for (int i = 0; i < 9; i++)
            c.rgb_to_xyz[i] = (float)(i / 3 == 1 ? 0.1 + check_uniform() : 2.0 * check_uniform() - 1.0);
    }
    c.floor = (float)exp2(-30.0 * check_uniform());
    c.clip = check_uniform() < 0.5 ? 0.0f : (float)exp2(40.0 * check_uniform() - 20.0);
    if (check_uniform() < 0.1)
        c.clip = check_uniform() < 0.5 ? 0x1p127f : INFINITY;
    if (check_uniform() < 0.3)
        pupil_metering_centre(&c);
    c.meter_rows = check_uniform() < 0.2 ? 1u << (int)(check_uniform() * 4) : 0;
    c.accuracy = check_uniform() < 0.3 ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT;
    c.histogram_step = check_uniform() < 0.5 ? 1u << (int)(check_uniform() * 4) : 0;
    c.grey_world = check_uniform() < 0.3;
    return c;
}

/* A coding that is valid for the format. */
static pupil_coding any_coding(uint32_t pixel)
{
    pupil_coding c = {0};
    c.matrix = (uint32_t)(check_uniform() * PUPIL_MATRIX_COUNT);
    c.range = (uint32_t)(check_uniform() * PUPIL_RANGE_COUNT);
    c.light = !pupil_pixel_is_mosaic(pixel) ? (uint32_t)(check_uniform() * PUPIL_LIGHT_COUNT) : 0;
    c.bayer = (uint32_t)(check_uniform() * PUPIL_BAYER_COUNT);
    if (pixel == PUPIL_PIXEL_GREY10 || pixel == PUPIL_PIXEL_BAYER10 || pixel == PUPIL_PIXEL_BAYER12)
        c.shift = (uint32_t)(check_uniform() * 5);
    if (check_uniform() < 0.7)
        c.black = (float)(check_uniform() < 0.5 ? (int)(check_uniform() * 64) : check_uniform() * 64);
    if (check_uniform() < 0.5)
        c.white = c.black + 100 + (float)(check_uniform() * 900);
    for (int i = 0; i < 3 && check_uniform() < 0.9; i++)
        c.balance[0] = c.balance[1] = 1, c.balance[2] = c.balance[2] > 0 ? c.balance[2] : 1.5f, c.balance[i] += 0.7f;
    if (check_uniform() < 0.5)
        for (int i = 0; i < 9; i++)
            c.rgb_from_camera[i] = (float)((i % 4 == 0 ? 1.6 : -0.3) * (0.5 + check_uniform()));
    if (pupil_pixel_bits(pixel) && check_uniform() < 0.3) {
        const float white = c.white > 0.0f ? c.white : (float)((1u << pupil_pixel_bits(pixel)) - 1);
        const uint32_t most = (uint32_t)((white - c.black) / 2.0f) - 1;
        c.light = PUPIL_LIGHT_DEFAULT;
        c.knees = 1 + (uint32_t)(check_uniform() * PUPIL_KNEES);
        c.knees = c.knees < most ? c.knees : most;
        for (uint32_t k = 0; k < c.knees; k++) {
            const float before = k ? c.knee_light[k - 1] : 0.0f;
            c.knee_code[k] = c.black + (white - c.black) * (float)(k + 1) / (float)(c.knees + 1);
            c.knee_light[k] = before + (0.99f - before) * (float)(0.01 + 0.5 * check_uniform());
        }
    }
    CHECK(pupil_coding_check(&c, pixel, NULL) == PUPIL_OK);
    return c;
}

static pupil_curve any_curve(void)
{
    pupil_curve c = {.size_bytes = sizeof c, .scale = (float)exp2(24.0 * check_uniform() - 12.0), .gamut = 4.0f};
    if (check_uniform() < 0.1)
        c.scale = check_uniform() < 0.5 ? 0.0f : (float)exp2(120.0 * check_uniform() - 60.0);
    if (check_uniform() < 0.7) {
        c.inverse_white_squared = (float)exp2(20.0 * check_uniform() - 16.0);
        c.gamut = check_uniform() < 0.3 ? 0.0f : (float)(4.0 * check_uniform());
    }
    if (check_uniform() < 0.3) {
        c.knots = PUPIL_CURVE_KNOTS;
        c.levels = check_uniform() < 0.3 ? 2 + (uint32_t)(check_uniform() * 255) : 0;
        c.knot_scale = (float)exp2(check_uniform() < 0.8 ? 24.0 * check_uniform() : 120.0 * check_uniform() - 60.0);
        for (int k = 0; k < PUPIL_CURVE_KNOTS; k++)
            c.knot[k] = check_uniform() < 0.1 ? (float)(k % 2) : (float)check_uniform();
    }
    c.dither = check_uniform() < 0.3;
    c.first_row = (uint32_t)(check_uniform() * 16);
    return c;
}

enum { KINDS = 5 };

static const char *fill(frame *f, int kind)
{
    static const char *const name[KINDS] = {"any bits", "odd values", "a lognormal frame", "a gradient", "one bright"};
    if (kind == 0)
        frame_bits(f, check_uniform);
    else if (kind == 1)
        frame_odd(f, check_uniform);
    else if (kind == 2)
        frame_lognormal(f, exp2(8.0 * check_uniform() - 6.0), 4.0 * check_uniform(), check_uniform);
    else if (kind == 3)
        frame_gradient(f, 1e-6, 1e3);
    else
        frame_one(f, 0.01, 1e4, check_uniform);
    return name[kind];
}

static size_t sample_bytes(uint32_t pixel)
{
    const size_t bytes = pupil_pixel_bytes(pixel);
    const int words = (pixel >= PUPIL_PIXEL_GREY10 && pixel <= PUPIL_PIXEL_GREY16) || pixel == PUPIL_PIXEL_P010 ||
                      pixel == PUPIL_PIXEL_I420_10 || pixel == PUPIL_PIXEL_I444_16 ||
                      (pixel >= PUPIL_PIXEL_BAYER10 && pixel <= PUPIL_PIXEL_BAYER16);
    return bytes > 8 || pixel == PUPIL_PIXEL_RGB10A2 ? 4 : bytes > 4 || words ? 2 : 1;
}

static void one(uint32_t width, uint32_t height, size_t in, size_t out, int kind)
{
    const pupil_coding coding = any_coding(in_pixel[in]);
    frame_fit(in_pixel[in], &width, &height);
    frame f = frame_make(width, height, in_pixel[in], sample_bytes(in_pixel[in]) * (size_t)(check_uniform() * 5),
                         check_uniform() < 0.3);
    const char *what = fill(&f, kind);
    const pupil_config config = any_config();
    const pupil_curve curve = any_curve();
    const int halved = pupil_pixel_is_mosaic(in_pixel[in]) && check_uniform() < 0.5;
    f.image.coding = !frame_is_rgb(in_pixel[in]) ? &coding : NULL;
    compare(&f, &config, &curve, out_pixel[out] | (halved ? HALVED : 0),
            sample_bytes(out_pixel[out]) * (size_t)(check_uniform() * 7), check_uniform() < 0.3, what);
    frame_free(&f);
}

/* Every width to and from every format; for each pair of formats some of the widths. */
static void every_width(void)
{
    const size_t every = (size_t)check_every(4);
    static const uint32_t more[] = {127, 128, 129, 255, 256, 257, 511, 1023, 1920};
    for (size_t in = 0; in < INS; in++)
        for (size_t out = 0; out < OUTS; out++) {
            for (uint32_t width = 1; width <= 66; width++)
                if ((width + in + out) % every == 0)
                    one(width, 1 + width % 3, in, out, (int)(width % KINDS));
            for (size_t i = 0; i < sizeof more / sizeof *more; i++)
                for (size_t kind = 0; kind < KINDS; kind++)
                    if ((i + kind + in + out) % every == 0)
                        one(more[i], 2, in, out, (int)kind);
        }
}

/* Every half, as red, green and blue next to other halves. */
static void every_half(void)
{
    for (uint32_t channel = 0; channel < 4; channel++) {
        frame f = frame_make(256, 256, PUPIL_PIXEL_RGBA16F, 0, 0);
        uint16_t *row = (uint16_t *)(uintptr_t)f.image.data;
        for (uint32_t i = 0; i < 65536; i++)
            for (uint32_t k = 0; k < 4; k++)
                row[4 * i + k] = k == channel ? (uint16_t)i : frame_half(exp2(20.0 * check_uniform() - 12.0));
        for (int n = 0; n < 4; n++) {
            const pupil_config config = any_config();
            const pupil_curve curve = any_curve();
            compare(&f, &config, &curve, out_pixel[n % OUTS], 0, 0, "all halves");
        }
        frame_free(&f);
    }
}

/* --- no byte beyond a row is touched --- */

/* `bytes` of memory just before a page that cannot be read. */
typedef struct last_bytes {
    unsigned char *memory;
    size_t size, page;
} last_bytes;

static last_bytes last_bytes_make(void)
{
    last_bytes l = {.page = (size_t)sysconf(_SC_PAGESIZE)};
    l.size = 4 * l.page;
    l.memory = mmap(NULL, l.size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(l.memory != MAP_FAILED && mprotect(l.memory + l.size - l.page, l.page, PROT_NONE) == 0);
    return l;
}

static unsigned char *last(const last_bytes *l, size_t bytes)
{
    return l->memory + l->size - l->page - bytes;
}

/* The last byte of each plane, in and out, is just before a page that cannot be read. */
static void at_the_end_of_memory(void)
{
    const last_bytes in = last_bytes_make(), in_chroma = last_bytes_make(), in_cr = last_bytes_make(),
                     out = last_bytes_make(), out_chroma = last_bytes_make(), out_cr = last_bytes_make();
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        for (size_t i = 0; i < INS; i++)
            for (uint32_t w = 1; w <= 66; w++) {
                uint32_t width = w, height = 1;
                frame_fit(in_pixel[i], &width, &height);
                pupil_config config = any_config();
                const pupil_coding coding = any_coding(in_pixel[i]);
                const pupil_curve curve = any_curve();
                const uint32_t to = out_pixel[w % OUTS];
                const size_t in_row = pupil_row_bytes(in_pixel[i], width), out_row = pupil_row_bytes(to, width);
                const pupil_image_const from = {.data = last(&in, height * in_row),
                                                .stride_bytes = (ptrdiff_t)in_row,
                                                .width = width,
                                                .height = height,
                                                .pixel = in_pixel[i],
                                                .chroma = last(&in_chroma, pupil_chroma_row_bytes(in_pixel[i], width)),
                                                .cr = last(&in_cr, pupil_chroma_row_bytes(in_pixel[i], width)),
                                                .coding = &coding};
                const pupil_image target = {.data = last(&out, height * out_row),
                                            .stride_bytes = (ptrdiff_t)out_row,
                                            .width = width,
                                            .height = height,
                                            .pixel = to,
                                            .chroma = last(&out_chroma, pupil_chroma_row_bytes(to, width)),
                                            .cr = last(&out_cr, pupil_chroma_row_bytes(to, width))};
                pupil_stats stats;
                pupil_t pupil;
                config.levels = 1u << level;
                pupil_stats_clear(&stats);
                CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
                CHECK(pupil_meter_rows(&pupil, &from, 0, height, &stats) == PUPIL_OK);
                CHECK(pupil_map_rows(&pupil, &curve, &from, &target) == PUPIL_OK);
            }
    munmap(in.memory, in.size);
    munmap(in_chroma.memory, in_chroma.size);
    munmap(in_cr.memory, in_cr.size);
    munmap(out.memory, out.size);
    munmap(out_chroma.memory, out_chroma.size);
    munmap(out_cr.memory, out_cr.size);
}

/* --- threads --- */

typedef struct part {
    const pupil_t *pupil;
    const pupil_curve *curve;
    pupil_image_const in;
    pupil_image out;
    uint32_t first, rows, height;
    int error; /* the checks are counted by one thread */
    pupil_stats stats;
} part;

static void *work_part(void *argument)
{
    part *p = argument;
    const pupil_image_const rows = pupil_image_rows(p->in, p->first, p->rows);
    const pupil_image to = pupil_image_out_rows(p->out, p->first, p->rows);
    pupil_stats_clear(&p->stats);
    p->error = pupil_fused_rows(p->pupil, p->curve, &rows, p->first, p->height, &to, &p->stats);
    return NULL;
}

static void any_number_of_threads(void)
{
    enum { MOST = 8 };
    for (size_t i = 0; i < INS; i++) {
        const pupil_config usual = any_config();
        const pupil_coding coding = any_coding(in_pixel[i]);
        const pupil_curve curve = any_curve();
        const uint32_t to = out_pixel[i % 3 ? 0 : 3];
        const int pairs =
            to == PUPIL_PIXEL_NV12 || pupil_pixel_planes(in_pixel[i]) > 1 || pupil_pixel_is_mosaic(in_pixel[i]);
        uint32_t width = 333, height = 61;
        frame_fit(in_pixel[i], &width, &height);
        frame f = frame_make(width, height, in_pixel[i], 0, 0);
        fill(&f, (int)i % 3);
        f.image.coding = !frame_is_rgb(in_pixel[i]) ? &coding : NULL;
        outcome expected;
        work(&f, &usual, &curve, PUPIL_LEVEL_SCALAR, to, 0, 0, &expected);
        for (uint32_t threads = 1; threads <= MOST; threads++) {
            static part p[MOST];
            pthread_t thread[MOST];
            pupil_t pupil;
            pupil_stats sum;
            frame out = frame_make(width, height, to, 0, 0);
            out.image.coding = expected.mapped.image.coding;
            CHECK(pupil_init(&pupil, &usual) == PUPIL_OK); /* the best level */
            pupil_stats_clear(&sum);
            for (uint32_t t = 0; t < threads; t++) {
                uint32_t first = height * t / threads, end = height * (t + 1) / threads;
                if (pairs) {
                    first -= first % 2;
                    end -= t + 1 < threads ? end % 2 : 0;
                }
                p[t] = (part){&pupil, &curve, f.image, frame_writable(&out), first, end - first, height, 0, {0}};
                pthread_create(&thread[t], NULL, work_part, &p[t]);
            }
            for (uint32_t t = 0; t < threads; t++)
                pthread_join(thread[t], NULL);
            for (uint32_t t = threads; t-- > 0;)
                CHECK(p[t].error == PUPIL_OK && pupil_stats_add(&sum, &p[t].stats) == PUPIL_OK);
            CHECK_MSG(memcmp(&sum, &expected.fused, sizeof sum) == 0, "%s on %u threads", pixel_name[in_pixel[i]],
                      threads);
            CHECK_MSG(frame_equal(&out, &expected.fused_to), "%s on %u threads, mapped", pixel_name[in_pixel[i]],
                      threads);
            frame_free(&out);
        }
        frame_free(&expected.mapped);
        frame_free(&expected.fused_to);
        frame_free(&f);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    printf("levels here:");
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        if (pupil_level_choose(1u << level) == level)
            printf(" %s", level_name[level]);
    putchar('\n');
    every_width();
    every_half();
    at_the_end_of_memory();
    any_number_of_threads();
    return check_end();
}
