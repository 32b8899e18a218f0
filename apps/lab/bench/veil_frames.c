/* Frames that are metered and mapped with a veil, with bloom and without, in turns. */
#include "veil_frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "clock.h"
#include "common/interrupt.h"
#include "file/still/still.h"
#include "frames.h"
#include "pupil/bloom.h"

typedef struct frames {
    pupil_t pupil;
    pupil_veil veil;
    pupil_veil_light light;
    pupil_veil_scratch scratch;
    pupil_bloom_scratch bloom_scratch;
    pupil_bloom *bloom, *bright; /* of all light, and with a bright pass */
    pupil_stats stats;
    pupil_curve curve;
    pupil_image_const in;
    pupil_image out;
    float *pixels;
    unsigned long long seen;
} frames;

static void read_only(void *context)
{
    frames *f = context;
    f->seen += bench_read(f->pixels, (size_t)f->in.width * f->in.height * 16 / 64 * 64);
}

static void meter(void *context)
{
    frames *f = context;
    pupil_stats_clear(&f->stats);
    pupil_meter_rows(&f->pupil, &f->in, 0, f->in.height, &f->stats);
}

static void meter_and_gather(void *context)
{
    frames *f = context;
    pupil_stats_clear(&f->stats);
    pupil_veil_light_clear(&f->light);
    pupil_veil_gather_rows(&f->veil, &f->pupil, &f->in, 0, &f->stats, &f->light);
}

static void solve(void *context)
{
    frames *f = context;
    pupil_veil_begin(&f->veil);
    pupil_veil_add_light(&f->veil, &f->light);
    pupil_veil_solve(&f->veil);
}

static void map(void *context)
{
    frames *f = context;
    pupil_map_rows(&f->pupil, &f->curve, &f->in, &f->out);
}

static void map_with_veil(void *context)
{
    frames *f = context;
    pupil_veil_map_rows(&f->veil, &f->pupil, &f->curve, &f->in, &f->out, &f->scratch);
}

enum { GROUP = 16 }; /* rows that are metered and gathered while they are in the cache */

static void meter_groups(frames *f, pupil_bloom *bloom)
{
    pupil_stats_clear(&f->stats);
    for (uint32_t y = 0; y < f->in.height; y += GROUP) {
        const uint32_t rows = f->in.height - y < GROUP ? f->in.height - y : GROUP;
        const pupil_image_const part = pupil_image_rows(f->in, y, rows);
        pupil_meter_rows(&f->pupil, &part, y, f->in.height, &f->stats);
        if (bloom)
            pupil_bloom_gather_rows(bloom, &f->pupil, &f->in, y, rows, &f->bloom_scratch);
    }
}

static void meter_in_groups(void *context)
{
    meter_groups(context, NULL);
}

static void meter_and_gather_bloom(void *context)
{
    frames *f = context;
    meter_groups(f, f->bloom);
}

static void meter_and_gather_bright(void *context)
{
    frames *f = context;
    meter_groups(f, f->bright);
}

static void solve_bloom(void *context)
{
    frames *f = context;
    pupil_bloom_solve(f->bloom, &f->pupil);
}

static void solve_bright(void *context)
{
    frames *f = context;
    pupil_bloom_solve(f->bright, &f->pupil);
}

static void map_with_bloom(void *context)
{
    frames *f = context;
    pupil_bloom_map_rows(f->bloom, NULL, &f->pupil, &f->curve, &f->in, &f->out, &f->bloom_scratch);
}

static void map_with_bright(void *context)
{
    frames *f = context;
    pupil_bloom_map_rows(f->bright, NULL, &f->pupil, &f->curve, &f->in, &f->out, &f->bloom_scratch);
}

/* The narrow lobes of the veil's eye. NULL: no memory. */
static pupil_bloom *open_bloom(const frames *f, double threshold)
{
    pupil_bloom_config config;
    pupil_veil_result eye;
    pupil_veil_get(&f->veil, &eye);
    pupil_bloom_config_default(&config);
    config.width = f->in.width;
    config.height = f->in.height;
    config.threshold = threshold;
    config.lobes = eye.lobes;
    memcpy(config.lobe, eye.lobe, sizeof config.lobe);
    const size_t bytes = pupil_bloom_bytes(&config);
    pupil_bloom *bloom = malloc(bytes);
    if (bloom)
        pupil_bloom_init(bloom, bytes, &config);
    return bloom;
}

/* --- what is in them --- */

static double random_share(uint64_t *state) /* Knuth's MMIX generator */
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

/* Independent samples over eight stops. */
static void fill_noise(frames *f)
{
    uint64_t state = 20261122;
    for (size_t i = 0; i < (size_t)f->in.width * f->in.height * 4; i++)
        f->pixels[i] = i % 4 == 3 ? 1.0f : (float)exp2(8 * random_share(&state) - 6);
}

static void fill_with(frames *f, const float *rgb, uint32_t width, uint32_t height)
{
    double log2_sum = 0;
    const size_t count = (size_t)width * height;
    for (size_t i = 0; i < count; i++)
        log2_sum += log2(fmax(0.2126 * rgb[3 * i] + 0.7152 * rgb[3 * i + 1] + 0.0722 * rgb[3 * i + 2], 1e-6));
    const float scale = (float)(0.18 / exp2(log2_sum / (double)count));
    for (uint32_t y = 0; y < f->in.height; y++)
        for (uint32_t x = 0; x < f->in.width; x++) {
            const float *from = rgb + 3 * ((size_t)(y % height) * width + x % width);
            float *to = f->pixels + 4 * ((size_t)y * f->in.width + x);
            for (int c = 0; c < 3; c++)
                to[c] = scale * from[c];
            to[3] = 1.0f;
        }
}

/* 0; -1: no memory; 1: the picture cannot be read. */
static int fill(frames *f, const char *picture)
{
    pupil_still still = {0};
    pupil_why why;
    if (!picture) {
        const pupil_image_const easy = bench_frame(PUPIL_PIXEL_RGBA32F, f->in.width, f->in.height, 0);
        if (!easy.data)
            return -1;
        memcpy(f->pixels, easy.data, (size_t)f->in.width * f->in.height * 16);
        free((void *)(uintptr_t)easy.data);
        return 0;
    }
    const int failed = pupil_still_load(&still, picture, &why);
    if (failed)
        fprintf(stderr, "pupil bench veil: %s\n", why.text);
    else if (still.pixel != PUPIL_PIXEL_RGB32F)
        fprintf(stderr, "pupil bench veil: %s: a picture in floats is needed\n", picture);
    else
        fill_with(f, still.pixels, still.width, still.height);
    const int unusable = failed || still.pixel != PUPIL_PIXEL_RGB32F;
    pupil_still_free(&still);
    return unusable;
}

/* Pixels above a threshold in a part of the frame; positions outside the frame do not count. */
static size_t lit_pixels(const frames *f, double above, int64_t x, int64_t y, int64_t side)
{
    const int64_t width = f->in.width, height = f->in.height;
    size_t lit = 0;
    for (int64_t j = y < 0 ? 0 : y; j < y + side && j < height; j++)
        for (int64_t i = x < 0 ? 0 : x; i < x + side && i < width; i++) {
            const float *v = f->pixels + 4 * (j * width + i);
            lit += (double)fmaxf(fmaxf(v[0], v[1]), v[2]) > above;
        }
    return lit;
}

static double lit_percent(const frames *f, double above)
{
    const int64_t side = f->in.width > f->in.height ? f->in.width : f->in.height;
    return 100.0 * (double)lit_pixels(f, above, 0, 0, side) / ((double)f->in.width * f->in.height);
}

/* The share of blocks that the full-size kernel, with a reach of 3 pixels, scatters to. */
static double reached_percent(const frames *f, double above)
{
    enum { BLOCK = 32, REACH = 3 };
    size_t blocks = 0, reached = 0;
    for (int64_t y = 0; y < f->in.height; y += BLOCK)
        for (int64_t x = 0; x < f->in.width; x += BLOCK, blocks++)
            reached += lit_pixels(f, above, x - REACH, y - REACH, BLOCK + 2 * REACH) > 0;
    return 100.0 * (double)reached / (double)blocks;
}

static int open_frames(const veil_frames_options *o, frames *f)
{
    pupil_config config;
    pupil_veil_config eye;
    const pupil_image in = bench_room(PUPIL_PIXEL_RGBA32F, o->width, o->height);
    f->out = bench_room(PUPIL_PIXEL_RGBA8, o->width, o->height);
    f->pixels = in.data;
    if (!f->pixels || !f->out.data)
        return -1;
    f->in = pupil_image_as_const(in);
    f->curve = (pupil_curve){.scale = 0.5f, .inverse_white_squared = 0.0625f};
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    pupil_init(&f->pupil, &config);
    pupil_veil_config_default(&eye);
    eye.width = o->width;
    eye.height = o->height;
    if (pupil_veil_init(&f->veil, &eye))
        return -1;
    f->bloom = open_bloom(f, 0.0);
    f->bright = open_bloom(f, o->above);
    return f->bloom && f->bright ? 0 : -1;
}

static void close_frames(frames *f)
{
    free(f->bloom);
    free(f->bright);
    free(f->pixels);
    free(f->out.data);
    free(f);
}

/* --- in turns --- */

enum { READ, METER, VEIL_METER, VEIL_SOLVE, MAP, VEIL_MAP, GROUPS, ALL, BRIGHT = ALL + 3, RUNNERS = BRIGHT + 3 };

static double print_bloom(const char *what, const double *ns, const double *bloom)
{
    const double more = bloom[0] - ns[GROUPS] + bloom[1] + bloom[2] - ns[MAP];
    printf("  %-30s metering %6.3f more, octaves %6.3f, mapping %6.3f more; in all %6.3f\n", what,
           bloom[0] - ns[GROUPS], bloom[1], bloom[2] - ns[MAP], more);
    return more;
}

static void print_frames(const veil_frames_options *o, const frames *f, const char *what,
                         const bench_runner runner[RUNNERS])
{
    double ns[RUNNERS];
    char words[40];
    for (int i = 0; i < RUNNERS; i++)
        ns[i] = runner[i].least_s * 1e9 / ((double)o->width * o->height);
    const double veil = ns[VEIL_METER] - ns[METER] + ns[VEIL_MAP] - ns[MAP] + ns[VEIL_SOLVE];
    printf("\nA frame of %u x %u, %s, RGBA32F to RGBA8, Spencer's eye, one thread, ns a pixel:\n"
           "  a plain read %.3f; metering %.3f, by %d rows at a time %.3f; mapping %.3f\n"
           "  %-30s metering %6.3f more, nodes %8.3f, mapping %6.3f more; in all %6.3f\n",
           o->width, o->height, what, ns[READ], ns[METER], GROUP, ns[GROUPS], ns[MAP], "a veil",
           ns[VEIL_METER] - ns[METER], ns[VEIL_SOLVE], ns[VEIL_MAP] - ns[MAP], veil);
    print_bloom("bloom of all light", ns, ns + ALL);
    snprintf(words, sizeof words, "of what is above %g", o->above);
    print_bloom(words, ns, ns + BRIGHT);
    printf("    which is %.2f %% of the pixels, in or next to %.1f %% of the blocks of 32 x 32\n",
           lit_percent(f, o->above), reached_percent(f, o->above));
    fflush(stdout);
}

static int race(const veil_frames_options *o, frames *f, const char *what, progress *shown)
{
    void (*const run[RUNNERS])(void *) = {read_only,
                                          meter,
                                          meter_and_gather,
                                          solve,
                                          map,
                                          map_with_veil,
                                          meter_in_groups,
                                          meter_and_gather_bloom,
                                          solve_bloom,
                                          map_with_bloom,
                                          meter_and_gather_bright,
                                          solve_bright,
                                          map_with_bright};
    bench_runner runner[RUNNERS];
    for (int i = 0; i < RUNNERS; i++)
        runner[i] = (bench_runner){.run = run[i], .context = f};
    const int stopped = bench_race(runner, RUNNERS, (unsigned)o->rounds, NULL, interrupt_came);
    progress_clear(shown);
    if (!stopped)
        print_frames(o, f, what, runner);
    return stopped;
}

int veil_frames_run(const veil_frames_options *options, progress *shown)
{
    frames *f = calloc(1, sizeof *f);
    if (!f)
        return -1;
    int failed = open_frames(options, f);
    if (!failed)
        failed = fill(f, options->picture);
    if (!failed)
        failed = race(options, f, options->picture ? options->picture : "with grain", shown);
    if (!failed) {
        fill_noise(f);
        failed = race(options, f, "noise", shown);
    }
    close_frames(f);
    return failed;
}
