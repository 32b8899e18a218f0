/* Cameras that are nonlinear, and cameras that do not do what they report. */
#include <math.h>
#include <stdio.h>

#include "ae.h"

#define OVERSHOOT_EV 0.10
#define REST_EV      0.02
#define LEVEL_EV     0.10

enum { REST = 90, FRAMES = 690, EVENT = 390 };

/* Three small changes to learn the camera from, then the one that counts, at EVENT. */
static int learn_and_step(bench_ae *b, fixture_loop *loop, double base_ev, double step_ev)
{
    const double t = loop->plant.frame_s;
    return bench_ae_loop(b, loop, FRAMES,
                         "0s %gev; %.6fs step 1ev; %.6fs step -1.5ev; %.6fs step 0.5ev; %.6fs step %gev", base_ev,
                         90 * t, 180 * t, 270 * t, EVENT * t, step_ev);
}

/* The index of the first frame at or after EVENT: dropped frames have numbers, too. */
static size_t event_of(const bench_ae *b, const fixture_loop *loop)
{
    size_t event = 0;
    while (event < FRAMES - REST && b->frame[event].truth.time_s < EVENT * loop->plant.frame_s - 1e-6)
        event++;
    return event;
}

/* Returns the number of frames until it settled; -1: never. */
static long show(bench_ae *b, const fixture_loop *loop, const char *test, const char *of, double step_ev, int reachable)
{
    const size_t event = event_of(b, loop);
    const fixture_loop_sum before = fixture_loop_sum_of(b->frame, event, 0, 30);
    const fixture_loop_sum s = fixture_loop_sum_of(b->frame, FRAMES, event, REST);
    const uint32_t d = loop->plant.delay[0];
    char words[80];
    snprintf(words, sizeof words, "%s: frames", of);
    bench_ae_show(b, loop, test, words, step_ev, s.settle_frames < 0 ? NAN : (double)s.settle_frames, 2.0 * (d + 3));
    if (reachable) { /* a loop at rest may have given up */
        snprintf(words, sizeof words, "%s: level", of);
        bench_ae_show(b, loop, test, words, step_ev, fabs(s.aim_ev - before.aim_ev), LEVEL_EV);
    }
    snprintf(words, sizeof words, "%s: overshoot", of);
    bench_ae_show(b, loop, test, words, step_ev, s.overshoot_ev, OVERSHOOT_EV);
    snprintf(words, sizeof words, "%s: at rest", of);
    bench_ae_show(b, loop, test, words, step_ev, s.asked_pp_ev, REST_EV);
    return s.settle_frames;
}

/* The same camera with the slow, safe setting: up to two stops, the largest far_ev, only the filter acts. */
static int beside_slow(bench_ae *b, const fixture_loop *loop, const char *of, double base_ev, double step_ev,
                       long frames)
{
    fixture_loop slow = *loop;
    char words[80];
    slow.sensor.far_ev = 2.0;
    if (learn_and_step(b, &slow, base_ev, step_ev))
        return -1;
    const fixture_loop_sum s = fixture_loop_sum_of(b->frame, FRAMES, event_of(b, &slow), REST);
    snprintf(words, sizeof words, "%s: frames compared with far_ev = 2", of);
    bench_ae_show(b, loop, "lies", words, step_ev, frames < 0 ? NAN : (double)frames,
                  s.settle_frames < 0 ? (double)FRAMES : (double)s.settle_frames);
    return 0;
}

int bench_ae_curve(bench_ae *b, const fixture_controller *law)
{
    static const struct {
        const char *of, *camera;
    } of[] = {{"slope 0.5", "curve=gamma:0.5"}, {"slope 0.7", "curve=gamma:0.7"},
              {"slope 1.4", "curve=gamma:1.4"}, {"slope 2", "curve=gamma:2"},
              {"S-shaped", "curve=s:1"},        {"8 bits, S-shaped", "curve=s:1,bits=8"}};
    static const double steps[] = {-3, 3};
    fixture_loop loop;
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        for (size_t k = 0; k < 2; k++) {
            bench_ae_begin(&loop, law, 3, FIXTURE_GAIN_RECIPROCAL);
            if (fixture_plant_parse(&loop.plant, of[i].camera, &b->why) || learn_and_step(b, &loop, 0.0, steps[k]))
                return -1;
            (void)show(b, &loop, "curve", of[i].of, steps[k], 1);
        }
    }
    return 0;
}

int bench_ae_lies(bench_ae *b, const fixture_controller *law)
{
    static const struct {
        const char *of, *camera;
        double base_ev;
        int beyond; /* out of reach for any loop: it only must not oscillate */
    } of[] = {{"info has what was asked", "told=asked", 0, 0},
              {"no info", "told=nothing", 0, 0},
              {"read-back does not change", "told=first", 0, 0},
              {"a line more", "off=1", 3, 0},
              {"a line less", "off=-1", 3, 0},
              {"gain shortens exposure", "moves=0.3", -4, 0},
              {"exposure wraps at 1000 lines", "wrap_lines=1000", -1, 0},
              {"gain wraps at 8", "wrap_gain=8", -5, 1},
              {"a fifth of the writes is lost", "ignore=20%", 0, 0},
              {"gain is dead", "ignore=0%/100%", -3, 1},
              {"exposure is dead", "ignore=100%/0%", -2, 1},
              {"jitters by a frame", "jitter=1", 0, 0},
              {"exposure reported ten times too long", "scale=10", 0, 0},
              {"a fifth of the frames is dropped", "drop=20%", 0, 0},
              {"exposure 4, gain 1", "delay=4/1", -5, 0}};
    static const double steps[] = {-2, 2};
    fixture_loop loop;
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        for (size_t k = 0; k < 2; k++) {
            bench_ae_begin(&loop, law, 3, FIXTURE_GAIN_RECIPROCAL);
            if (fixture_plant_parse(&loop.plant, of[i].camera, &b->why) ||
                learn_and_step(b, &loop, of[i].base_ev, steps[k]))
                return -1;
            const long frames = show(b, &loop, "lies", of[i].of, steps[k], !of[i].beyond);
            if (!law->total && beside_slow(b, &loop, of[i].of, of[i].base_ev, steps[k], frames))
                return -1;
        }
    }
    return 0;
}
