/* drivers/v4l2/absent/v4l2_absent.c: in the place of the cameras where they are not built in. */
#include <stdio.h>
#include <string.h>

#include "refuse.h"
#include "v4l2/device.h"
#include "v4l2/format.h"
#include "v4l2/modes.h"
#include "v4l2/offers/offers.h"
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

int pupil_v4l2_offers_read(pupil_live_offers *offers, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why)
{
    (void)offers, (void)system;
    return absent(which, why);
}

/* Nobody has a device to ask for these. */
void pupil_v4l2_identify(const pupil_v4l2_device *device, pupil_live_identity *is)
{
    (void)device;
    *is = (pupil_live_identity){{0}, {0}, {0}, {0}};
}

int pupil_v4l2_modes_read(const pupil_v4l2_device *device, pupil_live_modes *modes, pupil_why *why)
{
    *modes = (pupil_live_modes){0};
    return absent(device->path, why);
}

/* Any name will do: the camera is refused. */
uint32_t pupil_v4l2_fourcc(const char *name)
{
    return *name ? 1 : 0;
}
