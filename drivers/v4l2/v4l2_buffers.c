/* drivers/v4l2/v4l2_buffers.c: the memory that frames arrive in: the driver's own, mapped, or ours where it has none.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "v4l2/v4l2_capture.h"

#define DEFAULT_BUFFERS 4u /* one with the caller, one being filled, two for a caller that is late */
#define PAGE_BYTES      4096u

static int is_multi(const pupil_v4l2_capture *c)
{
    return c->device.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

static int request(pupil_v4l2_capture *c, uint32_t memory, uint32_t count)
{
    struct v4l2_requestbuffers r = {.count = count, .type = c->device.type, .memory = memory};
    if (pupil_v4l2_ask(&c->device, VIDIOC_REQBUFS, &r) != 0)
        return -1;
    c->memory = memory;
    c->buffers = r.count < PUPIL_V4L2_MOST_BUFFERS ? r.count : PUPIL_V4L2_MOST_BUFFERS;
    return 0;
}

static int map(pupil_v4l2_capture *c, uint32_t index)
{
    const pupil_v4l2_system *system = c->device.system;
    pupil_v4l2_buffer *buffer = &c->buffer[index];
    struct v4l2_plane planes[VIDEO_MAX_PLANES] = {{0}};
    struct v4l2_buffer b = {.type = c->device.type, .memory = V4L2_MEMORY_MMAP, .index = index};
    if (is_multi(c)) {
        b.m.planes = planes;
        b.length = VIDEO_MAX_PLANES;
    }
    if (pupil_v4l2_ask(&c->device, VIDIOC_QUERYBUF, &b) != 0)
        return -1;
    for (uint32_t i = 0; i < c->format.buffers; i++) {
        const size_t bytes = is_multi(c) ? planes[i].length : b.length;
        const off_t offset = is_multi(c) ? planes[i].m.mem_offset : b.m.offset;
        if (bytes < c->format.needs_bytes[i]) {
            errno = EOVERFLOW;
            return -1;
        }
        buffer->memory[i] = system->mmap(system->context, bytes, c->device.fd, offset);
        if (!buffer->memory[i])
            return -1;
        buffer->bytes[i] = bytes;
    }
    return 0;
}

/* What the driver refuses to share is not shared: mapping it still works. */
static void export_areas(pupil_v4l2_capture *c, uint32_t index)
{
    for (uint32_t i = 0; i < c->format.buffers; i++) {
        struct v4l2_exportbuffer e = {.type = c->device.type, .index = index, .plane = i, .flags = O_RDWR | O_CLOEXEC};
        if (pupil_v4l2_ask(&c->device, VIDIOC_EXPBUF, &e) == 0)
            c->buffer[index].dmabuf[i] = e.fd;
    }
}

static int allocate(pupil_v4l2_capture *c, uint32_t index)
{
    for (uint32_t i = 0; i < c->format.buffers; i++) {
        const size_t bytes = ((size_t)c->format.size_bytes[i] + PAGE_BYTES - 1) / PAGE_BYTES * PAGE_BYTES;
        c->buffer[index].memory[i] = aligned_alloc(PAGE_BYTES, bytes);
        if (!c->buffer[index].memory[i]) {
            errno = ENOMEM;
            return -1;
        }
        memset(c->buffer[index].memory[i], 0, bytes); /* so that the pages are there */
        c->buffer[index].bytes[i] = bytes;
    }
    return 0;
}

int pupil_v4l2_buffer_queue(pupil_v4l2_capture *c, uint32_t index)
{
    struct v4l2_plane planes[2] = {{0}};
    struct v4l2_buffer b = {.type = c->device.type, .memory = c->memory, .index = index};
    pupil_v4l2_buffer *buffer = &c->buffer[index];
    const int own = c->memory == V4L2_MEMORY_USERPTR;
    if (is_multi(c)) {
        b.m.planes = planes;
        b.length = c->format.buffers;
        for (uint32_t i = 0; own && i < c->format.buffers; i++) {
            planes[i].m.userptr = (unsigned long)(uintptr_t)buffer->memory[i];
            planes[i].length = (uint32_t)buffer->bytes[i];
        }
    } else if (own) {
        b.m.userptr = (unsigned long)(uintptr_t)buffer->memory[0];
        b.length = (uint32_t)buffer->bytes[0];
    }
    if (pupil_v4l2_ask(&c->device, VIDIOC_QBUF, &b) != 0)
        return -1;
    buffer->queued = 1;
    return 0;
}

int pupil_v4l2_buffers_make(pupil_v4l2_capture *c, char *why, size_t why_bytes)
{
    const uint32_t asked = c->options.buffers ? c->options.buffers : DEFAULT_BUFFERS;
    if (asked < 2 || asked > PUPIL_V4L2_MOST_BUFFERS) {
        snprintf(why, why_bytes, "%s: %u buffers; it must be from 2 to %u", c->device.path, asked,
                 PUPIL_V4L2_MOST_BUFFERS);
        return PUPIL_V4L2_FAILED;
    }
    if (request(c, V4L2_MEMORY_MMAP, asked) != 0 && (errno != EINVAL || request(c, V4L2_MEMORY_USERPTR, asked) != 0))
        return pupil_v4l2_failed(&c->device, "gives no buffers", errno, why, why_bytes);
    if (c->buffers < 2) {
        snprintf(why, why_bytes, "%s: its driver gives %u buffer; two are the least that a stream needs",
                 c->device.path, c->buffers);
        return PUPIL_V4L2_FAILED;
    }
    for (uint32_t i = 0; i < c->buffers; i++)
        if (c->memory == V4L2_MEMORY_MMAP ? map(c, i) : allocate(c, i))
            return pupil_v4l2_failed(&c->device, "its buffers cannot be mapped", errno, why, why_bytes);
    for (uint32_t i = 0; c->options.share && c->memory == V4L2_MEMORY_MMAP && i < c->buffers; i++)
        export_areas(c, i);
    for (uint32_t i = 0; i < c->buffers; i++)
        if (pupil_v4l2_buffer_queue(c, i) != 0)
            return pupil_v4l2_failed(&c->device, "takes no buffers", errno, why, why_bytes);
    return 0;
}

void pupil_v4l2_buffers_free(pupil_v4l2_capture *c)
{
    const pupil_v4l2_system *system = c->device.system;
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_BUFFERS; i++)
        for (int k = 0; k < 2; k++) {
            pupil_v4l2_buffer *b = &c->buffer[i];
            if (b->dmabuf[k] >= 0)
                system->close(system->context, b->dmabuf[k]);
            b->dmabuf[k] = -1;
            if (b->memory[k] && c->memory == V4L2_MEMORY_MMAP)
                system->munmap(system->context, b->memory[k], b->bytes[k]);
        }
    struct v4l2_requestbuffers none = {.type = c->device.type, .memory = c->memory};
    if (c->buffers)
        pupil_v4l2_ask(&c->device, VIDIOC_REQBUFS, &none); /* closing does it too, where this fails */
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_BUFFERS; i++)
        for (int k = 0; k < 2; k++) {
            if (c->memory == V4L2_MEMORY_USERPTR)
                free(c->buffer[i].memory[k]); /* after the driver has let go of it */
            c->buffer[i].memory[k] = NULL;
        }
    c->buffers = 0;
}
