/* What the loop does with cameras of every fault that docs/camera-answers.md has a rule for, in lights that change: a
 * line for each camera and light, compared with loops.txt. Lines that differ are what a change of the loop does; where
 * that is meant, --write puts them there, and the commit says why they are better.
 *
 *     off       frames in which the sensor is over 0.25 EV off
 *     asked     settings that were asked for
 *     sensor, shown, scene  how far these are off on average, in 1/1000 EV: the setting, what is shown, scene_ev
 *     ms, gain  the last setting; then the delays and the slope that were found, the mask of all limits that it was
 *               at, and how often day and night changed
 *     state     and for how many frames: Empty, Searching, Converged, Limited, cLipped (X), Flicker, locKed; and why at
 *               last */
#include <math.h>
#include <stdio.h>

#include "check.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { WIDTH = 48, FRAMES = 150, MOST_DELAY = 8, ASKS = FRAMES + MOST_DELAY + 1, LINE_BYTES = 240 };

#define KEY    0.18
#define LINE_S 20e-6

/* What info says. */
typedef enum telling { TOLD_TRUTH, TOLD_NOTHING, TOLD_ASKED, TOLD_FIRST, TOLD_HALF, TOLD_LATE } telling;

typedef enum exposures { LINES, POWERS_OF_TWO, THREE_EXPOSURES, HALF_STOPS } exposures;
typedef enum gains { SIXTEENTHS, FOUR_GAINS, TWO_GAINS, DECIBELS, RECIPROCAL } gains;

typedef struct camera {
    const char *name;
    uint32_t delay[2], believed; /* frames; 0: 2 */
    telling told;
    exposures exposures;
    gains gains;
    double slope;                   /* of the picture's log2 over the light's; 0: 1 */
    double jump_gain, jump;         /* from this gain on it does so many times more */
    double weak[2];                 /* stops for one of the control; 0: 1; -1: none */
    double knee;                    /* values above it rise 16 times more slowly; 0: 1 */
    double black, white;            /* added to all values; where they are full, 0: 1 */
    double lamp;                    /* this share of the scene is five stops brighter */
    int own_auto_from, own_auto_to; /* frames in which the camera decides itself */
    double fps;                     /* 0: 30 */
    double lamp_hz;                 /* all light beats by 0.08 EV; 0: it does not */
    int has_no_clock;               /* info is NULL */
    int loses;                      /* one frame in so many */
    uint32_t mains_hz;
    int is_curved;       /* linear = 0 */
    double key_at_night; /* below 2 EV of light; 0: none */
    double day_night_s;
    uint32_t stages;
    double highlight_ev, gain_max; /* 0: by default */
} camera;

static const camera cameras[] = {
    {.name = "plain"},
    {.name = "delay 1", .delay = {1, 1}, .believed = 1},
    {.name = "delay 4, believed 2", .delay = {4, 4}},
    {.name = "delay 1, believed 4", .delay = {1, 1}, .believed = 4, .told = TOLD_NOTHING},
    {.name = "delays 3 and 1", .delay = {3, 1}, .believed = 3, .told = TOLD_NOTHING},
    {.name = "delays 1 and 2, told asked", .delay = {1, 2}, .believed = 4, .told = TOLD_ASKED},
    {.name = "tells nothing", .told = TOLD_NOTHING},
    {.name = "tells what was first", .told = TOLD_FIRST},
    {.name = "tells half", .told = TOLD_HALF},
    {.name = "tells late", .told = TOLD_LATE},
    {.name = "powers of two", .exposures = POWERS_OF_TWO},
    {.name = "powers of two, untold", .exposures = POWERS_OF_TWO, .told = TOLD_NOTHING},
    {.name = "powers of two, no gain", .exposures = POWERS_OF_TWO, .gain_max = 1.0},
    {.name = "the same, untold", .exposures = POWERS_OF_TWO, .gain_max = 1.0, .told = TOLD_NOTHING, .slope = 0.7},
    {.name = "three exposures", .exposures = THREE_EXPOSURES},
    {.name = "half stops, 50 Hz", .exposures = HALF_STOPS, .mains_hz = 50},
    {.name = "four gains", .gains = FOUR_GAINS},
    {.name = "two gains", .gains = TWO_GAINS, .mains_hz = 50},
    {.name = "decibels", .gains = DECIBELS, .mains_hz = 60},
    {.name = "reciprocal", .gains = RECIPROCAL, .told = TOLD_NOTHING},
    {.name = "gamma", .slope = 0.5, .is_curved = 1},
    {.name = "gamma, taken for linear", .slope = 0.5, .told = TOLD_NOTHING},
    {.name = "steep", .slope = 1.8, .is_curved = 1, .delay = {3, 3}, .believed = 4},
    {.name = "gain jumps", .jump_gain = 3.0, .jump = 1.5, .told = TOLD_NOTHING},
    {.name = "gain falls", .jump_gain = 4.0, .jump = 0.7, .is_curved = 1},
    {.name = "weak gain", .weak = {0.0, 0.5}, .told = TOLD_NOTHING},
    {.name = "strong exposure", .weak = {1.6, 0.0}, .told = TOLD_NOTHING, .is_curved = 1},
    {.name = "dead exposure", .weak = {-1.0, 0.0}, .told = TOLD_NOTHING},
    {.name = "dead exposure, believed", .weak = {-1.0, 0.0}},
    {.name = "dead gain", .weak = {0.0, -1.0}},
    {.name = "all dead", .weak = {-1.0, -1.0}, .told = TOLD_NOTHING},
    {.name = "coarse, gain jumps", .gains = FOUR_GAINS, .jump_gain = 2.0, .jump = 1.4, .told = TOLD_NOTHING},
    {.name = "coarse, gain falls", .gains = FOUR_GAINS, .jump_gain = 4.0, .jump = 0.7, .weak = {1.3, 0.0}},
    {.name = "all coarse, gain jumps",
     .exposures = THREE_EXPOSURES,
     .gains = FOUR_GAINS,
     .jump_gain = 4.0,
     .jump = 1.5},
    {.name = "all coarse, curved", .exposures = POWERS_OF_TWO, .gains = FOUR_GAINS, .slope = 0.6, .told = TOLD_NOTHING},
    {.name = "all coarse, weak",
     .exposures = POWERS_OF_TWO,
     .gains = TWO_GAINS,
     .weak = {0.7, 0.6},
     .told = TOLD_FIRST},
    {.name = "rounded, weak gain",
     .exposures = POWERS_OF_TWO,
     .weak = {0.0, 0.6},
     .is_curved = 1,
     .told = TOLD_NOTHING},
    {.name = "knee", .knee = 0.1, .is_curved = 1, .told = TOLD_NOTHING},
    {.name = "black level", .black = 0.07},
    {.name = "full at 0.8", .white = 0.8},
    {.name = "full at 0.6", .white = 0.6},
    {.name = "lamp", .lamp = 0.1},
    {.name = "lamp, not held back", .lamp = 0.1, .highlight_ev = -1.0},
    {.name = "its own auto", .own_auto_from = 20, .own_auto_to = 90, .told = TOLD_NOTHING},
    {.name = "its own auto, told", .own_auto_from = 40, .own_auto_to = 70},
    {.name = "loses a third", .loses = 3},
    {.name = "loses a seventh, untold", .loses = 7, .told = TOLD_NOTHING, .delay = {4, 4}, .believed = 4},
    {.name = "night", .key_at_night = 0.06, .day_night_s = 0.5},
    {.name = "lamps", .lamp_hz = 100.05, .fps = 32.0, .delay = {3, 3}, .believed = 3},
    {.name = "lamps, mains unknown",
     .lamp_hz = 120.1,
     .fps = 32.5,
     .mains_hz = PUPIL_SENSOR_MAINS_AUTO,
     .told = TOLD_NOTHING},
    {.name = "no clock", .has_no_clock = 1},
    {.name = "stages", .stages = 1, .mains_hz = 50},
};
enum { CAMERAS = sizeof cameras / sizeof cameras[0] };

typedef enum event_kind {
    LIGHT = 1, /* is so many EV from the frame on */
    RAMP,      /* so many EV more in each frame */
    FLASH,     /* so many EV more in two frames */
    COVERED,   /* black for so many frames */
    HALF_DARK, /* this share of the scene is black from the frame on */
    ANNOUNCED, /* light by so many EV, three frames before it comes */
    FILTER,    /* the same, of a filter; which never comes where it is negative */
    EXPOSURE_MODE,
    GAIN_MODE,
    LOCK,
    GAIN_MAX,
    FRAME_PERIOD /* 1 / 30 s times so much */
} event_kind;

typedef struct event {
    int frame;
    event_kind kind;
    double value;
} event;

typedef struct light {
    const char *name;
    event events[8];
} light;

static const light lights[] = {
    {"room, sun, room", {{0, LIGHT, 4.0}, {50, LIGHT, 8.5}, {100, LIGHT, 4.6}}},
    {"dark, less, dim", {{0, LIGHT, -0.5}, {60, LIGHT, -2.3}, {105, LIGHT, 1.3}}},
    {"ramps", {{0, LIGHT, 3.0}, {30, RAMP, 0.03}, {60, RAMP, -0.06}, {110, RAMP, 0.0}}},
    {"flashes, cover", {{0, LIGHT, 2.0}, {25, FLASH, 4.0}, {45, FLASH, -3.0}, {70, COVERED, 12}, {110, LIGHT, 11.0}}},
    {"announced", {{0, LIGHT, 5.0}, {30, ANNOUNCED, -2.5}, {60, FILTER, 3.0}, {90, FILTER, -2.0}, {120, LIGHT, 4.0}}},
    {"modes",
     {{0, LIGHT, 1.0},
      {30, GAIN_MODE, PUPIL_SENSOR_MANUAL},
      {50, EXPOSURE_MODE, PUPIL_SENSOR_HELD},
      {60, LIGHT, 2.5},
      {70, GAIN_MODE, PUPIL_SENSOR_AUTO},
      {90, LOCK, 1},
      {100, LIGHT, 1.7},
      {110, LOCK, 0}}},
    {"limits",
     {{0, LIGHT, -4.0}, {40, GAIN_MAX, 4.0}, {70, FRAME_PERIOD, 2.0}, {90, LIGHT, 13.0}, {120, EXPOSURE_MODE, 1}}},
    {"steps",
     {{0, LIGHT, 4.01},
      {22, LIGHT, 2.90},
      {44, LIGHT, 3.52},
      {66, LIGHT, 3.16},
      {88, LIGHT, 3.05},
      {110, LIGHT, 3.76},
      {132, LIGHT, 3.75}}},
    {"half dark",
     {{0, LIGHT, 3.0}, {30, HALF_DARK, 0.54}, {36, HALF_DARK, 0.3}, {75, LIGHT, 5.0}, {110, HALF_DARK, 0}}},
    {"held",
     {{0, LIGHT, 2.9},
      {30, GAIN_MODE, PUPIL_SENSOR_HELD},
      {30, EXPOSURE_MODE, PUPIL_SENSOR_HELD},
      {50, LIGHT, 4.0},
      {70, EXPOSURE_MODE, PUPIL_SENSOR_AUTO},
      {90, GAIN_MODE, PUPIL_SENSOR_AUTO},
      {110, LIGHT, 0.3}}},
    {"creeps", {{0, LIGHT, 6.0}, {20, RAMP, -0.005}, {80, RAMP, 0.01}, {115, LIGHT, 6.4}, {130, LIGHT, 6.05}}},
};
enum { LIGHTS = sizeof lights / sizeof lights[0] };

static double or_else(double value, double usual)
{
    return value == 0.0 ? usual : value;
}

static void set_table(double *table, uint32_t *count, double first, double times, uint32_t n)
{
    *count = n;
    for (uint32_t i = 0; i < n; i++)
        table[i] = i ? table[i - 1] * times : first;
}

static pupil_sensor_config config_of(const camera *c)
{
    pupil_sensor_config config;
    pupil_sensor_config_default(&config);
    config.frame_s = 1.0 / or_else(c->fps, 30.0);
    config.delay_frames = c->believed ? c->believed : 2;
    config.exposure_min_s = config.exposure_step_s = LINE_S;
    config.gain_law = PUPIL_GAIN_LINEAR;
    config.gain_max = or_else(c->gain_max, config.gain_max);
    config.mains_hz = c->mains_hz;
    config.linear = !c->is_curved;
    config.manual_exposure_s = 0.01;
    config.manual_gain = 2.0;
    config.highlight_ev = c->highlight_ev < 0.0 ? 0.0 : config.highlight_ev;
    config.day_night_s = c->day_night_s;
    config.day_ev = 3.0;
    config.night_ev = 1.5;
    if (c->key_at_night > 0.0) {
        config.key_points = 2;
        config.key_at[0] = (pupil_key_point){0.0, c->key_at_night};
        config.key_at[1] = (pupil_key_point){4.0, KEY};
    }
    config.stages = c->stages;
    config.stage[0] = (pupil_sensor_stage){0.01, 4.0};
    if (c->gains == DECIBELS || c->gains == RECIPROCAL) {
        config.gain_law = c->gains == DECIBELS ? PUPIL_GAIN_DB : PUPIL_GAIN_RECIPROCAL;
        config.gain_step = c->gains == DECIBELS ? 0.3 : 256.0;
    }
    if (c->exposures == THREE_EXPOSURES)
        set_table(config.exposure_table, &config.exposure_count, 0.0005, 7.0, 3);
    if (c->exposures == HALF_STOPS)
        set_table(config.exposure_table, &config.exposure_count, 0.00125, sqrt(2.0), 10);
    if (c->gains == FOUR_GAINS || c->gains == TWO_GAINS) {
        config.gain_law = PUPIL_GAIN_TABLE;
        set_table(config.gain_table, &config.gain_count, 1.0, c->gains == TWO_GAINS ? 8.0 : 2.0,
                  c->gains == TWO_GAINS ? 2 : 4);
        config.gain_max = 8.0;
    }
    return config;
}

typedef struct loop {
    const camera *camera;
    pupil_sensor_config config;
    pupil_sensor sensor;
    pupil_sensor_setting s;
    pupil_t meter;
    double asked[ASKS][2]; /* in force in frame i, if the controls do as they are asked */
    double light_ev, ramp_ev, awaited_ev;
    int flash_frames, covered_frames, awaited_frames;
    double flash_ev, dark_share;
    int frame;
    /* of the line */
    int off, settings;
    double sensor_ev, shown_ev, scene_off_ev, scene_ev;
    uint32_t limits, day_night;
    int day_changes;
    char states[96];
    char last;
    int repeats;
} loop;

static void ask_from(loop *l, int first)
{
    for (int c = 0; c < 2; c++)
        for (int i = first - 1 + (int)or_else(l->camera->delay[c], 2); i < ASKS; i++)
            l->asked[i][c] = c ? l->s.gain : l->s.exposure_s;
}

/* What the camera makes of what it was asked for. */
static void make(const loop *l, int frame, double made[2])
{
    const camera *c = l->camera;
    const double *asked = l->asked[frame];
    made[0] = c->weak[0] < 0.0 ? 0.004 : asked[0];
    made[1] = c->weak[1] < 0.0 ? 1.5 : asked[1];
    if (frame >= c->own_auto_from && frame < c->own_auto_to) {
        made[0] = 0.006;
        made[1] = 2.0;
    }
    if (c->exposures == POWERS_OF_TWO)
        made[0] = exp2(round(log2(made[0])));
}

/* Stops of the light that the setting lets through. */
static double effect_of(const camera *c, const double made[2])
{
    const double strange = made[1] >= or_else(c->jump_gain, (double)INFINITY) ? log2(c->jump) : 0.0;
    const double exposure = c->weak[0] > 0.0 ? c->weak[0] : 1.0, gain = c->weak[1] > 0.0 ? c->weak[1] : 1.0;
    return exposure * log2(made[0] / 0.01) + log2(0.01) + gain * log2(made[1]) + strange;
}

static uint16_t code_of(const camera *c, double ev)
{
    const double x = KEY * exp2(or_else(c->slope, 1.0) * ev), knee = or_else(c->knee, 1.0);
    return (uint16_t)lround(4095.0 *
                            fmin((x > knee ? knee + (x - knee) / 16.0 : x) + c->black, or_else(c->white, 1.0)));
}

static pupil_frame_info info_of(const loop *l, const double made[2])
{
    pupil_frame_info info = {.size_bytes = sizeof info,
                             .timestamp_ns = 1000000000 + (int64_t)(l->frame * 1e9 / or_else(l->camera->fps, 30.0)),
                             .sequence = (uint64_t)l->frame + 1,
                             .exposure_s = made[0],
                             .gain = made[1]};
    const double *said = made;
    double before[2];
    if (l->camera->told == TOLD_NOTHING)
        info.exposure_s = info.gain = 0.0;
    if (l->camera->told == TOLD_ASKED)
        said = l->asked[ASKS - 1];
    if (l->camera->told == TOLD_FIRST)
        said = l->asked[0];
    if (l->camera->told == TOLD_LATE && l->frame > 0) {
        make(l, l->frame - 1, before);
        said = before;
    }
    if (l->camera->told != TOLD_NOTHING) {
        info.exposure_s = said[0] * (l->camera->told == TOLD_HALF ? 0.5 : 1.0);
        info.gain = said[1];
    }
    return info;
}

/* How far the frame is from the key, stops of the light. */
static double read_frame(loop *l, uint16_t *pixels, const double made[2])
{
    const camera *c = l->camera;
    const double beat_ev =
        c->lamp_hz > 0.0 ? 0.08 * sin(2.0 * 3.141592653589793 * c->lamp_hz * l->frame / or_else(c->fps, 30.0)) : 0.0;
    const double light_ev = l->light_ev + beat_ev + (l->flash_frames > 0 ? l->flash_ev : 0.0);
    l->scene_ev = light_ev;
    const double ev = light_ev + effect_of(c, made) - log2(KEY);
    for (int x = 0; x < WIDTH; x++) {
        const double lamp = x < c->lamp * WIDTH ? 5.0 : 0.0;
        pixels[x] = l->covered_frames > 0 || (x * 29) % WIDTH < l->dark_share * WIDTH
                        ? 0
                        : code_of(c, ev + lamp + 4.0 * ((x + 0.5) / WIDTH - 0.5));
    }
    l->flash_frames--;
    l->covered_frames--;
    return ev;
}

static void count_state(loop *l, char state)
{
    const size_t n = strlen(l->states);
    if (l->repeats && state != l->last) {
        snprintf(l->states + n, sizeof l->states - n, "%c%d ", l->last, l->repeats);
        l->repeats = 0;
    }
    l->last = state;
    l->repeats++;
}

static void take_setting(loop *l)
{
    CHECK(pupil_sensor_get(&l->sensor, &l->s) == PUPIL_OK);
    l->settings += l->s.changed != 0;
    ask_from(l, l->frame);
}

static void happen(loop *l, const event *e)
{
    pupil_sensor_config *c = &l->config;
    switch (e->kind) {
    case LIGHT:
        l->light_ev = e->value;
        l->ramp_ev = 0.0;
        return;
    case RAMP:
        l->ramp_ev = e->value;
        return;
    case FLASH:
        l->flash_ev = e->value;
        l->flash_frames = 2;
        return;
    case COVERED:
        l->covered_frames = (int)e->value;
        return;
    case HALF_DARK:
        l->dark_share = e->value;
        return;
    case ANNOUNCED:
    case FILTER:
        l->awaited_ev = e->value;
        l->awaited_frames = e->kind == FILTER && e->value < 0.0 ? 0 : 3;
        CHECK(pupil_sensor_announce(&l->sensor, e->value, 8,
                                    e->kind == FILTER ? PUPIL_SENSOR_CHANGE_FILTER : PUPIL_SENSOR_CHANGE_LIGHT) ==
              PUPIL_OK);
        take_setting(l);
        return;
    case EXPOSURE_MODE:
        c->exposure_mode = (uint32_t)e->value;
        break;
    case GAIN_MODE:
        c->gain_mode = (uint32_t)e->value;
        break;
    case LOCK:
        c->lock = (uint32_t)e->value;
        break;
    case GAIN_MAX:
        c->gain_max = e->value;
        break;
    case FRAME_PERIOD:
        c->exposure_max_s *= e->value;
        c->frame_s *= e->value;
        break;
    }
    CHECK(pupil_sensor_retune(&l->sensor, c) == PUPIL_OK);
    take_setting(l);
}

static void one_frame(loop *l)
{
    static uint16_t pixels[WIDTH];
    static pupil_stats stats;
    const pupil_image_const image = {.size_bytes = sizeof image,
                                     .pixel = PUPIL_PIXEL_GREY12,
                                     .data = pixels,
                                     .stride_bytes = sizeof pixels,
                                     .width = WIDTH,
                                     .height = 1};
    double made[2];
    l->light_ev += l->ramp_ev + (l->awaited_frames == 1 ? l->awaited_ev : 0.0);
    l->awaited_frames -= l->awaited_frames > 0;
    make(l, l->frame, made);
    const pupil_frame_info info = info_of(l, made);
    const double off_ev = read_frame(l, pixels, made);
    if (!l->camera->loses || l->frame % l->camera->loses != 1) {
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&l->meter, &image, 0, 1, &stats) == PUPIL_OK);
        CHECK(pupil_sensor_frame(&l->sensor, &stats, l->camera->has_no_clock ? NULL : &info) == PUPIL_OK);
    }
    l->frame++;
    take_setting(l);
    l->off += fabs(off_ev) > 0.25;
    l->sensor_ev += fabs(off_ev) / FRAMES;
    l->shown_ev += fabs(or_else(l->camera->slope, 1.0) * off_ev + log2(l->s.frame_digital)) / FRAMES;
    l->scene_off_ev += l->s.frames ? fabs(l->s.scene_ev - l->scene_ev) / FRAMES : 0.0;
    l->limits |= l->s.limits;
    l->day_changes += l->s.day_night != l->day_night;
    l->day_night = l->s.day_night;
    count_state(l, "ESCLXFK"[l->s.state]);
}

static void run(const camera *c, const light *at, char line[LINE_BYTES])
{
    static loop l;
    pupil_config metering;
    memset(&l, 0, sizeof l);
    l.camera = c;
    l.config = config_of(c);
    pupil_config_default(&metering);
    metering.histogram = 1;
    CHECK(pupil_init(&l.meter, &metering) == PUPIL_OK && pupil_sensor_init(&l.sensor, &l.config) == PUPIL_OK);
    CHECK(pupil_sensor_get(&l.sensor, &l.s) == PUPIL_OK);
    for (int i = 0; i < ASKS; i++) {
        l.asked[i][0] = l.s.exposure_s;
        l.asked[i][1] = l.s.gain;
    }
    for (const event *e = at->events; l.frame < FRAMES;) {
        if (e->kind && e->frame == l.frame && e < at->events + 8)
            happen(&l, e++);
        else
            one_frame(&l);
    }
    count_state(&l, 0);
    snprintf(line, LINE_BYTES, "%-27s %-16s %3d %3d %5.0f %5.0f %5.0f %7.3f %7.4f %2u %2u %.3f %02x %d %s%s\n", c->name,
             at->name, l.off, l.settings, 1e3 * l.sensor_ev, 1e3 * l.shown_ev, 1e3 * l.scene_off_ev,
             1e3 * l.s.exposure_s, l.s.gain, l.s.exposure_delay, l.s.gain_delay, l.s.slope, l.limits, l.day_changes,
             l.states, pupil_sensor_reason_name(l.s.reason));
}

int main(int argc, char **argv)
{
    static const char path[] = PUPIL_SOURCE_DIR "/tests/sensor/loops.txt";
    const int writes = argc == 2 && strcmp(argv[1], "--write") == 0;
    static char line[LINE_BYTES], expected[LINE_BYTES];
    check_begin(writes ? 1 : argc, argv);
    FILE *file = fopen(path, writes ? "w" : "r");
    CHECK_MSG(file, "%s", path);
    for (int i = 0; file && i < CAMERAS * LIGHTS && check_state.failures < 20; i++) { /* more are not printed */
        run(&cameras[i / LIGHTS], &lights[i % LIGHTS], line);
        if (writes) {
            CHECK(fputs(line, file) >= 0);
            continue;
        }
        const int is_there = fgets(expected, sizeof expected, file) != NULL;
        CHECK_MSG(is_there && strcmp(line, expected) == 0, "loops.txt: %s     now: %s", is_there ? expected : "\n",
                  line);
    }
    CHECK(!file || fclose(file) == 0);
    return check_end();
}
