/* drivers/v4l2/capture/buffers.c: the memory that frames arrive in, and which kind of it. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "capture.h"
#include "refuse.h"

#define DEFAULT_BUFFERS 4u /* one with the caller, one being filled, two for a caller that is late */
#define PAGE_BYTES      4096u

static int is_multi(const pupil_v4l2_capture *c)
{
    return c->device.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

static size_t in_pages(size_t bytes)
{
    return (bytes + PAGE_BYTES - 1) / PAGE_BYTES * PAGE_BYTES;
}

static uint32_t asked_buffers(const pupil_v4l2_capture *c)
{
    return c->options.buffers ? c->options.buffers : DEFAULT_BUFFERS;
}

/* --- one kind of memory --- */
/* Each: 0, or -1 and errno; what was taken so far is freed by pupil_v4l2_buffers_free. */

static int request(pupil_v4l2_capture *c, uint32_t memory, uint32_t count, uint32_t flags)
{
    struct v4l2_requestbuffers r = {.count = count, .type = c->device.type, .memory = memory, .flags = (uint8_t)flags};
    if (pupil_v4l2_ask(&c->device, VIDIOC_REQBUFS, &r) != 0)
        return -1;
    c->memory = memory;
    c->buffers = r.count < PUPIL_V4L2_MOST_BUFFERS ? r.count : PUPIL_V4L2_MOST_BUFFERS;
    c->can = r.capabilities;
    if (c->buffers < 2) {
        errno = ENOBUFS;
        return -1;
    }
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

static int make_mapped(pupil_v4l2_capture *c, uint32_t flags)
{
    if (request(c, V4L2_MEMORY_MMAP, asked_buffers(c), flags) != 0)
        return -1;
    for (uint32_t i = 0; i < c->buffers; i++)
        if (map(c, i) != 0)
            return -1;
    c->speed = pupil_v4l2_measure(c->device.system, c->buffer[0].memory[0], c->buffer[0].bytes[0]);
    c->reading = flags ? PUPIL_V4L2_READS_HINTED : PUPIL_V4L2_READS_MAPPED;
    return 0;
}

static void *allocate(size_t bytes)
{
    void *memory = aligned_alloc(PAGE_BYTES, in_pages(bytes));
    if (memory)
        memset(memory, 0, in_pages(bytes)); /* so that the pages are allocated */
    else
        errno = ENOMEM;
    return memory;
}

static int make_own(pupil_v4l2_capture *c)
{
    if (request(c, V4L2_MEMORY_USERPTR, asked_buffers(c), 0) != 0)
        return -1;
    c->reading = PUPIL_V4L2_READS_OWN;
    for (uint32_t i = 0; i < c->buffers; i++)
        for (uint32_t k = 0; k < c->format.buffers; k++) {
            c->buffer[i].memory[k] = allocate(c->format.size_bytes[k]);
            if (!c->buffer[i].memory[k])
                return -1;
            c->buffer[i].bytes[k] = in_pages(c->format.size_bytes[k]);
        }
    return 0;
}

/* Area k of buffer i as a dma-buf, mapped. */
static int map_dmabuf(pupil_v4l2_capture *c, uint32_t i, uint32_t k, size_t bytes)
{
    const pupil_v4l2_system *system = c->device.system;
    c->buffer[i].memory[k] = system->mmap(system->context, bytes, c->buffer[i].dmabuf[k], 0);
    c->buffer[i].bytes[k] = bytes;
    return c->buffer[i].memory[k] ? 0 : -1;
}

/* The driver looks at a dma-buf when it is queued: one that it cannot reach is refused there. */
static int queue_all(pupil_v4l2_capture *c)
{
    for (uint32_t i = 0; i < c->buffers; i++)
        if (pupil_v4l2_buffer_queue(c, i) != 0)
            return -1;
    return 0;
}

static int make_of_heap(pupil_v4l2_capture *c, int heap_fd)
{
    if (request(c, V4L2_MEMORY_DMABUF, asked_buffers(c), 0) != 0)
        return -1;
    c->reading = PUPIL_V4L2_READS_HEAP;
    for (uint32_t i = 0; i < c->buffers; i++)
        for (uint32_t k = 0; k < c->format.buffers; k++) {
            const size_t bytes = in_pages(c->format.size_bytes[k]);
            c->buffer[i].dmabuf[k] = pupil_v4l2_heap_buffer(c->device.system, heap_fd, bytes);
            if (c->buffer[i].dmabuf[k] < 0 || map_dmabuf(c, i, k, bytes) != 0)
                return -1;
        }
    c->speed = pupil_v4l2_measure(c->device.system, c->buffer[0].memory[0], c->buffer[0].bytes[0]);
    return queue_all(c);
}

/* The first heap whose memory the driver takes and the CPU reads fast. */
static int make_heap(pupil_v4l2_capture *c)
{
    const pupil_v4l2_system *system = c->device.system;
    int error = ENOENT;
    for (int i = 0; pupil_v4l2_heaps[i]; i++) {
        const int heap_fd = system->open(system->context, pupil_v4l2_heaps[i]);
        if (heap_fd < 0)
            continue;
        const int made = make_of_heap(c, heap_fd) == 0;
        error = made ? ENOMEM : errno;
        system->close(system->context, heap_fd);
        if (made && !pupil_v4l2_is_slow(&c->speed)) {
            c->heap = pupil_v4l2_heaps[i];
            return 0;
        }
        pupil_v4l2_buffers_free(c);
    }
    errno = error;
    return -1;
}

static int make_of_caller(pupil_v4l2_capture *c)
{
    if (request(c, V4L2_MEMORY_DMABUF, c->options.dmabufs, 0) != 0)
        return -1;
    c->reading = PUPIL_V4L2_READS_CALLERS;
    c->buffers = c->buffers < c->options.dmabufs ? c->buffers : c->options.dmabufs;
    for (uint32_t i = 0; i < c->buffers; i++)
        for (uint32_t k = 0; k < c->format.buffers; k++) {
            c->buffer[i].dmabuf[k] = c->options.dmabuf[i * c->format.buffers + k];
            if (map_dmabuf(c, i, k, in_pages(c->format.size_bytes[k])) != 0)
                return -1;
        }
    c->speed = pupil_v4l2_measure(c->device.system, c->buffer[0].memory[0], c->buffer[0].bytes[0]);
    return queue_all(c);
}

static int make_copied(pupil_v4l2_capture *c)
{
    if (make_mapped(c, 0) != 0)
        return -1;
    c->reading = PUPIL_V4L2_READS_COPIED;
    for (uint32_t i = 0; i < c->buffers; i++)
        for (uint32_t k = 0; k < c->format.buffers; k++) {
            c->buffer[i].copy[k] = allocate(c->buffer[i].bytes[k]);
            if (!c->buffer[i].copy[k])
                return -1;
        }
    return 0;
}

/* --- which kind --- */

/* The driver's own if the CPU reads it fast; else the next best kind that there is. */
static int make_fast(pupil_v4l2_capture *c)
{
    if (make_mapped(c, 0) != 0)
        return errno == EINVAL && !c->buffers ? make_own(c) : -1;
    if (!pupil_v4l2_is_slow(&c->speed))
        return 0;
    const uint32_t can = c->can;
    pupil_v4l2_buffers_free(c);
    if (can & V4L2_BUF_CAP_SUPPORTS_MMAP_CACHE_HINTS) {
        if (make_mapped(c, V4L2_MEMORY_FLAG_NON_COHERENT) == 0 && !pupil_v4l2_is_slow(&c->speed))
            return 0;
        pupil_v4l2_buffers_free(c);
    }
    if (can & V4L2_BUF_CAP_SUPPORTS_DMABUF && make_heap(c) == 0)
        return 0;
    return make_copied(c);
}

static int make(pupil_v4l2_capture *c)
{
    switch (c->options.memory) {
    case PUPIL_V4L2_MEMORY_MMAP:
        return make_mapped(c, 0);
    case PUPIL_V4L2_MEMORY_USERPTR:
        return make_own(c);
    case PUPIL_V4L2_MEMORY_DMABUF:
        return make_of_caller(c);
    case PUPIL_V4L2_MEMORY_HEAP:
        return make_heap(c);
    default:
        return make_fast(c);
    }
}

static int check_options(const pupil_v4l2_capture *c, pupil_why *why)
{
    const pupil_v4l2_options *o = &c->options;
    const uint32_t asked = o->memory == PUPIL_V4L2_MEMORY_DMABUF ? o->dmabufs : asked_buffers(c);
    if (o->memory >= PUPIL_V4L2_MEMORY_COUNT)
        pupil_refuse(why, "%s: memory %u; it is one of the %u of pupil_v4l2_memory", c->device.path, o->memory,
                     PUPIL_V4L2_MEMORY_COUNT);
    else if (asked < 2 || asked > PUPIL_V4L2_MOST_BUFFERS)
        pupil_refuse(why, "%s: %u buffers; it must be from 2 to %u", c->device.path, asked, PUPIL_V4L2_MOST_BUFFERS);
    else if (o->memory == PUPIL_V4L2_MEMORY_DMABUF && !o->dmabuf)
        pupil_refuse(why, "%s: memory of the caller's dma-bufs, and none was given", c->device.path);
    else
        return 0;
    return PUPIL_V4L2_FAILED;
}

int pupil_v4l2_buffers_make(pupil_v4l2_capture *c, pupil_why *why)
{
    static const char *const kinds[] = {"gives no buffers that can be mapped", "gives no buffers that can be mapped",
                                        "takes no memory of this program's", "takes none of the dma-bufs given",
                                        "takes no memory of a dma-heap"};
    if (check_options(c, why))
        return PUPIL_V4L2_FAILED;
    if (make(c) != 0) {
        if (errno != ENOBUFS)
            return pupil_v4l2_failed(&c->device, kinds[c->options.memory], errno, why);
        pupil_refuse(why, "%s: its driver gives %u buffer; two are the least that a stream needs", c->device.path,
                     c->buffers);
        return PUPIL_V4L2_FAILED;
    }
    for (uint32_t i = 0; c->options.share && c->memory == V4L2_MEMORY_MMAP && i < c->buffers; i++)
        export_areas(c, i);
    if (c->memory != V4L2_MEMORY_DMABUF && queue_all(c) != 0)
        return pupil_v4l2_failed(&c->device, "takes no buffers", errno, why);
    return 0;
}

/* --- a buffer --- */

int pupil_v4l2_buffer_queue(pupil_v4l2_capture *c, uint32_t index)
{
    struct v4l2_plane planes[PUPIL_V4L2_MOST_AREAS] = {{0}};
    struct v4l2_buffer b = {.type = c->device.type, .memory = c->memory, .index = index};
    pupil_v4l2_buffer *buffer = &c->buffer[index];
    const int own = c->memory == V4L2_MEMORY_USERPTR, dmabuf = c->memory == V4L2_MEMORY_DMABUF;
    if (is_multi(c)) {
        b.m.planes = planes;
        b.length = c->format.buffers;
        for (uint32_t i = 0; (own || dmabuf) && i < c->format.buffers; i++) {
            if (own)
                planes[i].m.userptr = (unsigned long)(uintptr_t)buffer->memory[i];
            else
                planes[i].m.fd = buffer->dmabuf[i];
            planes[i].length = (uint32_t)buffer->bytes[i];
        }
    } else if (own || dmabuf) {
        if (own)
            b.m.userptr = (unsigned long)(uintptr_t)buffer->memory[0];
        else
            b.m.fd = buffer->dmabuf[0];
        b.length = (uint32_t)buffer->bytes[0];
    }
    if (pupil_v4l2_ask(&c->device, VIDIOC_QBUF, &b) != 0)
        return -1;
    buffer->queued = 1;
    return 0;
}

int pupil_v4l2_buffer_read(pupil_v4l2_capture *c, uint32_t index)
{
    pupil_v4l2_buffer *b = &c->buffer[index];
    for (uint32_t k = 0; k < c->format.buffers && c->memory == V4L2_MEMORY_DMABUF; k++) {
        if (pupil_v4l2_sync(c->device.system, b->dmabuf[k], 1) != 0)
            return -1;
        b->read |= 1u << k;
    }
    for (uint32_t k = 0; k < c->format.buffers && c->reading == PUPIL_V4L2_READS_COPIED; k++)
        memcpy(b->copy[k], b->memory[k], b->used[k]);
    return 0;
}

void pupil_v4l2_buffer_unread(pupil_v4l2_capture *c, uint32_t index)
{
    pupil_v4l2_buffer *b = &c->buffer[index];
    for (uint32_t k = 0; k < PUPIL_V4L2_MOST_AREAS; k++)
        if (b->read >> k & 1)
            pupil_v4l2_sync(c->device.system, b->dmabuf[k], 0); /* an error could lose only writes */
    b->read = 0;
}

void pupil_v4l2_buffers_free(pupil_v4l2_capture *c)
{
    const pupil_v4l2_system *system = c->device.system;
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_BUFFERS; i++) {
        pupil_v4l2_buffer *b = &c->buffer[i];
        pupil_v4l2_buffer_unread(c, i);
        for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++)
            if (b->memory[k] && c->memory != V4L2_MEMORY_USERPTR)
                system->munmap(system->context, b->memory[k], b->bytes[k]);
    }
    struct v4l2_requestbuffers none = {.type = c->device.type, .memory = c->memory};
    if (c->buffers)
        pupil_v4l2_ask(&c->device, VIDIOC_REQBUFS, &none);   /* closing does it too, where this fails */
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_BUFFERS; i++) { /* after the driver has let go of it */
        pupil_v4l2_buffer *b = &c->buffer[i];
        for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++) {
            if (b->dmabuf[k] >= 0 && c->reading != PUPIL_V4L2_READS_CALLERS)
                system->close(system->context, b->dmabuf[k]);
            if (c->memory == V4L2_MEMORY_USERPTR)
                free(b->memory[k]);
            free(b->copy[k]);
        }
        *b = (pupil_v4l2_buffer){.dmabuf = {-1, -1, -1}};
    }
    c->buffers = 0;
    c->reading = PUPIL_V4L2_READS_MAPPED;
}
