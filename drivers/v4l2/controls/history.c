/* What was in force in a frame, and what frames show about it. */
#include "controls_private.h"

void pupil_camera_v4l2_in_force(pupil_camera *of, uint64_t sequence, pupil_frame_info *info)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    pthread_mutex_lock(&camera->lock);
    info->exposure_s = pupil_camera_history_at(&camera->exposures, sequence);
    info->gain = pupil_camera_history_at(&camera->gains, sequence);
    pupil_camera_timeline_measured(&camera->time, sequence);
    pthread_mutex_unlock(&camera->lock);
}

void pupil_camera_v4l2_learn(pupil_camera *of, uint32_t exposure_delay, uint32_t gain_delay)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    camera_history *e = &camera->exposures, *g = &camera->gains;
    pthread_mutex_lock(&camera->lock);
    if (!camera->delay_given && pupil_camera_history_learn(e, g, &camera->time, exposure_delay, gain_delay)) {
        camera->status.exposure_s.from_frame = e->count ? pupil_camera_history_acts_from(e) : 0;
        camera->status.gain.from_frame = g->count ? pupil_camera_history_acts_from(g) : 0;
    }
    pthread_mutex_unlock(&camera->lock);
}
