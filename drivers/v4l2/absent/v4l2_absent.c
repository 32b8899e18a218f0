/* drivers/v4l2/absent/v4l2_absent.c: in the place of the cameras where they are not built in. */
#include <stdio.h>
#include <string.h>

#include "refuse.h"
#include "v4l2/capture/capture.h"
#include "v4l2/device.h"
#include "v4l2/format.h"
#include "v4l2/media/media.h"
#include "v4l2/modes.h"
#include "v4l2/output/v4l2_sink.h"

static int absent(const char *which, pupil_why *why)
{
    return pupil_refuse(why, "%s: this program was built without cameras (PUPIL_V4L2=OFF)", which);
}

int pupil_v4l2_devices(const pupil_v4l2_system *system, pupil_v4l2_seen *seen, void *closure, pupil_why *why)
{
    (void)system, (void)seen, (void)closure;
    return absent("/dev/video*", why);
}

int pupil_is_v4l2_output(const char *path)
{
    return strncmp(path, "/dev/video", 10) == 0 || strncmp(path, "/dev/v4l/", 9) == 0 ||
           strncmp(path, PUPIL_V4L2_PREFIX, sizeof PUPIL_V4L2_PREFIX - 1) == 0;
}

int pupil_v4l2_sink_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                         const pupil_v4l2_system *system, pupil_why *why)
{
    (void)options, (void)system;
    *sink = NULL;
    absent(path, why);
    return PUPIL_SINK_FAILED;
}

int pupil_v4l2_device_open(pupil_v4l2_device *device, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why)
{
    (void)system;
    device->fd = -1;
    return absent(which, why);
}

/* Nobody has a device to ask for these. */
int pupil_v4l2_modes_read(const pupil_v4l2_device *device, pupil_v4l2_modes *modes, pupil_why *why)
{
    *modes = (pupil_v4l2_modes){0};
    return absent(device->path, why);
}

void pupil_v4l2_modes_free(pupil_v4l2_modes *modes)
{
    (void)modes;
}

void pupil_v4l2_mode_text(const pupil_v4l2_mode *mode, char *text, size_t text_bytes)
{
    (void)mode;
    snprintf(text, text_bytes, "-");
}

pupil_v4l2_name pupil_v4l2_fourcc_name(uint32_t fourcc)
{
    (void)fourcc;
    return (pupil_v4l2_name){"-"};
}

/* Any name will do: the camera is refused. */
uint32_t pupil_v4l2_fourcc(const char *name)
{
    return *name ? 1 : 0;
}

int pupil_v4l2_media_sensor(const pupil_v4l2_device *device, pupil_v4l2_sensor *sensor, pupil_why *why)
{
    (void)sensor;
    return absent(device->path, why);
}

void pupil_v4l2_device_close(pupil_v4l2_device *device)
{
    (void)device;
}

int pupil_v4l2_ioctl(const pupil_v4l2_system *system, int fd, unsigned long request, void *argument)
{
    (void)system, (void)fd, (void)request, (void)argument;
    return -1;
}

const char *pupil_v4l2_reading_name(uint32_t reading)
{
    (void)reading;
    return "-";
}
