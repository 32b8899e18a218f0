/* The controller: from a frame's light to what the camera is asked for. */
#include "sensor_private.h"

#include "base/numeric.h"
#include "base/versioned.h"
#include "core/read.h"

/* "sensor" and the object's size: another version's object is refused. */
#define SENSOR_MAGIC (UINT64_C(0x73656e736f720000) + sizeof(pupil_sensor_object))

static pupil_sensor_object *object_of(pupil_sensor *sensor)
{
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    return o && o->magic == SENSOR_MAGIC ? o : 0;
}

/* From a configuration that has been checked. */
static void configure(pupil_sensor_object *o, const pupil_sensor_config *theirs)
{
    const uint32_t delay = o->config.delay_frames, linear = o->config.linear;
    const pupil_sensor_config *config = &o->config;
    (void)pupil_sensor_config_read(&o->config, theirs);
    o->setting.mains = config->mains_hz != PUPIL_SENSOR_MAINS_AUTO ? PUPIL_SENSOR_MAINS_CONFIGURED
                       : o->mains.hz                               ? PUPIL_SENSOR_MAINS_FOUND
                                                                   : PUPIL_SENSOR_MAINS_UNDETERMINED;
    if (o->setting.mains == PUPIL_SENSOR_MAINS_FOUND)
        o->config.mains_hz = o->mains.hz;
    if (delay != config->delay_frames || linear != config->linear) /* also at first, because delay_frames is never 0 */
        pupil_sensor_forget(o);
    if (o->setting.state == PUPIL_SENSOR_LOCKED && !config->lock && (!config->exposure_mode || !config->gain_mode)) {
        o->setting.state = PUPIL_SENSOR_SEARCHING; /* frames without light would leave it locked */
        o->setting.reason = PUPIL_SENSOR_NO_REASON;
    }
    const double e = config->exposure_mode == PUPIL_SENSOR_MANUAL ? config->manual_exposure_s : o->setting.exposure_s;
    o->held_exposure = pupil_sensor_held_exposure_of(config, clamp(e, config->exposure_min_s, config->exposure_max_s));
    o->held_gain =
        pupil_sensor_gain_of(config, config->gain_mode == PUPIL_SENSOR_MANUAL ? config->manual_gain : o->setting.gain);
    const double wanted = o->plan.wanted;
    double least, most;
    o->told.count = 0; /* exposures of other limits */
    if (config->lock)
        o->announced.frames = 0;
    pupil_sensor_begin(o, o->search.total);
    if (!o->setting.frames)
        return;
    o->plan.wanted = wanted;
    pupil_sensor_reach(o, &least, &most); /* the shown level remains, as far as the new limits allow */
    o->plan.wanted = clamp(wanted, least, most);
}

int pupil_sensor_init(pupil_sensor *sensor, const pupil_sensor_config *config)
{
    const int error = pupil_sensor_config_check(config, 0);
    if (!sensor || error)
        return sensor ? error : PUPIL_ERR_NULL;
    __builtin_memset(sensor, 0, sizeof *sensor);
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    o->magic = SENSOR_MAGIC;
    o->plan.is_looking = 1;
    o->white.top = SENSOR_FAR_AWAY;
    o->white.highest = -SENSOR_FAR_AWAY;
    o->black.before[0] = -SENSOR_FAR_AWAY;
    o->search.since = o->search.looks = SENSOR_RING; /* nothing is on its way */
    o->setting.exposure_s = SENSOR_FIRST_EXPOSURE_S;
    o->setting.gain = 1.0;
    o->setting.frame_digital = o->setting.slope = 1.0;
    o->search.total = pupil_log2(SENSOR_FIRST_EXPOSURE_S);
    o->estimate.requested[0] = o->estimate.in_force[0] = o->estimate.effect = o->search.total;
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
    o->announced.frames = 0;
    pupil_sensor_begin(o, pupil_log2(exposure_s) + pupil_log2(gain));
    o->plan.is_looking = 1;
    return PUPIL_OK;
}

int pupil_sensor_announce(pupil_sensor *sensor, double ev, uint32_t within_frames, uint32_t change)
{
    pupil_sensor_object *o = object_of(sensor);
    double least, most;
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    if (!(ev >= -32.0 && ev <= 32.0) || within_frames < 1 || within_frames > SENSOR_ANNOUNCED_FRAMES ||
        change >= PUPIL_SENSOR_CHANGE_COUNT)
        return PUPIL_ERR_VALUE;
    o->setting.changed = 0;
    if (!o->setting.frames || o->config.lock)
        return PUPIL_OK;
    sensor_announced *a = &o->announced;
    const int is_second = a->frames != 0;
    pupil_sensor_reach(o, &least, &most);
    a->with = (is_second ? a->with : o->plan.wanted + o->plan.beyond) + pupil_sensor_plan_for(o, ev);
    a->with = clamp(a->with, least, most);
    a->without = o->plan.wanted;
    a->filter_ev = (is_second ? a->filter_ev : 0.0) + (change == PUPIL_SENSOR_CHANGE_FILTER ? ev : 0.0);
    a->frames = within_frames;
    a->seen = 0;
    pupil_sensor_move_to(o, a->with);
    return PUPIL_OK;
}

int pupil_sensor_get_sized(const pupil_sensor *sensor, pupil_sensor_setting *setting, size_t setting_bytes)
{
    const pupil_sensor_object *o = (const pupil_sensor_object *)(const void *)sensor;
    if (!o || !setting || o->magic != SENSOR_MAGIC)
        return o && setting ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    pupil_sensor_setting now = o->setting;
    now.mains_hz = o->config.mains_hz > PUPIL_SENSOR_MAINS_AUTO ? o->config.mains_hz : 0;
    now.mains_modulation = o->mains.modulation;
    return pupil_versioned_write(setting, setting_bytes, &now, sizeof now);
}

/* Seconds since the frame before, and whether this one is new. A rising sequence means a new frame, with any timestamp;
 * if clocks stop or go back, frames are taken to be a period apart. */
static uint32_t tick(pupil_sensor_object *o, const pupil_frame_info *info)
{
    const int64_t now = info ? info->timestamp_ns : 0, last = o->last_timestamp_ns;
    const uint64_t sequence = info ? info->sequence : 0, ahead = sequence - o->last_sequence;
    const int is_next = sequence > o->last_sequence && ahead < SENSOR_RING;
    /* in double: the difference of two int64 may not fit; 2^-53 of a century is 30 ns */
    const double dt_s = ((double)now - (double)last) * SENSOR_NS;
    const double period_s = (is_next ? (double)ahead : 1.0) * o->config.frame_s;
    uint32_t reason = PUPIL_SENSOR_NO_REASON;
    if (o->has_time && now && sequence && now == last && sequence == o->last_sequence)
        reason = PUPIL_SENSOR_REPEATED_FRAME;
    else if (o->has_time && dt_s < 0.0)
        reason = PUPIL_SENSOR_CLOCK_BACK;
    if (!o->has_time || (reason && !is_next))
        o->setting.dt_s = 0.0;
    else
        o->setting.dt_s = dt_s > 0.0 ? dt_s : period_s;
    o->last_timestamp_ns = now;
    o->last_sequence = sequence;
    o->has_time = 1;
    return reason;
}

static void find_flicker(pupil_sensor_object *o, sensor_evidence *v)
{
    const double exposure_s = pupil_exp2(o->estimate.in_force[0]), before_ev = o->setting.flicker_ev;
    double *moved = &o->estimate.scene_moved[0];
    pupil_flicker_frame(&o->flicker, v->middle - o->estimate.effect, exposure_s, o->last_timestamp_ns);
    o->setting.flicker_ev = pupil_flicker_at(&o->flicker, o->last_timestamp_ns);
    if (*moved != 0.0) /* flicker going up or down is no ramp of the light */
        *moved -= o->setting.flicker_ev - before_ev;
    v->mean -= o->setting.flicker_ev;
    v->highlight -= o->setting.flicker_ev;
}

/* One frame: evidence -> estimate -> plan -> follow -> report. */
static void take_frame(pupil_sensor_object *o, sensor_evidence *v, const pupil_frame_info *info)
{
    pupil_sensor_setting *s = &o->setting;
    s->changed = 0;
    s->reason = tick(o, info);
    if (s->reason == PUPIL_SENSOR_REPEATED_FRAME)
        return;
    pupil_sensor_white_frame(o, v);
    pupil_sensor_black_frame(o, v);
    pupil_sensor_estimate_frame(o, v, info);
    if (v->is_dead) {
        s->reason = PUPIL_SENSOR_INVALID_FRAME;
    } else {
        find_flicker(o, v);
        s->frames++;
        pupil_sensor_count_frame(o);
        pupil_sensor_plan_frame(o, v);
        pupil_sensor_follow(o, v);
    }
    const double missing = clamp(o->plan.wanted - o->estimate.effect, -o->config.digital_ev, o->config.digital_ev);
    s->frame_digital = pupil_exp2(missing - s->flicker_ev);
    s->slope = 0.5 * (o->estimate.response[0] + o->estimate.response[1]);
    s->exposure_delay = o->estimate.delay[0];
    s->gain_delay = o->estimate.delay[1];
    if (!v->is_dead) {
        pupil_sensor_report(o, v);
        pupil_sensor_day_night_frame(o);
    }
}

/* The bands that lamps leave in rows show the frequency of the mains. */
static void find_mains(pupil_sensor_object *o, const pupil_stats *stats)
{
    const double step_s = o->flicker.step_s > 0.0 ? o->flicker.step_s : o->setting.dt_s;
    pupil_mains_frame(&o->mains, stats, pupil_exp2(o->estimate.in_force[0]), step_s);
    if (o->setting.mains == PUPIL_SENSOR_MAINS_CONFIGURED || o->config.lock || !o->mains.hz ||
        o->mains.hz == o->config.mains_hz)
        return;
    const double wanted = o->plan.wanted;
    o->config.mains_hz = o->mains.hz;
    o->setting.mains = PUPIL_SENSOR_MAINS_FOUND;
    pupil_sensor_begin(o, o->search.total); /* the same total in other exposures */
    o->plan.wanted = wanted;
}

int pupil_sensor_frame(pupil_sensor *sensor, const pupil_stats *stats, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    sensor_evidence evidence;
    pupil_frame_info own;
    if (!o || !stats)
        return sensor && stats ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    int error = pupil_stats_check_bytes(stats);
    if (!error)
        error = pupil_info_read(&own, info);
    if (!error)
        error = pupil_sensor_evidence(o, stats, &evidence);
    if (error)
        return error;
    take_frame(o, &evidence, info ? &own : 0);
    if (!evidence.is_dead && o->setting.reason != PUPIL_SENSOR_REPEATED_FRAME)
        find_mains(o, stats);
    return PUPIL_OK;
}

int pupil_sensor_scene(pupil_sensor *sensor, double scene_ev, double clipped_share, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    sensor_evidence evidence = {.is_dead = 1};
    pupil_frame_info own;
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    if (pupil_info_read(&own, info))
        return PUPIL_ERR_SIZE_BYTES;
    info = info ? &own : 0;
    /* the caller has divided by what the metadata say, or by what was asked for */
    double e = o->setting.exposure_s, g = o->setting.gain;
    if (info && info->exposure_s >= 0x1p-64 && info->exposure_s <= 0x1p64)
        e = info->exposure_s;
    if (info && info->gain >= 0x1p-64 && info->gain <= 0x1p64)
        g = info->gain;
    if (scene_ev >= -256.0 && scene_ev <= 256.0 && clipped_share >= 0.0 && clipped_share <= 1.0)
        pupil_sensor_evidence_of_level(o, scene_ev + pupil_log2(e) + pupil_log2(g), clipped_share, &evidence);
    take_frame(o, &evidence, info);
    return PUPIL_OK;
}
