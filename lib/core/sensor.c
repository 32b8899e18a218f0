/* The controller: from a frame's light to what the camera is asked for. */
#include "sensor_object.h"

#include "numeric.h"

/* "sensor" and the object's size: another version's object is refused. */
#define SENSOR_MAGIC (UINT64_C(0x73656e736f720000) + sizeof(pupil_sensor_object))

/* A frame with this share of it clipped, or half of it black, says little but that: by how many stops the total then
 * moves, to look again. Six stops are the largest step of a scene that is to settle with one look more. */
#define BLIND_CLIPPED 0.97
#define BLIND_BLACK   0.5
#define BLIND_STEP_EV 6.0

/* The quantile that is to stay below clip comes from bins of up to 0.32 stops and moves by as much where many pixels
 * change from one to the next. So it is aimed at below the last bin's middle, and what it asks for is far only beyond a
 * bin; the filter makes a hundredth of it. */
#define HIGHLIGHT_AIM_EV  0.20
#define HIGHLIGHT_FAR_EV  0.35
#define HIGHLIGHT_STEP_EV 0.40
#define LEAST_STRIDE      0.125

static pupil_sensor_object *object_of(pupil_sensor *sensor)
{
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    return o && o->magic == SENSOR_MAGIC ? o : 0;
}

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* The setting for the wanted total, unless that is near enough to when it was last chosen. */
static void choose(pupil_sensor_object *o, int anew)
{
    pupil_sensor_setting *s = &o->setting;
    const double moved = o->total_log2 - o->set_log2, exposure_s = s->exposure_s, gain = s->gain;
    anew |= o->total_log2 >= o->most_log2 || o->total_log2 <= o->least_log2;
    if (anew || moved > o->config.hold_ev || moved < -o->config.hold_ev) {
        pupil_sensor_split(o, o->total_log2, &s->exposure_s, &s->gain);
        o->set_log2 = o->total_log2;
    }
    s->changed = s->exposure_s != exposure_s || s->gain != gain;
    s->total_s = pupil_exp2(o->total_log2);
    s->digital = s->total_s / (s->exposure_s * s->gain);
    s->limits = pupil_sensor_limits(o);
}

/* The wanted total, brought into what the camera can under the current config. */
static void begin_from(pupil_sensor_object *o, double total_log2)
{
    double e, g;
    pupil_sensor_split(o, -500.0, &e, &g);
    o->least_log2 = pupil_log2(e * g);
    pupil_sensor_split(o, 500.0, &e, &g);
    o->most_log2 = pupil_log2(e * g);
    o->total_log2 = clamp(total_log2, o->least_log2, o->most_log2);
    choose(o, 1);
}

static void configure(pupil_sensor_object *o, const pupil_sensor_config *config)
{
    const int idle = o->waited >= o->config.delay_frames;
    o->config = *config;
    o->held_exposure = pupil_sensor_exposure_of(
        config, clamp(config->exposure_mode == PUPIL_SENSOR_MANUAL ? config->manual_exposure_s : o->setting.exposure_s,
                      config->exposure_min_s, config->exposure_max_s));
    o->held_gain =
        pupil_sensor_gain_of(config, config->gain_mode == PUPIL_SENSOR_MANUAL ? config->manual_gain : o->setting.gain);
    begin_from(o, o->total_log2);
    if (idle || o->waited > config->delay_frames)
        o->waited = config->delay_frames;
}

int pupil_sensor_init(pupil_sensor *sensor, const pupil_sensor_config *config)
{
    const int error = pupil_sensor_config_check(config, 0);
    if (!sensor || error)
        return sensor ? error : PUPIL_ERR_NULL;
    *sensor = (pupil_sensor){{0}};
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    o->magic = SENSOR_MAGIC;
    o->config.delay_frames = config->delay_frames;
    o->waited = config->delay_frames; /* nothing is on its way */
    o->stride = 1.0;
    o->setting.exposure_s = 0.01;
    o->setting.gain = 1.0;
    o->setting.frame_digital = 1.0;
    o->total_log2 = pupil_log2(0.01);
    configure(o, config);
    return PUPIL_OK;
}

int pupil_sensor_retune(pupil_sensor *sensor, const pupil_sensor_config *config)
{
    pupil_sensor_object *o = object_of(sensor);
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    const int error = pupil_sensor_config_check(config, 0);
    if (!error)
        configure(o, config);
    return error;
}

int pupil_sensor_start(pupil_sensor *sensor, double exposure_s, double gain)
{
    pupil_sensor_object *o = object_of(sensor);
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    if (!(exposure_s >= 0x1p-64 && exposure_s <= 0x1p64 && gain >= 0x1p-64 && gain <= 0x1p64))
        return PUPIL_ERR_VALUE;
    begin_from(o, pupil_log2(exposure_s) + pupil_log2(gain));
    if (o->stamped) /* the stream runs: this step, too, takes its time */
        o->waited = 0;
    return PUPIL_OK;
}

int pupil_sensor_get(const pupil_sensor *sensor, pupil_sensor_setting *setting)
{
    const pupil_sensor_object *o = (const pupil_sensor_object *)(const void *)sensor;
    if (!o || !setting)
        return PUPIL_ERR_NULL;
    if (o->magic != SENSOR_MAGIC)
        return PUPIL_ERR_OBJECT;
    *setting = o->setting;
    return PUPIL_OK;
}

/* log2 of the exposure and gain that the frame was taken with. */
static double taken_with(const pupil_sensor_object *o, const pupil_frame_info *info)
{
    double e = o->setting.exposure_s, g = o->setting.gain;
    if (info && info->exposure_s >= 0x1p-64 && info->exposure_s <= 0x1p64)
        e = info->exposure_s;
    if (info && info->gain >= 0x1p-64 && info->gain <= 0x1p64)
        g = info->gain;
    return pupil_log2(e) + pupil_log2(g);
}

/* Seconds since the frame before. */
static uint32_t tick(pupil_sensor_object *o, const pupil_frame_info *info)
{
    const int64_t now = info ? info->timestamp_ns : 0, last = o->last_timestamp_ns;
    /* in double: the difference of two int64 may not fit; 2^-53 of a century is 30 ns */
    double dt_s = !o->stamped ? 0.0 : !now && !last ? o->config.frame_s : ((double)now - (double)last) * 1e-9;
    const uint32_t reason = o->stamped && now && now == last ? PUPIL_SENSOR_SAME_FRAME
                            : dt_s < 0.0                     ? PUPIL_SENSOR_CLOCK_BACK
                                                             : PUPIL_SENSOR_NO_REASON;
    o->setting.dt_s = dt_s > 0.0 ? dt_s : 0.0;
    o->last_timestamp_ns = now;
    o->stamped = 1;
    if (reason != PUPIL_SENSOR_SAME_FRAME && o->waited < o->config.delay_frames)
        o->waited++;
    return reason;
}

/* log2 of the highest total by the highlights. */
static double highlight_limit(const pupil_sensor_config *c, const pupil_sensor_light *light, double frame_log2,
                              double guess)
{
    const double room = pupil_log2(c->clip) - light->highlight;
    if (light->clipped_share > c->highlight_share || room <= 0.0) { /* by how much is not known */
        const double over = guess - pupil_log2(c->clip);
        return frame_log2 - (over > HIGHLIGHT_STEP_EV ? over : HIGHLIGHT_STEP_EV);
    }
    return frame_log2 + room - HIGHLIGHT_AIM_EV;
}

/* log2 of the total that this frame asks for; the reason where it is not the key alone; whether it is a guess.
 *
 * A clipped frame's mean is too low, so its target lies between the frame's own total and the right one: whatever the
 * scene, one such step after another comes nearer from one side (the error that is left is the clipped share of the one
 * before). It is only where this says "far too bright" that a guess may go further, and too far; what comes after it
 * comes from the dark side, without guesses. So guesses cannot make it swing. */
static double target_of(pupil_sensor_object *o, const pupil_sensor_light *light, double frame_log2, uint32_t *reason,
                        int *guessed)
{
    const pupil_sensor_config *c = &o->config;
    const double wanted = pupil_log2(c->key) + pupil_log2(c->clip) + c->ev_compensation;
    double target = frame_log2 + wanted - light->mean, mean, highlight;
    pupil_sensor_guess(c, light, &mean, &highlight);
    o->setting.scene_ev = light->mean - frame_log2;
    if (target < frame_log2 - c->far_ev) {
        *guessed = mean > light->mean;
        target = light->clipped_share >= BLIND_CLIPPED ? frame_log2 - BLIND_STEP_EV : frame_log2 + wanted - mean;
        o->setting.scene_ev = mean - frame_log2;
    }
    if (light->has_highlight) {
        const double most = highlight_limit(c, light, frame_log2, highlight);
        if (most < target) {
            target = most > target - c->highlight_ev ? most : target - c->highlight_ev;
            *reason = PUPIL_SENSOR_HIGHLIGHTS;
        }
    }
    if (light->black_share > BLIND_BLACK && target > frame_log2 + BLIND_STEP_EV) {
        target = frame_log2 + BLIND_STEP_EV;
        *guessed = 1;
    }
    return target;
}

/* The wanted total, on its way to the target. A large step that goes back on the one before, without any rest between
 * them, goes half the way, the next one of that kind half of that: so a camera that answers otherwise than its numbers
 * say (a tone curve, dark areas that come and go with a code) is approached and not swung around. */
static void move(pupil_sensor_object *o, double target, double far_ev, int at_end, int guessed)
{
    const pupil_sensor_config *c = &o->config;
    const double off = target - o->total_log2, most_weight = 0.39 / c->delay_frames; /* sensor.h: tau_s */
    double weight = c->tau_s > 0.0 ? pupil_one_minus_exp(o->setting.dt_s / c->tau_s) : 1.0;
    if (o->waited < c->delay_frames)
        return;
    if (off <= far_ev && off >= -far_ev) {
        o->direction = 0;
        o->stride = 1.0;
        weight = weight < most_weight ? weight : most_weight;
        /* the last 5 thousandths to a limit are not seen, and then all of it is used */
        o->total_log2 = at_end && off < 0.005 && off > -0.005 ? target : o->total_log2 + weight * off;
        return;
    }
    const int32_t direction = off > 0.0 ? 1 : -1;
    if (o->direction == -direction && o->stride > LEAST_STRIDE)
        o->stride *= 0.5;
    o->total_log2 += o->stride * off;
    o->direction = guessed ? 0 : direction;
    o->waited = 0;
}

/* After the step. */
static void judge(pupil_sensor_object *o, double beyond, double far_ev, double clipped_share, uint32_t reason)
{
    pupil_sensor_setting *s = &o->setting;
    const pupil_sensor_config *c = &o->config;
    const int by_hand = c->exposure_mode != PUPIL_SENSOR_AUTO && c->gain_mode != PUPIL_SENSOR_AUTO;
    const int far = s->error_ev > far_ev || s->error_ev < -far_ev;
    s->state = PUPIL_SENSOR_CONVERGED;
    if (c->lock || by_hand) {
        s->state = PUPIL_SENSOR_LOCKED;
        reason = c->lock ? PUPIL_SENSOR_LOCK : PUPIL_SENSOR_BY_HAND;
    } else if (far || o->waited < c->delay_frames) {
        s->state = clipped_share > 0.5 ? PUPIL_SENSOR_CLIPPED : PUPIL_SENSOR_SEARCHING;
        reason = o->waited > 0 ? PUPIL_SENSOR_WAITING : reason;
    } else if (beyond > 0.05 || beyond < -0.05) { /* pupil.h, too, calls a level settled within 0.05 */
        s->state = PUPIL_SENSOR_LIMITED;
        reason = pupil_sensor_limit(o, beyond > 0.0);
    } else if (c->mains_hz && s->exposure_s < 0.5 / c->mains_hz * 0.99 - c->exposure_step_s) {
        s->state = PUPIL_SENSOR_FLICKER;
        reason = PUPIL_SENSOR_BELOW_MAINS;
    }
    s->reason = reason;
}

static void advance(pupil_sensor_object *o, const pupil_sensor_light *light, const pupil_frame_info *info,
                    double frame_log2)
{
    pupil_sensor_setting *s = &o->setting;
    const pupil_sensor_config *c = &o->config;
    uint32_t reason = tick(o, info);
    s->changed = 0;
    if (light->dead || reason == PUPIL_SENSOR_SAME_FRAME) {
        s->reason = light->dead ? PUPIL_SENSOR_DEAD_FRAME : reason;
    } else {
        int guessed = 0;
        const double wanted = target_of(o, light, frame_log2, &reason, &guessed);
        const double target = clamp(wanted, o->least_log2, o->most_log2);
        const double far_ev =
            reason == PUPIL_SENSOR_HIGHLIGHTS && c->far_ev < HIGHLIGHT_FAR_EV ? HIGHLIGHT_FAR_EV : c->far_ev;
        s->error_ev = target - o->total_log2;
        s->frames++;
        if (!c->lock)
            move(o, target, far_ev, wanted != target, guessed);
        choose(o, 0);
        judge(o, wanted - target, far_ev, light->clipped_share, reason);
    }
    s->frame_digital = pupil_exp2(clamp(o->total_log2 - frame_log2, -c->digital_ev, c->digital_ev));
}

int pupil_sensor_frame(pupil_sensor *sensor, const pupil_stats *stats, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    pupil_sensor_light light = {0};
    if (!o || !stats)
        return sensor && stats ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    const pupil_sensor_config *c = &o->config;
    int error = PUPIL_OK;
    light.dead = !stats->weight;
    light.has_highlight = stats->has_histogram && c->highlight_ev > 0.0;
    if (!light.dead) {
        const int trims = stats->has_histogram != 0;
        error = pupil_stats_mean(stats, trims ? c->trim_low : 0.0, trims ? c->trim_high : 1.0, &light.mean);
        if (!error && light.has_highlight)
            error = pupil_stats_peak_quantile(stats, 1.0 - c->highlight_share, &light.highlight);
        light.clipped_share = (double)stats->clipped / (double)(stats->pixels ? stats->pixels : 1);
        light.black_share = (double)stats->black / (double)(stats->pixels ? stats->pixels : 1);
    }
    if (!error)
        advance(o, &light, info, taken_with(o, info));
    return error;
}

int pupil_sensor_scene(pupil_sensor *sensor, double scene_ev, double clipped_share, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    pupil_sensor_light light = {0};
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    const double frame_log2 = taken_with(o, info);
    light.dead = !(scene_ev >= -256.0 && scene_ev <= 256.0 && clipped_share >= 0.0 && clipped_share <= 1.0);
    if (!light.dead) {
        light.mean = scene_ev + frame_log2;
        light.clipped_share = clipped_share;
    }
    advance(o, &light, info, frame_log2);
    return PUPIL_OK;
}
