#include "vm/vivid.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static int refused(const char *what)
{
    printf("vivid refuses %s: %s\n", what, strerror(errno));
    return -1;
}

int vivid_open(vivid_node *node, int output)
{
    uint32_t wanted = output ? V4L2_CAP_VIDEO_OUTPUT_MPLANE : V4L2_CAP_VIDEO_CAPTURE_MPLANE;
    memset(node, 0, sizeof *node);
    node->type = output ? V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    for (int i = 0; i < 8; i++) {
        char path[32];
        struct v4l2_capability capability;
        snprintf(path, sizeof path, "/dev/video%d", i);
        node->fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
        if (node->fd < 0)
            continue;
        if (ioctl(node->fd, VIDIOC_QUERYCAP, &capability) == 0 &&
            strcmp((const char *)capability.driver, "vivid") == 0 && (capability.device_caps & wanted))
            return 0;
        close(node->fd);
    }
    printf("no multi-planar %s node of vivid\n", output ? "output" : "capture");
    return -1;
}

static int set_format(vivid_node *node, uint32_t fourcc, uint32_t width, uint32_t height, uint32_t padding_bytes)
{
    struct v4l2_format format = {.type = node->type};
    struct v4l2_pix_format_mplane *pix = &format.fmt.pix_mp;
    /* Twice: the first time to learn the bytes of a row. */
    for (int pass = 0; pass < 2; pass++) {
        pix->width = width;
        pix->height = height;
        pix->pixelformat = fourcc;
        pix->field = V4L2_FIELD_NONE;
        for (int p = 0; pass == 1 && p < pix->num_planes; p++)
            pix->plane_fmt[p].bytesperline += padding_bytes;
        if (ioctl(node->fd, VIDIOC_S_FMT, &format) != 0)
            return refused("the format");
    }
    if (pix->pixelformat != fourcc || pix->width != width || pix->height != height || pix->num_planes > 2) {
        printf("vivid takes %u x %u of %.4s as %u x %u of %.4s in %u planes\n", width, height, (const char *)&fourcc,
               pix->width, pix->height, (const char *)&pix->pixelformat, pix->num_planes);
        return -1;
    }
    node->width = width;
    node->height = height;
    node->planes = pix->num_planes;
    for (uint32_t p = 0; p < node->planes; p++)
        node->stride_bytes[p] = pix->plane_fmt[p].bytesperline;
    return 0;
}

static int make_buffers(vivid_node *node, int vgem)
{
    struct v4l2_format format = {.type = node->type};
    if (ioctl(node->fd, VIDIOC_G_FMT, &format) != 0)
        return refused("telling the format");
    for (uint32_t i = 0; i < VIVID_BUFFERS; i++)
        for (uint32_t p = 0; p < node->planes; p++)
            if (vgem_make(vgem, format.fmt.pix_mp.plane_fmt[p].sizeimage, &node->buffer[i][p]) != 0) {
                perror("vgem refuses a buffer");
                return -1;
            }
    return 0;
}

int vivid_start(vivid_node *node, int vgem, uint32_t fourcc, uint32_t width, uint32_t height, uint32_t padding_bytes)
{
    struct v4l2_requestbuffers request = {.count = VIVID_BUFFERS, .type = node->type, .memory = V4L2_MEMORY_DMABUF};
    for (uint32_t i = 0; i < VIVID_BUFFERS; i++)
        for (uint32_t p = 0; p < 2; p++)
            node->buffer[i][p] = (vgem_buffer){-1, NULL, 0};
    if (set_format(node, fourcc, width, height, padding_bytes) != 0 || make_buffers(node, vgem) != 0)
        return -1;
    if (ioctl(node->fd, VIDIOC_REQBUFS, &request) != 0 || request.count != VIVID_BUFFERS)
        return refused("three dma-bufs");
    return 0;
}

int vivid_queue(vivid_node *node, uint32_t index)
{
    struct v4l2_plane planes[2] = {{0}};
    struct v4l2_buffer buffer = {.type = node->type, .memory = V4L2_MEMORY_DMABUF, .index = index};
    buffer.m.planes = planes;
    buffer.length = node->planes;
    for (uint32_t p = 0; p < node->planes; p++) {
        planes[p].m.fd = node->buffer[index][p].fd;
        planes[p].length = planes[p].bytesused = (uint32_t)node->buffer[index][p].bytes;
    }
    return ioctl(node->fd, VIDIOC_QBUF, &buffer) == 0 ? 0 : refused("a dma-buf");
}

int vivid_stream(vivid_node *node)
{
    int type = (int)node->type;
    return ioctl(node->fd, VIDIOC_STREAMON, &type) == 0 ? 0 : refused("to stream");
}

int vivid_dequeue(vivid_node *node)
{
    struct pollfd ready = {node->fd, node->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE ? POLLOUT : POLLIN, 0};
    struct v4l2_plane planes[2] = {{0}};
    struct v4l2_buffer buffer = {.type = node->type, .memory = V4L2_MEMORY_DMABUF};
    buffer.m.planes = planes;
    buffer.length = 2;
    if (poll(&ready, 1, 10000) != 1) {
        printf("vivid: no frame within ten seconds\n");
        return -1;
    }
    if (ioctl(node->fd, VIDIOC_DQBUF, &buffer) != 0)
        return refused("to give a frame");
    return (int)buffer.index;
}

void vivid_stop(vivid_node *node)
{
    int type = (int)node->type;
    struct v4l2_requestbuffers none = {.count = 0, .type = node->type, .memory = V4L2_MEMORY_DMABUF};
    ioctl(node->fd, VIDIOC_STREAMOFF, &type);
    ioctl(node->fd, VIDIOC_REQBUFS, &none);
    for (uint32_t i = 0; i < VIVID_BUFFERS; i++)
        for (uint32_t p = 0; p < 2; p++)
            vgem_free(&node->buffer[i][p]);
}
