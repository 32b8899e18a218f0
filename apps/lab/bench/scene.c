/* pupil bench scene: what a scene costs: each light's picture once, then a sum for each frame. Each scene has its own
 * process, so that the peak memory is its own. */
#include "scene_cost.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench.h"
#include "clock.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "options/commands.h"
#include "refuse.h"
#include "scene.h"
#include "synth/spread.h"

enum { MOST_SCENES = 16, WARM_ROUNDS = 101, COLD_ROUNDS = 21 };

typedef struct bench {
    const char *scene[MOST_SCENES];
    size_t scenes;
    uint64_t frames;
    uint32_t width, height;
    unsigned threads;
    int json, quiet;
    progress progress;
} bench;

/* --- what is measured --- */

typedef struct measuring {
    bench *b;
    bench_scene *out;
    fixture_scene *scene;
    pupil_spread spread;
    size_t samples;
    float *rgb, *copy;
    const float *image[BENCH_MOST_LIGHTS];
    float level[BENCH_MOST_LIGHTS];
    size_t lit;
    unsigned long long seen;
} measuring;

static void show(measuring *m, const char *doing, uint64_t done, uint64_t total)
{
    progress *p = &m->b->progress;
    if (!progress_due(p, done ? 0.1 : 0.0))
        return;
    progress_add(p, "%s: %s", m->out->name, doing);
    if (total)
        progress_add(p, " %llu of %llu", (unsigned long long)done, (unsigned long long)total);
    progress_show(p);
}

static uint64_t resident_peak(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (uint64_t)u.ru_maxrss * 1024u;
}

static int refuse(measuring *m, const char *words)
{
    return pupil_refuse(&m->out->why, "%s: %s", m->out->name, words);
}

static int load(measuring *m)
{
    bench_scene *o = m->out;
    fixture_scene_options options = {m->b->width, m->b->height, 0.0, pupil_spread_run, &m->spread};
    double began_s = progress_now_s();
    show(m, "loading", 0, 0);
    if (fixture_scene_load(&m->scene, o->name, &options, &o->why))
        return -1;
    o->load_s = progress_now_s() - began_s;
    fixture_scene_facts f = fixture_scene_facts_of(m->scene);
    if (f.moves)
        return refuse(m, "its camera moves, so every frame is a picture of its own and none a sum");
    if (!f.lights)
        return refuse(m, "it has no light, so there is nothing to sum");
    o->width = f.width;
    o->height = f.height;
    o->lights = f.lights;
    m->samples = (size_t)f.width * f.height * 3;
    o->image_bytes = f.lights * m->samples * sizeof(float);
    o->geometry_bytes = f.geometry_bytes;
    m->rgb = malloc(m->samples * sizeof(float));
    return m->rgb ? 0 : refuse(m, "not enough memory for a frame");
}

/* The sequence, as a reader of the scene gets it. */
static int sequence(measuring *m)
{
    bench_scene *o = m->out;
    double began_s = progress_now_s();
    show(m, "rendering its lights", 0, 0);
    if (fixture_scene_prepare(m->scene, &o->why))
        return -1;
    o->prepare_s = progress_now_s() - began_s;
    for (uint64_t n = 0; n < o->frames && !interrupt_came(); n++) {
        began_s = progress_now_s();
        if (fixture_scene_frame(m->scene, n, m->rgb, NULL, &o->why))
            return -1;
        o->frames_s += progress_now_s() - began_s;
        show(m, "frame", n + 1, o->frames);
    }
    return 0;
}

/* Switches on a frame's lights, or, if `all` is set, all lights regardless of the schedule. */
static void light_up(measuring *m, uint64_t frame, int all)
{
    m->lit = 0;
    for (size_t i = 0; i < m->out->lights; i++) {
        double level = all ? 1.0 + (double)i : fixture_scene_level(m->scene, i, frame);
        if (level > 0.0) {
            m->image[m->lit] = fixture_scene_light_image(m->scene, i);
            m->level[m->lit++] = (float)level;
        }
    }
}

static void run_sum(void *context)
{
    measuring *m = context;
    fixture_sum_lights(m->rgb, m->image, m->level, m->lit, m->samples);
}

static void run_copy(void *context)
{
    measuring *m = context;
    memcpy(m->copy, m->image[0], m->samples * sizeof(float));
}

static void run_read(void *context)
{
    measuring *m = context;
    for (size_t i = 0; i < m->lit; i++)
        m->seen += bench_read(m->image[i], m->samples * sizeof(float));
}

static int race(measuring *m, bench_sums *sums, unsigned rounds, const bench_flush *flush)
{
    bench_runner runners[] = {
        {.run = run_sum, .context = m}, {.run = run_copy, .context = m}, {.run = run_read, .context = m}};
    if (bench_race(runners, 3, rounds, flush, interrupt_came))
        return interrupt_came() ? -1 : refuse(m, "not enough memory to measure");
    *sums = (bench_sums){runners[0].median_s, runners[1].median_s, runners[2].median_s};
    return 0;
}

static int sums(measuring *m)
{
    bench_scene *o = m->out;
    bench_flush flush = {0};
    show(m, "sums alone", 0, 0);
    for (uint64_t n = 0; n < o->frames && !interrupt_came(); n++) {
        light_up(m, n, 0);
        double began_s = progress_now_s();
        run_sum(m);
        o->sums_s += progress_now_s() - began_s;
    }
    light_up(m, 0, 1);
    m->copy = malloc(m->samples * sizeof(float));
    if (!m->copy || bench_flush_open(&flush))
        return refuse(m, "not enough memory to measure");
    memset(m->copy, 0, m->samples * sizeof(float)); /* so that the first copy takes no page faults */
    int failed = race(m, &o->warm, WARM_ROUNDS, NULL) || race(m, &o->cold, COLD_ROUNDS, &flush);
    bench_flush_close(&flush);
    return failed ? -1 : 0;
}

static void renders(measuring *m)
{
    for (size_t light = 0; light < m->out->lights && !interrupt_came(); light++) {
        show(m, "rendering light", light + 1, m->out->lights);
        double began_s = progress_now_s();
        fixture_scene_render_lights(m->scene, light, 1);
        m->out->light_s[light] = progress_now_s() - began_s;
    }
}

static void measure(bench *b, bench_scene *out)
{
    measuring m = {.b = b, .out = out, .spread = {out->threads, interrupt_came}};
    uint64_t base = resident_peak();
    if (load(&m) == 0 && sequence(&m) == 0) {
        out->peak_bytes = resident_peak() - base;
        if (sums(&m) == 0) {
            renders(&m);
            out->done = !interrupt_came();
        }
    }
    progress_clear(&b->progress);
    fixture_scene_free(m.scene);
    free(m.rgb);
    free(m.copy);
}

/* --- a process a scene --- */

static int measure_apart(bench *b, bench_scene *out)
{
    int status = 0, told = 0;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        measure(b, out);
        exit(0);
    }
    if (child < 0)
        return pupil_refuse(&out->why, "%s: no process to measure it in: %s", out->name, strerror(errno));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        if (interrupt_came() && !told++)
            kill(child, SIGTERM); /* the child has a terminal's signal already, but not that of `kill` */
    if (!out->done && !*out->why.text && !interrupt_came())
        pupil_refuse(&out->why, "%s: the process that measured it ended early%s", out->name,
                     WIFSIGNALED(status) ? ", by a signal" : "");
    return out->done ? 0 : -1;
}

static int run(bench *b, bench_scene *results)
{
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    progress_begin(&b->progress, b->quiet, 0);
    interrupt_watch();
    for (size_t i = 0; i < b->scenes; i++) {
        bench_scene *s = &results[i];
        snprintf(s->name, sizeof s->name, "%s", b->scene[i]);
        s->frames = b->frames;
        s->threads = b->threads ? b->threads : processors > 0 ? (unsigned)processors : 1;
        if (measure_apart(b, s)) {
            fprintf(stderr, "pupil bench scene: %s\n", interrupt_came() ? "interrupted" : s->why.text);
            return interrupt_came() ? EXIT_INTERRUPTED : EXIT_FAILED;
        }
        if (b->json) {
            bench_scene_json(stdout, s);
            fflush(stdout);
        }
    }
    if (!b->json)
        bench_scene_table(stdout, results, b->scenes);
    if (fflush(stdout) || ferror(stdout)) {
        fprintf(stderr, "pupil bench scene: standard output: %s\n", strerror(errno));
        return EXIT_FAILED;
    }
    return EXIT_DONE;
}

/* --- the command line --- */

#define AT(field) offsetof(bench, field)

static const option_row rows[] = {
    {"frames", 'n', OPTION_COUNT, "N", AT(frames), .low = 1, .high = 999999999, .initial = "1800",
     .help = "of the sequence"},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .initial = "600x600",
     .help = "of the frames"},
    OPTION_ROW_THREADS(bench, threads, "0"),
    OPTION_ROW_JSON(bench, json, "one object a line for each scene"),
    OPTION_ROW_QUIET(bench, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_scene_command = {
    .name = "bench scene",
    .summary = "rendering a scene's lights once, and its frames as their sums",
    .usage = "[SCENE...] [options]",
    .about = "What a scene costs: each light's picture once, then a sum a frame; relative to memcpy.\n"
             "  SCENE  a recipe by name or path (room); several: side by side, a row each",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Measures what each SCENE costs: the picture of each of its lights once, then a sum a frame, relative to a "
        "memcpy of one picture and a plain read of all in the same run; the whole sequence; the memory. Several "
        "scenes are measured in a process each. --threads are those that render; a sum is of one thread. "
        "docs/bench.md explains the figures.",
    .groups = groups,
};

/* -1: continue; else the exit status. */
static int parse(bench *b, int argc, char **argv)
{
    option_words words;
    const int status = options_read(&bench_scene_command, b, argc, argv, &words);
    if (status >= 0)
        return status;
    for (int i = 0; i < words.count; i++) {
        if (b->scenes == MOST_SCENES || strlen(words.word[i]) >= sizeof((bench_scene *)0)->name) {
            fprintf(stderr, "pupil bench scene: %s: at most 16 scenes, and names of at most 255 bytes\n",
                    words.word[i]);
            return EXIT_USAGE;
        }
        b->scene[b->scenes++] = words.word[i];
    }
    if (!b->scenes)
        b->scene[b->scenes++] = "room";
    return -1;
}

int bench_scene_main(int argc, char **argv)
{
    bench b = {.frames = 1800, .width = 600, .height = 600};
    const int parsed = parse(&b, argc, argv);
    if (parsed >= 0)
        return parsed;
    size_t bytes = MOST_SCENES * sizeof(bench_scene);
    bench_scene *results = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (results == MAP_FAILED) {
        fprintf(stderr, "pupil bench scene: not enough memory\n");
        return EXIT_FAILED;
    }
    int status = run(&b, results);
    munmap(results, bytes);
    return status;
}
