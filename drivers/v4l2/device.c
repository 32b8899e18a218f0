#include "device.h"

#include "plain_text.h"
#include "refuse.h"
#include <ctype.h>
#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MOST_NODES 256 /* minors of the kernel's video nodes (VIDEO_NUM_DEVICES) */

int pupil_v4l2_ask(const pupil_v4l2_device *device, unsigned long request, void *argument)
{
    return pupil_v4l2_ioctl(device->system, device->fd, request, argument);
}

int pupil_v4l2_failed(const pupil_v4l2_device *device, const char *what, int error, pupil_why *why)
{
    const char *words = error == EBUSY    ? "another program is using the camera"
                        : error == ENOSPC ? "the USB bus has no room for this size and rate; ask for less, or move the "
                                            "camera to another port"
                                          : strerror(error);
    if (error == ENODEV)
        pupil_refuse(why, "%s: the camera was unplugged", device->path);
    else
        pupil_refuse(why, "%s: %s: %s", device->path, what, words);
    return -1;
}

static void copy_text(char *to, size_t to_bytes, const unsigned char *from, size_t from_bytes)
{
    size_t i = 0;
    for (; i < to_bytes - 1 && i < from_bytes && from[i]; i++)
        to[i] = (char)from[i];
    to[i] = 0;
    pupil_plain_text(to);
}

static int identify(pupil_v4l2_device *d, pupil_why *why)
{
    struct v4l2_capability capability = {0};
    if (pupil_v4l2_ask(d, VIDIOC_QUERYCAP, &capability) != 0) {
        if (errno != ENOTTY && errno != EINVAL)
            return pupil_v4l2_failed(d, "cannot be asked what it is", errno, why);
        return pupil_refuse(why, "%s: is not a video device; a camera is /dev/video0 or its like ('pupil list')",
                            d->path);
    }
    copy_text(d->name, sizeof d->name, capability.card, sizeof capability.card);
    copy_text(d->driver, sizeof d->driver, capability.driver, sizeof capability.driver);
    copy_text(d->bus, sizeof d->bus, capability.bus_info, sizeof capability.bus_info);
    d->capabilities = capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;

    const uint32_t capture = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE;
    const uint32_t memory_to_memory = V4L2_CAP_VIDEO_M2M | V4L2_CAP_VIDEO_M2M_MPLANE;
    if (!(d->capabilities & capture) || d->capabilities & memory_to_memory) {
        const char *is = d->capabilities & memory_to_memory        ? "a converter in memory"
                         : d->capabilities & V4L2_CAP_META_CAPTURE ? "a camera's metadata"
                         : d->capabilities & (V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_OUTPUT_MPLANE)
                             ? "a video output"
                             : "no capture device";
        return pupil_refuse(why, "%s: %s is %s; a node that captures video is needed ('pupil list')", d->path, d->name,
                            is);
    }
    if (!(d->capabilities & V4L2_CAP_STREAMING))
        return pupil_refuse(why, "%s: %s cannot stream; a camera whose driver shares buffers is needed", d->path,
                            d->name);
    d->type =
        d->capabilities & V4L2_CAP_VIDEO_CAPTURE ? V4L2_BUF_TYPE_VIDEO_CAPTURE : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    return 0;
}

static int open_path(pupil_v4l2_device *d, const char *path, pupil_why *why)
{
    if (strlen(path) >= sizeof d->path)
        return pupil_refuse(why, "%.60s...: the path is longer than %u bytes", path, (unsigned)sizeof d->path - 1);
    strcpy(d->path, path);
    d->fd = d->system->open(d->system->context, path);
    for (int i = 0; d->fd < 0 && errno == EINTR && i < 100; i++)
        d->fd = d->system->open(d->system->context, path);
    if (d->fd < 0) {
        if (errno == EACCES)
            pupil_refuse(why, "%s: permission denied; the user must be in the node's group, most often 'video'", path);
        else if (errno == ENOENT)
            pupil_refuse(why, "%s: is not there; 'pupil list' shows the cameras that are", path);
        else
            pupil_v4l2_failed(d, "cannot be opened", errno, why);
        return -1;
    }
    if (identify(d, why)) {
        pupil_v4l2_device_close(d);
        return -1;
    }
    return 0;
}

void pupil_v4l2_device_close(pupil_v4l2_device *device)
{
    if (device->fd >= 0)
        device->system->close(device->system->context, device->fd);
    device->fd = -1;
}

/* --- all of them --- */

static void note_node(void *closure, const char *name)
{
    unsigned char *there = closure;
    char *end;
    if (strncmp(name, "video", 5) != 0 || !isdigit((unsigned char)name[5]))
        return;
    const unsigned long number = strtoul(name + 5, &end, 10);
    if (!*end && number < MOST_NODES)
        there[number] = 1;
}

int pupil_v4l2_devices(const pupil_v4l2_system *system, pupil_v4l2_seen *seen, void *closure, pupil_why *why)
{
    unsigned char there[MOST_NODES] = {0};
    int count = 0;
    system = system ? system : &pupil_v4l2_kernel;
    if (system->list(system->context, "/dev", note_node, there) != 0)
        return pupil_refuse(why, "/dev: cannot be listed: %s", strerror(errno));
    for (int i = 0; i < MOST_NODES; i++) {
        pupil_v4l2_device device = {.system = system, .fd = -1};
        char path[32];
        pupil_why refused = {""};
        if (!there[i])
            continue;
        count++;
        snprintf(path, sizeof path, "/dev/video%d", i);
        const int failed = open_path(&device, path, &refused);
        if (*device.name && !device.type)
            *refused.text = 0; /* it could be asked, and is something else */
        const int ends = seen(closure, failed ? NULL : &device, path, refused.text);
        pupil_v4l2_device_close(&device);
        if (ends)
            break;
    }
    return count;
}

/* --- by name --- */

typedef struct search {
    const char *name;
    char path[2][32]; /* of the node with this whole name, and of one with a part of it */
    char names[512];  /* of all that were seen */
    unsigned matches[2];
} search;

static int contains(const char *text, const char *part)
{
    const size_t length = strlen(part);
    for (; *text; text++)
        if (strncasecmp(text, part, length) == 0)
            return 1;
    return 0;
}

static int compare(void *closure, const pupil_v4l2_device *device, const char *path, const char *why)
{
    search *s = closure;
    (void)why;
    if (!device)
        return 0;
    const size_t used = strlen(s->names);
    snprintf(s->names + used, sizeof s->names - used, "%s%s (%s)", used ? ", " : "", device->name, path);
    for (int part = 0; part < 2; part++)
        if (part ? contains(device->name, s->name) : strcasecmp(device->name, s->name) == 0)
            if (s->matches[part]++ == 0)
                snprintf(s->path[part], sizeof s->path[part], "%s", path);
    return 0;
}

static int open_name(pupil_v4l2_device *d, const char *name, pupil_why *why)
{
    search s = {.name = name};
    if (pupil_v4l2_devices(d->system, compare, &s, why) < 0)
        return -1;
    /* A camera may have several nodes of one name: the first of them is the picture's. */
    const int part = s.matches[0] == 0;
    if (s.matches[0] || s.matches[1] == 1)
        return open_path(d, s.path[part], why);
    if (!*s.names)
        pupil_refuse(why, "%s: there is no camera", name);
    else
        pupil_refuse(why, "%s: %s camera has this name; there are %s", name, s.matches[1] ? "more than one" : "no",
                     s.names);
    return -1;
}

int pupil_v4l2_device_open(pupil_v4l2_device *device, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why)
{
    *device = (pupil_v4l2_device){.system = system ? system : &pupil_v4l2_kernel, .fd = -1};
    const size_t digits = strspn(which, "0123456789");
    if (strchr(which, '/'))
        return open_path(device, which, why);
    if (*which && !which[digits]) {
        char path[32];
        if (digits > 3)
            return pupil_refuse(why, "%.20s: the number of a video node is 255 at most", which);
        snprintf(path, sizeof path, "/dev/video%lu", strtoul(which, NULL, 10));
        return open_path(device, path, why);
    }
    if (*which)
        return open_name(device, which, why);
    return pupil_refuse(why, "no camera was named; a path (/dev/video0), a number or a name is needed");
}
