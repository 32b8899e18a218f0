#include "capture.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "refuse.h"
#include "source.h"
#include "v4l2/media/media.h"

#define DEFAULT_TIMEOUT_S 5.0                  /* webcams take up to three seconds to their first frame */
#define SLICE_MS          100                  /* between two questions to options.stop */
#define MOST_EVENTS       64                   /* taken in one call */
#define AHEAD_NS          INT64_C(1000000000)  /* how far ahead a stamp may be; uvcvideo's are by milliseconds */
#define BEHIND_NS         INT64_C(60000000000) /* no queue of frames is as old */

static int64_t now_ns(const pupil_v4l2_capture *c)
{
    return c->device.system->now_ns(c->device.system->context);
}

double pupil_v4l2_capture_timeout_s(const pupil_v4l2_capture *c)
{
    return c->options.timeout_s > 0.0 ? c->options.timeout_s : DEFAULT_TIMEOUT_S;
}

static int failed(const pupil_v4l2_capture *c, const char *what, int error, pupil_why *why)
{
    pupil_v4l2_failed(&c->device, what, error, why);
    return error == ENODEV ? PUPIL_V4L2_GONE : error == EIO ? PUPIL_V4L2_STOPPED : PUPIL_V4L2_FAILED;
}

const char *pupil_v4l2_reading_name(uint32_t reading)
{
    static const char *const names[] = {"mapped",   "mapped with cache hints", "this program's memory",
                                        "dma-heap", "the caller's dma-bufs",   "copied"};
    return reading < PUPIL_V4L2_READS_COUNT ? names[reading] : "-";
}

/* --- begin and end --- */

static int subscribe(const pupil_v4l2_capture *c, uint32_t type, int id)
{
    struct v4l2_event_subscription s = {.type = type, .id = (uint32_t)id};
    return pupil_v4l2_ask(&c->device, VIDIOC_SUBSCRIBE_EVENT, &s); /* few drivers have any; not having them is fine */
}

static int start(pupil_v4l2_capture *c, pupil_why *why)
{
    int type = (int)c->device.type, input = 0;
    if (pupil_v4l2_ask(&c->device, VIDIOC_G_INPUT, &input) != 0)
        input = 0; /* it has only one */
    subscribe(c, V4L2_EVENT_SOURCE_CHANGE, input);
    subscribe(c, V4L2_EVENT_EOS, 0);
    if (pupil_v4l2_ask(&c->device, VIDIOC_STREAMON, &type) == 0) {
        c->streaming = 1;
        return 0;
    }
    const int error = errno;
    char mend[512];
    if ((error == EPIPE || error == ENOLINK) && pupil_v4l2_media_mend(&c->device, &c->format, mend, sizeof mend) == 0) {
        pupil_refuse(why, "%s: does not start: %s", c->device.path, mend);
        return PUPIL_V4L2_FAILED;
    }
    return failed(c, "does not start", error, why);
}

int pupil_v4l2_capture_open(pupil_v4l2_capture *c, const char *which, const pupil_v4l2_options *options, pupil_why *why)
{
    memset(c, 0, sizeof *c);
    c->options = *options;
    for (int i = 0; i < PUPIL_V4L2_MOST_BUFFERS; i++)
        for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++)
            c->buffer[i].dmabuf[k] = -1;
    if (pupil_v4l2_device_open(&c->device, options->system, which, why))
        return PUPIL_V4L2_FAILED;
    int error = pupil_v4l2_negotiate(c, why);
    if (!error)
        error = pupil_v4l2_buffers_make(c, why);
    if (!error)
        error = start(c, why);
    if (error)
        pupil_v4l2_capture_close(c);
    return error;
}

void pupil_v4l2_capture_close(pupil_v4l2_capture *c)
{
    int type = (int)c->device.type;
    if (c->device.fd < 0)
        return;
    if (c->streaming)
        pupil_v4l2_ask(&c->device, VIDIOC_STREAMOFF, &type);
    c->streaming = 0;
    pupil_v4l2_buffers_free(c);
    pupil_v4l2_device_close(&c->device);
}

/* --- a buffer --- */

typedef struct done_buffer {
    struct v4l2_buffer b;
    struct v4l2_plane planes[VIDEO_MAX_PLANES];
} done_buffer;

/* PUPIL_V4L2_FRAME; -EAGAIN: none is ready; or another result and a sentence. */
static int dequeue(pupil_v4l2_capture *c, done_buffer *d, pupil_why *why)
{
    memset(d, 0, sizeof *d);
    d->b.type = c->device.type;
    d->b.memory = c->memory;
    if (c->device.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
        d->b.m.planes = d->planes;
        d->b.length = VIDEO_MAX_PLANES;
    }
    if (pupil_v4l2_ask(&c->device, VIDIOC_DQBUF, &d->b) != 0) {
        if (errno == EAGAIN)
            return -EAGAIN;
        if (errno == EPIPE)
            return PUPIL_V4L2_END; /* the one with V4L2_BUF_FLAG_LAST is out */
        return failed(c, errno == EIO ? "its driver reports that the stream broke" : "gives no frame", errno, why);
    }
    if (d->b.index >= c->buffers || !c->buffer[d->b.index].queued) {
        pupil_refuse(why, "%s: its driver hands out buffer %u, which it does not have", c->device.path, d->b.index);
        return PUPIL_V4L2_FAILED;
    }
    c->buffer[d->b.index].queued = 0;
    return PUPIL_V4L2_FRAME;
}

static int give_back(pupil_v4l2_capture *c, uint32_t index, pupil_why *why)
{
    pupil_v4l2_buffer_unread(c, index);
    return pupil_v4l2_buffer_queue(c, index) == 0 ? 0 : failed(c, "takes no buffer back", errno, why);
}

/* Where an area's pixels begin, how many bytes it has from there on, and whether all of them are there. */
static int find_area(pupil_v4l2_capture *c, const done_buffer *d, uint32_t area, uint32_t *offset, size_t *bytes)
{
    const int multi = c->device.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    const uint32_t used = multi ? d->planes[area].bytesused : d->b.bytesused;
    *offset = multi ? d->planes[area].data_offset : 0;
    *bytes = *offset <= used ? used - *offset : 0;
    c->buffer[d->b.index].used[area] = used;
    return used <= c->buffer[d->b.index].bytes[area] && *bytes >= c->format.needs_bytes[area];
}

/* Some drivers call another clock's time monotonic: uvcvideo with clock=CLOCK_REALTIME, for one. */
static int is_of_our_clock(int64_t stamp_ns, int64_t taken_ns)
{
    return stamp_ns > 0 && stamp_ns <= taken_ns + AHEAD_NS && stamp_ns >= taken_ns - BEHIND_NS;
}

/* 0, which is no clock's, if the driver's value is not a time. */
static int64_t nanoseconds_of(const struct v4l2_buffer *b)
{
    int64_t whole_ns, part_ns, ns;
    if (__builtin_mul_overflow((int64_t)b->timestamp.tv_sec, 1000000000, &whole_ns) ||
        __builtin_mul_overflow((int64_t)b->timestamp.tv_usec, 1000, &part_ns) ||
        __builtin_add_overflow(whole_ns, part_ns, &ns))
        return 0;
    return ns;
}

static void stamp(pupil_v4l2_capture *c, const struct v4l2_buffer *b, pupil_v4l2_frame *frame)
{
    frame->taken_ns = now_ns(c);
    frame->stamp_ns = nanoseconds_of(b);
    frame->stamp = (b->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                       ? PUPIL_LIVE_STAMP_START_OF_EXPOSURE
                       : PUPIL_LIVE_STAMP_END_OF_FRAME;
    if ((b->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC ||
        !is_of_our_clock(frame->stamp_ns, frame->taken_ns)) {
        frame->stamp = PUPIL_LIVE_STAMP_NONE;
        frame->stamp_ns = frame->taken_ns;
        c->counts.unstamped++;
    }
}

/* The driver's numbers, of 32 bits that wrap. A step back is a driver that began again. */
static uint32_t count_lost(pupil_v4l2_capture *c, uint32_t sequence)
{
    const uint32_t step = sequence - c->last_sequence;
    uint32_t lost = 0;
    if (c->began && step == 0)
        c->counts.repeated++;
    else if (c->began && step < UINT32_C(1) << 31)
        lost = step - 1;
    c->counts.lost += lost;
    c->last_sequence = sequence;
    c->began = 1;
    return lost;
}

static const void *plane_at(const pupil_v4l2_capture *c, const pupil_v4l2_frame *frame, uint32_t plane)
{
    const pupil_v4l2_buffer *buffer = &c->buffer[frame->index];
    const uint32_t area = c->format.buffers > 1 ? plane : 0;
    const unsigned char *memory = buffer->copy[area] ? buffer->copy[area] : buffer->memory[area];
    return memory + frame->offset_bytes[area] + c->format.plane_bytes[plane];
}

/* The planes of the image as image.data, chroma and cr have them. */
static void describe_shared(const pupil_v4l2_capture *c, pupil_v4l2_frame *frame)
{
    const pupil_v4l2_format *f = &c->format;
    const pupil_v4l2_buffer *buffer = &c->buffer[frame->index];
    const uint32_t planes = pupil_pixel_planes(f->pixel);
    frame->is_shared = !f->compressed;
    for (uint32_t i = 0; i < planes; i++) {
        const uint32_t plane = i && f->cr_first ? 3 - i : i, area = f->buffers > 1 ? plane : 0;
        frame->dmabuf.fd[i] = buffer->dmabuf[area];
        frame->dmabuf.offset_bytes[i] = frame->offset_bytes[area] + (uint32_t)f->plane_bytes[plane];
        frame->is_shared &= buffer->dmabuf[area] >= 0;
    }
}

static void describe(pupil_v4l2_capture *c, const done_buffer *d, pupil_v4l2_frame *frame)
{
    const pupil_v4l2_format *f = &c->format;
    const uint32_t planes = pupil_pixel_planes(f->pixel);
    frame->index = d->b.index;
    const void *data = plane_at(c, frame, 0);
    frame->image = (pupil_image_const){.data = data,
                                       .stride_bytes = (ptrdiff_t)f->stride_bytes[0],
                                       .width = f->width,
                                       .height = f->height,
                                       .pixel = f->pixel,
                                       .coding = &f->coding};
    frame->coded_bytes = f->compressed ? frame->coded_bytes : 0;
    if (f->compressed) {
        frame->coded = data;
        frame->image.data = NULL;
    }
    if (planes > 1) {
        const uint32_t chroma = f->cr_first ? 2 : 1;
        frame->image.chroma = plane_at(c, frame, chroma);
        frame->image.chroma_stride_bytes = (ptrdiff_t)f->stride_bytes[chroma];
    }
    if (planes > 2) {
        const uint32_t cr = f->cr_first ? 1 : 2;
        frame->image.cr = plane_at(c, frame, cr);
        frame->image.cr_stride_bytes = (ptrdiff_t)f->stride_bytes[cr];
    }
    describe_shared(c, frame);
}

/* --- a frame --- */

/* PUPIL_V4L2_FRAME where there was nothing that ends the stream. */
static int take_events(pupil_v4l2_capture *c, pupil_why *why)
{
    for (int i = 0; i < MOST_EVENTS; i++) {
        struct v4l2_event event = {0};
        if (pupil_v4l2_ask(&c->device, VIDIOC_DQEVENT, &event) != 0)
            return errno == ENODEV ? failed(c, "its events", errno, why) : PUPIL_V4L2_FRAME;
        if (event.type == V4L2_EVENT_EOS)
            c->last = 1; /* what is ready is still to be taken */
        if (event.type == V4L2_EVENT_SOURCE_CHANGE) {
            pupil_refuse(why,
                         "%s: the camera's signal changed in mid-stream (another size, or none); it must "
                         "be opened again",
                         c->device.path);
            return PUPIL_V4L2_CHANGED;
        }
    }
    return PUPIL_V4L2_FRAME;
}

/* PUPIL_V4L2_FRAME: something may be ready; -EAGAIN: not yet. */
static int wait(pupil_v4l2_capture *c, int64_t left_ns, short *ready, pupil_why *why)
{
    const pupil_v4l2_system *system = c->device.system;
    struct pollfd p = {c->device.fd, POLLIN | POLLPRI, 0};
    const int64_t left_ms = left_ns / 1000000 + 1;
    *ready = 0;
    const int got = system->poll(system->context, &p, 1, left_ms < SLICE_MS ? (int)left_ms : SLICE_MS);
    if (got < 0)
        return errno == EINTR || errno == EAGAIN ? -EAGAIN : failed(c, "cannot be waited for", errno, why);
    if (got == 0)
        return c->last ? PUPIL_V4L2_END : -EAGAIN;
    *ready = p.revents;
    if (p.revents & POLLPRI)
        return take_events(c, why);
    return PUPIL_V4L2_FRAME;
}

/* A buffer that the driver handed out: a frame, or (-EAGAIN) one to be left out. */
static int judge(pupil_v4l2_capture *c, const done_buffer *d, pupil_v4l2_frame *frame, pupil_why *why)
{
    const int last = (d->b.flags & V4L2_BUF_FLAG_LAST) != 0;
    const int flagged = (d->b.flags & V4L2_BUF_FLAG_ERROR) != 0;
    c->last |= last;
    frame->lost += count_lost(c, d->b.sequence);
    int whole = !flagged;
    for (uint32_t i = 0; i < c->format.buffers && whole; i++) {
        size_t bytes = 0;
        whole = find_area(c, d, i, &frame->offset_bytes[i], &bytes);
        frame->coded_bytes = i ? frame->coded_bytes : bytes;
    }
    if (whole)
        return PUPIL_V4L2_FRAME;
    c->counts.flagged += flagged;
    c->counts.cut += !flagged && !last; /* the last one may be empty */
    const int error = give_back(c, d->b.index, why);
    return error ? error : last ? PUPIL_V4L2_END : -EAGAIN;
}

/* Replaces *d by the newest that is ready. An error is left for the next call to find. */
static void skip_to_newest(pupil_v4l2_capture *c, done_buffer *d, pupil_v4l2_frame *frame)
{
    pupil_why unused;
    for (uint32_t i = 1; i < c->buffers; i++) {
        done_buffer next;
        pupil_v4l2_frame newer = {.lost = frame->lost};
        if (dequeue(c, &next, &unused) != PUPIL_V4L2_FRAME)
            return;
        if (judge(c, &next, &newer, &unused) == PUPIL_V4L2_FRAME) {
            c->counts.late++;
            give_back(c, d->b.index, &unused);
            *d = next;
            *frame = newer;
        } else {
            frame->lost = newer.lost;
        }
    }
}

static int no_frame(const pupil_v4l2_capture *c, uint64_t left_out, pupil_why *why)
{
    pupil_refuse(why, "%s: no %sframe within %g seconds%s", c->device.path, left_out ? "whole " : "",
                 pupil_v4l2_capture_timeout_s(c),
                 left_out ? "; the driver flags all as damaged, or cuts them short" : "");
    return PUPIL_V4L2_STOPPED;
}

int pupil_v4l2_capture_next(pupil_v4l2_capture *c, pupil_v4l2_frame *frame, pupil_why *why)
{
    const int64_t end_ns = now_ns(c) + (int64_t)(pupil_v4l2_capture_timeout_s(c) * 1e9);
    const uint64_t left_out = c->counts.flagged + c->counts.cut;
    memset(frame, 0, sizeof *frame);
    for (;;) {
        done_buffer d;
        short ready;
        const int64_t left_ns = end_ns - now_ns(c);
        if (c->options.stop && c->options.stop())
            return PUPIL_V4L2_END;
        if (left_ns <= 0)
            return no_frame(c, c->counts.flagged + c->counts.cut - left_out, why);
        int got = wait(c, left_ns, &ready, why);
        if (got == PUPIL_V4L2_FRAME)
            got = dequeue(c, &d, why);
        if (got == -EAGAIN && ready & (POLLHUP | POLLNVAL))
            return failed(c, "gives no frame", ENODEV, why);
        if (got == -EAGAIN && ready & POLLERR)
            return failed(c, "its driver reports that the stream broke", EIO, why);
        if (got == PUPIL_V4L2_FRAME)
            got = judge(c, &d, frame, why);
        if (got == PUPIL_V4L2_FRAME) {
            const uint64_t late = c->counts.late;
            if (pupil_live_wants_newest(c->options.late, &c->pace))
                skip_to_newest(c, &d, frame);
            pupil_live_pace_frame(&c->pace, c->counts.late - late + frame->lost);
            if (pupil_v4l2_buffer_read(c, d.b.index) != 0) {
                const int error = failed(c, "its buffers cannot be read", errno, why);
                pupil_v4l2_buffer_unread(c, d.b.index);
                pupil_v4l2_buffer_queue(c, d.b.index); /* where this fails, too, it is missing until close */
                return error;
            }
            frame->sequence = d.b.sequence;
            stamp(c, &d.b, frame);
            describe(c, &d, frame);
            c->counts.frames++;
        }
        if (got != -EAGAIN)
            return got;
    }
}

int pupil_v4l2_capture_done(pupil_v4l2_capture *c, const pupil_v4l2_frame *frame, pupil_why *why)
{
    if (frame->index >= c->buffers || c->buffer[frame->index].queued || !c->streaming)
        return 0; /* it is back already */
    return give_back(c, frame->index, why);
}
