/* The V4L2 node of a webcam that libcamera has: its controls keep their values when a program ends, and libcamera
 * cannot say what they were. */
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "libcamera_private.h"
#include "v4l2/device.h"

/* In the order in which they are put back: values are not taken while automatic exposure is on. */
static const uint32_t ids[LIBCAMERA_NODE_CONTROLS] = {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_GAIN,
                                                      V4L2_CID_EXPOSURE_AUTO};

/* libcamera's id of a webcam ends with where it is plugged in, and its vendor and product, as sysfs has them:
 * "...-2.1:1.0-1bcf:2b9e" is at /sys/class/video4linux/videoN/device -> .../3-2.1:1.0. */
static int is_at(const char *id, const char *path)
{
    char link[300], place[300];
    const char *node = strrchr(path, '/');
    snprintf(link, sizeof link, "/sys/class/video4linux/%.200s/device", node ? node + 1 : path);
    const ssize_t length = readlink(link, place, sizeof place - 1);
    if (length <= 0)
        return 0;
    place[length] = 0;
    const char *name = strrchr(place, '/'), *port = strchr(name ? name : place, '-');
    const size_t id_length = strlen(id), port_length = port ? strlen(port) : 0;
    const size_t tail = sizeof "-1bcf:2b9e" - 1;
    return port && id_length > port_length + tail &&
           strncmp(id + id_length - tail - port_length, port, port_length) == 0;
}

typedef struct search {
    const char *id;
    char path[64];
} search;

static int seen(void *closure, const pupil_v4l2_device *device, const char *path, const char *why)
{
    search *s = closure;
    (void)why;
    if (!device || !is_at(s->id, path))
        return 0;
    snprintf(s->path, sizeof s->path, "%.63s", path);
    return 1;
}

static int control(const libcamera_node *node, unsigned long request, uint32_t id, int32_t *value)
{
    struct v4l2_ext_control one = {.id = id, .value = *value};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
    const int result = pupil_v4l2_ioctl(node->system, node->fd, request, &all);
    *value = one.value;
    return result;
}

void libcamera_node_open(libcamera_node *node, const pupil_v4l2_system *system, const char *id)
{
    search s = {.id = id};
    pupil_why unused;
    *node = (libcamera_node){.system = system ? system : &pupil_v4l2_kernel, .fd = -1};
    pupil_v4l2_devices(node->system, seen, &s, &unused);
    if (!*s.path)
        return;
    node->fd = node->system->open(node->system->context, s.path);
    for (int i = 0; i < LIBCAMERA_NODE_CONTROLS && node->fd >= 0; i++) {
        int32_t value = 0;
        if (control(node, VIDIOC_G_EXT_CTRLS, ids[i], &value) != 0)
            continue;
        node->saved[node->saved_count].id = ids[i];
        node->saved[node->saved_count++].value = value;
        if (ids[i] == V4L2_CID_EXPOSURE_ABSOLUTE)
            node->exposure_s = value * 1e-4; /* V4L2: "in 100 us units" */
    }
    struct v4l2_streamparm rate = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    const struct v4l2_fract *interval = &rate.parm.capture.timeperframe;
    if (node->fd >= 0 && pupil_v4l2_ioctl(node->system, node->fd, VIDIOC_G_PARM, &rate) == 0 && interval->denominator)
        node->frame_s = (double)interval->numerator / interval->denominator;
}

int libcamera_node_put_back(const libcamera_node *node)
{
    int failed = 0;
    for (int i = 0; i < node->saved_count; i++) {
        int32_t value = node->saved[i].value;
        failed += control(node, VIDIOC_S_EXT_CTRLS, node->saved[i].id, &value) != 0;
    }
    return failed;
}

void libcamera_node_close(libcamera_node *node)
{
    if (node->fd >= 0)
        node->system->close(node->system->context, node->fd);
    node->fd = -1;
}
