#include "simulated_camera.h"

#include <math.h>

static simulated_camera *of(pupil_camera *camera)
{
    return (simulated_camera *)camera;
}

/* The setting reaches the sensor, or is refused. */
static void finish(simulated_camera *c)
{
    pupil_camera_value *const values[] = {&c->status.exposure_s, &c->status.gain};
    double taken[2];
    c->writing = 0;
    c->status.writing = 0;
    c->status.written = c->number;
    if (c->refusal) {
        c->status.failed++;
        c->status.error = c->refusal;
        return;
    }
    taken[0] = floor(c->pending.exposure_s / c->config.line_s + 1e-6) * c->config.line_s;
    taken[1] = fixture_plant_gain_of(&c->config, c->pending.gain);
    fixture_plant_ask(c->plant, taken[0], taken[1], 1.0);
    for (int k = 0; k < 2; k++) {
        values[k]->taken = taken[k];
        values[k]->from_frame = c->frame + c->config.delay[k];
    }
}

static void start(simulated_camera *c)
{
    c->writing = 1;
    c->status.writing = 1;
    c->number = c->status.asks;
    c->pending = c->wanted;
    c->done_at = c->frame + c->write_frames;
    if (!c->write_frames)
        finish(c);
}

static uint64_t ask(pupil_camera *camera, const pupil_camera_setting *setting)
{
    simulated_camera *c = of(camera);
    c->wanted = *setting;
    c->status.exposure_s.asked = setting->exposure_s;
    c->status.gain.asked = setting->gain;
    c->status.asks++;
    if (!c->writing)
        start(c);
    return c->status.asks;
}

static uint64_t reapply(pupil_camera *camera)
{
    const pupil_camera_setting latest = of(camera)->wanted;
    return ask(camera, &latest);
}

static void frame(pupil_camera *camera, uint64_t sequence, int started)
{
    (void)camera, (void)sequence, (void)started; /* knows it without this call */
}

static void in_force(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info)
{
    const simulated_camera *c = of(camera);
    info->exposure_s = sequence == c->frame ? c->told.exposure_s : 0.0;
    info->gain = sequence == c->frame ? c->told.gain : 0.0;
}

static void learn(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay)
{
    (void)camera, (void)exposure_delay, (void)gain_delay; /* its frames say what they were taken with */
}

static void get_status(pupil_camera *camera, pupil_camera_status *status)
{
    *status = of(camera)->status;
}

static void get_limits(pupil_camera *camera, pupil_camera_limits *limits)
{
    const fixture_plant_config *c = &of(camera)->config;
    *limits = (pupil_camera_limits){
        .exposure_min_s = c->exposure_min_s,
        .exposure_max_s = c->exposure_max_s,
        .exposure_step_s = c->line_s,
        .gain_min = 1.0,
        .gain_max = c->gain_max,
        .frame_s = c->frame_s,
        .has_gain = 1,
        .gain_known = 1,
        .gain_code_step = 1,
        .exposure_delay = c->delay[FIXTURE_EXPOSURE] - 1,
        .gain_delay = c->delay[FIXTURE_GAIN] - 1,
        .gain = {.law = PUPIL_CAMERA_RATIO, .p = {0.0, 256.0, -1.0, 256.0}},
        .readout_s = c->readout_s,
    };
}

static void restore(pupil_camera *camera)
{
    of(camera)->restored++;
}

static int close_camera(pupil_camera *camera, pupil_why *why)
{
    simulated_camera *c = of(camera);
    (void)why;
    c->closed++;
    fixture_plant_close(c->plant);
    c->plant = NULL;
    return 0;
}

static const pupil_camera_ops ops = {ask,        reapply,    frame,   in_force,    learn,
                                     get_status, get_limits, restore, close_camera};

int simulated_camera_open(simulated_camera *c, const fixture_plant_config *config, const fixture_light_script *script,
                          double exposure_s, double gain, pupil_why *why)
{
    *c = (simulated_camera){.base = {&ops}, .config = *config};
    c->status.exposure_s.taken = exposure_s;
    c->status.gain.taken = gain;
    return fixture_plant_open(&c->plant, config, script, exposure_s, gain, why);
}

void simulated_camera_next(simulated_camera *c, pupil_stats *stats, pupil_frame_info *info, fixture_truth *truth)
{
    fixture_plant_next(c->plant, stats, &c->told, truth);
    c->frame = c->told.sequence;
    *info = c->told;
    info->exposure_s = 0.0;
    info->gain = 0.0;
    if (!c->writing || c->frame < c->done_at)
        return;
    finish(c);
    if (c->status.written != c->status.asks) /* the latest of what was asked for meanwhile */
        start(c);
}
