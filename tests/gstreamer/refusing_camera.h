/* tests/gstreamer/refusing_camera.h: a camera in this process whose controls can be made unwritable. One per
 * program. */
#ifndef PUPIL_TESTS_GSTREAMER_REFUSING_CAMERA_H
#define PUPIL_TESTS_GSTREAMER_REFUSING_CAMERA_H

#include <errno.h>
#include <linux/videodev2.h>

#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"

static struct {
    fake_v4l2 *fake;
    const pupil_v4l2_system *inside;
    pupil_v4l2_system v4l2;
    pupil_live_system system;
    int refuses;
} rig;

static inline int refusing(void *context, int fd, unsigned long request, void *argument)
{
    if (rig.refuses && (request == VIDIOC_S_EXT_CTRLS || request == VIDIOC_S_CTRL)) {
        errno = EIO;
        return -1;
    }
    return rig.inside->ioctl(context, fd, request, argument);
}

static inline void plug_camera(const fake_v4l2_config *config)
{
    rig.refuses = 0;
    rig.fake = fake_v4l2_new(config);
    rig.inside = fake_v4l2_system(rig.fake);
    rig.v4l2 = *rig.inside;
    rig.v4l2.ioctl = refusing;
    rig.system = (pupil_live_system){&rig.v4l2, NULL};
}

#endif
