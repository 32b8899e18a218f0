/* What the camera can, in seconds and factors. */
#include <math.h>

#include "controls_private.h"

void pupil_camera_get_limits(pupil_camera *camera, pupil_camera_limits *l)
{
    pthread_mutex_lock(&camera->lock);
    const pupil_camera_range range = camera->exposure.range, *e = &range;
    const double frame_s = camera->now_frame_s;
    const uint32_t exposure_delay = camera->exposures.delay, gain_delay = camera->gains.delay;
    pthread_mutex_unlock(&camera->lock);
    const pupil_camera_range *g = &camera->gain.range, *v = &camera->vblank.range;
    *l = (pupil_camera_limits){.gain_min = 1.0, .gain_max = 1.0};
    l->exposure_step_s = camera->unit_s * (double)(e->step > 0 ? e->step : 1);
    l->exposure_min_s = camera->unit_s * (double)(e->least > 0 ? e->least : 1);
    l->exposure_max_s = camera->unit_s * (double)e->most;
    l->readout_s = camera->line_s * camera->height;
    l->exposure_delay = exposure_delay;
    l->gain_delay = gain_delay;
    l->has_gain = camera->gain.fd >= 0;
    if (l->has_gain) {
        l->gain = camera->law;
        l->gain_known = camera->gain_known;
        l->gain_min = pupil_camera_gain_of_code(&camera->law, g->least);
        l->gain_max = pupil_camera_gain_of_code(&camera->law, pupil_camera_code_of_gain(&camera->law, INFINITY, g));
    }
    if (camera->vblank.fd >= 0) {
        l->frame_s = frame_s;
        l->frame_min_s = ((double)v->least + camera->height) * camera->line_s;
        l->frame_max_s = ((double)v->most + camera->height) * camera->line_s;
    }
}

/* The same law by pupil/sensor.h's names, where it has one. */
static void law_of(const pupil_camera_gain *gain, double step, pupil_sensor_config *config)
{
    const double *p = gain->p;
    config->gain_law = PUPIL_GAIN_ANY;
    if (gain->law == PUPIL_CAMERA_DB) {
        config->gain_law = PUPIL_GAIN_DB;
        config->gain_step = p[0] * step;
    } else if (gain->law == PUPIL_CAMERA_RATIO && p[1] == 0.0 && p[2] == 0.0) {
        config->gain_law = PUPIL_GAIN_LINEAR;
        config->gain_step = p[0] * step / p[3];
    } else if (gain->law == PUPIL_CAMERA_RATIO && p[0] == 0.0 && p[1] == p[3] && p[2] == -1.0 && step == 1.0) {
        config->gain_law = PUPIL_GAIN_RECIPROCAL;
        config->gain_step = p[3];
    } else if (gain->law == PUPIL_CAMERA_TABLE && gain->rows && step == 1.0) {
        config->gain_law = PUPIL_GAIN_TABLE;
        config->gain_count = gain->rows;
        for (uint32_t i = 0; i < gain->rows; i++)
            config->gain_table[i] = gain->gain[i];
    }
}

void pupil_camera_configure(pupil_camera *camera, pupil_sensor_config *config)
{
    pupil_camera_limits l;
    pupil_camera_get_limits(camera, &l);
    config->exposure_step_s = l.exposure_step_s;
    config->exposure_min_s = l.exposure_min_s;
    config->exposure_max_s = l.exposure_max_s;
    config->gain_min = l.gain_min;
    config->gain_max = l.gain_max;
    if (l.has_gain)
        law_of(&l.gain, (double)(camera->gain.range.step > 0 ? camera->gain.range.step : 1), config);
    if (l.frame_s > 0.0)
        config->frame_s = l.frame_s;
    if (config->frame_s < config->exposure_min_s)
        config->frame_s = config->exposure_min_s;
    /* measured, then written while the next frame is under way: one frame more than the sensor's own delay */
    const uint32_t longer = l.exposure_delay > l.gain_delay ? l.exposure_delay : l.gain_delay;
    config->delay_frames = longer + 1 < 16 ? longer + 1 : 16;
}
