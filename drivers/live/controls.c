/* Where a camera's controls are: on its node, and on its sensor's subdevice. */
#include <linux/v4l2-subdev.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "live.h"
#include "live_private.h"
#include "refuse.h"
#include "v4l2/media/media.h"

/* The capture closes its own file whenever the camera stops, and a write may then still be in progress. */
typedef struct live_files {
    pupil_v4l2_device device;
    int subdevice_fd; /* -1: none */
    pupil_v4l2_sensor sensor;
} live_files;

static atomic_int not_released;

static void released(void *user)
{
    live_files *files = user;
    const pupil_v4l2_system *system = files->device.system;
    if (files->subdevice_fd >= 0)
        system->close(system->context, files->subdevice_fd);
    pupil_v4l2_device_close(&files->device);
    free(files);
    atomic_fetch_sub(&not_released, 1);
}

int pupil_live_await(double most_s, int (*stop)(void))
{
    const struct timespec moment = {0, 10000000};
    for (double s = 0.0; atomic_load(&not_released) && s < most_s && !(stop && stop()); s += 0.01)
        nanosleep(&moment, NULL);
    return atomic_load(&not_released) ? -1 : 0;
}

/* The sensor's subdevice, where there is one that opens; webcams have none. */
static void find_sensor(live_files *files, uint32_t *width, uint32_t *height)
{
    const pupil_v4l2_system *system = files->device.system;
    struct v4l2_subdev_format format = {.which = V4L2_SUBDEV_FORMAT_ACTIVE};
    pupil_why unused;
    if (pupil_v4l2_media_sensor(&files->device, &files->sensor, &unused))
        return;
    files->subdevice_fd = system->open(system->context, files->sensor.path);
    if (files->subdevice_fd < 0 || pupil_v4l2_ioctl(system, files->subdevice_fd, VIDIOC_SUBDEV_G_FMT, &format) < 0)
        return;
    *width = format.format.width;
    *height = format.format.height;
}

pupil_camera *live_controls_open(const live_which *which, pupil_why *why)
{
    live_files *files = calloc(1, sizeof *files);
    if (!files) {
        pupil_refuse(why, "%s: not enough memory", which->path);
        return NULL;
    }
    files->subdevice_fd = -1;
    if (pupil_v4l2_device_open(&files->device, which->system, which->path, why)) {
        free(files);
        return NULL;
    }
    atomic_fetch_add(&not_released, 1);
    uint32_t width = which->width, height = which->height;
    find_sensor(files, &width, &height);
    const pupil_camera_calls calls = {which->system->context, which->system->ioctl};
    const pupil_camera_options options = {.calls = &calls,
                                          .released = released,
                                          .user = files,
                                          .fd = files->device.fd,
                                          .subdevice_fd = files->subdevice_fd,
                                          .sensor_name = *files->sensor.entity ? files->sensor.entity : NULL,
                                          .width = width,
                                          .height = height,
                                          .delay = which->delay,
                                          .mains_hz = which->mains_hz};
    pupil_why reason;
    pupil_camera *camera = pupil_camera_open(&options, &reason);
    if (!camera)
        pupil_refuse(why, "%s: %.900s", which->path, reason.text);
    return camera;
}
