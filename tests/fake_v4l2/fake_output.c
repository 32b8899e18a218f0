/* tests/fake_v4l2/fake_output.c: the fake monitor behind /dev/video2: it keeps the frame that it shows. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static const uint32_t formats[] = {V4L2_PIX_FMT_RGB24, V4L2_PIX_FMT_BGR24,  V4L2_PIX_FMT_XBGR32, V4L2_PIX_FMT_YUYV,
                                   V4L2_PIX_FMT_NV12,  V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_UYVY,   V4L2_PIX_FMT_NV21,
                                   V4L2_PIX_FMT_NV16,  V4L2_PIX_FMT_YVU420, V4L2_PIX_FMT_RGBX32, V4L2_PIX_FMT_ABGR32,
                                   V4L2_PIX_FMT_RGBA32};
#define FORMATS (sizeof formats / sizeof formats[0])

static uint32_t format_at(const fake_v4l2 *f, uint32_t index) /* 0: none */
{
    if (f->config.out_format)
        return index ? 0 : f->config.out_format;
    return index < FORMATS ? formats[index] : 0;
}

static uint32_t stride_of(const fake_output *o)
{
    const uint32_t pixel = pupil_v4l2_pixel_of(o->fourcc), row = (uint32_t)pupil_row_bytes(pixel, o->width);
    return row + (pupil_pixel_planes(pixel) > 1 ? row % 2 : 0) + o->extra_bytes;
}

static uint32_t size_of(const fake_output *o)
{
    const uint32_t pixel = pupil_v4l2_pixel_of(o->fourcc), chroma = pupil_chroma_rows(pixel, o->height);
    return stride_of(o) * (o->height + (pupil_pixel_planes(pixel) == 2 ? chroma : 0)) +
           (pupil_pixel_planes(pixel) == 3 ? 2 * chroma * (stride_of(o) / 2) : 0);
}

static int set_format(fake_v4l2 *f, struct v4l2_format *format, int set)
{
    fake_output *o = &f->output;
    struct v4l2_pix_format *p = &format->fmt.pix;
    if (format->type != V4L2_BUF_TYPE_VIDEO_OUTPUT)
        return fake_fail(EINVAL);
    if (set && o->buffers)
        return fake_fail(EBUSY);
    if (set) {
        o->fourcc = format_at(f, 0);
        for (uint32_t i = 0; format_at(f, i); i++)
            if (format_at(f, i) == p->pixelformat)
                o->fourcc = p->pixelformat;
        o->width = f->config.out_width ? f->config.out_width : p->width;
        o->height = f->config.out_width ? f->config.out_height : p->height;
        o->extra_bytes = (uint32_t)f->config.extra_bytes;
        o->colorspace = f->config.out_colorspace ? f->config.out_colorspace : p->colorspace;
    }
    *p = (struct v4l2_pix_format){.width = o->width,
                                  .height = o->height,
                                  .pixelformat = o->fourcc,
                                  .field = V4L2_FIELD_NONE,
                                  .bytesperline = stride_of(o),
                                  .sizeimage = size_of(o),
                                  .colorspace = o->colorspace,
                                  .priv = V4L2_PIX_FMT_PRIV_MAGIC,
                                  .quantization = f->config.out_quantization};
    p->ycbcr_enc = f->config.out_ycbcr_enc;
    return 0;
}

static int enum_formats(const fake_v4l2 *f, struct v4l2_fmtdesc *d)
{
    if (d->type != V4L2_BUF_TYPE_VIDEO_OUTPUT || !format_at(f, d->index))
        return fake_fail(EINVAL);
    d->pixelformat = format_at(f, d->index);
    d->flags = 0;
    return 0;
}

static int enum_sizes(const fake_v4l2 *f, struct v4l2_frmsizeenum *s)
{
    if (!f->config.out_width || s->index)
        return fake_fail(EINVAL);
    s->type = V4L2_FRMSIZE_TYPE_DISCRETE;
    s->discrete = (struct v4l2_frmsize_discrete){f->config.out_width, f->config.out_height};
    return 0;
}

/* --- buffers --- */

void fake_output_free(fake_v4l2 *f)
{
    fake_output *o = &f->output;
    for (uint32_t i = 0; i < o->buffers; i++) {
        munmap(o->buffer[i].memory, o->buffer[i].bytes);
        close(o->buffer[i].memfd);
    }
    o->buffers = o->waiting = 0;
    o->owner = -1;
    o->streaming = 0;
}

static int request_buffers(fake_v4l2 *f, int fd, struct v4l2_requestbuffers *r)
{
    fake_output *o = &f->output;
    if (r->type != V4L2_BUF_TYPE_VIDEO_OUTPUT || r->memory != V4L2_MEMORY_MMAP || f->config.out_write_only)
        return fake_fail(EINVAL);
    fake_output_free(f);
    r->count = r->count < FAKE_OUTPUT_BUFFERS ? r->count : FAKE_OUTPUT_BUFFERS;
    for (; o->buffers < r->count; o->buffers++) {
        fake_output_buffer *b = &o->buffer[o->buffers];
        b->bytes = (size_of(o) + 4095) / 4096 * 4096;
        b->memfd = memfd_create("fake monitor", MFD_CLOEXEC);
        b->queued = 0;
        if (b->memfd < 0 || ftruncate(b->memfd, (off_t)b->bytes) != 0)
            return fake_fail(ENOMEM);
        b->memory = mmap(NULL, b->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, b->memfd, 0);
        if (b->memory == MAP_FAILED)
            return fake_fail(ENOMEM);
    }
    o->owner = r->count ? fd : -1;
    return 0;
}

void *fake_output_mmap(fake_v4l2 *f, size_t bytes, off_t offset)
{
    const uint32_t index = (uint32_t)(offset >> 16);
    if (index >= f->output.buffers || bytes > f->output.buffer[index].bytes)
        return NULL;
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, f->output.buffer[index].memfd, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

/* Shows a frame; at this one the monitor may be unplugged. */
static int show(fake_v4l2 *f, const void *data, uint32_t bytes)
{
    fake_output *o = &f->output;
    if (f->config.out_gone_at && o->frames + 1 >= f->config.out_gone_at) {
        o->gone = 1;
        return fake_fail(ENODEV);
    }
    unsigned char *shown = realloc(o->shown, bytes);
    if (!shown)
        return fake_fail(ENOMEM);
    memcpy(shown, data, bytes);
    o->shown = shown;
    o->shown_bytes = bytes;
    o->frames++;
    return 0;
}

/* One frame after another, from when it was queued. */
static int queue_buffer(fake_v4l2 *f, struct v4l2_buffer *b)
{
    fake_output *o = &f->output;
    if (b->type != V4L2_BUF_TYPE_VIDEO_OUTPUT || b->index >= o->buffers || o->buffer[b->index].queued ||
        b->bytesused < size_of(o))
        return fake_fail(EINVAL);
    if (show(f, o->buffer[b->index].memory, b->bytesused))
        return -1;
    const int64_t from_ns = o->last_ns > f->now_ns ? o->last_ns : f->now_ns;
    const int stalls = f->config.out_stall_at && o->frames >= f->config.out_stall_at;
    o->buffer[b->index].queued = 1;
    o->buffer[b->index].done_ns = stalls ? INT64_MAX : from_ns + (int64_t)(1e9 / f->config.fps);
    o->last_ns = o->buffer[b->index].done_ns;
    o->order[o->waiting++] = b->index;
    return 0;
}

static int dequeue_buffer(fake_v4l2 *f, struct v4l2_buffer *b)
{
    fake_output *o = &f->output;
    if (b->type != V4L2_BUF_TYPE_VIDEO_OUTPUT || !o->streaming)
        return fake_fail(EINVAL);
    if (!o->waiting || o->buffer[o->order[0]].done_ns > f->now_ns)
        return fake_fail(EAGAIN);
    b->index = o->order[0];
    o->buffer[b->index].queued = 0;
    memmove(o->order, o->order + 1, --o->waiting * sizeof o->order[0]);
    return 0;
}

ssize_t fake_output_write(fake_v4l2 *f, const void *data, size_t bytes)
{
    fake_output *o = &f->output;
    if (o->owner >= 0 || bytes < size_of(o))
        return fake_fail(o->owner >= 0 ? EBUSY : EINVAL);
    if (o->last_ns > f->now_ns)
        return fake_fail(EAGAIN);
    if (show(f, data, (uint32_t)bytes))
        return -1;
    o->last_ns = f->config.out_stall_at && o->frames >= f->config.out_stall_at
                     ? INT64_MAX
                     : f->now_ns + (int64_t)(1e9 / f->config.fps);
    return (ssize_t)bytes;
}

short fake_output_ready(const fake_v4l2 *f)
{
    const fake_output *o = &f->output;
    if (o->gone)
        return POLLERR | POLLHUP;
    return fake_output_next_ns(f) <= f->now_ns ? POLLOUT : 0;
}

int64_t fake_output_next_ns(const fake_v4l2 *f)
{
    const fake_output *o = &f->output;
    if (o->owner < 0)
        return o->last_ns;
    return o->waiting ? o->buffer[o->order[0]].done_ns : 0;
}

int fake_output_ioctl(fake_v4l2 *f, int fd, unsigned long request, void *argument)
{
    fake_output *o = &f->output;
    struct v4l2_streamparm *parm = argument;
    struct v4l2_buffer *buffer = argument;
    if (o->owner >= 0 && o->owner != fd)
        return fake_fail(EBUSY);
    switch (request) {
    case VIDIOC_ENUM_FMT:
        return enum_formats(f, argument);
    case VIDIOC_ENUM_FRAMESIZES:
        return enum_sizes(f, argument);
    case VIDIOC_G_FMT:
        return set_format(f, argument, 0);
    case VIDIOC_S_FMT:
        return set_format(f, argument, 1);
    case VIDIOC_S_PARM:
        o->fps = (double)parm->parm.output.timeperframe.denominator / parm->parm.output.timeperframe.numerator;
        return f->config.no_rate ? fake_fail(ENOTTY) : 0;
    case VIDIOC_REQBUFS:
        return request_buffers(f, fd, argument);
    case VIDIOC_QUERYBUF:
        if (buffer->index >= o->buffers)
            return fake_fail(EINVAL);
        buffer->length = (uint32_t)o->buffer[buffer->index].bytes;
        buffer->m.offset = buffer->index << 16;
        return 0;
    case VIDIOC_QBUF:
        return queue_buffer(f, argument);
    case VIDIOC_DQBUF:
        return dequeue_buffer(f, argument);
    case VIDIOC_STREAMON:
        if (f->config.start_error || !o->buffers)
            return fake_fail(o->buffers ? f->config.start_error : EINVAL);
        o->streaming = 1;
        return 0;
    case VIDIOC_STREAMOFF:
        o->streaming = 0;
        o->waiting = 0;
        return 0;
    default:
        return fake_fail(ENOTTY);
    }
}

uint64_t fake_v4l2_shown(fake_v4l2 *f, fake_v4l2_screen *screen)
{
    const fake_output *o = &f->output;
    *screen = (fake_v4l2_screen){.data = o->shown,
                                 .bytes = o->shown_bytes,
                                 .fourcc = o->fourcc,
                                 .width = o->width,
                                 .height = o->height,
                                 .stride_bytes = stride_of(o),
                                 .colorspace = o->colorspace,
                                 .fps = o->fps};
    return o->frames;
}
