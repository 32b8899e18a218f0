/* The calls of a camera of any kind: its table's functions, and the configuration of pupil/sensor.h made from its
 * limits. */
#include "pupil/camera_controls.h"

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
        law_of(&l.gain, (double)l.gain_code_step, config);
    if (l.frame_s > 0.0)
        config->frame_s = l.frame_s;
    if (config->frame_s < config->exposure_min_s)
        config->frame_s = config->exposure_min_s;
    /* measured, then written while the next frame is in progress: one frame more than the sensor's own delay */
    const uint32_t longer = l.exposure_delay > l.gain_delay ? l.exposure_delay : l.gain_delay;
    config->delay_frames = longer + 1 < 16 ? longer + 1 : 16;
}

#define MOST_LATE 256 /* frames that are waiting or lost: with more, a timestamp is by another clock */

uint64_t pupil_camera_newest(uint64_t sequence, int64_t end_ns, int64_t now_ns, double frame_s)
{
    const double frames = (double)(now_ns - end_ns) * 1e-9 / frame_s;
    const uint64_t since = frames >= 1.0 ? frames < MOST_LATE ? (uint64_t)frames : MOST_LATE : 0;
    return sequence + since;
}

uint64_t pupil_camera_ask(pupil_camera *camera, const pupil_camera_setting *setting)
{
    return camera->ops->ask(camera, setting);
}

uint64_t pupil_camera_reapply(pupil_camera *camera)
{
    return camera->ops->reapply(camera);
}

void pupil_camera_frame(pupil_camera *camera, uint64_t sequence, int started)
{
    camera->ops->frame(camera, sequence, started);
}

void pupil_camera_in_force(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info)
{
    camera->ops->in_force(camera, sequence, info);
}

void pupil_camera_learn(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay)
{
    camera->ops->learn(camera, exposure_delay, gain_delay);
}

void pupil_camera_get_status(pupil_camera *camera, pupil_camera_status *status)
{
    camera->ops->get_status(camera, status);
}

void pupil_camera_get_limits(pupil_camera *camera, pupil_camera_limits *limits)
{
    camera->ops->get_limits(camera, limits);
}

void pupil_camera_restore(pupil_camera *camera)
{
    if (camera)
        camera->ops->restore(camera);
}

int pupil_camera_close(pupil_camera *camera, pupil_why *why)
{
    return camera ? camera->ops->close(camera, why) : 0;
}
