/* The controller: from a frame's light to what the camera is asked for. */
#include "sensor_private.h"

#include "base/numeric.h"
#include "base/versioned.h"
#include "core/read.h"

/* "sensor" and the object's size: another version's object is refused. */
#define SENSOR_MAGIC (UINT64_C(0x73656e736f720000) + sizeof(pupil_sensor_object))

/* Clipped and black pixels do not flicker, small lamps blink: both are left out of the mean that a beat is seen in. */
#define BEAT_TRIM 0.1

static pupil_sensor_object *object_of(pupil_sensor *sensor)
{
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    return o && o->magic == SENSOR_MAGIC ? o : 0;
}

/* The wanted total, brought into what the camera can under the current config; where both controls are held, what was
 * rounded is held, too. */
static void begin_from(pupil_sensor_object *o, double total_log2)
{
    double e, g;
    pupil_sensor_split(o, -500.0, &e, &g);
    o->least_log2 = pupil_log2(e * g);
    pupil_sensor_split(o, 500.0, &e, &g);
    o->most_log2 = pupil_log2(e * g);
    const int is_held = o->config.exposure_mode == PUPIL_SENSOR_HELD && o->config.gain_mode == PUPIL_SENSOR_HELD;
    const double digital_log2 = total_log2 - o->most_log2;
    if (is_held && o->setting.frames && digital_log2 > -1.0 && digital_log2 < 1.0)
        o->least_log2 = o->most_log2 = total_log2;
    o->total_log2 = clamp(total_log2, o->least_log2, o->most_log2);
    o->band_ev = 0.0;
    pupil_sensor_choose(o, 1);
    if (o->setting.changed && o->stamped) /* until both controls are there the frames show a mixture */
        o->waited = 0;
}

/* From a configuration that has been checked. */
static void configure(pupil_sensor_object *o, const pupil_sensor_config *theirs)
{
    const uint32_t believed = o->config.delay_frames, linear = o->config.linear;
    const pupil_sensor_config *config = &o->config;
    (void)pupil_sensor_config_read(&o->config, theirs);
    o->setting.mains = config->mains_hz != PUPIL_SENSOR_MAINS_AUTO ? PUPIL_SENSOR_MAINS_CONFIGURED
                       : o->mains.hz                               ? PUPIL_SENSOR_MAINS_FOUND
                                                                   : PUPIL_SENSOR_MAINS_UNDETERMINED;
    if (o->setting.mains != PUPIL_SENSOR_MAINS_CONFIGURED)
        o->config.mains_hz = o->mains.hz;
    if (believed != config->delay_frames)
        pupil_sensor_answer_reset(o);
    if (linear != config->linear) /* what was learned of gains went with it */
        o->answer.gain_does = 1.0, o->answer.jumps = o->answer.short_steps = 0;
    if (o->setting.state == PUPIL_SENSOR_LOCKED && !config->lock && (!config->exposure_mode || !config->gain_mode)) {
        o->setting.state = PUPIL_SENSOR_SEARCHING; /* frames that show nothing would leave it locked */
        o->setting.reason = PUPIL_SENSOR_NO_REASON;
    }
    const double e = config->exposure_mode == PUPIL_SENSOR_MANUAL ? config->manual_exposure_s : o->setting.exposure_s;
    o->held_exposure = pupil_sensor_exposure_of(&o->config, clamp(e, config->exposure_min_s, config->exposure_max_s));
    o->held_gain =
        pupil_sensor_gain_of(config, config->gain_mode == PUPIL_SENSOR_MANUAL ? config->manual_gain : o->setting.gain);
    begin_from(o, o->total_log2);
}

int pupil_sensor_init(pupil_sensor *sensor, const pupil_sensor_config *config)
{
    const int error = pupil_sensor_config_check(config, 0);
    if (!sensor || error)
        return sensor ? error : PUPIL_ERR_NULL;
    __builtin_memset(sensor, 0, sizeof *sensor);
    pupil_sensor_object *o = (pupil_sensor_object *)(void *)sensor;
    o->magic = SENSOR_MAGIC;
    o->waited = PUPIL_SENSOR_DELAYS; /* nothing is on its way */
    o->looking = 1;
    o->stride = 1.0;
    o->noise_ev = 0.02;
    o->setting.exposure_s = 0.01, o->setting.gain = 1.0;
    o->setting.frame_digital = o->setting.slope = 1.0;
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
    o->looking = 1;
    return PUPIL_OK;
}

int pupil_sensor_get_sized(const pupil_sensor *sensor, pupil_sensor_setting *setting, size_t setting_bytes)
{
    const pupil_sensor_object *o = (const pupil_sensor_object *)(const void *)sensor;
    if (!o || !setting || o->magic != SENSOR_MAGIC)
        return o && setting ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    pupil_sensor_setting now = o->setting;
    now.mains_hz = o->config.mains_hz;
    now.mains_modulation = o->mains.modulation;
    return pupil_versioned_write(setting, setting_bytes, &now, sizeof now);
}

/* log2 of the exposure and gain that the frame was taken with, as info says. */
static double told(pupil_sensor_object *o, const pupil_frame_info *info)
{
    double e = o->setting.exposure_s, g = o->setting.gain;
    uint32_t known = 0;
    if (info && info->exposure_s >= 0x1p-64 && info->exposure_s <= 0x1p64)
        e = info->exposure_s, known++;
    if (info && info->gain >= 0x1p-64 && info->gain <= 0x1p64)
        g = info->gain, known++;
    if (known == 2 && !o->answer.info_tells && o->answer.frame) { /* the camera is back: as at first */
        pupil_sensor_answer_reset(o);
        o->answer.frame = 0; /* and what was asked for meanwhile was not heard */
    }
    o->answer.info_tells = known == 2;
    o->answer.told[0] = pupil_log2(e);
    o->answer.told[1] = pupil_log2(g);
    return o->answer.told[0] + o->answer.told[1];
}

int pupil_sensor_frame(pupil_sensor *sensor, const pupil_stats *stats, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    pupil_sensor_light light = {0};
    pupil_frame_info own;
    if (!o || !stats)
        return sensor && stats ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    const pupil_sensor_config *c = &o->config;
    int error = pupil_stats_check_bytes(stats);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    info = info ? &own : 0;
    light.dead = !stats->weight;
    light.has_highlight = stats->has_histogram && c->highlight_ev > 0.0;
    if (!light.dead) {
        const int trims = stats->has_histogram != 0;
        error = pupil_stats_mean(stats, trims ? c->trim_low : 0.0, trims ? c->trim_high : 1.0, &light.mean);
        if (!error)
            error = pupil_stats_mean(stats, trims ? BEAT_TRIM : 0.0, trims ? 1.0 - BEAT_TRIM : 1.0, &light.middle);
        if (!error && light.has_highlight)
            error = pupil_stats_peak_quantile(stats, 1.0 - c->highlight_share, &light.highlight);
        light.clipped_share = (double)stats->clipped / (double)(stats->pixels ? stats->pixels : 1);
        light.black_share = (double)stats->black / (double)(stats->pixels ? stats->pixels : 1);
    }
    if (error)
        return error;
    if (!light.dead)
        pupil_sensor_orders(c, stats, &light);
    told(o, info);
    pupil_sensor_advance(o, &light, info);
    if (light.dead || o->setting.reason == PUPIL_SENSOR_REPEATED_FRAME)
        return PUPIL_OK;
    const double step_s = o->flicker.step_s > 0.0 ? o->flicker.step_s : o->setting.dt_s;
    pupil_mains_frame(&o->mains, stats, pupil_exp2(o->answer.taken[0]), step_s);
    if (o->setting.mains != PUPIL_SENSOR_MAINS_CONFIGURED && !c->lock && o->mains.hz != c->mains_hz) {
        const uint32_t changed = o->setting.changed;
        o->config.mains_hz = o->mains.hz;
        o->setting.mains = PUPIL_SENSOR_MAINS_FOUND;
        begin_from(o, o->total_log2); /* the same in other exposures */
        o->setting.changed |= changed;
    }
    return PUPIL_OK;
}

int pupil_sensor_scene(pupil_sensor *sensor, double scene_ev, double clipped_share, const pupil_frame_info *info)
{
    pupil_sensor_object *o = object_of(sensor);
    pupil_sensor_light light = {0};
    pupil_frame_info own;
    if (!o)
        return sensor ? PUPIL_ERR_OBJECT : PUPIL_ERR_NULL;
    if (pupil_info_read(&own, info))
        return PUPIL_ERR_SIZE_BYTES;
    info = info ? &own : 0;
    const double frame_log2 = told(o, info);
    light.dead = !(scene_ev >= -256.0 && scene_ev <= 256.0 && clipped_share >= 0.0 && clipped_share <= 1.0);
    if (!light.dead) {
        light.mean = light.middle = scene_ev + frame_log2;
        light.clipped_share = clipped_share;
        pupil_sensor_orders(&o->config, 0, &light);
    }
    pupil_sensor_advance(o, &light, info);
    return PUPIL_OK;
}
