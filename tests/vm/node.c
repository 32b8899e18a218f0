#include "vm/node.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/ioctl.h>
#include <unistd.h>

static int refused(const char *what)
{
    printf("the node refuses %s: %s\n", what, strerror(errno));
    return -1;
}

int node_open(const char *path)
{
    const int fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        printf("%s: %s\n", path, strerror(errno));
    return fd;
}

int node_find(const char *driver, int output, int n, char path[32])
{
    const uint32_t wanted = output ? V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_OUTPUT_MPLANE
                                   : V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE;
    for (int i = 0; i < 64; i++) {
        struct v4l2_capability c = {0};
        snprintf(path, 32, "/dev/video%d", i);
        const int fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
        if (fd < 0)
            continue;
        const int asked = ioctl(fd, VIDIOC_QUERYCAP, &c);
        close(fd);
        if (asked == 0 && strcmp((const char *)c.driver, driver) == 0 && c.device_caps & wanted && n-- == 0)
            return 0;
    }
    return -1;
}

uint32_t node_control_id(int fd, const char *name)
{
    struct v4l2_queryctrl control = {.id = V4L2_CTRL_FLAG_NEXT_CTRL};
    while (ioctl(fd, VIDIOC_QUERYCTRL, &control) == 0) {
        if (strcasecmp((const char *)control.name, name) == 0)
            return control.id;
        control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    return 0;
}

int node_set(int fd, const char *name, int value)
{
    struct v4l2_control control = {node_control_id(fd, name), value};
    return control.id && ioctl(fd, VIDIOC_S_CTRL, &control) == 0 ? 0 : refused(name);
}

int node_get(int fd, const char *name, int *value)
{
    struct v4l2_control control = {node_control_id(fd, name), 0};
    if (!control.id || ioctl(fd, VIDIOC_G_CTRL, &control) != 0)
        return refused(name);
    *value = control.value;
    return 0;
}

int node_input(int fd, int index)
{
    return ioctl(fd, VIDIOC_S_INPUT, &index) == 0 ? 0 : refused("an input");
}

int node_timings(int fd, uint32_t width, uint32_t height, unsigned fps)
{
    struct v4l2_enum_dv_timings known = {.index = 0};
    const struct v4l2_bt_timings *bt = &known.timings.bt;
    for (; ioctl(fd, VIDIOC_ENUM_DV_TIMINGS, &known) == 0; known.index++) {
        const uint64_t all = (uint64_t)V4L2_DV_BT_FRAME_WIDTH(bt) * V4L2_DV_BT_FRAME_HEIGHT(bt);
        if (bt->width == width && bt->height == height && !bt->interlaced && (bt->pixelclock + all / 2) / all == fps)
            return ioctl(fd, VIDIOC_S_DV_TIMINGS, &known.timings) == 0 ? 0 : refused("timings");
    }
    return refused("to tell timings");
}

int node_output_format(int fd, uint32_t fourcc, uint32_t width, uint32_t height)
{
    struct v4l2_format f = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT};
    if (ioctl(fd, VIDIOC_G_FMT, &f) != 0)
        f.type = V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE;
    f.fmt.pix.width = width; /* at the same offset in both */
    f.fmt.pix.height = height;
    f.fmt.pix.pixelformat = fourcc;
    return ioctl(fd, VIDIOC_S_FMT, &f) == 0 && f.fmt.pix.pixelformat == fourcc ? 0 : refused("a format");
}

int node_cable(int fd)
{
    /* No text of the camera over the picture: item 2 of the menu. */
    if (node_set(fd, "OSD Text Mode", 2) != 0)
        return -1;
    /* Before Linux 6.11 a switch; since then a menu with what the camera's connector may be wired to: its own test
     * pattern, nothing, the monitors. */
    if (node_control_id(fd, "Loop Video"))
        return node_set(fd, "Loop Video", 1);
    return node_set(fd, "HDMI 000-0 Is Connected To", 2);
}

node_held node_holds(void)
{
    node_held held = {0, 0};
    DIR *folder = opendir("/proc/self/fd");
    FILE *maps = fopen("/proc/self/maps", "re");
    char line[512];
    while (folder && readdir(folder))
        held.files++;
    while (maps && fgets(line, sizeof line, maps))
        held.maps += strstr(line, "/dev/video") || strstr(line, "dmabuf");
    if (folder)
        closedir(folder);
    if (maps)
        fclose(maps);
    return held;
}
