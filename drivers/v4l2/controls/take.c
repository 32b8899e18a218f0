/* System calls; taking the camera and giving it back. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "controls_private.h"

enum { PUT_BACK_AGAIN = 4, PUT_BACK_PAUSE_NS = 10000000 }; /* a write to a webcam takes some milliseconds */

/* 0, or a negative errno; again where a signal interrupted it, a hundred times at most. */
static int call(const v4l2_camera *camera, int fd, unsigned long request, void *argument)
{
    int result = -1;
    int error = EINTR;
    for (int i = 0; i < 100 && result < 0 && error == EINTR; i++) {
        result = camera->calls.ioctl(camera->calls.context, fd, request, argument);
        error = result < 0 ? errno : 0;
    }
    return -error;
}

int pupil_camera_query(const v4l2_camera *camera, int fd, uint32_t id, camera_control *control)
{
    struct v4l2_query_ext_ctrl query = {.id = id};
    struct v4l2_queryctrl older = {.id = id};
    int error = call(camera, fd, VIDIOC_QUERY_EXT_CTRL, &query);
    *control = (camera_control){.fd = -1, .id = id};
    if (error == -ENOTTY) { /* kernels before 3.17, and drivers that do without the framework */
        error = call(camera, fd, VIDIOC_QUERYCTRL, &older);
        query.flags = older.flags;
        query.minimum = older.minimum;
        query.maximum = older.maximum;
        query.step = (uint64_t)older.step;
        query.default_value = older.default_value;
    }
    if (error)
        return error;
    if (query.flags & V4L2_CTRL_FLAG_DISABLED)
        return -EINVAL;
    control->fd = fd;
    control->range = (pupil_camera_range){query.minimum, query.maximum, (int64_t)query.step, query.default_value};
    return 0;
}

int pupil_camera_set_controls(const v4l2_camera *camera, int fd, struct v4l2_ext_controls *controls)
{
    return call(camera, fd, VIDIOC_S_EXT_CTRLS, controls);
}

int pupil_camera_get_control(const v4l2_camera *camera, int fd, uint32_t id, int64_t *value)
{
    struct v4l2_ext_control control = {.id = id};
    struct v4l2_ext_controls controls = {.count = 1, .controls = &control};
    const int error = call(camera, fd, VIDIOC_G_EXT_CTRLS, &controls);
    if (!error)
        *value = id == V4L2_CID_PIXEL_RATE ? control.value64 : control.value;
    return error;
}

int pupil_camera_set_control(const v4l2_camera *camera, int fd, uint32_t id, int64_t value)
{
    struct v4l2_ext_control control = {.id = id, .value = (int32_t)value};
    struct v4l2_ext_controls controls = {.count = 1, .controls = &control};
    return call(camera, fd, VIDIOC_S_EXT_CTRLS, &controls);
}

const char *pupil_camera_control_name(uint32_t id)
{
    static const struct {
        uint32_t id;
        const char *name;
    } names[] = {
        {V4L2_CID_EXPOSURE, "EXPOSURE"},
        {V4L2_CID_EXPOSURE_ABSOLUTE, "EXPOSURE_ABSOLUTE"},
        {V4L2_CID_EXPOSURE_AUTO, "EXPOSURE_AUTO"},
        {V4L2_CID_EXPOSURE_AUTO_PRIORITY, "EXPOSURE_AUTO_PRIORITY"},
        {V4L2_CID_ANALOGUE_GAIN, "ANALOGUE_GAIN"},
        {V4L2_CID_GAIN, "GAIN"},
        {V4L2_CID_VBLANK, "VBLANK"},
        {V4L2_CID_HBLANK, "HBLANK"},
        {V4L2_CID_PIXEL_RATE, "PIXEL_RATE"},
        {V4L2_CID_AUTOGAIN, "AUTOGAIN"},
        {V4L2_CID_AUTO_WHITE_BALANCE, "AUTO_WHITE_BALANCE"},
        {V4L2_CID_BACKLIGHT_COMPENSATION, "BACKLIGHT_COMPENSATION"},
        {V4L2_CID_POWER_LINE_FREQUENCY, "POWER_LINE_FREQUENCY"},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].id == id)
            return names[i].name;
    return "a control";
}

static int note(v4l2_camera *camera, int fd, uint32_t id, pupil_why *why)
{
    int64_t value = 0;
    const int error = pupil_camera_get_control(camera, fd, id, &value);
    if (error)
        return pupil_refuse(why, "the driver does not report the value of %s: %s", pupil_camera_control_name(id),
                            strerror(-error));
    camera->saved[camera->saved_count].fd = fd;
    camera->saved[camera->saved_count].id = id;
    camera->saved[camera->saved_count++].value = value;
    return 0;
}

/* The entry of EXPOSURE_AUTO by which a program sets the time: the menu need not have all. */
static int64_t manual_of(const v4l2_camera *camera, const camera_control *control)
{
    static const uint32_t wanted[] = {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY};
    for (int i = 0; i < 2; i++) {
        struct v4l2_querymenu menu = {.id = control->id, .index = wanted[i]};
        if (wanted[i] >= control->range.least && wanted[i] <= control->range.most &&
            !call(camera, control->fd, VIDIOC_QUERYMENU, &menu))
            return wanted[i];
    }
    return -1;
}

/* Turns one off on every file that has it. */
static int turn_off(v4l2_camera *camera, int fd, uint32_t id, int64_t value, pupil_why *why)
{
    camera_control control;
    const int absent = fd < 0 ? -EINVAL : pupil_camera_query(camera, fd, id, &control);
    if (absent == -EINVAL || absent == -ENOTTY)
        return 0;
    if (absent)
        return pupil_refuse(why, "the driver does not answer for %s: %s", pupil_camera_control_name(id),
                            strerror(-absent));
    if (id == V4L2_CID_EXPOSURE_AUTO && (value = manual_of(camera, &control)) < 0)
        return pupil_refuse(why,
                            "the menu of EXPOSURE_AUTO has neither manual nor shutter priority: this camera's exposure "
                            "cannot be set");
    value = value < control.range.least ? control.range.least : value > control.range.most ? control.range.most : value;
    if (note(camera, fd, id, why))
        return -1;
    camera->off[camera->off_count].fd = fd;
    camera->off[camera->off_count].id = id;
    camera->off[camera->off_count++].value = value;
    const int error = pupil_camera_set_control(camera, fd, id, value);
    /* EINVAL of the priority: some cameras allow it in other modes only, and then it does nothing */
    if (error && !(id == V4L2_CID_EXPOSURE_AUTO_PRIORITY && error == -EINVAL))
        return pupil_refuse(why, "the driver refuses %s = %lld: %s", pupil_camera_control_name(id), (long long)value,
                            strerror(-error));
    return 0;
}

int pupil_camera_take(v4l2_camera *camera, uint32_t mains_hz, pupil_why *why)
{
    const camera_control *const steered[] = {&camera->vblank, &camera->exposure, &camera->gain};
    const int64_t mains = mains_hz == 50 ? V4L2_CID_POWER_LINE_FREQUENCY_50HZ : V4L2_CID_POWER_LINE_FREQUENCY_60HZ;
    const struct {
        uint32_t id;
        int64_t value;
    } off[] = {
        {V4L2_CID_AUTOGAIN, 0},
        {V4L2_CID_AUTO_WHITE_BALANCE, 0},
        {V4L2_CID_BACKLIGHT_COMPENSATION, 0},
        {V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0},
        {V4L2_CID_POWER_LINE_FREQUENCY, mains},
        {V4L2_CID_EXPOSURE_AUTO, 0},
    };
    const int fd[2] = {camera->subdevice_fd, camera->fd};
    /* What is steered is put back first, while it still can be written, in the order in which it is written. */
    for (int i = 0; i < 3; i++)
        if (steered[i]->fd >= 0 && note(camera, steered[i]->fd, steered[i]->id, why))
            return -1;
    for (size_t i = 0; i < sizeof off / sizeof *off; i++)
        for (int k = 0; k < 2; k++)
            if ((off[i].id != V4L2_CID_POWER_LINE_FREQUENCY || mains_hz) &&
                turn_off(camera, fd[k], off[i].id, off[i].value, why))
                return -1;
    return 0;
}

int pupil_camera_turn_off_again(const v4l2_camera *camera)
{
    int error = 0;
    for (uint32_t i = 0; i < camera->off_count; i++) {
        const int one = pupil_camera_set_control(camera, camera->off[i].fd, camera->off[i].id, camera->off[i].value);
        error = error || camera->off[i].id == V4L2_CID_EXPOSURE_AUTO_PRIORITY ? error : one;
    }
    return error;
}

/* 1: it has its value again. A camera may be busy for a moment, and nothing tries again after this. */
static int put_one_back(const v4l2_camera *camera, int fd, uint32_t id, int64_t value)
{
    for (int i = 0;; i++) {
        int64_t found = 0;
        const int error = pupil_camera_set_control(camera, fd, id, value);
        if (!error)
            return 1;
        /* a control that has its value already, but cannot be written in this mode, is as it was */
        if (!pupil_camera_get_control(camera, fd, id, &found) && found == value)
            return 1;
        if (error == -ENODEV || i == PUT_BACK_AGAIN)
            return 0;
        nanosleep(&(struct timespec){0, PUT_BACK_PAUSE_NS}, NULL);
    }
}

int pupil_camera_put_back(const v4l2_camera *camera, uint32_t *first)
{
    int failed = 0;
    for (uint32_t i = 0; i < camera->saved_count; i++)
        if (!put_one_back(camera, camera->saved[i].fd, camera->saved[i].id, camera->saved[i].value) && !failed++ &&
            first)
            *first = camera->saved[i].id;
    return failed;
}

void pupil_camera_free(v4l2_camera *camera)
{
    void (*const released)(void *user) = camera->released;
    void *user = camera->user;
    if (camera->owns) {
        if (camera->fd >= 0)
            close(camera->fd);
        if (camera->subdevice_fd >= 0)
            close(camera->subdevice_fd);
    }
    pthread_cond_destroy(&camera->wake);
    pthread_cond_destroy(&camera->idle);
    pthread_mutex_destroy(&camera->lock);
    free(camera);
    if (released)
        released(user);
}
