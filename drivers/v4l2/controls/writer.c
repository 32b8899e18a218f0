/* The writer's thread, and what is handed to it and asked about it without waiting. */
#include <errno.h>
#include <math.h>
#include <time.h>

#include "controls_private.h"

enum { FRAME_START_WAIT_MS = 200, STOP_WAIT_MS = 1000 };

static struct timespec later(long ms)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_nsec += ms % 1000 * 1000000;
    t.tv_sec += ms / 1000 + t.tv_nsec / 1000000000;
    t.tv_nsec %= 1000000000;
    return t;
}

/* Waits for something to write; 0: closing. The lock is held. */
static int wait_for_work(v4l2_camera *camera)
{
    while (!camera->closing && camera->status.written == camera->status.asks)
        pthread_cond_wait(&camera->wake, &camera->lock);
    if (camera->at_frame_start && camera->time.any_frame) {
        const struct timespec until = later(FRAME_START_WAIT_MS);
        camera->frame_started = 0;
        while (!camera->closing && !camera->frame_started)
            if (pthread_cond_timedwait(&camera->wake, &camera->lock, &until) == ETIMEDOUT)
                break;
    }
    return !camera->closing;
}

static void *writer(void *of)
{
    v4l2_camera *camera = of;
    pthread_mutex_lock(&camera->lock);
    while (wait_for_work(camera)) {
        const pupil_camera_setting setting = camera->pending;
        const uint64_t number = camera->status.asks;
        const int again = (int)camera->again;
        const uint64_t after = camera->pending_after, *const known = camera->pending_is ? &after : NULL;
        double exposure_s, gain;
        camera->pending = (pupil_camera_setting){0};
        camera->again = 0;
        camera->status.writing = 1;
        pthread_mutex_unlock(&camera->lock);
        int error = again ? pupil_camera_turn_off_again(camera) : 0;
        const int written = pupil_camera_write(camera, &setting, &exposure_s, &gain);
        error = error ? error : written;
        pthread_mutex_lock(&camera->lock);
        camera->status.writing = 0;
        camera->status.written = number;
        if (error) {
            camera->status.failed++;
            camera->status.error = -error;
        }
        pupil_camera_history_take(&camera->exposures, &camera->time, &camera->status.exposure_s, exposure_s, known);
        pupil_camera_history_take(&camera->gains, &camera->time, &camera->status.gain, gain, known);
    }
    camera->running = 0;
    const int abandoned = (int)camera->abandoned;
    pthread_cond_broadcast(&camera->idle);
    pthread_mutex_unlock(&camera->lock);
    if (abandoned) { /* nobody waits any more */
        pupil_camera_put_back(camera, NULL);
        pupil_camera_free(camera);
    }
    return NULL;
}

int pupil_camera_writer_start(v4l2_camera *camera)
{
    pthread_condattr_t monotonic;
    int64_t code = 0;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&camera->lock, NULL);
    pthread_cond_init(&camera->wake, &monotonic);
    pthread_cond_init(&camera->idle, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (!pupil_camera_get_control(camera, camera->exposure.fd, camera->exposure.id, &code))
        pupil_camera_history_take(&camera->exposures, &camera->time, &camera->status.exposure_s,
                                  (double)code * camera->unit_s, NULL);
    if (camera->gain.fd < 0)
        pupil_camera_history_take(&camera->gains, &camera->time, &camera->status.gain, 1.0, NULL);
    else if (!pupil_camera_get_control(camera, camera->gain.fd, camera->gain.id, &code))
        pupil_camera_history_take(&camera->gains, &camera->time, &camera->status.gain,
                                  pupil_camera_gain_of_code(&camera->law, code), NULL);
    camera->running = 1;
    return -pthread_create(&camera->thread, NULL, writer, camera);
}

int pupil_camera_writer_stop(v4l2_camera *camera)
{
    const struct timespec until = later(STOP_WAIT_MS);
    pthread_mutex_lock(&camera->lock);
    camera->closing = 1;
    pthread_cond_broadcast(&camera->wake);
    while (camera->running && pthread_cond_timedwait(&camera->idle, &camera->lock, &until) != ETIMEDOUT)
        ;
    const pthread_t thread = camera->thread;
    const int hangs = (int)camera->running;
    camera->abandoned = (uint32_t)hangs;
    if (hangs) /* under the lock: after it the thread owns the camera */
        pthread_detach(thread);
    pthread_mutex_unlock(&camera->lock);
    if (!hangs)
        pthread_join(thread, NULL);
    return hangs;
}

static double positive(double x)
{
    return x > 0.0 && isfinite(x) ? x : 0.0;
}

uint64_t pupil_camera_v4l2_ask(pupil_camera *of, const pupil_camera_setting *setting)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    const pupil_camera_setting s = {positive(setting->exposure_s), positive(setting->gain), positive(setting->frame_s)};
    pthread_mutex_lock(&camera->lock);
    /* an earlier ask that was not written yet may want a value that the latest leaves as it is */
    camera->pending.exposure_s = s.exposure_s > 0.0 ? s.exposure_s : camera->pending.exposure_s;
    camera->pending.gain = s.gain > 0.0 ? s.gain : camera->pending.gain;
    camera->pending.frame_s = s.frame_s > 0.0 ? s.frame_s : camera->pending.frame_s;
    camera->status.exposure_s.asked = s.exposure_s > 0.0 ? s.exposure_s : camera->status.exposure_s.asked;
    camera->status.gain.asked = s.gain > 0.0 ? s.gain : camera->status.gain.asked;
    camera->pending_after = camera->time.measured;
    camera->pending_is = camera->time.measured_mask != 0;
    const uint64_t number = ++camera->status.asks;
    pthread_cond_broadcast(&camera->wake);
    pthread_mutex_unlock(&camera->lock);
    return number;
}

uint64_t pupil_camera_v4l2_reapply(pupil_camera *of)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    pupil_camera_setting latest = {0};
    pthread_mutex_lock(&camera->lock);
    camera->again = 1;
    latest.exposure_s =
        camera->status.exposure_s.asked > 0.0 ? camera->status.exposure_s.asked : camera->status.exposure_s.taken;
    latest.gain = camera->status.gain.asked > 0.0 ? camera->status.gain.asked : camera->status.gain.taken;
    pthread_mutex_unlock(&camera->lock);
    return pupil_camera_v4l2_ask(of, &latest);
}

void pupil_camera_v4l2_frame(pupil_camera *of, uint64_t sequence, int started)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    pthread_mutex_lock(&camera->lock);
    pupil_camera_timeline_frame(&camera->time, sequence, started);
    if (started) {
        camera->frame_started = 1;
        pthread_cond_broadcast(&camera->wake);
    }
    pthread_mutex_unlock(&camera->lock);
}

void pupil_camera_v4l2_get_status(pupil_camera *of, pupil_camera_status *status)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    pthread_mutex_lock(&camera->lock);
    *status = camera->status;
    pthread_mutex_unlock(&camera->lock);
}
