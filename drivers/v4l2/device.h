/* drivers/v4l2/device.h: a camera's node: found, opened, asked what it offers. */
#ifndef PUPIL_DRIVERS_V4L2_DEVICE_H
#define PUPIL_DRIVERS_V4L2_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "system.h"

/* May be written before what names a camera or an output node. */
#define PUPIL_V4L2_PREFIX "v4l2:"

typedef struct pupil_v4l2_device {
    const pupil_v4l2_system *system;
    int fd; /* -1: closed */
    char path[256];
    char name[32], driver[16], bus[32]; /* as the driver says them: the card, itself, where it is plugged in */
    uint32_t capabilities;              /* of this node: V4L2_CAP_... */
    uint32_t type;                      /* V4L2_BUF_TYPE_VIDEO_CAPTURE or _MPLANE */
} pupil_v4l2_device;

/* Opens what a user names: a path (/dev/video2, /dev/v4l/by-id/...), a number (2: /dev/video2), or the camera's name,
 * whole or in part, in any case, if only one has it. system NULL: the kernel. 0, or -1 and a sentence. */
int pupil_v4l2_device_open(pupil_v4l2_device *device, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why);
void pupil_v4l2_device_close(pupil_v4l2_device *device); /* twice is allowed */

/* ioctl on the node: 0 or more, or -1 and errno. */
int pupil_v4l2_ask(const pupil_v4l2_device *device, unsigned long request, void *argument);

/* "PATH: WHAT: what errno says, in the words of cameras"; -1. */
int pupil_v4l2_failed(const pupil_v4l2_device *device, const char *what, int error, pupil_why *why);

/* Every video node of /dev in the order of their numbers. `seen` is called with each that captures video. For each that
 * could not be opened or asked, device is NULL and there is a sentence. Device is NULL and the sentence empty for those
 * that are something else (outputs, a camera's metadata). It returns nonzero to end the walk. Returns how many nodes
 * there were, or -1 and a sentence: /dev cannot be listed. */
typedef int pupil_v4l2_seen(void *closure, const pupil_v4l2_device *device, const char *path, const char *why);
int pupil_v4l2_devices(const pupil_v4l2_system *system, pupil_v4l2_seen *seen, void *closure, pupil_why *why);

#endif
