#include "sensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "options/key_at.h"
#include "refuse.h"

static const char *state_word(const run_sensor *s)
{
    if (s->steers && s->refused)
        return "searching";
    static const char *const words[] = {"empty", "searching", "converged", "limited", "clipped", "flicker", "locked"};
    const uint32_t state = s->setting.state;
    return !s->steers ? "" : state < sizeof words / sizeof words[0] ? words[state] : "?";
}

static const char *reason_word(const run_sensor *s)
{
    static const char *const words[] = {"",         "waiting",    "exposure min", "exposure max", "frame period",
                                        "gain min", "gain max",   "highlights",   "mains",        "lock",
                                        "manual",   "dead frame", "same frame",   "clock back",   "flash",
                                        "ignored",  "strange",    "unsteady"};
    const uint32_t reason = s->setting.reason;
    if (s->refused)
        return "refused";
    return !s->steers ? "" : reason < sizeof words / sizeof words[0] ? words[reason] : "?";
}

/* What keys can change while it runs. Where the picture is adapted to by itself, the sensor's own level is hidden, and
 * stays where a sensor is best. */
static int follow_keys(run_sensor *s)
{
    const pupil_config *shown = &s->options->shown.config;
    const pupil_sensor_config before = s->config;
    if (s->options->mode != RUN_SENSOR)
        return 0;
    s->config.key = shown->key;
    s->config.ev_compensation = shown->ev_compensation;
    s->config.lock = shown->lock;
    return s->config.key != before.key || s->config.ev_compensation != before.ev_compensation ||
           s->config.lock != before.lock;
}

static void configure(run_sensor *s)
{
    const run_options *o = s->options;
    pupil_sensor_config *c = &s->config;
    pupil_sensor_config_default(c);
    c->frame_s = 1.0 / s->source->fps;
    pupil_camera_configure(s->camera, c);
    c->frame_rate_priority = !o->any_frame_rate;
    c->mains_hz = o->live.mains_hz || o->mains_off ? o->live.mains_hz : PUPIL_SENSOR_MAINS_AUTO;
    c->linear = o->curve == RUN_CURVE_AUTO ? (uint32_t)pupil_live_is_linear(s->source) : o->curve == RUN_CURVE_LINEAR;
    c->trim_low = (double)o->shown.config.trim_low;
    c->trim_high = (double)o->shown.config.trim_high;
    if (o->key_at)
        key_at_parse(o->key_at, c); /* it was right when it was read */
    if (o->exposure_s > 0.0) {
        c->exposure_mode = PUPIL_SENSOR_MANUAL;
        c->manual_exposure_s = o->exposure_s;
    }
    if (o->gain > 0.0) {
        c->gain_mode = PUPIL_SENSOR_MANUAL;
        c->manual_gain = o->gain;
    }
    follow_keys(s);
}

/* Where it is another setting than the last one. */
static void ask(run_sensor *s)
{
    const pupil_camera_setting wanted = {.exposure_s = s->setting.exposure_s, .gain = s->setting.gain};
    if (wanted.exposure_s != s->asked.exposure_s || wanted.gain != s->asked.gain) {
        pupil_live_mark(s->source);
        pupil_camera_ask(s->camera, &wanted);
    }
    s->asked = wanted;
}

/* While the setting is to stand still it is locked, too. */
static void retune(run_sensor *s)
{
    pupil_sensor_config config = s->config;
    config.lock |= (uint32_t)s->slow;
    pupil_sensor_retune(&s->sensor, &config);
}

/* A setting that was refused, for as long as it is: a camera may be busy for a moment. */
static void ask_again(run_sensor *s)
{
    pupil_camera_status status;
    pupil_camera_get_status(s->camera, &status);
    if (status.written != status.asks)
        return;
    s->refused = status.failed != s->seen_refusals;
    if (!s->refused)
        return;
    s->refusals += status.failed - s->seen_refusals;
    s->refusal = status.error;
    s->seen_refusals = status.failed;
    pupil_live_mark(s->source);
    pupil_camera_ask(s->camera, &s->asked);
}

/* While a write takes longer than a frame nobody knows which frame is the first with its setting, so the setting stands
 * still for them, and for the first one after it, for its delay may be wrong by one. */
static void wait_for_slow(run_sensor *s, const pupil_frame_info *info)
{
    const int before = s->slow;
    pupil_camera_status status;
    pupil_camera_get_status(s->camera, &status);
    const uint64_t exposure = status.exposure_s.from_frame, gain = status.gain.from_frame;
    if (status.written != status.asks)
        s->slow = 1;
    else if (info->sequence > exposure && info->sequence > gain)
        s->slow = 0;
    if (s->slow == before)
        return;
    retune(s);
}

/* From the level that the camera has, so that its picture does not jump; of one that came back, from the wanted one. */
static int steer(run_sensor *s, pupil_why *why)
{
    const char *fault = "";
    pupil_camera_status status;
    configure(s);
    if (pupil_sensor_config_check(&s->config, &fault)) {
        pupil_refuse(why, "the camera's exposure cannot be steered: %s", fault);
        return -1;
    }
    const double total_s = s->steers ? s->setting.total_s : s->first_total_s;
    s->slow = 0;
    pupil_sensor_init(&s->sensor, &s->config); /* one that came back may be another one */
    pupil_camera_get_status(s->camera, &status);
    if (total_s > 0.0)
        pupil_sensor_start(&s->sensor, total_s, 1.0);
    else
        pupil_sensor_start(&s->sensor, status.exposure_s.taken, status.gain.taken); /* refused where unknown */
    s->steers = 1;
    s->asked = (pupil_camera_setting){0}; /* of the camera before */
    pupil_sensor_get(&s->sensor, &s->setting);
    ask(s);
    return 0;
}

void run_sensor_begin(run_sensor *s, const run_options *options, pupil_source *source)
{
    *s = (run_sensor){.options = options, .source = source, .setting = {.digital = 1.0, .frame_digital = 1.0}};
}

int run_sensor_take(run_sensor *s, pupil_why *why)
{
    const run_options *o = s->options;
    pupil_camera *camera = pupil_live_camera(s->source);
    const int is_new = camera && !s->camera;
    if (!camera)
        s->refused = 0;
    if (!camera && s->steers) { /* what was found is of a camera that is gone */
        s->setting.state = PUPIL_SENSOR_SEARCHING;
        s->setting.reason = PUPIL_SENSOR_WAITING;
        s->setting.frame_digital = 1.0;
    }
    s->camera = camera;
    if (camera && !is_new)
        ask_again(s);
    if (!is_new)
        return 0;
    s->seen_refusals = 0;
    s->refused = 0;
    if (o->mode != RUN_DIGITAL)
        return steer(s, why);
    s->asked = (pupil_camera_setting){.exposure_s = o->exposure_s, .gain = o->gain};
    pupil_camera_ask(camera, &s->asked);
    return 0;
}

int run_sensor_curve(const run_sensor *s, pupil_curve *curve)
{
    if (s->options->mode != RUN_SENSOR)
        return 0;
    /* Reinhard's extended operator with a white point of 1 leaves all that is below it as it is. */
    *curve = (pupil_curve){.scale = (float)s->setting.frame_digital, .inverse_white_squared = 1.0f};
    return 1;
}

void run_sensor_judge(void *run_sensor_, const pupil_stats *stats, const pupil_frame_info *info, pupil_curve *curve)
{
    run_sensor *s = run_sensor_;
    if (s->steers && s->camera) {
        if (follow_keys(s))
            retune(s);
        wait_for_slow(s, info);
        pupil_sensor_frame(&s->sensor, stats, info);
        pupil_sensor_get(&s->sensor, &s->setting);
        pupil_camera_learn(s->camera, s->setting.exposure_delay, s->setting.gain_delay);
        if (s->slow && !s->config.lock) {
            s->setting.state = PUPIL_SENSOR_SEARCHING;
            s->setting.reason = PUPIL_SENSOR_WAITING;
        }
        ask(s);
    }
    run_sensor_curve(s, curve);
}

static double known(double x)
{
    return x > 0.0 ? x : (double)NAN;
}

void run_sensor_tell(const run_sensor *s, char *text, size_t text_bytes)
{
    *text = 0;
    if (s->refusals)
        snprintf(text, text_bytes, "; settings refused by the camera: %llu (%s)", (unsigned long long)s->refusals,
                 strerror(s->refusal));
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
    record->digital = s->steers ? s->setting.frame_digital : 1.0;
    const int sees = s->steers && s->camera && s->setting.frames;
    record->scene_ev = sees ? s->setting.scene_ev : (double)NAN;
    record->camera_key = sees ? exp2(s->setting.wanted_ev) : (double)NAN;
    if (s->options->mode == RUN_SENSOR)
        record->key = record->camera_key;
    record->sensor = state_word(s);
    record->sensor_reason = reason_word(s);
}
