/* pupil sim --random: many cameras and scripts from seeds, and how the loops around them end. */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "common/interrupt.h"
#include "common/progress.h"
#include "options/commands.h"
#include "refuse.h"
#include "sim.h"
#include "synth/spread.h"

enum { MOST_RANDOM_FRAMES = 4000, MOST_NAMED = 20 };
/* BLOCK: cameras that a thread takes at once. ROUND: cameras after which the failed ones are named, in order. */
enum { BLOCK = 16, ROUND = 64 * BLOCK };

int sim_random_loop(sim_options *o, uint64_t seed, pupil_why *why)
{
    fixture_loop *loop = &o->loop;
    fixture_plant_random(&loop->plant, seed);
    fixture_plant_random_script(seed, &loop->plant, o->light, sizeof o->light);
    if (fixture_plant_check(&loop->plant, why) || fixture_light_parse(&loop->script, o->light, why))
        return -1;
    fixture_loop_fit(loop);
    /* the guess of an owner: 4, the longest usual delay, plus the jitter that was seen */
    const uint32_t late = loop->plant.jitter[0] > loop->plant.jitter[1] ? loop->plant.jitter[0] : loop->plant.jitter[1];
    loop->sensor.delay_frames = 4 + late;
    sim_configure(o);
    return 0;
}

typedef struct outcome {
    int is_done;
    uint32_t faults;
    fixture_verdict verdict;
    pupil_why why; /* empty: all is well */
} outcome;

typedef struct random_run {
    const sim_options *options;
    uint64_t first, named; /* counted from the first seed */
    size_t count;
    pthread_mutex_t lock; /* of the progress and the three counts */
    progress progress;
    uint64_t done, frames, failed;
    sim_fault_table table;
    outcome outcome[ROUND];
} random_run;

static double cpu_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Runs one plant; -1 and a sentence if it could not be run to its end, or ended wrong. */
static int try_one(sim_options *o, uint64_t seed, fixture_loop_frame *frame, size_t *frames, outcome *out)
{
    size_t event;
    if (sim_random_loop(o, seed, &out->why))
        return -1;
    const size_t all = sim_frames(o, &event);
    *frames = all < MOST_RANDOM_FRAMES ? all : MOST_RANDOM_FRAMES;
    out->faults = fixture_plant_faults(&o->loop.plant, &o->loop.script);
    if (fixture_loop_run(&o->loop, *frames, frame, &out->why) ||
        fixture_evaluate(&o->loop, frame, *frames, &out->verdict, &out->why))
        return -1;
    if (!out->verdict.is_evaluated)
        return pupil_refuse(&out->why, "its light is not still for long enough");
    return out->verdict.wrong ? pupil_refuse(&out->why, "%s", out->verdict.text) : 0;
}

static void say(random_run *r)
{
    progress *p = &r->progress;
    if (!progress_due(p, 0.2))
        return;
    const double left_s = (p->last_s - p->began_s) * (double)(p->total - r->done) / (double)r->done;
    progress_add(p, "%llu of %llu cameras, %llu failed, %.0f %s left", (unsigned long long)r->done,
                 (unsigned long long)p->total, (unsigned long long)r->failed, left_s < 100.0 ? left_s : left_s / 60.0,
                 left_s < 100.0 ? "s" : "min");
    progress_show(p);
}

static void try_block(void *context, size_t block)
{
    random_run *r = context;
    const size_t from = block * BLOCK, to = from + BLOCK < r->count ? from + BLOCK : r->count;
    fixture_loop_frame *frame = malloc(MOST_RANDOM_FRAMES * sizeof *frame);
    sim_options o = *r->options;
    for (size_t i = from; i < to && !interrupt_came(); i++) {
        outcome *out = &r->outcome[i];
        size_t frames = 0;
        const int failed = frame ? try_one(&o, o.seed + r->first + i, frame, &frames, out)
                                 : pupil_refuse(&out->why, "not enough memory");
        out->is_done = 1;
        pthread_mutex_lock(&r->lock);
        r->done++;
        r->frames += frames;
        r->failed += failed != 0;
        say(r);
        pthread_mutex_unlock(&r->lock);
    }
    free(frame);
}

static void count_round(random_run *r)
{
    for (size_t i = 0; i < r->count; i++)
        if (r->outcome[i].is_done)
            sim_count_faults(&r->table, r->outcome[i].faults, &r->outcome[i].verdict);
}

/* Names the failed cameras of a round, each with the command that shows it. */
static void name_failed(random_run *r)
{
    const sim_options *o = r->options;
    for (size_t i = 0; i < r->count && r->named < MOST_NAMED; i++) {
        const unsigned long long seed = o->seed + r->first + i;
        if (!r->outcome[i].is_done || !*r->outcome[i].why.text)
            continue;
        r->named++;
        progress_clear(&r->progress);
        if (o->json) {
            printf("{\"seed\":%llu,\"wrong\":\"%s\"}\n", seed, r->outcome[i].why.text);
            continue;
        }
        printf("seed %llu: %s; again with: pupil sim --random 1 --seed %llu", seed, r->outcome[i].why.text, seed);
        if (o->loop.law->total)
            printf(" --controller %s", o->loop.law->name);
        if (o->believed)
            printf(" --delay %u", o->believed);
        if (o->mains_hz != PUPIL_SENSOR_MAINS_AUTO)
            printf(" --mains %u", o->mains_hz);
        if (o->key_at)
            printf(" --key-at %s", o->key_at);
        puts(" --plot again.svg");
        fflush(stdout);
    }
}

static void print_sum(const random_run *r, double took_s)
{
    const sim_options *o = r->options;
    const unsigned long long seed = o->seed, done = r->done, frames = r->frames, failed = r->failed;
    if (o->json)
        printf("{\"controller\":\"%s\",\"seed\":%llu,\"plants\":%llu,\"frames\":%llu,\"failed\":%llu,\"cpu_s\":%.3f,",
               o->loop.law->name, seed, done, frames, failed, took_s);
    sim_print_faults(&r->table, o->json);
    if (!o->json)
        printf("%s: %llu cameras from seed %llu, %llu frames: %llu failed; %.0f cameras a second of CPU time\n",
               o->loop.law->name, done, seed, frames, failed, (double)done / fmax(took_s, 1e-6));
}

int sim_random(const sim_options *o)
{
    const double began_s = cpu_s();
    pupil_spread spread = {.threads = o->threads, .stop = interrupt_came};
    random_run *r = calloc(1, sizeof *r);
    if (!r)
        return fputs("pupil sim: not enough memory\n", stderr), EXIT_FAILED;
    r->options = o;
    pthread_mutex_init(&r->lock, NULL);
    progress_begin(&r->progress, o->quiet, o->plants);
    interrupt_watch();
    for (; r->first < o->plants && !interrupt_came(); r->first += ROUND) {
        const uint64_t left = o->plants - r->first;
        r->count = left < ROUND ? (size_t)left : ROUND;
        for (size_t i = 0; i < r->count; i++)
            r->outcome[i] = (outcome){0};
        pupil_spread_run(&spread, try_block, r, (r->count + BLOCK - 1) / BLOCK);
        name_failed(r);
        count_round(r);
    }
    progress_clear(&r->progress);
    print_sum(r, cpu_s() - began_s);
    const int failed = r->failed != 0;
    pthread_mutex_destroy(&r->lock);
    free(r);
    if (interrupt_came())
        return fputs("pupil sim: interrupted\n", stderr), EXIT_INTERRUPTED;
    return failed ? EXIT_FAILED : EXIT_DONE;
}
