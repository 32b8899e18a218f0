/* Detects any change of what the loop does: random cameras with faults of all kinds, random configurations, and light
 * and calls at random. A line for each group of loops, compared with random_loops.txt. Lines that differ show the
 * effect of a change of the loop; where it is intended, --write stores them. loops.txt shows better which frames
 * changed: this only shows whether every setting is the same to the last bit.
 *
 *     off       frames in which the sensor is over 0.25 EV off
 *     asked     settings that were asked for
 *     sensor    how far the setting is off on average, in EV
 *     digest    of every field of every setting */
#include <stdio.h>

#include "expected_lines.h"
#include "scripted_loop.h"

enum { GROUPS = 21, IN_GROUP = 20, LINE_BYTES = 120 };
enum { LAST_GROUP = 147 }; /* the first with an exchange where the exposure is not automatic */

static int one_in(int n)
{
    return check_random() % (uint64_t)n == 0;
}

static int below(int n)
{
    return (int)(check_random() % (uint64_t)n);
}

static double between(double low, double high)
{
    return low + (high - low) * check_uniform();
}

/* One of them, and as a rule the first. */
#define USUALLY(...) pick((const double[]){__VA_ARGS__}, (int)(sizeof(const double[]){__VA_ARGS__} / sizeof(double)))
static double pick(const double *values, int count)
{
    return one_in(2) ? values[below(count)] : values[0];
}

static scripted_camera random_camera(void)
{
    scripted_camera c = {.name = "random"};
    c.delay[0] = c.delay[1] = 1 + (uint32_t)below(one_in(4) ? SCRIPTED_DELAY_MOST : 4);
    c.delay[1] = one_in(3) ? 1 + (uint32_t)below(4) : c.delay[0];
    c.believed = one_in(2) ? c.delay[0] : 1 + (uint32_t)below(4);
    c.told = (telling)(one_in(2) ? below(6) : TOLD_TRUTH);
    c.exposures = (exposures)(one_in(2) ? below(4) : LINES);
    c.gains = (gains)below(5);
    c.slope = USUALLY(1.0, 0.5, 0.6, 0.8, 1.3, 1.8, 2.2);
    if (one_in(6)) {
        c.jump_gain = USUALLY(2.0, 3.0, 4.0);
        c.jump = USUALLY(1.5, 0.7, 1.2, 2.0);
    }
    for (int control = 0; control < 2; control++)
        c.weak[control] = one_in(8) ? USUALLY(-1.0, 0.5, 0.7, 1.5) : 0.0;
    c.knee = one_in(6) ? between(0.05, 0.5) : 0.0;
    c.black = one_in(4) ? USUALLY(0.07, 0.02, 0.15) : 0.0;
    c.white = one_in(8) ? between(0.5, 1.0) : 0.0;
    c.lamp = one_in(6) ? between(0.0, 0.3) : 0.0;
    c.own_auto_from = one_in(8) ? below(60) : 0;
    c.own_auto_to = c.own_auto_from ? c.own_auto_from + below(60) : 0;
    c.fps = USUALLY(30.0, 25.0, 60.0, 15.0, 32.0);
    c.lamp_hz = one_in(6) ? USUALLY(100.05, 120.1, 100.0) : 0.0;
    c.has_no_clock = one_in(12);
    c.clock = (clocks)(one_in(4) ? below(5) : CLOCK_RIGHT);
    c.loses = one_in(8) ? 2 + below(6) : 0;
    c.mains_hz = one_in(2) ? 0 : (uint32_t)USUALLY(PUPIL_SENSOR_MAINS_AUTO, 50, 60);
    c.is_curved = one_in(4);
    c.key_at_night = one_in(8) ? 0.06 : 0.0;
    c.day_night_s = one_in(6) ? USUALLY(0.5, 0.1) : 0.0;
    c.stages = one_in(6);
    c.drops = one_in(8) ? 0.2 : 0.0;
    c.jitter = one_in(8) ? 0.2 : 0.0;
    c.dead = one_in(16) ? 0.1 : 0.0;
    c.noise_ev = one_in(3) ? USUALLY(0.02, 0.1, 1.5) : 0.0;
    c.uncounted = one_in(8) ? USUALLY(0.3, 1.0) : 0.0;
    c.has_levels = one_in(12);
    return c;
}

static pupil_sensor_config random_config(const scripted_camera *camera)
{
    pupil_sensor_config c = scripted_config(camera);
    c.far_ev = USUALLY(0.1, 0.05, 0.3);
    c.tau_s = USUALLY(0.8, 0.0, 0.2);
    c.hold_ev = USUALLY(0.05, 0.0, 0.2);
    c.digital_ev = USUALLY(1.5, 0.0, 0.5, 3.0);
    c.ev_compensation = USUALLY(0.0, -1.0, 0.5);
    c.trim_low = USUALLY(0.0, 0.1);
    c.trim_high = USUALLY(1.0, 0.9);
    c.highlight_share = USUALLY(0.05, 0.01, 0.2);
    c.highlight_ev = USUALLY(1.0, 0.0, 2.0);
    c.flash_frames = (uint32_t)USUALLY(2, 0, 1, 4);
    c.exposure_max_s = USUALLY(1.0 / 30.0, 0.1, 0.02, 2.0);
    c.frame_rate_priority = !one_in(4);
    c.exposure_step_s = USUALLY(SCRIPTED_LINE_S, 0.0, 1e-4);
    c.exposure_min_s = USUALLY(SCRIPTED_LINE_S, 1e-4, 0.001);
    c.gain_min = camera->gains == DECIBELS ? USUALLY(1.0, 0.3) : camera->gains < DECIBELS ? USUALLY(1.0, 2.0) : 1.0;
    c.gain_max = c.gain_law == PUPIL_GAIN_TABLE ? c.gain_max : USUALLY(16.0, 4.0, 2.0, 22.0);
    if (c.gain_law == PUPIL_GAIN_LINEAR)
        c.gain_step = USUALLY(1.0 / 16.0, 0.5, 1.0);
    if (c.gain_law == PUPIL_GAIN_DB)
        c.gain_step = USUALLY(0.3, 3.0, 6.0);
    if (one_in(6)) { /* coarse tables of its own */
        c.exposure_count = 2 + (uint32_t)below(8);
        const int is_even = one_in(2);
        for (uint32_t i = 0; i < c.exposure_count; i++)
            c.exposure_table[i] = !i        ? between(1e-4, 1e-3)
                                  : is_even ? 2.0 * c.exposure_table[i - 1]
                                            : c.exposure_table[i - 1] * between(1.0, 4.0);
    }
    if (c.gain_law == PUPIL_GAIN_TABLE && one_in(2)) {
        c.gain_count = 1 + (uint32_t)below(8);
        for (uint32_t i = 1; i < c.gain_count; i++)
            c.gain_table[i] = c.gain_table[i - 1] * between(1.0, 3.0);
    }
    c.stages += c.stages;
    c.stage[1] = (pupil_sensor_stage){0.02, 8.0};
    return c;
}

static double random_value(event_kind kind)
{
    switch (kind) {
    case LIGHT:
        return one_in(8) ? between(-4.0, 12.0) : between(0.5, 9.0);
    case RAMP:
        return between(-0.08, 0.08);
    case FLASH:
        return between(-4.0, 4.0);
    case COVERED:
        return 1 + below(12);
    case HALF_DARK:
        return USUALLY(0.3, 0.54, 0.0, 0.97);
    case ANNOUNCED:
    case FILTER:
        return USUALLY(-2.5, 3.0, 1.0, -1.0, 0.0);
    case EXPOSURE_MODE:
    case GAIN_MODE:
    case BOTH_MODES:
        return USUALLY(PUPIL_SENSOR_AUTO, PUPIL_SENSOR_MANUAL, PUPIL_SENSOR_HELD);
    case LOCK:
        return USUALLY(0.0, 1.0);
    case GAIN_MAX:
        return USUALLY(4.0, 8.0, 2.0);
    case FRAME_PERIOD:
        return USUALLY(2.0, 1.5);
    case COMPENSATION:
        return USUALLY(0.0, 1.0, -0.5);
    case BELIEVED:
        return 1 + below(8);
    default:
        return between(1e-3, 0.2); /* START */
    }
}

/* Mostly events of light, in steps of every size. Returns the number of frames. */
static int random_script(script *s)
{
    const int space = one_in(8) ? 60 : 18;  /* frames, at most */
    const int still = one_in(12) ? 320 : 0; /* before the last: a pinned control is free again after 300 */
    int frame = 0;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < SCRIPTED_EVENTS - 1; i++) {
        event *e = &s->events[i];
        e->kind = !i || one_in(2) ? LIGHT : (event_kind)(LIGHT + below(EVENT_KINDS - LIGHT));
        e->frame = frame;
        e->value = random_value(e->kind);
        if (i && e->kind == LIGHT && one_in(2)) /* a small step */
            e->value = s->events[0].value + between(-1.0, 1.0);
        frame += below(space) + (i == SCRIPTED_EVENTS - 3 ? still : 0);
    }
    return frame;
}

typedef struct group {
    int frames, off, settings;
    double sensor_ev;
    uint64_t digest;
} group;

static void run(group *g)
{
    static scripted_loop l;
    script light;
    const scripted_camera camera = random_camera();
    const pupil_sensor_config config = random_config(&camera);
    const int frames = random_script(&light);
    const char *why = "";
    CHECK_MSG(pupil_sensor_config_check(&config, &why) == PUPIL_OK, "%s", why);
    scripted_open(&l, &camera, &config, &light);
    while (l.frame < frames)
        scripted_frame(&l);
    CHECK_MSG(!l.errors, "%d calls were refused", l.errors);
    g->frames += frames;
    g->off += l.off;
    g->settings += l.settings;
    g->sensor_ev += l.sensor_ev;
    g->digest = (g->digest << 1 | g->digest >> 63) ^ l.digest;
}

int main(int argc, char **argv)
{
    static char line[LINE_BYTES];
    const expected_lines table = expected_begin("random_loops.txt", argc, argv);
    for (int i = 0; table.file && i < GROUPS; i++) {
        group g = {0};
        /* a group does not depend on those before */
        check_state.random = check_state.seed + (uint64_t)(i == GROUPS - 1 ? LAST_GROUP : i);
        for (int k = 0; k < IN_GROUP; k++)
            run(&g);
        snprintf(line, sizeof line, "%2d: off %5d of %5d asked %4d sensor %6.3f digest %016llx\n", i, g.off, g.frames,
                 g.settings, g.sensor_ev / g.frames, (unsigned long long)g.digest);
        expected_line(&table, line);
    }
    return expected_end(&table);
}
