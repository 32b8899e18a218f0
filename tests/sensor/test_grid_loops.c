/* Random cameras and lights on a grid, which reach bounds exactly. Levels are multiples of 1/2000 EV, as the loop's
 * constants are, and light and the controls' effects change by such constants. The key and the first setting are at 0
 * EV, so that differences of levels are exact. There are no pictures: the test makes the statistics.
 *
 * A digest of every field of every setting for each group of loops, compared with grid_loops.txt. The file has the same
 * purpose as random_loops.txt, and --write replaces its lines. */
#include <stdio.h>

#include "exact_numbers.h"
#include "expected_lines.h"
#include "scripted_loop.h"

enum { EV = 2000, IN_GROUP = 8, FRAMES = 40, LINE_BYTES = 60 };

#define PICK(...) ((const double[]){__VA_ARGS__})[below((int)(sizeof(const double[]){__VA_ARGS__} / sizeof(double)))]
#define WHITE     4.0
#define WHITE_TOO 0x1.9b8f9e5378996p+2 /* 0.1 EV above the edge of a histogram bin at log2 6 */

/* Loops with the seeds 1 to FIRST, and those of 48000 that detect a mutation such as < for <= in a line of lib/sensor
 * where no earlier loop detects it. */
static const uint16_t chosen[] = {305,   312,   326,   344,   450,   472,   525,   606,   658,   698,   772,   798,
                                  887,   918,   938,   946,   961,   1003,  1060,  1089,  1182,  1202,  1216,  1229,
                                  1247,  1252,  1318,  1348,  1495,  1641,  1904,  2046,  2150,  2153,  3107,  3109,
                                  3579,  3926,  4202,  4810,  4986,  6283,  6344,  6419,  7073,  7551,  8409,  10987,
                                  12052, 12226, 12934, 13763, 15463, 15497, 15574, 16572, 16954, 19651, 21184, 22034,
                                  24246, 27373, 28654, 30321, 32228, 36397, 39861, 40055, 41085, 44807, 46651};
enum { FIRST = 300, LOOPS = FIRST + sizeof chosen / sizeof chosen[0] };

typedef struct grid_camera {
    uint32_t delay[2];
    telling told;
    double unit[2];   /* the metadata are this many times as large */
    double answer[2]; /* stops of the picture for one of the control */
    double jump_gain; /* from this gain on the picture has `jump` more; 0: none */
    int jump;
    int rounds;    /* exposures, to powers of two */
    int has_bins;  /* a histogram */
    int is_level;  /* no statistics: pupil_sensor_scene */
    int is_bright; /* some pixels' brightest channel is at white */
    int spread;    /* bins from the mean to its brightest pixels */
    clocks clock;
    int loses; /* one frame in so many */
    double frame_s;
} grid_camera;

typedef struct grid_loop {
    grid_camera camera;
    pupil_sensor_config config;
    pupil_sensor sensor;
    pupil_sensor_setting s;
    double asked[SCRIPTED_RING][2]; /* after frame i % SCRIPTED_RING */
    int light, ramp;                /* 1/2000 EV, and in a frame */
    uint64_t clipped, black, top;   /* of 2000 pixels; top: in the brightest bin */
    int frame;
    uint64_t sequence, digest;
} grid_loop;

static int below(int n)
{
    return (int)(check_random() % (uint64_t)n);
}

static int one_in(int n)
{
    return below(n) == 0;
}

/* A step up or down, of a size that the loop may compare with; the first are the most. */
static int step(void)
{
    const int size =
        (int)PICK(5, 10, 20, 40, 50, 100, 100, 120, 125, 200, 200, 210, 250, 300, 300, 400, 450, 500, 500, 600, 600,
                  700, 800, 900, 1000, 1400, 2000, 2000, 2100, 3000, 4000, 4400, 6000, 12000, 18000);
    return one_in(2) ? size : -size;
}

static double step_ev(void)
{
    return (double)step() / EV;
}

/* Such a share of 2000 pixels. */
static uint64_t share(void)
{
    return (uint64_t)PICK(1, 2, 4, 10, 20, 40, 40, 60, 80, 100, 160, 200, 400, 500, 800, 980, 1000, 1000, 1020, 1280,
                          1580, 1780, 1880, 1940, 1940, 1980);
}

static grid_camera random_camera(void)
{
    grid_camera c = {.frame_s = PICK(0.03125, 0.5, 1.0)};
    for (int i = 0; i < 2; i++) {
        c.delay[i] = 1 + (uint32_t)below(4);
        c.answer[i] =
            one_in(2) ? 1.0 : PICK(0.0, 0.1, 0.3, 0.45, 0.5, 0.7, 0.8, 0.85, 0.9, 1.1, 1.25, 1.5, 2.0, 2.2, 4.0);
        c.unit[i] = one_in(8) ? exact_exp2(step_ev()) : 1.0;
    }
    c.delay[1] = one_in(2) ? c.delay[0] : c.delay[1];
    c.told = (telling)(one_in(2) ? below(TOLD_FIRST + 1) : TOLD_TRUTH);
    c.jump_gain = one_in(3) ? PICK(0.5, 2.0, 4.0) : 0.0;
    c.jump = step();
    c.rounds = one_in(4);
    c.has_bins = one_in(2);
    c.is_level = !c.has_bins && one_in(3);
    c.is_bright = one_in(3);
    c.spread = below(20);
    c.loses = one_in(6) ? 2 + below(4) : 24;
    c.clock = one_in(8) ? CLOCK_NONE : one_in(8) ? CLOCK_GOES_BACK : CLOCK_RIGHT;
    return c;
}

/* After each number one that is a part in 1e9 larger: up to there two numbers count as the same. */
static void double_up(double *table, uint32_t *count)
{
    *count *= 2;
    for (uint32_t i = *count; i > 0; i--)
        table[i - 1] = i % 2 ? table[i / 2] : table[i / 2 - 1] * (1.0 + 1e-9);
}

static void set_tables(pupil_sensor_config *c)
{
    const double exposure_ev = PICK(1.0, 0.5, 0.25, 2.0, 0.15, 0.3, 0.05),
                 gain_ev = PICK(1.0, 0.5, 0.25, 2.0, 0.15, 0.3);
    c->exposure_count = one_in(2) ? 0 : 2 + (uint32_t)below(9);
    for (uint32_t i = 0; i < c->exposure_count; i++)
        c->exposure_table[i] = exact_exp2(exposure_ev * ((int)i - (int)c->exposure_count / 2));
    c->gain_law =
        (uint32_t)PICK(PUPIL_GAIN_TABLE, PUPIL_GAIN_TABLE, PUPIL_GAIN_LINEAR, PUPIL_GAIN_ANY, PUPIL_GAIN_RECIPROCAL);
    c->gain_step = c->gain_law == PUPIL_GAIN_RECIPROCAL ? PICK(4.0, 256.0) : PICK(0.25, 0.0625, 1.0);
    c->gain_count = c->gain_law == PUPIL_GAIN_TABLE ? 1 + (uint32_t)below(8) : 0;
    for (uint32_t i = 0; i < c->gain_count; i++)
        c->gain_table[i] = c->gain_min * exact_exp2(gain_ev * i);
    if (one_in(2)) {
        double_up(c->exposure_table, &c->exposure_count);
        double_up(c->gain_table, &c->gain_count);
    }
}

static pupil_sensor_config random_config(const grid_camera *camera)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.delay_frames = one_in(2) ? camera->delay[0] : 1 + (uint32_t)below(4);
    c.clip = PICK(WHITE, WHITE, WHITE_TOO);
    c.key = 1.0 / c.clip;
    c.highlight_share = PICK(0.05, 0.01, 0.2);
    c.highlight_ev = PICK(1.0, 0.0, 2.0);
    c.far_ev = PICK(0.1, 0.05, 0.02, 0.2);
    c.tau_s = PICK(0.8, 0.0, 0.2);
    c.hold_ev = PICK(0.05, 0.0, 0.125, 0.1);
    c.digital_ev = PICK(1.5, 0.0, 0.5);
    c.flash_frames = (uint32_t)PICK(2, 0, 1);
    c.frame_rate_priority = one_in(3);
    c.frame_s = c.frame_rate_priority ? PICK(1.0, 16.0) : camera->frame_s;
    c.exposure_min_s = PICK(0.0625, 0.015625, 0.25);
    c.exposure_max_s = PICK(16.0, 4.0, 1.0, 256.0);
    c.exposure_step_s = PICK(0.0, 0.015625, 0.0625);
    c.mains_hz = (uint32_t)PICK(0, 0, 50, PUPIL_SENSOR_MAINS_AUTO);
    c.gain_min = PICK(1.0, 0.25);
    c.gain_max = PICK(16.0, 4.0, 1.0, 2.0);
    c.linear = !one_in(4);
    c.day_night_s = PICK(0.0, 0.5);
    c.day_ev = PICK(0.5, 1.0);
    c.night_ev = PICK(0.5, -1.0, 0.0);
    c.manual_exposure_s = c.manual_gain = 2.0;
    set_tables(&c);
    return c;
}

static void take_setting(grid_loop *l)
{
    const int place = (l->frame + SCRIPTED_RING - 1) % SCRIPTED_RING;
    CHECK(pupil_sensor_get(&l->sensor, &l->s) == PUPIL_OK);
    l->asked[place][0] = l->s.exposure_s;
    l->asked[place][1] = l->s.gain;
    l->digest = scripted_digest(l->digest, &l->s);
}

static void retune(grid_loop *l)
{
    pupil_sensor_config *c = &l->config;
    const uint32_t mode = (uint32_t)below(PUPIL_SENSOR_MODE_COUNT);
    const int which = below(8);
    c->exposure_mode = which < 2 ? mode : c->exposure_mode;
    c->gain_mode = which == 1 || which == 2 ? mode : c->gain_mode;
    c->lock = which == 3 ? (uint32_t)below(2) : c->lock;
    c->ev_compensation = which == 4 ? step_ev() : c->ev_compensation;
    c->gain_max = which == 5 ? 2.0 : c->gain_max;
    c->highlight_ev = which == 6 ? PICK(0.0, 1.0) : c->highlight_ev;
    c->clip = which == 7 ? PICK(2.0, 8.0) : c->clip;
    CHECK(pupil_sensor_retune(&l->sensor, c) == PUPIL_OK);
}

static void call(grid_loop *l)
{
    if (one_in(2)) {
        const double ev = one_in(4) ? PICK(-32.0, 32.0) : step_ev();
        const uint32_t frames = one_in(8) ? 1000 : 1 + (uint32_t)below(8), change = (uint32_t)below(2);
        CHECK(pupil_sensor_announce(&l->sensor, ev, frames, change) == PUPIL_OK);
    } else {
        const double exposure_s = PICK(1.0, 0x1p-64, 0x1p64, 0.25), gain = PICK(1.0, 1.0, 0x1p-64, 0x1p64);
        CHECK(pupil_sensor_start(&l->sensor, exposure_s, gain) == PUPIL_OK);
    }
    take_setting(l);
}

static void happen(grid_loop *l)
{
    const int which = below(14);
    if (which == 0)
        retune(l);
    else if (which == 1)
        call(l);
    else if (which == 2)
        l->ramp = one_in(2) ? 0 : below(200) - 100;
    else if (which == 3)
        l->clipped = one_in(2) ? 0 : share();
    else if (which == 4)
        l->black = one_in(2) ? 0 : share();
    else if (which == 5)
        l->top = one_in(2) ? 0 : share();
    else if (which == 6)
        l->camera.has_bins ^= one_in(4);
    else if (which == 7)
        l->light = one_in(2) ? 0 : EV * (below(9) - 4);
    else
        l->light += step();
    if (which > 7 && one_in(3)) /* from 0 on */
        l->light = step();
}

/* Fills the mean's bin, the bin of the `top` pixels above it, and one with as many below. */
static void put_bins(const grid_loop *l, pupil_stats *stats, double ev)
{
    const double whole = floor(ev);
    const int bin = 8 * (int)(whole + 32.0) + (int)(8.0 * (exact_exp2(ev - whole) - 1.0));
    const uint64_t rest = EV - l->top, low = l->top < rest ? l->top : rest;
    const uint64_t white = l->camera.is_bright ? l->top : 0;
    stats->has_histogram = 1;
    stats->bin[bin + l->camera.spread] += l->top;
    stats->bin[bin - l->camera.spread / 2] += low;
    stats->bin[bin] += rest - low;
    stats->peak_bin[bin / 2] = EV - white;
    stats->peak_bin[4 * (32 + 2)] += white;
    stats->peak = l->camera.is_bright ? (float)WHITE : (float)exact_exp2(0.25 * (bin / 2 + 1) - 32.0);
}

static pupil_frame_info info_of(const grid_loop *l, const double made[2])
{
    const grid_camera *c = &l->camera;
    const double *said = c->told == TOLD_ASKED ? l->asked[(l->frame + SCRIPTED_RING - 1) % SCRIPTED_RING] : made;
    const double odd = one_in(100) ? PICK(0x1p64, 0x1p-64, 0x1.8p64, 0x1.8p-65) : 0.0;
    pupil_frame_info info = {.size_bytes = sizeof info,
                             .timestamp_ns = 1000000000 + (int64_t)(l->frame * c->frame_s * 1e9),
                             .sequence = l->sequence,
                             .exposure_s = c->unit[0] * said[0],
                             .gain = c->unit[1] * said[1]};
    if (c->told == TOLD_NOTHING)
        info.exposure_s = info.gain = 0.0;
    if (c->told == TOLD_FIRST)
        info.exposure_s = info.gain = 1.0;
    if (odd > 0.0)
        *(one_in(2) ? &info.exposure_s : &info.gain) = odd;
    if (c->clock == CLOCK_NONE)
        info.timestamp_ns = 0;
    if (c->clock == CLOCK_GOES_BACK && one_in(8)) /* to the last frame's time, or by two frames more */
        info.timestamp_ns -= (int64_t)(PICK(1.0, 3.0) * c->frame_s * 1e9);
    return info;
}

static void deliver(grid_loop *l)
{
    const grid_camera *c = &l->camera;
    static pupil_stats stats;
    double made[2], level = l->light;
    for (int i = 0; i < 2; i++) {
        made[i] = l->asked[(l->frame + SCRIPTED_RING - (int)c->delay[i]) % SCRIPTED_RING][i];
        if (i == 0 && c->rounds)
            made[i] = exact_exp2(floor(exact_log2(made[i]) + 0.5));
        level += floor(EV * c->answer[i] * exact_log2(made[i]) + 0.5);
    }
    level += c->jump_gain > 0.0 && made[1] >= c->jump_gain ? c->jump : 0;
    level = level > 20.0 * EV ? 20.0 * EV : level < -20.0 * EV ? -20.0 * EV : level;
    const pupil_frame_info info = info_of(l, made);
    if (c->is_level) {
        const double clipped = l->clipped == 1 ? 1e-6 : (double)l->clipped / EV;
        CHECK(pupil_sensor_scene(&l->sensor, level / EV, clipped, &info) == PUPIL_OK);
        return;
    }
    pupil_stats_clear(&stats);
    stats.pixels = stats.weight = EV;
    stats.rows = stats.frame_height = 1;
    stats.log2_sum = (int64_t)level;
    stats.clipped = l->clipped;
    stats.black = l->black;
    if (c->has_bins)
        put_bins(l, &stats, level / EV);
    CHECK(pupil_sensor_frame(&l->sensor, &stats, &info) == PUPIL_OK);
}

static uint64_t run(uint64_t seed)
{
    static grid_loop l;
    const char *why = "";
    memset(&l, 0, sizeof l);
    check_state.random = seed;
    l.camera = random_camera();
    l.config = random_config(&l.camera);
    CHECK_MSG(pupil_sensor_config_check(&l.config, &why) == PUPIL_OK, "%s", why);
    CHECK(pupil_sensor_init(&l.sensor, &l.config) == PUPIL_OK);
    CHECK(pupil_sensor_start(&l.sensor, 1.0, 1.0) == PUPIL_OK);
    for (int i = 0; i < SCRIPTED_RING; i++) {
        l.frame = i;
        take_setting(&l);
    }
    const int rarely = 2 + below(10), frames = one_in(4) ? 3 * FRAMES : FRAMES;
    l.top = one_in(4) ? 0 : share();
    for (l.frame = 0; l.frame < frames;) {
        if (l.frame > 3 && one_in(rarely))
            happen(&l);
        l.light += l.ramp;
        l.sequence += one_in(60) ? (uint64_t)PICK(0, 15, 16, 31, 32) : 1;
        if (!one_in(l.camera.loses))
            deliver(&l);
        l.frame++;
        take_setting(&l);
    }
    return l.digest;
}

int main(int argc, char **argv)
{
    static char line[LINE_BYTES];
    const expected_lines table = expected_begin("grid_loops.txt", argc, argv);
    for (int i = 0; table.file && i < LOOPS; i += IN_GROUP) {
        uint64_t digest = 0;
        for (int k = i; k < i + IN_GROUP && k < LOOPS; k++)
            digest = (digest << 1 | digest >> 63) ^ run(k < FIRST ? (uint64_t)k + 1 : chosen[k - FIRST]);
        snprintf(line, sizeof line, "%2d: digest %016llx\n", i / IN_GROUP, (unsigned long long)digest);
        expected_line(&table, line);
    }
    return expected_end(&table);
}
