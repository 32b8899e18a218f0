#include "sensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "refuse.h"

#define FOLLOW_EV 0.05 /* the leader's own setting does not change for less: hold_ev */
#define SAME_EV   0.01 /* differences by a driver's rounding */

static const char *state_word(const run_sensor *s)
{
    if (s->loop.steers && s->follows)
        return "following";
    if (s->loop.steers && s->loop.refused)
        return "searching";
    return s->loop.steers ? pupil_sensor_state_name(s->loop.setting.state) : "";
}

static const char *reason_word(const run_sensor *s)
{
    if (s->loop.refused)
        return "refused";
    if (s->follows)
        return "";
    return s->loop.steers && s->loop.setting.reason ? pupil_sensor_reason_name(s->loop.setting.reason) : "";
}

/* The camera's limits, and the user's within them. */
static void limit(const run_sensor *s, pupil_sensor_config *c)
{
    const run_options *o = s->options;
    if (o->exposure_max_s > 0.0)
        c->exposure_max_s = fmax(c->exposure_min_s, fmin(c->exposure_max_s, o->exposure_max_s));
    if (o->gain_max > 0.0)
        c->gain_max = fmax(c->gain_min, fmin(c->gain_max, o->gain_max));
    if (s->several && !s->follows)
        run_several_limit(s->several, c);
}

/* Takes over what keys and the control socket can change during a run; 1: something changed. If the picture adapts by
 * itself, the sensor's own level is hidden, and stays where it is best for the sensor. */
static int follow(const run_sensor *s, pupil_sensor_config *config)
{
    const pupil_config *shown = &s->options->shown.config;
    const pupil_sensor_config before = *config;
    pupil_sensor_config camera = *config;
    pupil_camera_configure(s->camera, &camera);
    config->exposure_min_s = camera.exposure_min_s;
    config->exposure_max_s = camera.exposure_max_s;
    config->gain_max = camera.gain_max;
    limit(s, config);
    config->trim_low = (double)shown->trim_low;
    config->trim_high = (double)shown->trim_high;
    config->lock = s->options->locked || s->follows;
    config->night_ev = s->options->night_ev;
    config->day_ev = s->options->day_ev;
    config->day_night_s = s->options->day_night_s;
    if (s->options->mode != RUN_SENSOR)
        return memcmp(config, &before, sizeof before) != 0;
    config->key = shown->key;
    config->key_points = shown->key_points;
    memcpy(config->key_at, shown->key_at, sizeof config->key_at);
    config->ev_compensation = shown->ev_compensation;
    config->lock = shown->lock || s->follows;
    return memcmp(config, &before, sizeof before) != 0;
}

static void configure(const run_sensor *s, pupil_sensor_config *c)
{
    const run_options *o = s->options;
    pupil_sensor_config_default(c);
    c->frame_s = 1.0 / s->source->fps;
    pupil_camera_configure(s->camera, c);
    c->frame_rate_priority = !o->any_frame_rate;
    c->mains_hz = o->live.mains_hz || o->mains_off ? o->live.mains_hz : PUPIL_SENSOR_MAINS_AUTO;
    c->linear = o->curve == RUN_CURVE_AUTO ? (uint32_t)pupil_live_is_linear(s->source) : o->curve == RUN_CURVE_LINEAR;
    if (o->exposure_s > 0.0) {
        c->exposure_mode = PUPIL_SENSOR_MANUAL;
        c->manual_exposure_s = o->exposure_s;
    }
    if (o->gain > 0.0) {
        c->gain_mode = PUPIL_SENSOR_MANUAL;
        c->manual_gain = o->gain;
    }
    follow(s, c);
}

/* Starts from the camera's level, so that its picture does not jump; after a camera has come back, from the wanted
 * level. */
static int steer(run_sensor *s, pupil_why *why)
{
    pupil_sensor_config config;
    configure(s, &config);
    const double total_s = s->loop.steers ? s->loop.setting.total_s : s->first_total_s;
    return pupil_camera_loop_begin(&s->loop, s->camera, &config, total_s, why);
}

void run_sensor_begin(run_sensor *s, const run_options *options, pupil_source *source, const run_several *several)
{
    *s = (run_sensor){.options = options,
                      .source = source,
                      .several = several,
                      .digital = 1.0,
                      .loop = {.setting = {.digital = 1.0, .frame_digital = 1.0}}};
}

int run_sensor_take(run_sensor *s, pupil_why *why)
{
    const run_options *o = s->options;
    pupil_camera *camera = pupil_live_camera(s->source);
    const int is_new = camera && !s->camera;
    s->camera = camera;
    if (!camera)
        pupil_camera_loop_lost(&s->loop);
    else if (!is_new && (!s->loop.steers || !s->loop.setting.frames)) /* no frame was metered yet */
        pupil_camera_loop_retry(&s->loop);
    else if (!is_new)
        return 0;
    else if (o->mode != RUN_DIGITAL)
        return steer(s, why);
    else
        pupil_camera_loop_hold(&s->loop, camera, &(pupil_camera_setting){.exposure_s = o->exposure_s, .gain = o->gain});
    return 0;
}

/* Stops by which the camera's largest setting is above the frame's. 0: unknown. */
static double spare_ev(const run_sensor *s, const pupil_frame_info *info)
{
    const pupil_sensor_config *c = &s->loop.config;
    const double longest_s = c->frame_rate_priority ? fmin(c->frame_s, c->exposure_max_s) : c->exposure_max_s;
    const double exposure_s = c->exposure_mode == PUPIL_SENSOR_MANUAL ? c->manual_exposure_s : longest_s;
    const double gain = c->gain_mode == PUPIL_SENSOR_MANUAL ? c->manual_gain : c->gain_max;
    if (!s->loop.steers || !(info->exposure_s > 0.0 && info->gain > 0.0))
        return 0.0;
    return fmax(0.0, log2(exposure_s * gain / (info->exposure_s * info->gain)));
}

void run_sensor_limit(const run_sensor *s, const pupil_frame_info *info, frame_pipeline *p)
{
    pupil_config config = p->config;
    if (s->options->mode != RUN_BOTH)
        return;
    config.amplification_ev = fmin(32.0, s->options->shown.config.amplification_ev + spare_ev(s, info));
    if (config.amplification_ev != p->config.amplification_ev)
        frame_pipeline_retune(p, &config);
}

int run_sensor_is_at_rest(const pupil_sensor_setting *setting)
{
    const uint32_t state = setting->state;
    return state == PUPIL_SENSOR_CONVERGED || state == PUPIL_SENSOR_FLICKER ||
           (state == PUPIL_SENSOR_LIMITED && setting->reason != PUPIL_SENSOR_IGNORED);
}

/* For a small change of the total the setting stays, as the leader's does, and the picture is corrected. The correction
 * of a frame depends only on the setting with which it was taken, because this camera has no loop that would correct an
 * error. */
void run_sensor_follow(run_sensor *s, const pupil_frame_info *info, const run_led *led)
{
    const double most = exp2(s->loop.config.digital_ev), taken_s = info->exposure_s * info->gain;
    if (!s->loop.steers || !s->camera || !(led->total_s > 0.0))
        return;
    const int is_other =
        led->set_s != s->followed_set || !(s->followed_s > 0.0) || fabs(log2(led->total_s / s->followed_s)) > FOLLOW_EV;
    if (is_other && pupil_camera_loop_follow(&s->loop, led->total_s) == PUPIL_OK) {
        s->followed_s = led->total_s;
        s->followed_set = led->set_s;
    }
    s->digital = taken_s > 0.0 ? fmin(most, fmax(1.0 / most, led->shown_s / taken_s)) : 1.0;
}

double run_sensor_total_s(run_sensor *s, const pupil_frame_info *info)
{
    const pupil_sensor_setting *now = &s->loop.setting;
    const double taken_s = info->exposure_s * info->gain, set_s = now->exposure_s * now->gain;
    const double share = taken_s * now->frame_digital / now->total_s;
    if (taken_s > 0.0 && fabs(log2(taken_s / set_s)) < SAME_EV && fabs(log2(share)) < 1.0)
        s->shown_share = share;
    return now->total_s * (s->shown_share > 0.0 ? s->shown_share : 1.0);
}

double run_sensor_shown_s(const run_sensor *s, const pupil_frame_info *info)
{
    const double taken_s = info->exposure_s * info->gain;
    return (taken_s > 0.0 ? taken_s : s->loop.setting.total_s) * s->loop.setting.frame_digital;
}

/* The factor for the values of the last frame. */
static double frame_digital(const run_sensor *s)
{
    return s->follows ? s->digital : s->loop.setting.frame_digital;
}

int run_sensor_curve(const run_sensor *s, pupil_curve *curve)
{
    if (s->options->mode != RUN_SENSOR)
        return 0;
    /* Reinhard's extended operator with a white point of 1 leaves all values below it as they are. */
    *curve = (pupil_curve){.scale = (float)frame_digital(s), .inverse_white_squared = 1.0f};
    return 1;
}

void run_sensor_frame(run_sensor *s, const pupil_stats *stats, const pupil_frame_info *info, pupil_curve *curve)
{
    pupil_sensor_config config = s->loop.config;
    if (s->loop.steers && s->camera) {
        if (follow(s, &config))
            pupil_camera_loop_retune(&s->loop, &config);
        pupil_live_mark(s->source); /* after the time that metering took */
        pupil_camera_loop_frame(&s->loop, stats, info);
    }
    run_sensor_curve(s, curve);
}

int run_sensor_announce(run_sensor *s, double ev, uint32_t within_frames, uint32_t change, pupil_why *why)
{
    if (!s->loop.steers || !s->camera)
        return pupil_refuse(why, "nothing of this camera is controlled");
    if (s->loop.setting.state == PUPIL_SENSOR_LOCKED)
        return pupil_refuse(why, "the setting is locked");
    return pupil_camera_loop_announce(&s->loop, ev, within_frames, change)
               ? pupil_refuse(why, "must be stops from -32 to 32, within 1 to 1000 frames")
               : 0;
}

static double known(double x)
{
    return x > 0.0 ? x : (double)NAN;
}

void run_sensor_tell(const run_sensor *s, char *text, size_t text_bytes)
{
    *text = 0;
    if (s->loop.refusals)
        snprintf(text, text_bytes, "; settings refused by the camera: %llu (%s)", (unsigned long long)s->loop.refusals,
                 strerror(s->loop.refusal));
}

void run_sensor_describe(const run_sensor *s, const pupil_frame_info *info, frame_log_entry *record)
{
    pupil_camera_status status = {0};
    if (s->camera)
        pupil_camera_get_status(s->camera, &status);
    record->exposure_s = known(info->exposure_s);
    record->gain = known(info->gain);
    record->asked_exposure_s = known(status.exposure_s.asked);
    record->asked_gain = known(status.gain.asked);
    record->in_force_from =
        status.exposure_s.from_frame > status.gain.from_frame ? status.exposure_s.from_frame : status.gain.from_frame;
    record->digital = s->loop.steers ? frame_digital(s) : 1.0;
    const int sees = s->loop.steers && s->camera && s->loop.setting.frames;
    record->scene_ev = sees ? s->loop.setting.scene_ev : (double)NAN;
    record->camera_key = sees ? exp2(s->loop.setting.wanted_ev) : (double)NAN;
    if (s->options->mode == RUN_SENSOR)
        record->key = record->camera_key;
    record->day_night =
        sees && s->options->day_night_s > 0.0 ? pupil_sensor_day_night_name(s->loop.setting.day_night) : "";
    record->sensor = state_word(s);
    record->sensor_reason = reason_word(s);
}
