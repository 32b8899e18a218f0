#include "scripted_loop.h"

#include <string.h>

#include "exact_numbers.h"

enum { WIDTH = 48 };

#define KEY 0.18

static double or_else(double value, double usual)
{
    return value == 0.0 ? usual : value;
}

static void expect_ok(scripted_loop *l, int error)
{
    l->errors += error != PUPIL_OK;
}

/* In [0, 1): xorshift64* (Vigna 2016). */
static double uniform(scripted_loop *l)
{
    l->random ^= l->random >> 12;
    l->random ^= l->random << 25;
    l->random ^= l->random >> 27;
    return (double)(l->random * UINT64_C(0x2545f4914f6cdd1d) >> 11) * 0x1p-53;
}

/* True for this share of the calls, at random; a share of 0 draws no number. */
static int is_one_of(scripted_loop *l, double share)
{
    return share > 0.0 && uniform(l) < share;
}

static void set_table(double *table, uint32_t *count, double first, double times, uint32_t n)
{
    *count = n;
    for (uint32_t i = 0; i < n; i++)
        table[i] = i ? table[i - 1] * times : first;
}

pupil_sensor_config scripted_config(const scripted_camera *c)
{
    pupil_sensor_config config;
    pupil_sensor_config_default(&config);
    config.frame_s = 1.0 / or_else(c->fps, 30.0);
    config.delay_frames = c->believed ? c->believed : 2;
    config.exposure_min_s = config.exposure_step_s = SCRIPTED_LINE_S;
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
        set_table(config.exposure_table, &config.exposure_count, 0.00125, 1.4142135623730951, 10);
    if (c->gains == FOUR_GAINS || c->gains == TWO_GAINS) {
        config.gain_law = PUPIL_GAIN_TABLE;
        set_table(config.gain_table, &config.gain_count, 1.0, c->gains == TWO_GAINS ? 8.0 : 2.0,
                  c->gains == TWO_GAINS ? 2 : 4);
        config.gain_max = 8.0;
    }
    return config;
}

/* The exposure and gain that the camera makes of those asked for. */
static void make(const scripted_loop *l, int frame, double made[2])
{
    const scripted_camera *c = l->camera;
    for (int control = 0; control < 2; control++) {
        const int newest = frame + SCRIPTED_RING - (c->delay[control] ? (int)c->delay[control] : 2);
        made[control] = l->asked[(newest - l->is_late[newest % SCRIPTED_RING]) % SCRIPTED_RING][control];
    }
    made[0] = c->weak[0] < 0.0 ? 0.004 : made[0];
    made[1] = c->weak[1] < 0.0 ? 1.5 : made[1];
    if (frame >= c->own_auto_from && frame < c->own_auto_to) {
        made[0] = 0.006;
        made[1] = 2.0;
    }
    if (c->exposures == POWERS_OF_TWO)
        made[0] = exact_exp2(round(exact_log2(made[0])));
}

/* Stops of the light that the setting lets through. */
static double effect_of(const scripted_camera *c, const double made[2])
{
    const double strange = c->jump_gain > 0.0 && made[1] >= c->jump_gain ? exact_log2(c->jump) : 0.0;
    const double exposure = c->weak[0] > 0.0 ? c->weak[0] : 1.0, gain = c->weak[1] > 0.0 ? c->weak[1] : 1.0;
    return exposure * exact_log2(made[0] / 0.01) + exact_log2(0.01) + gain * exact_log2(made[1]) + strange;
}

static uint16_t code_of(const scripted_camera *c, double ev)
{
    const double x = KEY * exact_exp2(or_else(c->slope, 1.0) * ev), knee = or_else(c->knee, 1.0);
    const double bent = (x > knee ? knee + (x - knee) / 16.0 : x) + c->black, white = or_else(c->white, 1.0);
    return (uint16_t)lround(4095.0 * (bent < white ? bent : white));
}

static int64_t time_of(const scripted_loop *l, int frame)
{
    return 1000000000 + (int64_t)(frame * 1e9 / or_else(l->camera->fps, 30.0));
}

static pupil_frame_info info_of(const scripted_loop *l, const double made[2])
{
    const scripted_camera *c = l->camera;
    pupil_frame_info info = {.size_bytes = sizeof info,
                             .timestamp_ns = time_of(l, l->frame),
                             .sequence = (uint64_t)l->frame + 1,
                             .exposure_s = made[0],
                             .gain = made[1]};
    const double *said = made;
    double before[2];
    if (c->told == TOLD_NOTHING)
        info.exposure_s = info.gain = 0.0;
    if (c->told == TOLD_ASKED)
        said = l->asked[(l->frame + SCRIPTED_RING - 1) % SCRIPTED_RING];
    if (c->told == TOLD_FIRST)
        said = l->first;
    if (c->told == TOLD_LATE && l->frame > 0) {
        make(l, l->frame - 1, before);
        said = before;
    }
    if (c->told != TOLD_NOTHING) {
        info.exposure_s = said[0] * (c->told == TOLD_HALF ? 0.5 : 1.0);
        info.gain = said[1];
    }
    const int is_odd = l->frame % 7 == 5 && (c->clock == CLOCK_REPEATS || c->clock == CLOCK_GOES_BACK);
    if (is_odd) {
        info.timestamp_ns = time_of(l, l->frame - (c->clock == CLOCK_REPEATS ? 1 : 3));
        info.sequence -= c->clock == CLOCK_REPEATS || l->frame % 2;
    }
    if (c->clock == CLOCK_UNCOUNTED)
        info.sequence = 0;
    if (c->clock == CLOCK_NONE)
        info.timestamp_ns = 0;
    return info;
}

/* How far the frame is from the key, stops of the light. */
static double read_frame(scripted_loop *l, uint16_t *pixels, const double made[2])
{
    const scripted_camera *c = l->camera;
    const double beat_ev = c->lamp_hz > 0.0 ? 0.08 * exact_sine(c->lamp_hz * l->frame / or_else(c->fps, 30.0)) : 0.0;
    const double noise_ev = c->noise_ev > 0.0 ? c->noise_ev * (2.0 * uniform(l) - 1.0) : 0.0;
    const double light_ev = l->light_ev + beat_ev + noise_ev + (l->flash_frames > 0 ? l->flash_ev : 0.0);
    l->scene_ev = light_ev;
    const double ev = light_ev + effect_of(c, made) - exact_log2(KEY);
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

/* The prime is that of FNV-1a (Fowler, Noll, Vo); the shift spreads the high bits to all others. */
static uint64_t digest(uint64_t before, uint64_t number)
{
    const uint64_t mixed = (before ^ number) * UINT64_C(0x100000001b3);
    return mixed ^ mixed >> 29;
}

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

uint64_t scripted_digest(uint64_t before, const pupil_sensor_setting *s)
{
    uint64_t all = before;
    const double numbers[] = {s->exposure_s, s->gain,      s->digital,         s->total_s,  s->frame_digital,
                              s->flicker_ev, s->scene_ev,  s->wanted_ev,       s->error_ev, s->dt_s,
                              s->slope,      s->filter_ev, s->mains_modulation};
    const uint32_t counts[] = {s->state,      s->reason,   s->limits, s->changed,  s->exposure_delay,
                               s->gain_delay, s->mains_hz, s->mains,  s->day_night};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        all = digest(all, bits_of(numbers[i]));
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        all = digest(all, counts[i]);
    return digest(all, s->frames);
}

/* After frame - 1. */
static void take_setting(scripted_loop *l)
{
    const int place = (l->frame + SCRIPTED_RING - 1) % SCRIPTED_RING;
    expect_ok(l, pupil_sensor_get(&l->sensor, &l->s));
    l->settings += l->s.changed != 0;
    l->asked[place][0] = l->s.exposure_s;
    l->asked[place][1] = l->s.gain;
    l->digest = scripted_digest(l->digest, &l->s);
}

static void announce(scripted_loop *l, const event *e)
{
    const uint32_t change = e->kind == FILTER ? PUPIL_SENSOR_CHANGE_FILTER : PUPIL_SENSOR_CHANGE_LIGHT;
    l->awaited_ev = e->value;
    l->awaited_frames = e->kind == FILTER && e->value < 0.0 ? 0 : 3;
    expect_ok(l, pupil_sensor_announce(&l->sensor, e->value, 8, change));
    take_setting(l);
}

/* Applies an event of the light. Returns whether it is one. */
static int lights(scripted_loop *l, const event *e)
{
    switch (e->kind) {
    case LIGHT:
        l->light_ev = e->value;
        l->ramp_ev = 0.0;
        return 1;
    case RAMP:
        l->ramp_ev = e->value;
        return 1;
    case FLASH:
        l->flash_ev = e->value;
        l->flash_frames = 2;
        return 1;
    case COVERED:
        l->covered_frames = (int)e->value;
        return 1;
    case HALF_DARK:
        l->dark_share = e->value;
        return 1;
    default:
        return 0;
    }
}

static void happen(scripted_loop *l, const event *e)
{
    pupil_sensor_config *c = &l->config;
    if (lights(l, e))
        return;
    if (e->kind == ANNOUNCED || e->kind == FILTER) {
        announce(l, e);
        return;
    }
    if (e->kind == START) {
        expect_ok(l, pupil_sensor_start(&l->sensor, e->value, 1.0));
        take_setting(l);
        return;
    }
    if (e->kind == EXPOSURE_MODE || e->kind == BOTH_MODES)
        c->exposure_mode = (uint32_t)e->value;
    if (e->kind == GAIN_MODE || e->kind == BOTH_MODES)
        c->gain_mode = (uint32_t)e->value;
    c->lock = e->kind == LOCK ? (uint32_t)e->value : c->lock;
    c->gain_max = e->kind == GAIN_MAX ? e->value : c->gain_max;
    c->exposure_max_s *= e->kind == FRAME_PERIOD ? e->value : 1.0;
    c->frame_s *= e->kind == FRAME_PERIOD ? e->value : 1.0;
    c->ev_compensation = e->kind == COMPENSATION ? e->value : c->ev_compensation;
    c->delay_frames = e->kind == BELIEVED ? (uint32_t)e->value : c->delay_frames;
    expect_ok(l, pupil_sensor_retune(&l->sensor, c));
    take_setting(l);
}

/* Gives the frame to the loop in the camera's form. */
static void deliver(scripted_loop *l, const uint16_t *pixels, const pupil_frame_info *info)
{
    static pupil_stats stats;
    const scripted_camera *c = l->camera;
    const pupil_image_const image = pupil_image_const_of(pixels, WIDTH, 1, PUPIL_PIXEL_GREY12);
    const int is_counted = !is_one_of(l, c->uncounted);
    double mean_ev;
    pupil_stats_clear(&stats);
    if (!is_one_of(l, c->dead))
        expect_ok(l, pupil_meter_rows(&l->meter[is_counted], &image, 0, 1, &stats));
    if (!c->has_levels) {
        expect_ok(l, pupil_sensor_frame(&l->sensor, &stats, info));
        return;
    }
    const double clipped = (double)stats.clipped / (double)(stats.pixels ? stats.pixels : 1);
    const double e = info && info->exposure_s > 0.0 ? info->exposure_s : l->s.exposure_s;
    const double g = info && info->gain > 0.0 ? info->gain : l->s.gain;
    const int is_there = stats.weight && pupil_stats_mean(&stats, 0.0, 1.0, &mean_ev) == PUPIL_OK;
    expect_ok(l, pupil_sensor_scene(&l->sensor, is_there ? mean_ev - exact_log2(e * g) : 1e9, clipped, info));
}

static int is_lost(scripted_loop *l)
{
    const scripted_camera *c = l->camera;
    return (c->loses && l->frame % c->loses == 1) || is_one_of(l, c->drops);
}

void scripted_frame(scripted_loop *l)
{
    static uint16_t pixels[WIDTH];
    const scripted_camera *c = l->camera;
    double made[2];
    while (l->next->kind && l->next->frame == l->frame)
        happen(l, l->next++);
    l->light_ev += l->ramp_ev + (l->awaited_frames == 1 ? l->awaited_ev : 0.0);
    l->awaited_frames -= l->awaited_frames > 0;
    make(l, l->frame, made);
    const pupil_frame_info info = info_of(l, made);
    const double off_ev = read_frame(l, pixels, made);
    if (!is_lost(l))
        deliver(l, pixels, c->has_no_clock ? NULL : &info);
    l->is_late[l->frame % SCRIPTED_RING] = (uint8_t)is_one_of(l, c->jitter);
    l->frame++;
    take_setting(l);
    l->off += fabs(off_ev) > 0.25;
    l->sensor_ev += fabs(off_ev);
    l->shown_ev += fabs(or_else(c->slope, 1.0) * off_ev + exact_log2(l->s.frame_digital));
    l->scene_off_ev += l->s.frames ? fabs(l->s.scene_ev - l->scene_ev) : 0.0;
    l->limits |= l->s.limits;
    l->day_changes += l->s.day_night != l->day_night;
    l->day_night = l->s.day_night;
}

void scripted_open(scripted_loop *l, const scripted_camera *camera, const pupil_sensor_config *config,
                   const script *light)
{
    pupil_config metering;
    memset(l, 0, sizeof *l);
    l->camera = camera;
    l->config = *config;
    l->next = light->events;
    l->random = 1;
    pupil_config_default(&metering);
    for (int i = 0; i < 2; i++) {
        metering.histogram = (uint32_t)i;
        expect_ok(l, pupil_init(&l->meter[i], &metering));
    }
    expect_ok(l, pupil_sensor_init(&l->sensor, &l->config));
    expect_ok(l, pupil_sensor_get(&l->sensor, &l->s));
    l->first[0] = l->s.exposure_s;
    l->first[1] = l->s.gain;
    for (int i = 0; i < SCRIPTED_RING; i++)
        for (int control = 0; control < 2; control++)
            l->asked[i][control] = l->first[control];
}
