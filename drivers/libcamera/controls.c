/* Exposure and gain of a camera of libcamera: asked for in the next request, in force as the frames' metadata say. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "libcamera_private.h"
#include "refuse.h"

#define WEBCAM_STEP_S 1e-4 /* UVC: the exposure is in units of 100 us */
#define STEP_S        1e-6 /* ExposureTime is in microseconds; the metadata has it rounded to lines */
#define GAIN_CODES    1024 /* a scale for gains that are plain numbers: finer than sensors' */
/* From a request that is queued to the first frame with its setting, on pipelines that apply a request's controls when
 * it is its turn: the requests before it, and the sensor's own delay of 2 to 3 frames. */
#define REQUEST_DELAY 2

static libcamera_controls *of(pupil_camera *camera)
{
    return (libcamera_controls *)camera;
}

static double positive(double x)
{
    return x > 0.0 && isfinite(x) ? x : 0.0;
}

/* ---- the table of pupil/camera_controls.h ---- */

/* The nearest that the camera can have, as far as that is known. */
static double exposure_of(const libcamera_controls *c, double s)
{
    const double within = fmin(fmax(s, c->can.exposure_s.least), c->can.exposure_s.most);
    return c->is_webcam ? fmax(floor(within / WEBCAM_STEP_S + 1e-3), 1.0) * WEBCAM_STEP_S : within;
}

static int has_gain(const libcamera_controls *c)
{
    return !c->is_webcam && c->can.controls & PUPIL_LIBCAMERA_CAN_GAIN && c->can.gain.most > 0.0;
}

static double gain_of(const libcamera_controls *c, double gain)
{
    return fmin(fmax(gain, c->can.gain.least), c->can.gain.most);
}

static uint64_t ask(pupil_camera *camera, const pupil_camera_setting *setting)
{
    libcamera_controls *c = of(camera);
    pupil_camera_status *status = &c->status;
    const pupil_camera_setting s = {positive(setting->exposure_s), positive(setting->gain), positive(setting->frame_s)};
    pthread_mutex_lock(&c->lock);
    if (!c->waits)
        c->before = (pupil_camera_setting){.exposure_s = status->exposure_s.taken, .gain = status->gain.taken};
    if (s.exposure_s > 0.0) {
        c->pending.exposure_s = status->exposure_s.asked = s.exposure_s;
        status->exposure_s.taken = exposure_of(c, s.exposure_s);
        status->exposure_s.from_frame = c->time.under_way + c->exposures.delay;
    }
    if (s.gain > 0.0)
        c->pending.gain = status->gain.asked = s.gain;
    if (s.gain > 0.0 && has_gain(c)) {
        status->gain.taken = gain_of(c, s.gain);
        status->gain.from_frame = c->time.under_way + c->gains.delay;
    }
    c->pending.frame_s = s.frame_s > 0.0 ? s.frame_s : c->pending.frame_s;
    c->pending_after = c->time.measured;
    c->pending_is = c->time.measured_mask != 0;
    c->waits = 1;
    const uint64_t number = status->written = ++status->asks; /* handed over: it goes with the next request */
    pthread_mutex_unlock(&c->lock);
    return number;
}

static uint64_t reapply(pupil_camera *camera)
{
    libcamera_controls *c = of(camera);
    pthread_mutex_lock(&c->lock);
    const pupil_camera_setting latest = {.exposure_s = c->status.exposure_s.asked, .gain = c->status.gain.asked};
    pthread_mutex_unlock(&c->lock);
    return ask(camera, &latest);
}

static void frame(pupil_camera *camera, uint64_t sequence, int started)
{
    libcamera_controls *c = of(camera);
    pthread_mutex_lock(&c->lock);
    pupil_camera_timeline_frame(&c->time, sequence, started);
    pthread_mutex_unlock(&c->lock);
}

static void in_force(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info)
{
    libcamera_controls *c = of(camera);
    pthread_mutex_lock(&c->lock);
    const int says = c->told && sequence == c->told_sequence;
    info->exposure_s = says ? c->told_exposure_s : pupil_camera_history_at(&c->exposures, sequence);
    info->gain = says && c->told_gain > 0.0 ? c->told_gain : pupil_camera_history_at(&c->gains, sequence);
    pupil_camera_timeline_measured(&c->time, sequence);
    pthread_mutex_unlock(&c->lock);
}

static void learn(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay)
{
    libcamera_controls *c = of(camera);
    camera_history *e = &c->exposures, *g = &c->gains;
    pthread_mutex_lock(&c->lock);
    if (!c->delay_given && !c->told && pupil_camera_history_learn(e, g, &c->time, exposure_delay, gain_delay)) {
        c->status.exposure_s.from_frame = e->count ? pupil_camera_history_acts_from(e) : 0;
        c->status.gain.from_frame = g->count ? pupil_camera_history_acts_from(g) : 0;
    }
    pthread_mutex_unlock(&c->lock);
}

static void get_status(pupil_camera *camera, pupil_camera_status *status)
{
    libcamera_controls *c = of(camera);
    pthread_mutex_lock(&c->lock);
    *status = c->status;
    pthread_mutex_unlock(&c->lock);
}

static void get_limits(pupil_camera *camera, pupil_camera_limits *limits)
{
    libcamera_controls *c = of(camera);
    const pupil_libcamera_can *can = &c->can;
    pthread_mutex_lock(&c->lock);
    *limits = (pupil_camera_limits){.exposure_min_s = can->exposure_s.least,
                                    .exposure_max_s = can->exposure_s.most,
                                    .exposure_step_s = c->is_webcam ? WEBCAM_STEP_S : STEP_S,
                                    .gain_min = 1.0,
                                    .gain_max = 1.0,
                                    .frame_s = c->frame_s,
                                    .exposure_delay = c->exposures.delay,
                                    .gain_delay = c->gains.delay,
                                    .gain = {.law = PUPIL_CAMERA_RATIO, .p = {1.0, 0.0, 0.0, GAIN_CODES}},
                                    .gain_code_step = 1};
    pthread_mutex_unlock(&c->lock);
    if (has_gain(c)) {
        limits->has_gain = limits->gain_known = 1;
        limits->gain_min = can->gain.least > 0.0 ? can->gain.least : 1.0;
        limits->gain_max = can->gain.most;
    }
    if (can->controls & PUPIL_LIBCAMERA_CAN_FRAME) {
        limits->frame_min_s = can->frame_s.least;
        limits->frame_max_s = can->frame_s.most;
    }
}

static void restore(pupil_camera *camera)
{
    libcamera_node_put_back(&of(camera)->node);
}

static int close_controls(pupil_camera *camera, pupil_why *why)
{
    libcamera_controls *c = of(camera);
    const int failed = libcamera_node_put_back(&c->node);
    libcamera_node_close(&c->node);
    pthread_mutex_destroy(&c->lock);
    free(c);
    return failed ? pupil_refuse(why, "%d of the webcam's controls could not be put back to what they were", failed)
                  : 0;
}

static const pupil_camera_ops ops = {ask,        reapply,    frame,   in_force,      learn,
                                     get_status, get_limits, restore, close_controls};

/* ---- for the source ---- */

libcamera_controls *libcamera_controls_open(const pupil_libcamera_can *can, const char *id,
                                            const pupil_libcamera_options *options, uint32_t buffers, double frame_s,
                                            pupil_why *why)
{
    if (!(can->controls & PUPIL_LIBCAMERA_CAN_EXPOSURE) || !(can->exposure_s.most > 0.0)) {
        pupil_refuse(why, "libcamera has no control of this camera's exposure time");
        return NULL;
    }
    libcamera_controls *c = calloc(1, sizeof *c);
    if (!c) {
        pupil_refuse(why, "not enough memory for its controls");
        return NULL;
    }
    c->base.ops = &ops;
    c->can = *can;
    c->can.exposure_s.least = fmax(can->exposure_s.least, STEP_S);
    c->is_webcam = (uint32_t)libcamera_is_webcam(id);
    c->takes_over = 1;
    c->delay_given = options->delay != 0;
    c->exposures.delay = c->gains.delay = options->delay ? options->delay
                                          : c->is_webcam ? CAMERA_USUAL_DELAY
                                                         : buffers + REQUEST_DELAY;
    c->node.fd = -1;
    pthread_mutex_init(&c->lock, NULL);
    if (c->is_webcam)
        libcamera_node_open(&c->node, options->v4l2, id);
    c->frame_s = c->node.frame_s > 0.0 ? c->node.frame_s : frame_s;
    pupil_camera_history_take(&c->exposures, &c->time, &c->status.exposure_s, c->node.exposure_s, NULL);
    if (!has_gain(c))
        pupil_camera_history_take(&c->gains, &c->time, &c->status.gain, 1.0, NULL);
    return c;
}

/* The frame's own period; longer where the exposure is. */
static void choose_frame(const libcamera_controls *c, pupil_libcamera_ask *a)
{
    const double frame_s = c->pending.frame_s > 0.0 ? c->pending.frame_s : c->frame_s;
    if (!(c->can.controls & PUPIL_LIBCAMERA_CAN_FRAME))
        return;
    a->frame_least_s = fmax(frame_s, c->can.frame_s.least);
    a->frame_most_s = fmax(a->frame_least_s, a->exposure_s);
    if (c->can.frame_s.most > 0.0) {
        a->frame_least_s = fmin(a->frame_least_s, c->can.frame_s.most);
        a->frame_most_s = fmin(a->frame_most_s, c->can.frame_s.most);
    }
}

/* It is queued now. Frames that report nothing are assumed to have it after the usual delay, or the learned one. */
static void take(libcamera_controls *c, const pupil_libcamera_ask *a)
{
    const uint64_t *const after = c->pending_is ? &c->pending_after : NULL;
    pupil_camera_value *exposure = &c->status.exposure_s, *gain = &c->status.gain;
    if (c->told) {
        exposure->from_frame = c->time.under_way + c->exposures.delay;
        gain->from_frame = c->time.under_way + c->gains.delay;
        return;
    }
    exposure->taken = c->before.exposure_s;
    gain->taken = c->before.gain;
    pupil_camera_history_take(&c->exposures, &c->time, exposure, a->exposure_s, after);
    pupil_camera_history_take(&c->gains, &c->time, gain, a->gain, after);
}

pupil_libcamera_ask libcamera_controls_next(libcamera_controls *c)
{
    pupil_libcamera_ask a = {0};
    pthread_mutex_lock(&c->lock);
    if (c->takes_over) { /* alone: some pipelines refuse an exposure time until that is done */
        a.automatic = -1;
        choose_frame(c, &a);
        c->takes_over = 0;
    } else if (c->waits) {
        a.exposure_s = c->pending.exposure_s > 0.0 ? exposure_of(c, c->pending.exposure_s) : 0.0;
        a.gain = has_gain(c) && c->pending.gain > 0.0 ? gain_of(c, c->pending.gain) : 0.0;
        choose_frame(c, &a);
        take(c, &a);
        c->pending = (pupil_camera_setting){0};
        c->waits = 0;
    }
    pthread_mutex_unlock(&c->lock);
    return a;
}

void libcamera_controls_refused(libcamera_controls *c, const pupil_libcamera_ask *a)
{
    pthread_mutex_lock(&c->lock);
    if (a->automatic < 0)
        c->takes_over = 1;
    if (a->exposure_s > 0.0 || a->gain > 0.0) {
        c->status.failed++;
        c->status.error = ECANCELED;
        if (!c->told) { /* the camera has the setting from before */
            pupil_camera_history_take(&c->exposures, &c->time, &c->status.exposure_s, c->before.exposure_s, NULL);
            pupil_camera_history_take(&c->gains, &c->time, &c->status.gain, c->before.gain, NULL);
        }
    }
    pthread_mutex_unlock(&c->lock);
}

void libcamera_controls_told(libcamera_controls *c, uint64_t sequence, double exposure_s, double gain)
{
    if (!(exposure_s > 0.0))
        return;
    pthread_mutex_lock(&c->lock);
    const double known_gain = gain > 0.0 ? gain : c->status.gain.taken;
    if (exposure_s != c->status.exposure_s.taken)
        c->status.exposure_s.from_frame = sequence;
    if (known_gain != c->status.gain.taken)
        c->status.gain.from_frame = sequence;
    c->status.exposure_s.taken = c->told_exposure_s = exposure_s;
    c->status.gain.taken = c->told_gain = known_gain;
    c->told_sequence = sequence;
    c->told = 1;
    pthread_mutex_unlock(&c->lock);
}

void libcamera_controls_restart(libcamera_controls *c)
{
    pthread_mutex_lock(&c->lock);
    c->takes_over = 1;
    pthread_mutex_unlock(&c->lock);
    reapply(&c->base);
}
