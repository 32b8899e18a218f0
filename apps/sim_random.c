/* pupil sim --random: many cameras and scripts from seeds, and whether any loop around them swings for ever. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "interrupt.h"
#include "refuse.h"
#include "sim.h"
#include "source.h"

enum { TAIL_FRAMES = 240, MOST_RANDOM_FRAMES = 2000, MOST_NAMED = 20 };
enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_INTERRUPTED = 130 };

int sim_random_loop(sim_options *o, uint64_t seed, char *why, size_t why_bytes)
{
    fixture_loop *loop = &o->loop;
    fixture_plant_random(&loop->plant, seed);
    fixture_plant_random_script(seed, &loop->plant, o->light, sizeof o->light);
    if (fixture_plant_check(&loop->plant, why, why_bytes) ||
        fixture_light_parse(&loop->script, o->light, why, why_bytes))
        return -1;
    fixture_loop_fit(loop);
    /* what an owner believes who knows no better than that 4 is the longest that is usual, or has seen it jitter */
    const uint32_t late = loop->plant.jitter[0] > loop->plant.jitter[1] ? loop->plant.jitter[0] : loop->plant.jitter[1];
    loop->sensor.delay_frames = o->believed ? o->believed : 4 + late;
    loop->sensor.mains_hz = o->mains_hz;
    o->duration_s = fixture_light_last_s(&loop->script) + TAIL_FRAMES * loop->plant.frame_s;
    return 0;
}

static double now_s(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct tally {
    uint64_t done, frames, failed;
    double began_s, said_s;
} tally;

/* One plant; -1 and a sentence where it could not be run to its end or swings for ever. */
static int try_one(sim_options *o, uint64_t seed, fixture_loop_frame *frame, tally *t, char *why, size_t why_bytes)
{
    size_t event;
    if (sim_random_loop(o, seed, why, why_bytes))
        return -1;
    size_t frames = sim_frames(o, &event);
    frames = frames < MOST_RANDOM_FRAMES ? frames : MOST_RANDOM_FRAMES;
    if (fixture_loop_run(&o->loop, frames, frame, why, why_bytes))
        return -1;
    t->frames += frames;
    const fixture_loop_sum sum = fixture_loop_sum_of(frame, frames, 0, SIM_RANDOM_REST);
    if (!sim_cycles(&sum))
        return 0;
    return pupil_refuse(why, why_bytes, "a limit cycle: %u swings, %.2f EV from end to end, in %d frames", sum.swings,
                        sum.asked_pp_ev, (int)SIM_RANDOM_REST);
}

static void say(const sim_options *o, tally *t)
{
    const double now = now_s(CLOCK_MONOTONIC);
    if (o->quiet || !isatty(STDERR_FILENO) || now - t->said_s < 0.2)
        return;
    t->said_s = now;
    fprintf(stderr, "\r\033[K%llu of %llu cameras, %llu failed", (unsigned long long)t->done,
            (unsigned long long)o->plants, (unsigned long long)t->failed);
}

int sim_random(sim_options *o)
{
    tally t = {.began_s = now_s(CLOCK_PROCESS_CPUTIME_ID)};
    fixture_loop_frame *frame = malloc(MOST_RANDOM_FRAMES * sizeof *frame);
    char why[PUPIL_WHY_BYTES];
    if (!frame)
        return fputs("pupil sim: not enough memory\n", stderr), EXIT_FAILED;
    interrupt_watch();
    for (; t.done < o->plants && !interrupt_came(); t.done++) {
        const uint64_t seed = o->seed + t.done;
        if (try_one(o, seed, frame, &t, why, sizeof why) && t.failed++ < MOST_NAMED)
            printf("seed %llu: %s; again with: pupil sim --random 1 --seed %llu%s%s --plot again.svg\n",
                   (unsigned long long)seed, why, (unsigned long long)seed, o->loop.law->total ? " --controller " : "",
                   o->loop.law->total ? o->loop.law->name : "");
        say(o, &t);
    }
    free(frame);
    if (!o->quiet && isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr);
    const double took_s = now_s(CLOCK_PROCESS_CPUTIME_ID) - t.began_s;
    if (o->json)
        printf("{\"controller\":\"%s\",\"seed\":%llu,\"plants\":%llu,\"frames\":%llu,\"failed\":%llu,\"cpu_s\":%.3f}\n",
               o->loop.law->name, (unsigned long long)o->seed, (unsigned long long)t.done, (unsigned long long)t.frames,
               (unsigned long long)t.failed, took_s);
    else
        printf("%s: %llu cameras from seed %llu, %llu frames: %llu failed; %.0f cameras a second of CPU time\n",
               o->loop.law->name, (unsigned long long)t.done, (unsigned long long)o->seed, (unsigned long long)t.frames,
               (unsigned long long)t.failed, (double)t.done / fmax(took_s, 1e-6));
    if (interrupt_came())
        return fputs("pupil sim: interrupted\n", stderr), EXIT_INTERRUPTED;
    return t.failed ? EXIT_FAILED : EXIT_DONE;
}
