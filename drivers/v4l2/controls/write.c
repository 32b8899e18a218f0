/* One write: what goes first, what goes together, what the driver took. */
#include <math.h>

#include "controls_private.h"

/* Together where the driver takes that; else one by one: 0, or the first error. */
static int set_both(const v4l2_camera *camera, const camera_control *const control[2], const int64_t value[2],
                    int count)
{
    struct v4l2_ext_control batch[2];
    struct v4l2_ext_controls controls = {.count = (uint32_t)count, .controls = batch};
    int error = 0;
    for (int i = 0; i < count; i++)
        batch[i] = (struct v4l2_ext_control){.id = control[i]->id, .value = (int32_t)value[i]};
    if (count == 2 && control[0]->fd == control[1]->fd && !pupil_camera_set_controls(camera, control[0]->fd, &controls))
        return 0;
    for (int i = 0; i < count; i++) {
        const int one = pupil_camera_set_control(camera, control[i]->fd, control[i]->id, value[i]);
        error = error ? error : one;
    }
    return error;
}

/* The frame's period, by lines of blanking; the limits of EXPOSURE move with it. */
static int set_period(v4l2_camera *camera, double frame_s)
{
    camera_control *v = &camera->vblank;
    const double lines = frame_s / camera->line_s + 0.5 - camera->height;
    const int64_t code = lines <= (double)v->range.least  ? v->range.least
                         : lines >= (double)v->range.most ? v->range.most
                                                          : (int64_t)lines;
    camera_control again;
    int64_t taken = code;
    int error = pupil_camera_set_control(camera, v->fd, v->id, code);
    if (!error)
        error = pupil_camera_get_control(camera, v->fd, v->id, &taken);
    if (!error)
        error = pupil_camera_query(camera, camera->exposure.fd, camera->exposure.id, &again);
    if (!error) {
        pthread_mutex_lock(&camera->lock);
        camera->now_frame_s = ((double)taken + camera->height) * camera->line_s;
        camera->exposure.range = again.range;
        pthread_mutex_unlock(&camera->lock);
    }
    return error;
}

int pupil_camera_write(v4l2_camera *camera, const pupil_camera_setting *setting, double *exposure_s, double *gain)
{
    const camera_control *control[2];
    int64_t value[2], taken = 0;
    int count = 0, error = 0, one;
    if (setting->frame_s > 0.0 && camera->vblank.fd >= 0)
        error = set_period(camera, setting->frame_s);
    if (setting->exposure_s > 0.0) {
        control[count] = &camera->exposure;
        value[count++] = pupil_camera_code_of_exposure(setting->exposure_s, camera->unit_s, &camera->exposure.range);
    }
    if (setting->gain > 0.0 && camera->gain.fd >= 0) {
        control[count] = &camera->gain;
        value[count++] = pupil_camera_code_of_gain(&camera->law, setting->gain, &camera->gain.range);
    }
    one = set_both(camera, control, value, count);
    error = error ? error : one;
    /* read back also what was refused: only the driver knows */
    *exposure_s = *gain = 0.0;
    if ((one = pupil_camera_get_control(camera, camera->exposure.fd, camera->exposure.id, &taken)) == 0)
        *exposure_s = (double)taken * camera->unit_s;
    error = error ? error : one;
    if (camera->gain.fd >= 0) {
        if ((one = pupil_camera_get_control(camera, camera->gain.fd, camera->gain.id, &taken)) == 0)
            *gain = pupil_camera_gain_of_code(&camera->law, taken);
        error = error ? error : one;
    }
    return error;
}
