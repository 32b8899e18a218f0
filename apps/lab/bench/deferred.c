/* pupil bench deferred: many lamps, shaded in passes over the scene, or from a G-buffer; and ambient occlusion by rays
 * and in screen space. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "clock.h"
#include "common/command_line.h"
#include "common/interrupt.h"
#include "gbuffer.h"
#include "options/commands.h"
#include "refuse.h"
#include "scene.h"
#include "synth/spread.h"

enum { ROUNDS = 3, MOST_LIGHTS = 17, RAYS = 12, SAMPLES = 64 };
#define RADIUS_M 0.5

typedef struct bench {
    const char *name;
    uint32_t width, height;
    unsigned threads;
    pupil_spread spread;
    fixture_scene *scene;
    fixture_scene_facts facts;
    size_t samples, lamps; /* lamps: in this turn */
    float *forward, *deferred;
    fixture_gbuffer g;
    pupil_why why;
} bench;

/* --- what is measured --- */

static void sum_lights(bench *b)
{
    const float *image[MOST_LIGHTS];
    float level[MOST_LIGHTS];
    for (size_t i = 0; i < b->lamps; i++) {
        image[i] = fixture_scene_light_image(b->scene, i);
        level[i] = (float)fixture_scene_level(b->scene, i, 0);
    }
    fixture_sum_lights(b->forward, image, level, b->lamps, b->samples);
}

static void a_pass_each(void *context)
{
    bench *b = context;
    for (size_t i = 0; i < b->lamps; i++)
        fixture_scene_render_lights(b->scene, i, 1);
    sum_lights(b);
}

static void one_pass(void *context)
{
    bench *b = context;
    fixture_scene_render_lights(b->scene, 0, b->lamps);
    sum_lights(b);
}

static void make_layers(void *context)
{
    bench *b = context;
    fixture_gbuffer_free(&b->g);
    (void)fixture_gbuffer_make(&b->g, b->scene, 0, &b->why);
}

static void shade(void *context)
{
    bench *b = context;
    if (b->g.depth)
        (void)fixture_gbuffer_shade(&b->g, b->lamps, b->deferred, &b->why);
}

static void open_by_rays(void *context)
{
    bench *b = context;
    fixture_gbuffer_open_by_rays(&b->g, RADIUS_M, RAYS, b->forward);
}

static void open_by_screen(void *context)
{
    bench *b = context;
    const fixture_ssao ssao = {.radius_m = RADIUS_M, .samples = SAMPLES, .hemisphere = 1, .range = 1};
    fixture_gbuffer_open_by_screen(&b->g, &ssao, b->deferred);
}

static int race(bench *b, bench_runner *runner, size_t runners)
{
    if (bench_race(runner, runners, ROUNDS, NULL, interrupt_came))
        return interrupt_came() ? -1 : pupil_refuse(&b->why, "%s: not enough memory to measure", b->name);
    return 0;
}

static int compare_lamps(bench *b)
{
    static const size_t counts[] = {1, 4, 16};
    printf("%s, %ux%u, %u threads, ms, median of %d\n", b->name, b->facts.width, b->facts.height, b->threads, ROUNDS);
    printf("lamps  a pass each  one pass  layers  shading  layers + shading / a pass each, / one pass\n");
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        b->lamps = counts[i] < b->facts.lights ? counts[i] : b->facts.lights;
        bench_runner runner[] = {{.run = a_pass_each, .context = b},
                                 {.run = one_pass, .context = b},
                                 {.run = make_layers, .context = b},
                                 {.run = shade, .context = b}};
        if (race(b, runner, 4))
            return -1;
        if (*b->why.text)
            return -1;
        if (memcmp(b->forward, b->deferred, b->samples * sizeof(float)) != 0)
            return pupil_refuse(&b->why,
                                "%s: shading from layers has other bits than the frame; are its samples "
                                "antialias 1?",
                                b->name);
        const double deferred_s = runner[2].median_s + runner[3].median_s;
        printf("%5zu %12.1f %9.1f %7.1f %8.1f %10.2f %31.2f\n", b->lamps, runner[0].median_s * 1e3,
               runner[1].median_s * 1e3, runner[2].median_s * 1e3, runner[3].median_s * 1e3,
               deferred_s / runner[0].median_s, deferred_s / runner[1].median_s);
    }
    printf("the three pictures are the same to the bit\n");
    return 0;
}

static int compare_openness(bench *b)
{
    const size_t pixels = b->samples / 3;
    bench_runner runner[] = {{.run = open_by_rays, .context = b}, {.run = open_by_screen, .context = b}};
    double sum = 0.0, square = 0.0;
    if (race(b, runner, 2))
        return -1;
    for (size_t i = 0; i < pixels; i++) {
        const double error = (double)b->deferred[i] - (double)b->forward[i];
        sum += error;
        square += error * error;
    }
    printf(
        "openness within %g m: by %d rays %.1f ms; in screen space, %d points, %.1f ms (%.3f of it): error %+.3f mean, "
        "%.3f rms\n",
        RADIUS_M, RAYS * RAYS, runner[0].median_s * 1e3, SAMPLES, runner[1].median_s * 1e3,
        runner[1].median_s / runner[0].median_s, sum / (double)pixels, sqrt(square / (double)pixels));
    return 0;
}

static int measure(bench *b)
{
    const fixture_scene_options options = {b->width, b->height, 0.0, pupil_spread_run, &b->spread};
    b->spread = (pupil_spread){b->threads, interrupt_came};
    if (fixture_scene_load(&b->scene, b->name, &options, &b->why))
        return -1;
    b->facts = fixture_scene_facts_of(b->scene);
    if (b->facts.moves)
        return pupil_refuse(&b->why, "%s: its camera moves; a camera that does not move is needed", b->name);
    if (!b->facts.lights)
        return pupil_refuse(&b->why, "%s: it has no lamp", b->name);
    b->samples = (size_t)b->facts.width * b->facts.height * 3;
    b->forward = malloc(b->samples * sizeof(float));
    b->deferred = malloc(b->samples * sizeof(float));
    if (!b->forward || !b->deferred)
        return pupil_refuse(&b->why, "%s: not enough memory for a frame", b->name);
    if (fixture_scene_prepare(b->scene, &b->why))
        return -1;
    return compare_lamps(b) || compare_openness(b) ? -1 : 0;
}

/* --- the command line --- */

#define AT(field) offsetof(bench, field)

static const option_row rows[] = {
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .initial = "300x300",
     .help = "of the frames"},
    {"threads", 0, OPTION_COUNT32, "N", AT(threads), .low = 1, .high = 256, .initial = "1", .help = "that render"},
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_deferred_command = {
    .name = "bench deferred",
    .summary = "shading 1, 4 and 16 lamps in passes, or from layers; ambient occlusion",
    .usage = "[SCENE] [options]",
    .about = "What many lamps cost: a pass over the scene for each, one pass for all, or shading from layers\n"
             "that are made once; and ambient occlusion in screen space and by rays.\n"
             "  SCENE  a recipe by name or path, with samples antialias 1 (lamps)",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Measures what shading the first 1, 4 and 16 lamps of SCENE costs. The three ways have the same bits, which "
        "is checked. docs/bench.md explains the figures.",
    .groups = groups,
};

int bench_deferred_main(int argc, char **argv)
{
    bench b = {.name = "lamps", .width = 300, .height = 300, .threads = 1};
    option_words words;
    const int parsed = options_read(&bench_deferred_command, &b, argc, argv, &words);
    if (parsed >= 0)
        return parsed;
    if (words.count > 1) {
        fprintf(stderr, "pupil bench deferred: more than one scene\n");
        return EXIT_USAGE;
    }
    b.name = words.count ? words.word[0] : b.name;
    interrupt_watch();
    int failed = measure(&b), interrupted = failed && interrupt_came();
    if (!failed && (fflush(stdout) || ferror(stdout)))
        failed = pupil_refuse(&b.why, "standard output: %s", strerror(errno));
    fixture_gbuffer_free(&b.g);
    fixture_scene_free(b.scene);
    free(b.forward);
    free(b.deferred);
    if (failed)
        fprintf(stderr, "pupil bench deferred: %s\n", interrupted ? "interrupted" : b.why.text);
    return interrupted ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : EXIT_DONE;
}
