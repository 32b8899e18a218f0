/* What the camera can, in seconds and factors. */
#include <math.h>

#include "controls_private.h"

void pupil_camera_v4l2_get_limits(pupil_camera *of, pupil_camera_limits *l)
{
    v4l2_camera *camera = (v4l2_camera *)of;
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
        l->gain_code_step = g->step > 0 ? g->step : 1;
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
