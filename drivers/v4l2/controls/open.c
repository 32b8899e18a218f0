/* Finding the controls, and the object's life. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "controls_private.h"

static int system_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    (void)context;
    return (int)syscall(SYS_ioctl, fd, request, argument); /* the type of ioctl's request differs among C libraries */
}

/* On the subdevice, or passed on to the video node: 1; 0: there is none; -1: the driver fails, and `why` says so. */
static int find(const v4l2_camera *camera, uint32_t id, camera_control *control, pupil_why *why)
{
    const int fd[2] = {camera->subdevice_fd, camera->fd};
    *control = (camera_control){.fd = -1};
    for (int i = 0; i < 2; i++) {
        const int error = fd[i] < 0 ? -EINVAL : pupil_camera_query(camera, fd[i], id, control);
        if (!error)
            return 1;
        if (error != -EINVAL && error != -ENOTTY) /* EINVAL: no such control; ENOTTY: no controls at all */
            return pupil_refuse(why, "the driver does not answer for %s: %s", pupil_camera_control_name(id),
                                strerror(-error));
    }
    return 0;
}

/* line_s: 1; 0: it is not known; -1 and a sentence. */
static int find_line(v4l2_camera *camera, const pupil_camera_options *options, pupil_why *why)
{
    camera_control rate, blank;
    int64_t pixels_a_second = 0, pixels = 0;
    if (options->line_s > 0.0 && isfinite(options->line_s)) {
        camera->line_s = options->line_s;
        return 1;
    }
    const int has_rate = find(camera, V4L2_CID_PIXEL_RATE, &rate, why);
    const int has_blank = has_rate < 0 ? -1 : find(camera, V4L2_CID_HBLANK, &blank, why);
    if (has_blank < 0)
        return -1;
    if (!has_rate || !has_blank || pupil_camera_get_control(camera, rate.fd, rate.id, &pixels_a_second) ||
        pupil_camera_get_control(camera, blank.fd, blank.id, &pixels) || pixels_a_second <= 0 || pixels < 0 ||
        !options->width)
        return 0;
    camera->line_s = (double)(pixels + options->width) / (double)pixels_a_second;
    return 1;
}

static int find_exposure(v4l2_camera *camera, const pupil_camera_options *options, pupil_why *why)
{
    int64_t blank = 0;
    camera->vblank.fd = camera->gain.fd = -1;
    int has = find(camera, V4L2_CID_EXPOSURE_ABSOLUTE, &camera->exposure, why);
    camera->unit_s = 1e-4; /* V4L2: "in 100 us units" */
    if (has > 0) {         /* then only the readout needs the line's time, which may stay unknown */
        pupil_why unused;
        (void)find_line(camera, options, &unused);
    }
    if (has)
        return has < 0 ? -1 : 0;
    has = find(camera, V4L2_CID_EXPOSURE, &camera->exposure, why);
    if (has == 0)
        return pupil_refuse(why, "this camera has neither EXPOSURE_ABSOLUTE nor EXPOSURE, on the video node or on its "
                                 "sensor's subdevice: its exposure time cannot be set");
    const int has_line = has < 0 ? -1 : find_line(camera, options, why);
    if (has_line < 0)
        return -1;
    if (!has_line)
        return pupil_refuse(
            why, "EXPOSURE counts lines, and a line's time is not known: the driver must report PIXEL_RATE and "
                 "HBLANK, and the caller the width; or the caller the line's time itself");
    camera->unit_s = camera->line_s;
    has = options->height ? find(camera, V4L2_CID_VBLANK, &camera->vblank, why) : 0;
    if (has > 0 && !pupil_camera_get_control(camera, camera->vblank.fd, camera->vblank.id, &blank))
        camera->now_frame_s = ((double)blank + camera->height) * camera->line_s;
    return has < 0 ? -1 : 0;
}

/* Chooses the law of a control without a known one, and leaves out codes that have no gain: 0 of a proportional law. */
static void settle_law(v4l2_camera *camera, const pupil_camera_gain *known)
{
    pupil_camera_range *r = &camera->gain.range;
    const int64_t one = r->least > 0 ? r->least : r->usual > 0 ? r->usual : 1;
    camera->gain_known = known != NULL;
    camera->law = known ? *known : (pupil_camera_gain){.law = PUPIL_CAMERA_RATIO, .p = {1.0, 0.0, 0.0, (double)one}};
    while (pupil_camera_gain_of_code(&camera->law, r->least) == 0.0 && r->least < r->most && r->least < 65536)
        r->least += r->step > 0 ? r->step : 1;
}

static int find_law(v4l2_camera *camera, const pupil_camera_options *options, pupil_why *why)
{
    pupil_camera_sensor sensor = {.black = -1.0};
    int known = options->sensor != NULL;
    if (known)
        sensor = *options->sensor;
    else if (options->sensor_name && (known = pupil_camera_find_sensor(NULL, options->sensor_name, &sensor, why)) < 0)
        return -1;
    camera->exposures.delay = sensor.exposure_delay ? sensor.exposure_delay : CAMERA_USUAL_DELAY;
    camera->gains.delay = sensor.gain_delay ? sensor.gain_delay : CAMERA_USUAL_DELAY;
    camera->delay_given = options->delay != 0;
    if (options->delay)
        camera->exposures.delay = camera->gains.delay = options->delay;
    int has = find(camera, V4L2_CID_ANALOGUE_GAIN, &camera->gain, why);
    if (has == 0) { /* the table's laws are those of ANALOGUE_GAIN; the caller's is of any control */
        has = find(camera, V4L2_CID_GAIN, &camera->gain, why);
        known &= options->sensor != NULL;
    }
    if (has > 0)
        settle_law(camera, known ? &sensor.gain : NULL);
    return has < 0 ? -1 : 0;
}

static int set_up(v4l2_camera *camera, const pupil_camera_options *options, pupil_why *why)
{
    if ((options->fd >= 0 && camera->fd < 0) || (options->subdevice_fd >= 0 && camera->subdevice_fd < 0))
        return pupil_refuse(why, "no file could be opened: %s", strerror(errno));
    if (options->mains_hz && options->mains_hz != 50 && options->mains_hz != 60)
        return pupil_refuse(why, "mains_hz must be 50, 60 or 0, not %u", options->mains_hz);
    if (find_exposure(camera, options, why) || find_law(camera, options, why) ||
        pupil_camera_take(camera, options->mains_hz, why))
        return -1;
    const int error = pupil_camera_writer_start(camera);
    return error ? pupil_refuse(why, "no thread for the camera's controls: %s", strerror(-error)) : 0;
}

static int close_camera(pupil_camera *of, pupil_why *why)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    uint32_t first = 0;
    if (pupil_camera_writer_stop(camera)) /* the thread owns the object now */
        return 1;
    const int failed = pupil_camera_put_back(camera, &first);
    if (failed)
        pupil_refuse(why, "%s could not be put back to what it was before (and %d other controls)",
                     pupil_camera_control_name(first), failed - 1);
    pupil_camera_free(camera);
    return failed ? -1 : 0;
}

static void restore(pupil_camera *of)
{
    pupil_camera_put_back((v4l2_camera *)of, NULL);
}

static const pupil_camera_ops ops = {
    .ask = pupil_camera_v4l2_ask,
    .reapply = pupil_camera_v4l2_reapply,
    .frame = pupil_camera_v4l2_frame,
    .in_force = pupil_camera_v4l2_in_force,
    .learn = pupil_camera_v4l2_learn,
    .get_status = pupil_camera_v4l2_get_status,
    .get_limits = pupil_camera_v4l2_get_limits,
    .restore = restore,
    .close = close_camera,
};

pupil_camera *pupil_camera_open(const pupil_camera_options *options, pupil_why *why)
{
    v4l2_camera *camera = calloc(1, sizeof *camera);
    if (!camera) {
        pupil_refuse(why, "no memory for the camera's controls");
        if (options->released)
            options->released(options->user);
        return NULL;
    }
    camera->base.ops = &ops;
    camera->calls = options->calls ? *options->calls : (pupil_camera_calls){.ioctl = system_ioctl};
    camera->released = options->released;
    camera->user = options->user;
    camera->owns = !options->calls;
    camera->fd = options->fd;
    camera->subdevice_fd = options->subdevice_fd;
    camera->height = options->height;
    camera->at_frame_start = options->at_frame_start;
    if (camera->owns) { /* so that a write that hangs can still end after the caller closed its own */
        camera->fd = options->fd < 0 ? -1 : fcntl(options->fd, F_DUPFD_CLOEXEC, 0);
        camera->subdevice_fd = options->subdevice_fd < 0 ? -1 : fcntl(options->subdevice_fd, F_DUPFD_CLOEXEC, 0);
    }
    if (set_up(camera, options, why)) {
        pupil_camera_put_back(camera, NULL);
        pupil_camera_free(camera);
        return NULL;
    }
    return &camera->base;
}
