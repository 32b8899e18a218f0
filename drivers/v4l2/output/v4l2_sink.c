#include "v4l2_sink.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdlib.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "output.h"
#include "refuse.h"
#include "v4l2/device.h"

#define BUFFERS      3    /* one that is shown, the next one, and one to fill */
#define MOST_BUFFERS 32   /* of one queue (VIDEO_MAX_FRAME) */
#define TIMEOUT_MS   5000 /* the slowest display shows a frame far sooner */
#define PAUSE_MS     5    /* if a driver says that it is ready, and is not */

typedef struct v4l2_sink {
    pupil_sink base;
    pupil_sink_options options;
    pupil_v4l2_device device;
    pupil_v4l2_output output;
    int streaming, queued;  /* queued: how many buffers are the driver's */
    uint32_t buffers, next; /* buffers 0: write(). next: the first that was never queued */
    struct {
        void *memory;
        size_t bytes;
    } buffer[MOST_BUFFERS];
    unsigned char *frame; /* for write() */
    uint64_t frames;
} v4l2_sink;

int pupil_is_v4l2_output(const char *path)
{
    static const char *const begins[] = {"/dev/video", "/dev/v4l/", PUPIL_V4L2_PREFIX};
    for (size_t i = 0; i < sizeof begins / sizeof begins[0]; i++)
        if (strncmp(path, begins[i], strlen(begins[i])) == 0)
            return 1;
    return 0;
}

static int failed(const v4l2_sink *s, const char *what, int error, pupil_why *why)
{
    return pupil_v4l2_output_failed(&s->device, what, error, why);
}

static int is_multi(const v4l2_sink *s)
{
    return s->device.type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE;
}

/* --- open --- */

static int open_node(v4l2_sink *s, const char *path, pupil_why *why)
{
    const pupil_v4l2_system *system = s->device.system;
    const size_t prefix = sizeof PUPIL_V4L2_PREFIX - 1;
    const char *which = path + (strncmp(path, PUPIL_V4L2_PREFIX, prefix) == 0 ? prefix : 0);
    const int is_number = *which && strlen(which) <= 3 && !which[strspn(which, "0123456789")];
    if (!is_number && !strchr(which, '/'))
        return pupil_refuse(why, "%s: an output node is named by its path or number, as v4l2:2 or /dev/video2", path);
    if (strlen(which) >= sizeof s->device.path - sizeof "/dev/video")
        return pupil_refuse(why, "%.60s...: the path is longer than %zu bytes", which,
                            sizeof s->device.path - sizeof "/dev/video");
    snprintf(s->device.path, sizeof s->device.path, "%s%s", is_number ? "/dev/video" : "", which);
    for (int i = 0; i < 100; i++) {
        s->device.fd = system->open(system->context, s->device.path);
        if (s->device.fd >= 0 || errno != EINTR)
            break;
    }
    if (s->device.fd >= 0)
        return 0;
    if (errno == EACCES)
        return pupil_refuse(why, "%s: permission denied; the user must be in the node's group, most often 'video'",
                            s->device.path);
    return failed(s, "cannot be opened", errno, why);
}

static int identify(v4l2_sink *s, pupil_why *why)
{
    struct v4l2_capability c = {0};
    const uint32_t output = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_OUTPUT_MPLANE;
    if (pupil_v4l2_ask(&s->device, VIDIOC_QUERYCAP, &c) != 0) {
        if (errno != ENOTTY && errno != EINVAL)
            return failed(s, "cannot be asked what it is", errno, why);
        return pupil_refuse(why, "%s: is not a video device; an output is /dev/video0 or its like", s->device.path);
    }
    snprintf(s->device.name, sizeof s->device.name, "%.31s", (const char *)c.card);
    for (char *p = s->device.name; *p; p++)
        if (*p > 0 && *p < ' ')
            *p = '?';
    s->device.capabilities = c.capabilities & V4L2_CAP_DEVICE_CAPS ? c.device_caps : c.capabilities;
    if (!(s->device.capabilities & output))
        return pupil_refuse(why, "%s: %s is not a video output; a display's node is needed, or one of v4l2loopback",
                            s->device.path, s->device.name);
    if (!(s->device.capabilities & (V4L2_CAP_STREAMING | V4L2_CAP_READWRITE)))
        return pupil_refuse(why, "%s: %s takes no frames; a driver is needed that streams or has write()",
                            s->device.path, s->device.name);
    s->device.type =
        s->device.capabilities & V4L2_CAP_VIDEO_OUTPUT ? V4L2_BUF_TYPE_VIDEO_OUTPUT : V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE;
    return 0;
}

static int map(v4l2_sink *s, uint32_t index)
{
    const pupil_v4l2_system *system = s->device.system;
    struct v4l2_plane planes[VIDEO_MAX_PLANES] = {{0}};
    struct v4l2_buffer b = {.type = s->device.type, .memory = V4L2_MEMORY_MMAP, .index = index};
    if (is_multi(s)) {
        b.m.planes = planes;
        b.length = VIDEO_MAX_PLANES;
    }
    if (pupil_v4l2_ask(&s->device, VIDIOC_QUERYBUF, &b) != 0)
        return -1;
    const size_t bytes = is_multi(s) ? planes[0].length : b.length;
    if (bytes < s->output.needs_bytes) {
        errno = EOVERFLOW;
        return -1;
    }
    s->buffer[index].memory =
        system->mmap(system->context, bytes, s->device.fd, is_multi(s) ? planes[0].m.mem_offset : b.m.offset);
    s->buffer[index].bytes = bytes;
    return s->buffer[index].memory ? 0 : -1;
}

/* The driver's buffers, or, where it has none, one of our own for write(). */
static int make_buffers(v4l2_sink *s, pupil_why *why)
{
    const int can_write = (s->device.capabilities & V4L2_CAP_READWRITE) != 0;
    if (s->device.capabilities & V4L2_CAP_STREAMING) {
        struct v4l2_requestbuffers r = {.count = BUFFERS, .type = s->device.type, .memory = V4L2_MEMORY_MMAP};
        if (pupil_v4l2_ask(&s->device, VIDIOC_REQBUFS, &r) == 0)
            s->buffers = r.count < MOST_BUFFERS ? r.count : MOST_BUFFERS;
        else if (!can_write || (errno != EINVAL && errno != ENOTTY))
            return failed(s, "gives no buffers", errno, why);
    }
    if (!s->buffers && !can_write)
        return failed(s, "gives no buffers", ENOMEM, why);
    for (uint32_t i = 0; i < s->buffers; i++)
        if (map(s, i))
            return failed(s, "its buffers cannot be mapped", errno, why);
    if (s->buffers)
        return 0;
    s->frame = calloc(1, s->output.size_bytes);
    return s->frame ? 0 : failed(s, "cannot be written", ENOMEM, why);
}

/* --- write --- */

static int64_t now_ms(const v4l2_sink *s)
{
    return s->device.system->now_ns(s->device.system->context) / 1000000;
}

/* Sleeps until the driver may be ready. 0, or -1 and a sentence. */
static int wait(const v4l2_sink *s, int64_t end_ms, int tries, pupil_why *why)
{
    const pupil_v4l2_system *system = s->device.system;
    struct pollfd p = {s->device.fd, POLLOUT, 0};
    const int64_t left_ms = end_ms - now_ms(s);
    if (left_ms <= 0)
        return pupil_refuse(why, "%s: it shows no frame for %g seconds", s->device.path, TIMEOUT_MS * 1e-3);
    if (tries) /* it said that it was ready */
        system->poll(system->context, NULL, 0, PAUSE_MS);
    if (system->poll(system->context, &p, 1, (int)left_ms) < 0)
        return errno == EINTR || errno == EAGAIN ? 0 : failed(s, "cannot be waited for", errno, why);
    if (p.revents & (POLLHUP | POLLNVAL))
        return failed(s, "takes no frame", ENODEV, why);
    if (p.revents & POLLERR)
        return failed(s, "its driver reports that the stream broke", EIO, why);
    return 0;
}

/* The index of a buffer that was shown, or -1 and a sentence. */
static int dequeue(v4l2_sink *s, pupil_why *why)
{
    const int64_t end_ms = now_ms(s) + TIMEOUT_MS;
    for (int tries = 0;; tries++) {
        struct v4l2_plane planes[VIDEO_MAX_PLANES] = {{0}};
        struct v4l2_buffer b = {.type = s->device.type, .memory = V4L2_MEMORY_MMAP};
        if (is_multi(s)) {
            b.m.planes = planes;
            b.length = VIDEO_MAX_PLANES;
        }
        if (wait(s, end_ms, tries, why))
            return -1;
        if (pupil_v4l2_ask(&s->device, VIDIOC_DQBUF, &b) == 0) {
            if (b.index >= s->buffers)
                return pupil_refuse(why, "%s: its driver gives buffer %u back, which it does not have", s->device.path,
                                    b.index);
            s->queued--;
            return (int)b.index;
        }
        if (errno != EAGAIN)
            return failed(s, "takes no frame", errno, why);
    }
}

static int queue(v4l2_sink *s, uint32_t index, pupil_why *why)
{
    int type = (int)s->device.type;
    struct v4l2_plane plane = {.bytesused = s->output.size_bytes, .length = (uint32_t)s->buffer[index].bytes};
    struct v4l2_buffer b = {.type = s->device.type,
                            .memory = V4L2_MEMORY_MMAP,
                            .index = index,
                            .field = s->output.field ? s->output.field : V4L2_FIELD_NONE};
    b.bytesused = s->output.size_bytes;
    if (plane.bytesused > plane.length)
        b.bytesused = plane.bytesused = plane.length;
    if (is_multi(s)) {
        b.m.planes = &plane;
        b.length = 1;
    }
    if (pupil_v4l2_ask(&s->device, VIDIOC_QBUF, &b) != 0)
        return failed(s, "takes no frame", errno, why);
    s->queued++;
    if (!s->streaming && pupil_v4l2_ask(&s->device, VIDIOC_STREAMON, &type) != 0)
        return failed(s, "does not start", errno, why);
    s->streaming = 1;
    return 0;
}

static int write_whole(v4l2_sink *s, pupil_why *why)
{
    const pupil_v4l2_system *system = s->device.system;
    const int64_t end_ms = now_ms(s) + TIMEOUT_MS;
    for (int tries = 0;; tries++) {
        const ssize_t wrote = system->write(system->context, s->device.fd, s->frame, s->output.size_bytes);
        if (wrote == (ssize_t)s->output.size_bytes)
            return 0;
        if (wrote >= 0)
            return pupil_refuse(why, "%s: it takes %zd bytes of a frame's %u", s->device.path, wrote,
                                s->output.size_bytes);
        if (errno != EAGAIN && errno != EINTR)
            return failed(s, "takes no frame", errno, why);
        if (wait(s, end_ms, tries, why))
            return -1;
    }
}

static int sink_write(pupil_sink *sink, const pupil_image_const *image, const pupil_frame_info *info, pupil_why *why)
{
    v4l2_sink *s = (v4l2_sink *)sink;
    (void)info;
    if (pupil_sink_check_image(s->device.path, &s->options, image, why))
        return PUPIL_SINK_FAILED;
    int index = 0;
    if (s->buffers && s->next < s->buffers)
        index = (int)s->next++;
    else if (s->buffers)
        index = dequeue(s, why);
    if (index < 0)
        return PUPIL_SINK_FAILED;
    pupil_v4l2_output_fill(&s->output, image, s->buffers ? s->buffer[index].memory : s->frame);
    if (s->buffers ? queue(s, (uint32_t)index, why) : write_whole(s, why))
        return PUPIL_SINK_FAILED;
    s->frames++;
    return PUPIL_SINK_OK;
}

/* --- the end --- */

static void sink_discard(pupil_sink *sink)
{
    v4l2_sink *s = (v4l2_sink *)sink;
    const pupil_v4l2_system *system = s->device.system;
    int type = (int)s->device.type;
    if (s->streaming)
        pupil_v4l2_ask(&s->device, VIDIOC_STREAMOFF, &type);
    for (uint32_t i = 0; i < s->buffers; i++)
        if (s->buffer[i].memory)
            system->munmap(system->context, s->buffer[i].memory, s->buffer[i].bytes);
    if (s->device.fd >= 0)
        system->close(system->context, s->device.fd); /* frees the driver's buffers, too */
    free(s->frame);
    free(s);
}

static int sink_finish(pupil_sink *sink, pupil_why *why)
{
    v4l2_sink *s = (v4l2_sink *)sink;
    if (!s->frames)
        return pupil_refuse(why, "%s: nothing was written, for the input has no frame", s->device.path);
    while (s->queued > 1) /* the last one stays on the screen, and with the driver, until the end */
        if (dequeue(s, why) < 0)
            return PUPIL_SINK_FAILED;
    sink_discard(sink);
    return PUPIL_SINK_OK;
}

static const pupil_sink_ops sink_ops = {sink_write, sink_finish, sink_discard};

int pupil_v4l2_sink_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                         const pupil_v4l2_system *system, pupil_why *why)
{
    *sink = NULL;
    if (pupil_sink_check_options(path, options, why))
        return PUPIL_SINK_FAILED;
    v4l2_sink *s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "%s: out of memory", path);
    s->base.ops = &sink_ops;
    s->options = *options;
    s->device.system = system ? system : &pupil_v4l2_kernel;
    s->device.fd = -1;
    if (open_node(s, path, why) || identify(s, why) || pupil_v4l2_output_set(&s->device, options, &s->output, why) ||
        make_buffers(s, why)) {
        sink_discard(&s->base);
        return PUPIL_SINK_FAILED;
    }
    *sink = &s->base;
    return PUPIL_SINK_OK;
}
