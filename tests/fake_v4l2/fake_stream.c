/* tests/fake_v4l2/fake_stream.c: the fake camera's buffers, frames and events. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "v4l2/format.h"

/* --- frames --- */

static double draw_share(const fake_v4l2 *f, uint64_t frame, uint64_t what) /* in [0, 1) */
{
    uint64_t z = f->config.seed * UINT64_C(0x9e3779b97f4a7c15) + frame * 4 + what;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void post(fake_v4l2 *f, uint32_t event)
{
    if (f->subscribed & 1u << event && f->event_count < FAKE_MOST_EVENTS)
        f->events[f->event_count++] = event;
}

static void fill(fake_v4l2 *f, fake_buffer *b, uint32_t sequence, int64_t end_ns)
{
    const fake_settings *s = &f->of_frame[(f->made + FAKE_SETTINGS - f->config.control_delay) % FAKE_SETTINGS];
    const fake_settings *g =
        &f->of_frame[(f->made + FAKE_SETTINGS - f->config.control_delay + f->config.gain_earlier) % FAKE_SETTINGS];
    const double exposure = f->config.deaf_exposure ? 1.0 : s->exposure_100us / 100.0;
    const double asked = f->config.deaf_gain ? 1.0 : g->gain_16ths / 16.0;
    const double gain = f->config.coarse_gain ? exp2(floor(log2(asked))) : asked;
    const uint32_t pixel = pupil_v4l2_pixel_of(f->fourcc), colorspace = f->config.colorspace;
    const int jpeg = f->fourcc == V4L2_PIX_FMT_MJPEG;
    const int yuv = jpeg || pupil_pixel_planes(pixel) > 1 || pixel == PUPIL_PIXEL_YUYV || pixel == PUPIL_PIXEL_UYVY;
    const uint32_t offset = (uint32_t)f->config.data_offset;
    uint32_t size[PUPIL_V4L2_MOST_AREAS];
    fake_v4l2_picture p = {.seed = f->config.seed,
                           .sequence = sequence,
                           .fourcc = f->fourcc,
                           .width = f->width,
                           .height = f->height,
                           .ycbcr_enc = f->config.ycbcr_enc,
                           .quantization = f->config.quantization,
                           .xfer_func = f->config.xfer_func,
                           .scale = f->light * exposure * gain,
                           .black = f->config.black,
                           .flat = f->config.flat,
                           .lamp_hz = f->config.lamp_hz,
                           .modulation = f->config.modulation,
                           .readout_s = f->config.readout_s,
                           .end_s = (double)(end_ns - f->start_ns) * 1e-9,
                           .exposure_s = exposure * 0.01,
                           .colour = {f->config.colour[0], f->config.colour[1], f->config.colour[2]}};
    if (jpeg && !p.quantization)
        p.quantization = V4L2_QUANTIZATION_FULL_RANGE;
    if (!p.ycbcr_enc)
        p.ycbcr_enc = V4L2_MAP_YCBCR_ENC_DEFAULT(colorspace);
    if (!p.quantization)
        p.quantization = V4L2_MAP_QUANTIZATION_DEFAULT(!yuv, colorspace, p.ycbcr_enc);
    if (!p.xfer_func)
        p.xfer_func = !yuv         ? V4L2_XFER_FUNC_NONE
                      : colorspace ? V4L2_MAP_XFER_FUNC_DEFAULT(colorspace)
                                   : V4L2_XFER_FUNC_SRGB;
    if (f->config.drawn_xfer)
        p.xfer_func = f->config.drawn_xfer;
    fake_layout(f, p.stride_bytes, size);
    unsigned char *data = (unsigned char *)b->memory[0] + offset;
    if (jpeg)
        size[0] = offset + fake_jpeg(&p, data, size[0] - offset);
    else {
        const uint32_t rows = pupil_chroma_rows(pupil_v4l2_pixel_of(f->fourcc), f->height), areas = fake_areas(f);
        unsigned char *second =
            areas > 1 ? (unsigned char *)b->memory[1] + offset : data + (size_t)p.stride_bytes[0] * f->height;
        unsigned char *third =
            areas > 2 ? (unsigned char *)b->memory[2] + offset : second + (size_t)p.stride_bytes[1] * rows;
        const int cr_first = f->fourcc == V4L2_PIX_FMT_YVU420 || f->fourcc == V4L2_PIX_FMT_YVU420M;
        fake_v4l2_draw(&p, data, cr_first ? third : second, cr_first ? second : third);
    }
    for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++)
        b->used[k] = size[k];
}

/* A frame goes into the buffer that has waited longest. */
static void hand_out(fake_v4l2 *f, uint32_t sequence, int64_t stamp_ns)
{
    static const uint32_t stamps[] = {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF,
                                      V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
                                      V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN};
    const uint32_t index = f->order[0];
    fake_buffer *b = &f->buffer[index];
    memmove(f->order, f->order + 1, --f->waiting * sizeof f->order[0]);
    fill(f, b, sequence, stamp_ns);
    b->queued = 0;
    b->done = 1;
    b->sequence = f->config.no_sequence ? 0 : sequence;
    b->flags = stamps[f->config.stamp % 3];
    b->stamp_ns = f->config.stamp == FAKE_STAMP_NONE ? 0 : stamp_ns + f->config.stamps_ns;
    if (draw_share(f, f->made, 1) < f->config.flagged) {
        b->flags |= V4L2_BUF_FLAG_ERROR;
        memset(b->memory[0], 0xee, b->used[0] / 2);
    } else if (draw_share(f, f->made, 2) < f->config.cut) {
        b->used[0] /= 2;
    }
    if (f->config.end_at && f->made == f->config.end_at) {
        b->flags |= V4L2_BUF_FLAG_LAST;
        f->ended = 1;
        post(f, V4L2_EVENT_EOS);
    }
    f->ready[f->ready_count++] = index;
}

static int is_at(uint64_t when, uint64_t frame)
{
    return when && frame == when;
}

int64_t fake_next_ns(const fake_v4l2 *f)
{
    const int halted = !f->streaming || f->broken || f->ended || is_at(f->config.stall_at, f->made);
    const int64_t stream_ns =
        halted ? INT64_MAX : f->start_ns + (int64_t)((double)(f->made + 1) * 1e9 / fake_rate(f) + 0.5);
    return !f->plugged && f->back_ns ? f->back_ns : stream_ns;
}

void fake_produce(fake_v4l2 *f)
{
    for (int64_t due_ns; f->plugged && (due_ns = fake_next_ns(f)) <= f->now_ns;) {
        const uint32_t sequence = f->config.first_sequence + (uint32_t)f->made, width = f->width;
        f->of_frame[f->made % FAKE_SETTINGS] = f->settings;
        if (is_at(f->config.unplug_at, f->made)) {
            fake_unplug(f);
            return;
        }
        if (is_at(f->config.break_at, f->made))
            f->broken = 1;
        if (is_at(f->config.change_at, f->made)) {
            f->config.change_at = 0; /* once */
            post(f, V4L2_EVENT_SOURCE_CHANGE);
            f->width = f->config.height ? f->height : 32; /* buffers still have the old size */
            f->height = f->config.height ? width : 24;
            f->ended = 1;
            return;
        }
        if (!f->broken && f->waiting && !(draw_share(f, f->made, 0) < f->config.dropped))
            hand_out(f, sequence, due_ns);
        f->made++;
    }
}

/* --- buffers --- */

static void stop(fake_v4l2 *f)
{
    f->streaming = f->broken = f->ended = 0;
    f->waiting = f->ready_count = 0;
    for (uint32_t i = 0; i < f->buffers; i++)
        f->buffer[i].queued = f->buffer[i].done = 0;
}

void fake_free_buffers(fake_v4l2 *f)
{
    stop(f);
    for (uint32_t i = 0; i < f->buffers; i++)
        for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++) {
            fake_buffer *b = &f->buffer[i];
            if (f->memory == V4L2_MEMORY_MMAP && b->memory[k])
                munmap(b->memory[k], b->bytes[k]);
            if (f->memory == V4L2_MEMORY_MMAP && b->memory[k])
                close(b->memfd[k]);
            if (f->memory == V4L2_MEMORY_DMABUF)
                free(b->memory[k]);
            b->memory[k] = NULL;
        }
    f->buffers = 0;
    f->owner = -1;
}

static int make_buffer(fake_v4l2 *f, fake_buffer *b)
{
    uint32_t stride[PUPIL_V4L2_MOST_AREAS], size[PUPIL_V4L2_MOST_AREAS];
    fake_layout(f, stride, size);
    *b = (fake_buffer){0};
    for (uint32_t k = 0; k < fake_areas(f); k++) {
        b->bytes[k] = (size[k] + 4095) / 4096 * 4096;
        b->memfd[k] = memfd_create("fake camera", MFD_CLOEXEC);
        if (b->memfd[k] < 0 || ftruncate(b->memfd[k], b->bytes[k]) != 0)
            return fake_fail(ENOMEM);
        b->memory[k] = mmap(NULL, b->bytes[k], PROT_READ | PROT_WRITE, MAP_SHARED, b->memfd[k], 0);
        if (b->memory[k] == MAP_FAILED)
            return fake_fail(ENOMEM);
    }
    return 0;
}

static int request_buffers(fake_v4l2 *f, int fd, struct v4l2_requestbuffers *r)
{
    const uint32_t most = f->config.most_buffers ? f->config.most_buffers : FAKE_MOST_BUFFERS;
    r->capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP | V4L2_BUF_CAP_SUPPORTS_USERPTR |
                      (f->config.no_import ? 0 : V4L2_BUF_CAP_SUPPORTS_DMABUF) |
                      (f->config.hints ? V4L2_BUF_CAP_SUPPORTS_MMAP_CACHE_HINTS : 0);
    if (r->type != f->type || r->memory < V4L2_MEMORY_MMAP || r->memory == V4L2_MEMORY_OVERLAY ||
        r->memory > V4L2_MEMORY_DMABUF || (f->config.no_mmap && r->memory == V4L2_MEMORY_MMAP) ||
        (f->config.no_import && r->memory == V4L2_MEMORY_DMABUF))
        return fake_fail(EINVAL);
    if (f->owner >= 0 && fd != f->owner)
        return fake_fail(EBUSY);
    fake_free_buffers(f);
    r->count = r->count < most ? r->count : most;
    f->memory = r->memory;
    f->cached = f->config.hints == 1 && r->flags & V4L2_MEMORY_FLAG_NON_COHERENT;
    for (f->buffers = 0; f->buffers < r->count; f->buffers++) {
        if (r->memory != V4L2_MEMORY_MMAP)
            f->buffer[f->buffers] = (fake_buffer){0};
        else if (make_buffer(f, &f->buffer[f->buffers]))
            return -1;
    }
    f->owner = r->count ? fd : -1;
    return 0;
}

static int query_buffer(const fake_v4l2 *f, struct v4l2_buffer *b)
{
    if (b->type != f->type || b->index >= f->buffers)
        return fake_fail(EINVAL);
    const uint32_t first = b->index * PUPIL_V4L2_MOST_AREAS;
    if (f->type == V4L2_BUF_TYPE_VIDEO_CAPTURE) {
        b->length = f->buffer[b->index].bytes[0];
        b->m.offset = first << 16;
        return 0;
    }
    if (b->length < fake_areas(f))
        return fake_fail(EINVAL);
    for (uint32_t k = 0; k < fake_areas(f); k++) {
        b->m.planes[k].length = f->buffer[b->index].bytes[k];
        b->m.planes[k].m.mem_offset = (first + k) << 16;
    }
    b->length = fake_areas(f);
    return 0;
}

static int queue_buffer(fake_v4l2 *f, const struct v4l2_buffer *b)
{
    uint32_t stride[PUPIL_V4L2_MOST_AREAS], size[PUPIL_V4L2_MOST_AREAS];
    const int multi = f->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    if (b->type != f->type || b->memory != f->memory || b->index >= f->buffers || f->buffer[b->index].queued ||
        f->buffer[b->index].done || (multi && b->length < fake_areas(f)))
        return fake_fail(EINVAL);
    fake_buffer *own = &f->buffer[b->index];
    fake_layout(f, stride, size);
    for (uint32_t k = 0; f->memory == V4L2_MEMORY_USERPTR && k < fake_areas(f); k++) {
        own->memory[k] = (void *)(uintptr_t)(multi ? b->m.planes[k].m.userptr : b->m.userptr);
        own->bytes[k] = multi ? b->m.planes[k].length : b->length;
        if (!own->memory[k] || own->bytes[k] < size[k])
            return fake_fail(EINVAL);
    }
    for (uint32_t k = 0; f->memory == V4L2_MEMORY_DMABUF && k < fake_areas(f); k++)
        if (fake_import(f, own, k, multi ? b->m.planes[k].m.fd : b->m.fd, multi ? b->m.planes[k].length : b->length,
                        size[k]))
            return -1;
    own->queued = 1;
    f->order[f->waiting++] = b->index;
    return 0;
}

static int dequeue_buffer(fake_v4l2 *f, struct v4l2_buffer *b)
{
    if (b->type != f->type || b->memory != f->memory || !f->streaming)
        return fake_fail(EINVAL);
    if (f->broken)
        return fake_fail(EIO);
    if (!f->ready_count)
        return fake_fail(f->ended && f->config.end_at ? EPIPE : EAGAIN);
    const uint32_t index = f->ready[0];
    fake_buffer *own = &f->buffer[index];
    memmove(f->ready, f->ready + 1, --f->ready_count * sizeof f->ready[0]);
    own->done = 0;
    b->index = index;
    b->flags = own->flags;
    b->field = V4L2_FIELD_NONE;
    b->sequence = own->sequence;
    b->timestamp.tv_sec = own->stamp_ns / 1000000000;
    b->timestamp.tv_usec = own->stamp_ns % 1000000000 / 1000;
    b->bytesused = own->used[0];
    if (f->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
        b->length = fake_areas(f);
        for (uint32_t k = 0; k < fake_areas(f); k++) {
            b->m.planes[k].bytesused = own->used[k];
            b->m.planes[k].data_offset = (uint32_t)f->config.data_offset;
        }
    }
    return 0;
}

/* --- the rest --- */

static int start_stream(fake_v4l2 *f)
{
    if (f->config.start_error)
        return fake_fail(f->config.start_error);
    if (!f->buffers)
        return fake_fail(EINVAL);
    f->streaming = 1;
    f->start_ns = f->now_ns;
    f->made = 0;
    for (int i = 0; i < FAKE_SETTINGS; i++) /* earlier settings are in force from the first frame on */
        f->of_frame[i] = f->settings;
    return 0;
}

static int take_event(fake_v4l2 *f, struct v4l2_event *e)
{
    if (!f->event_count)
        return fake_fail(ENOENT);
    memset(e, 0, sizeof *e);
    e->type = f->events[0];
    if (e->type == V4L2_EVENT_SOURCE_CHANGE)
        e->u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
    memmove(f->events, f->events + 1, --f->event_count * sizeof f->events[0]);
    e->pending = f->event_count;
    return 0;
}

static int subscribe(fake_v4l2 *f, const struct v4l2_event_subscription *s)
{
    if (f->config.no_events || (s->type != V4L2_EVENT_EOS && s->type != V4L2_EVENT_SOURCE_CHANGE))
        return fake_fail(f->config.no_events ? ENOTTY : EINVAL);
    f->subscribed |= 1u << s->type;
    return 0;
}

/* Requests that only the owner of the stream may make. */
static int owner_ioctl(fake_v4l2 *f, int fd, unsigned long request, void *argument)
{
    switch (request) {
    case VIDIOC_S_FMT:
        return fake_format(f, argument, 1);
    case VIDIOC_S_PARM:
        return fake_parm(f, argument, 1);
    case VIDIOC_REQBUFS:
        return request_buffers(f, fd, argument);
    case VIDIOC_QUERYBUF:
        return query_buffer(f, argument);
    case VIDIOC_QBUF:
        return queue_buffer(f, argument);
    case VIDIOC_DQBUF:
        return dequeue_buffer(f, argument);
    case VIDIOC_STREAMON:
        return start_stream(f);
    case VIDIOC_STREAMOFF:
        stop(f);
        return 0;
    case VIDIOC_SUBSCRIBE_EVENT:
        return subscribe(f, argument);
    case VIDIOC_DQEVENT:
        return take_event(f, argument);
    default:
        return fake_fail(ENOTTY);
    }
}

int fake_stream_ioctl(fake_v4l2 *f, int fd, unsigned long request, void *argument)
{
    switch (request) {
    case VIDIOC_ENUM_FMT:
        return fake_enum_formats(f, argument);
    case VIDIOC_ENUM_FRAMESIZES:
        return fake_enum_sizes(f, argument);
    case VIDIOC_ENUM_FRAMEINTERVALS:
        return fake_enum_intervals(f, argument);
    case VIDIOC_G_FMT:
        return fake_format(f, argument, 0);
    case VIDIOC_G_PARM:
        return fake_parm(f, argument, 0);
    default:
        break;
    }
    const int control = fake_controls_ioctl(f, request, argument);
    if (control != 1)
        return control;
    if (fd < 0 || (f->owner >= 0 && fd != f->owner && request != VIDIOC_SUBSCRIBE_EVENT))
        return fake_fail(EBUSY); /* the twin, or another program */
    return owner_ioctl(f, fd, request, argument);
}
