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
#include "kernels.h"

static const char *const level_name[PUPIL_LEVEL_COUNT] = {"scalar", "NEON", "AVX2", "AVX-512"};
static const char *const pixel_name[PUPIL_PIXEL_COUNT] = {"none",  "rgba32f", "rgb32f", "rgba16f", "rgba16",
                                                          "rgb16", "rgba8",   "rgb8",   "bgrx8"};
static const uint32_t in_pixel[] = {PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGBA16,
                                    PUPIL_PIXEL_RGB16,   PUPIL_PIXEL_RGBA8,  PUPIL_PIXEL_RGB8};
static const uint32_t out_pixel[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGB8, PUPIL_PIXEL_BGRX8};
#define INS  (sizeof in_pixel / sizeof *in_pixel)
#define OUTS (sizeof out_pixel / sizeof *out_pixel)

/* ---- one frame at two levels ---------------------------------------------------------------------------------------
 */

typedef struct outcome {
    pupil_stats metered, fused;
    pupil_curve curve;
    frame mapped, fused_to;
} outcome;

static void work(const frame *in, const pupil_config *usual, const pupil_curve *curve, uint32_t level, uint32_t out,
                 size_t padding, int upside_down, outcome *o)
{
    pupil_config config = *usual;
    pupil_t pupil;
    uint32_t got = 99;
    const uint32_t h = in->image.height;
    config.levels = 1u << level;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_get_level(&pupil, &got) == PUPIL_OK && got == level);
    o->mapped = frame_make(in->image.width, h, out, padding, upside_down);
    o->fused_to = frame_make(in->image.width, h, out, padding, upside_down);
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
        CHECK_MSG(memcmp(got.mapped.memory, expected.mapped.memory, got.mapped.bytes) == 0,
                  "%s: %s of %s %s %ux%u, transfer %u, scale %g", level_name[level], pixel_name[out], what,
                  pixel_name[in->image.pixel], in->image.width, in->image.height, config->transfer, curve->scale);
        CHECK_MSG(memcmp(got.fused_to.memory, expected.fused_to.memory, got.fused_to.bytes) == 0 &&
                      frame_guards_intact(&got.mapped) && frame_guards_intact(&got.fused_to),
                  "%s: fused %s of %s %s %ux%u", level_name[level], pixel_name[out], what, pixel_name[in->image.pixel],
                  in->image.width, in->image.height);
        frame_free(&got.mapped);
        frame_free(&got.fused_to);
    }
    frame_free(&expected.mapped);
    frame_free(&expected.fused_to);
}

/* ---- what to compare on --------------------------------------------------------------------------------------------
 */

static pupil_config any_config(void)
{
    pupil_config c;
    pupil_config_default(&c);
    c.histogram = check_uniform() < 0.5;
    c.white_mode = c.histogram ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
    c.transfer = (uint32_t)(check_uniform() * PUPIL_TRANSFER_COUNT);
    c.primaries = check_uniform() < 0.8 ? PUPIL_PRIMARIES_BT709 : PUPIL_PRIMARIES_BT2020;
    c.floor = (float)exp2(-30.0 * check_uniform());
    c.clip = check_uniform() < 0.5 ? 0.0f : (float)exp2(40.0 * check_uniform() - 20.0);
    if (check_uniform() < 0.1)
        c.clip = check_uniform() < 0.5 ? 0x1p127f : INFINITY;
    if (check_uniform() < 0.3)
        pupil_metering_centre(&c);
    return c;
}

static pupil_curve any_curve(void)
{
    pupil_curve c = {(float)exp2(24.0 * check_uniform() - 12.0), 0.0f, 4.0f};
    if (check_uniform() < 0.1)
        c.scale = check_uniform() < 0.5 ? 0.0f : (float)exp2(120.0 * check_uniform() - 60.0);
    if (check_uniform() < 0.7) {
        c.inverse_white_squared = (float)exp2(20.0 * check_uniform() - 16.0);
        c.gamut = check_uniform() < 0.3 ? 0.0f : (float)(4.0 * check_uniform());
    }
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

static void one(uint32_t width, uint32_t height, size_t in, size_t out, int kind)
{
    const size_t sample = pupil_pixel_bytes(in_pixel[in]) > 8 ? 4 : pupil_pixel_bytes(in_pixel[in]) > 4 ? 2 : 1;
    frame f = frame_make(width, height, in_pixel[in], sample * (size_t)(check_uniform() * 5), check_uniform() < 0.3);
    const char *what = fill(&f, kind);
    const pupil_config config = any_config();
    const pupil_curve curve = any_curve();
    compare(&f, &config, &curve, out_pixel[out], (size_t)(check_uniform() * 7), check_uniform() < 0.3, what);
    frame_free(&f);
}

static void every_width(void)
{
    static const uint32_t more[] = {127, 128, 129, 255, 256, 257, 511, 1023, 1920};
    for (size_t in = 0; in < INS; in++)
        for (size_t out = 0; out < OUTS; out++) {
            for (uint32_t width = 1; width <= 66; width++)
                one(width, 1 + width % 3, in, out, (int)(width % KINDS));
            for (size_t i = 0; i < sizeof more / sizeof *more; i++)
                for (int kind = 0; kind < KINDS; kind++)
                    one(more[i], 2, in, out, kind);
        }
}

/* Every half, as red, green and blue beside other halves. */
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

/* ---- no byte beyond a row is touched -------------------------------------------------------------------------------
 */

/* The last byte of the only row is the last before a page that cannot be read. */
static void at_the_end_of_memory(void)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), bytes = 4 * page;
    unsigned char *in = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    unsigned char *out = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(in != MAP_FAILED && out != MAP_FAILED);
    CHECK(mprotect(in + bytes - page, page, PROT_NONE) == 0 && mprotect(out + bytes - page, page, PROT_NONE) == 0);
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        for (size_t i = 0; i < INS; i++)
            for (uint32_t width = 1; width <= 66; width++) {
                pupil_config config = any_config();
                const pupil_curve curve = any_curve();
                const uint32_t to = out_pixel[width % OUTS];
                const size_t in_row = width * pupil_pixel_bytes(in_pixel[i]), out_row = width * pupil_pixel_bytes(to);
                pupil_image_const from = {in + bytes - page - in_row, (ptrdiff_t)in_row, width, 1, in_pixel[i]};
                pupil_image target = {out + bytes - page - out_row, (ptrdiff_t)out_row, width, 1, to};
                pupil_stats stats;
                pupil_t pupil;
                config.levels = 1u << level;
                pupil_stats_clear(&stats);
                CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
                CHECK(pupil_meter_rows(&pupil, &from, 0, 1, &stats) == PUPIL_OK);
                CHECK(pupil_map_rows(&pupil, &curve, &from, &target) == PUPIL_OK);
            }
    munmap(in, bytes);
    munmap(out, bytes);
}

/* ---- threads -------------------------------------------------------------------------------------------------------
 */

typedef struct part {
    const pupil_t *pupil;
    const pupil_curve *curve;
    pupil_image_const in;
    pupil_image out;
    uint32_t first, rows, height;
    pupil_stats stats;
} part;

static void *work_part(void *argument)
{
    part *p = argument;
    const pupil_image_const rows = pupil_image_rows(p->in, p->first, p->rows);
    pupil_image to = p->out;
    to.data = (unsigned char *)to.data + (ptrdiff_t)p->first * to.stride_bytes;
    to.height = p->rows;
    pupil_stats_clear(&p->stats);
    CHECK(pupil_fused_rows(p->pupil, p->curve, &rows, p->first, p->height, &to, &p->stats) == PUPIL_OK);
    return NULL;
}

static void any_number_of_threads(void)
{
    enum { MOST = 8, HEIGHT = 61 };
    for (size_t i = 0; i < INS; i++) {
        const pupil_config usual = any_config();
        const pupil_curve curve = any_curve();
        frame f = frame_make(333, HEIGHT, in_pixel[i], 0, 0);
        fill(&f, (int)i % 3);
        outcome expected;
        work(&f, &usual, &curve, PUPIL_LEVEL_SCALAR, PUPIL_PIXEL_RGBA8, 0, 0, &expected);
        for (uint32_t threads = 1; threads <= MOST; threads++) {
            static part p[MOST];
            pthread_t thread[MOST];
            pupil_t pupil;
            pupil_stats sum;
            frame out = frame_make(333, HEIGHT, PUPIL_PIXEL_RGBA8, 0, 0);
            CHECK(pupil_init(&pupil, &usual) == PUPIL_OK); /* the best level */
            pupil_stats_clear(&sum);
            for (uint32_t t = 0; t < threads; t++) {
                const uint32_t first = HEIGHT * t / threads, end = HEIGHT * (t + 1) / threads;
                p[t] = (part){&pupil, &curve, f.image, frame_writable(&out), first, end - first, HEIGHT, {0}};
                pthread_create(&thread[t], NULL, work_part, &p[t]);
            }
            for (uint32_t t = 0; t < threads; t++)
                pthread_join(thread[t], NULL);
            for (uint32_t t = threads; t-- > 0;)
                CHECK(pupil_stats_add(&sum, &p[t].stats) == PUPIL_OK);
            CHECK_MSG(memcmp(&sum, &expected.fused, sizeof sum) == 0, "%s on %u threads", pixel_name[in_pixel[i]],
                      threads);
            CHECK(memcmp(out.memory, expected.fused_to.memory, out.bytes) == 0);
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
