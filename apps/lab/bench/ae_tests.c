/* The tests of exposure loops. A loop that keeps the limits is called good: docs/sim.md. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "ae.h"
#include "common/interrupt.h"

#define SETTLED_EV   0.1
#define OVERSHOOT_EV 0.05
#define HUNT_EV      0.02
#define STROBE_EV    0.02

enum {
    REST = 60,
    BELIEVED_DELAYS = 4,
    SLOW_BEFORE = 300,
    SLOW_AFTER = 600,
    BEFORE = 90,
    AFTER = 150,
    SEAM_FRAMES = 1400
};

const char *const bench_ae_tests[BENCH_AE_TESTS] = {"settle",     "overshoot", "hunt",   "identify", "calm", "seam",
                                                    "background", "bands",     "strobe", "curve",    "lies"};

void bench_ae_begin(fixture_loop *loop, const fixture_controller *law, uint32_t delay, fixture_gain_law gain)
{
    pupil_sensor_config usual;
    pupil_sensor_config_default(&usual);
    fixture_loop_default(loop);
    loop->law = law;
    loop->plant.law = gain;
    loop->plant.delay[0] = loop->plant.delay[1] = delay;
    fixture_loop_fit(loop);
    if (!law->total)
        loop->sensor.delay_frames = usual.delay_frames;
}

int bench_ae_loop(bench_ae *b, fixture_loop *loop, size_t frames, const char *format, ...)
{
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (interrupt_came() || fixture_light_parse(&loop->script, text, &b->why))
        return -1;
    return fixture_loop_run(loop, frames, b->frame, &b->why);
}

void bench_ae_show(bench_ae *b, const fixture_loop *loop, const char *test, const char *of, double step_ev,
                   double value, double limit)
{
    const bench_ae_row row = {
        .law = loop->law,
        .test = test,
        .of = of,
        .unit = strstr(of, "hertz")                                                                      ? "Hz"
                : strcmp(test, "settle") == 0 || strcmp(test, "identify") == 0 || strstr(of, ": frames") ? "frames"
                                                                                                         : "EV",
        .gain_law = fixture_gain_law_name[loop->plant.law],
        .delay = loop->plant.delay[0],
        .believed = loop->sensor.delay_frames,
        .step_ev = step_ev,
        .value = value,
        .limit = limit,
        .pass = value <= limit};
    if (!b->test || strcmp(b->test, test) == 0)
        b->see(b->context, &row);
}

static int is_slow(const fixture_controller *law)
{
    return strcmp(law->name, "softisp") == 0; /* it takes seconds for a stop, and gets the time */
}

/* Within D + 1 frames, plus the frames that are watched to detect a strobe; if nearly all of the frame was clipped,
 * within 2 D + 1 if that is more. */
static void show_settling(bench_ae *b, const fixture_loop *loop, const char *of, double step_ev, size_t frames,
                          size_t event)
{
    const fixture_loop_sum s = fixture_loop_sum_of(b->frame, frames, event, REST);
    const uint32_t d = loop->plant.delay[0], seen = d + 1 + loop->sensor.flash_frames;
    const int blind = b->frame[event].truth.clipped_share > 0.97;
    const double limit = blind && 2 * d + 1 > seen ? 2 * d + 1 : seen;
    /* the published laws have their own keys; pupil has to reach its key */
    const int lost = s.settle_frames < 0 || (!loop->law->total && fabs(s.aim_ev) > SETTLED_EV);
    char words[48];
    snprintf(words, sizeof words, "%s%s%s", of, *of && !loop->sensor.flash_frames ? ", " : "",
             loop->sensor.flash_frames ? "" : BENCH_AE_NO_FLASH);
    bench_ae_show(b, loop, "settle", words, step_ev, lost ? NAN : (double)s.settle_frames, limit);
    bench_ae_show(b, loop, "overshoot", words, step_ev, s.overshoot_ev, OVERSHOOT_EV);
}

static int settle_camera(bench_ae *b, const fixture_controller *law, uint32_t delay, fixture_gain_law gain, int rejects)
{
    static const double steps[] = {-6, -3, -1, 1, 3, 6};
    const size_t before = is_slow(law) ? SLOW_BEFORE : BEFORE, after = is_slow(law) ? SLOW_AFTER : AFTER;
    fixture_loop loop;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        bench_ae_begin(&loop, law, delay, gain);
        loop.sensor.flash_frames *= rejects != 0;
        if (bench_ae_loop(b, &loop, before + after, "%.6fs step %gev", (double)before * loop.plant.frame_s, steps[i]))
            return -1;
        show_settling(b, &loop, "", steps[i], before + after, before);
    }
    for (int white = 0; white < 2; white++) { /* ten stops off at the first frame */
        bench_ae_begin(&loop, law, delay, gain);
        loop.sensor.flash_frames *= rejects != 0;
        fixture_plant_split(&loop.plant, exp2(white ? -3.0 : -13.0), &loop.exposure_s, &loop.gain);
        if (bench_ae_loop(b, &loop, after, "0s %dev", white ? 5 : -5))
            return -1;
        show_settling(b, &loop, white ? "white" : "black", white ? 10 : -10, after, 0);
    }
    return 0;
}

/* The published laws do not detect strobes, and are not tested for it. */
int bench_ae_settle(bench_ae *b, const fixture_controller *law)
{
    for (int rejects = 1; rejects >= (law->total ? 1 : 0); rejects--)
        for (int gain = 0; gain < FIXTURE_GAIN_FINE; gain++)
            for (uint32_t delay = 1; delay <= 4; delay++)
                if (settle_camera(b, law, delay, (fixture_gain_law)gain, rejects))
                    return -1;
    return 0;
}

/* All pairs of a true delay and the delay in the camera's table, which its info and the controller use. */
int bench_ae_hunt(bench_ae *b, const fixture_controller *law)
{
    fixture_loop loop;
    for (uint32_t delay = 1; delay <= 4; delay++) {
        for (uint32_t believed = 1; believed <= BELIEVED_DELAYS; believed++) {
            bench_ae_begin(&loop, law, delay, FIXTURE_GAIN_RECIPROCAL);
            loop.plant.told = FIXTURE_TOLD_DELAYED;
            loop.plant.told_delay[0] = loop.plant.told_delay[1] = believed;
            loop.sensor.delay_frames = believed;
            if (bench_ae_loop(b, &loop, 600, "2s step 2ev; 4s step -4ev; 6s ramp 1ev/s 2s; 9s step 1ev"))
                return -1;
            const fixture_loop_sum s = fixture_loop_sum_of(b->frame, 600, 270, 150);
            bench_ae_show(b, &loop, "hunt", "", 1.0, s.rest_pp_ev, HUNT_EV);
        }
    }
    return 0;
}

/* All pairs of the two controls' delays, of a camera whose table says four. Counts the frames until both are known for
 * good, while the light goes up and down by a stop or two, as when something passes. */
int bench_ae_identify(bench_ae *b, const fixture_controller *law)
{
    fixture_loop loop;
    for (uint32_t pair = 0; pair < 16 && !law->total; pair++) {
        const uint32_t delay[FIXTURE_CONTROLS] = {1 + pair / 4, 1 + pair % 4};
        char of[32];
        bench_ae_begin(&loop, law, delay[0], FIXTURE_GAIN_RECIPROCAL);
        const uint32_t believed = loop.sensor.delay_frames;
        loop.plant.delay[FIXTURE_GAIN] = delay[1];
        loop.plant.told = FIXTURE_TOLD_DELAYED;
        loop.plant.told_delay[0] = loop.plant.told_delay[1] = 4;
        loop.plant.light_ev = 2.4; /* nearly the longest exposure: darker light needs gain, brighter light less
                                    * exposure */
        fixture_loop_fit(&loop);
        loop.sensor.delay_frames = believed;
        if (bench_ae_loop(b, &loop, 240, "3s step -1.5ev; 3.4s step 2.5ev; 3.8s step -2ev; 5s step 1ev"))
            return -1;
        size_t known = 240;
        while (known > 90 && b->frame[known - 1].setting.delay[0] == delay[0] &&
               b->frame[known - 1].setting.delay[1] == delay[1])
            known--;
        snprintf(of, sizeof of, "exposure %u, gain %u", delay[0], delay[1]);
        bench_ae_show(b, &loop, "identify", of, NAN, known < 240 ? (double)(known - 90) : NAN, 30.0);
    }
    return 0;
}

/* Constant light, metered with an error of 0.02 EV. */
int bench_ae_calm(bench_ae *b, const fixture_controller *law)
{
    fixture_loop loop;
    for (uint32_t delay = 1; delay <= 4; delay++) {
        bench_ae_begin(&loop, law, delay, FIXTURE_GAIN_RECIPROCAL);
        loop.plant.noise_ev = 0.02;
        if (bench_ae_loop(b, &loop, 1200, "0s 0ev"))
            return -1;
        const fixture_loop_sum s = fixture_loop_sum_of(b->frame, 1200, 0, 900);
        bench_ae_show(b, &loop, "calm", "from end to end", NAN, s.shown_pp_ev, HUNT_EV);
        bench_ae_show(b, &loop, "calm", "RMS a frame", NAN, s.shown_rms_ev, 0.001);
    }
    return 0;
}

int bench_ae_flicker(bench_ae *b, const fixture_controller *law)
{
    static const struct {
        const char *of, *script;
        double limit;
    } of[] = {{"1 % lamp blinking +7 EV", "blink 7ev 1% 1s", 0.001},
              {"10 % alias at 10 Hz", "flicker 10% 10Hz", 0.005},
              {"both", "blink 7ev 1% 1s; flicker 10% 10Hz", 0.005}};
    fixture_loop loop;
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        bench_ae_begin(&loop, law, 3, FIXTURE_GAIN_RECIPROCAL);
        if (bench_ae_loop(b, &loop, 900, "%s", of[i].script))
            return -1;
        bench_ae_show(b, &loop, "background", of[i].of, NAN, fixture_loop_sum_of(b->frame, 900, 0, 600).shown_rms_ev,
                      of[i].limit);
    }
    return 0;
}

/* Lamps on both mains, 300 frames in this light. */
static int run_lamps(bench_ae *b, fixture_loop *loop, double hz, double light_ev)
{
    const uint32_t believed = loop->sensor.delay_frames, mains_hz = loop->sensor.mains_hz;
    loop->plant.light_ev = light_ev;
    fixture_loop_fit(loop);
    loop->sensor.delay_frames = believed;
    loop->sensor.mains_hz = mains_hz;
    return bench_ae_loop(b, loop, 300, "lamp %gHz 30%%", hz);
}

static void show_bands(bench_ae *b, const fixture_loop *loop, const char *name)
{
    double worst = 0.0;
    for (size_t k = 240; k < 300; k++)
        worst = fmax(worst, b->frame[k].truth.band_ev);
    bench_ae_show(b, loop, "bands", name, NAN, worst, 0.02);
}

/* The frequency that is to be found. If each frame has the lamps at the same phase, and with all rows exposed at once,
 * it cannot be found, and nothing may be found. */
static void show_found(bench_ae *b, const fixture_loop *loop, const char *name, double hz, int seen)
{
    char of[64];
    size_t unknown = 0;
    for (size_t k = 0; k < 300; k++)
        unknown += b->frame[k].setting.mains_hz != (uint32_t)hz;
    snprintf(of, sizeof of, seen ? "%s: frames until found" : "%s: undetermined, hertz", name);
    if (seen)
        bench_ae_show(b, loop, "bands", of, NAN, unknown < 300 ? (double)unknown + 1.0 : NAN, 15.0);
    else
        bench_ae_show(b, loop, "bands", of, NAN, b->frame[299].setting.mains_hz, 0.0);
}

int bench_ae_mains(bench_ae *b, const fixture_controller *law)
{
    /* 13 ms are right: more than a period of either. 4.9 ms are less than a period of either: bands remain, and show
     * the frequency */
    static const double dim_ev = 3.7, bright_ev = 5.2;
    static const struct {
        const char *of;
        double hz, fps;
        int told, seen;
        const char *camera;
    } of[] = {{"50 Hz, configured", 50, 30, 1, 1, ""},
              {"60 Hz, configured", 60, 30, 1, 1, ""},
              {"50 Hz, 30 a second", 50, 30, 0, 1, ""},
              {"50 Hz, 24 a second", 50, 24, 0, 1, ""},
              {"50 Hz, 60 a second", 50, 60, 0, 1, "readout=15ms"},
              {"60 Hz, 25 a second", 60, 25, 0, 1, ""},
              {"60 Hz, 50 a second", 60, 50, 0, 1, "readout=15ms"},
              {"60 Hz, 30 a second", 60, 30, 0, 0, ""},
              {"50 Hz, 25 a second", 50, 25, 0, 0, ""},
              {"50 Hz, all rows at once", 50, 30, 0, 0, "readout=0ms"}};
    fixture_loop loop;
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        if (law->total && (of[i].told || !of[i].seen))
            continue; /* these laws neither take nor search the frequency */
        bench_ae_begin(&loop, law, 3, FIXTURE_GAIN_RECIPROCAL);
        if (fixture_plant_parse(&loop.plant, of[i].camera, &b->why))
            return -1;
        loop.plant.frame_s = 1.0 / of[i].fps;
        loop.sensor.mains_hz = of[i].told ? (uint32_t)of[i].hz : PUPIL_SENSOR_MAINS_AUTO;
        if (of[i].seen) {
            if (run_lamps(b, &loop, of[i].hz, dim_ev))
                return -1;
            show_bands(b, &loop, of[i].of);
        }
        if (!of[i].told && !law->total) {
            if (run_lamps(b, &loop, of[i].hz, bright_ev))
                return -1;
            show_found(b, &loop, of[i].of, of[i].hz, of[i].seen);
        }
    }
    return 0;
}

int bench_ae_strobe(bench_ae *b, const fixture_controller *law)
{
    static const double evs[] = {3, 5, 8, -3};
    fixture_loop loop;
    for (uint32_t delay = 1; delay <= 4; delay++) {
        for (unsigned flash = 1; flash <= 2; flash++) {
            for (size_t i = 0; i < sizeof evs / sizeof evs[0]; i++) {
                bench_ae_begin(&loop, law, delay, FIXTURE_GAIN_RECIPROCAL);
                if (bench_ae_loop(b, &loop, 200, "%.6fs flash %u frames %gev", 90 * loop.plant.frame_s, flash, evs[i]))
                    return -1;
                double moved = 0.0;
                for (size_t k = 90; k < 200; k++)
                    moved = fmax(moved, fabs(b->frame[k].asked_ev - b->frame[89].asked_ev));
                bench_ae_show(b, &loop, "strobe", flash == 1 ? "1 frame" : "2 in a row", evs[i], moved, STROBE_EV);
            }
        }
    }
    return 0;
}
