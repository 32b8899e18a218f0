/* tests/fake_v4l2/fake_modes.c: the fake camera's identity, and its formats, sizes and rates. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pupil/image.h"
#include "v4l2/format.h"

#define FOUR(a, b, c, d) v4l2_fourcc(a, b, c, d)

static const uint32_t formats[] = {
    V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y10, V4L2_PIX_FMT_Y12,
    V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_RGB24, FOUR('A', 'B', '2', '4'), V4L2_PIX_FMT_SRGGB8, V4L2_PIX_FMT_SGRBG8,
    V4L2_PIX_FMT_SGBRG8, V4L2_PIX_FMT_SBGGR8, V4L2_PIX_FMT_SRGGB10, V4L2_PIX_FMT_SGRBG10, V4L2_PIX_FMT_SGBRG10,
    V4L2_PIX_FMT_SBGGR10, V4L2_PIX_FMT_SRGGB12, V4L2_PIX_FMT_SGRBG12, V4L2_PIX_FMT_SGBRG12, V4L2_PIX_FMT_SBGGR12,
    FOUR('R', 'G', '1', '4'), FOUR('G', 'R', '1', '4'), FOUR('G', 'B', '1', '4'), FOUR('B', 'G', '1', '4'),
    V4L2_PIX_FMT_SRGGB16, V4L2_PIX_FMT_SGRBG16, V4L2_PIX_FMT_SGBRG16, V4L2_PIX_FMT_SBGGR16, V4L2_PIX_FMT_SRGGB10P,
    V4L2_PIX_FMT_SGRBG10P, V4L2_PIX_FMT_SGBRG10P, V4L2_PIX_FMT_SBGGR10P, FOUR('p', 'R', 'C', 'C'),
    FOUR('p', 'g', 'C', 'C'), FOUR('p', 'G', 'C', 'C'), FOUR('p', 'B', 'C', 'C'), FOUR('Y', '1', '0', 'P'),
    FOUR('Y', '1', '2', 'P'), V4L2_PIX_FMT_UYVY, V4L2_PIX_FMT_NV21, V4L2_PIX_FMT_NV16, V4L2_PIX_FMT_YUV420,
    V4L2_PIX_FMT_YVU420, FOUR('P', '0', '1', '0'), V4L2_PIX_FMT_BGR24, FOUR('X', 'B', '2', '4'), V4L2_PIX_FMT_XBGR32,
    V4L2_PIX_FMT_ABGR32,
    /* multi-planar only, from here on */
    V4L2_PIX_FMT_NV12M, V4L2_PIX_FMT_NV21M, V4L2_PIX_FMT_NV16M, V4L2_PIX_FMT_YUV420M, V4L2_PIX_FMT_YVU420M};
#define MULTI_ONLY 5

static const struct {
    uint32_t width, height;
} sizes[] = {{64, 48}, {32, 24}, {320, 240}};

static const double slower[] = {1.0, 0.5, 1.0 / 6.0}; /* of config.fps */

static uint32_t format_count(const fake_v4l2 *f)
{
    return f->config.only_format ? 1 : sizeof formats / sizeof formats[0] - (f->config.multiplanar ? 0 : MULTI_ONLY);
}

static uint32_t format_at(const fake_v4l2 *f, uint32_t index)
{
    return f->config.only_format ? f->config.only_format : formats[index];
}

static int has_format(const fake_v4l2 *f, uint32_t fourcc)
{
    for (uint32_t i = 0; i < format_count(f); i++)
        if (format_at(f, i) == fourcc)
            return 1;
    return 0;
}

static void name_it(unsigned char *to, size_t bytes, const char *text)
{
    snprintf((char *)to, bytes, "%s", text);
}

int fake_querycap(const fake_v4l2 *f, int kind, struct v4l2_capability *c)
{
    memset(c, 0, sizeof *c);
    name_it(c->driver, sizeof c->driver, "fake");
    name_it(c->card, sizeof c->card,
            kind == FAKE_TWIN     ? FAKE_V4L2_TWIN
            : kind == FAKE_OUTPUT ? "Fake Monitor"
                                  : FAKE_V4L2_NAME);
    name_it(c->bus_info, sizeof c->bus_info, kind == FAKE_TWIN ? "fake:2" : kind == FAKE_OUTPUT ? "fake:3" : "fake:1");
    c->device_caps = kind == FAKE_METADATA   ? V4L2_CAP_META_CAPTURE
                     : kind == FAKE_OUTPUT   ? V4L2_CAP_VIDEO_OUTPUT
                     : f->config.multiplanar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE
                                             : V4L2_CAP_VIDEO_CAPTURE;
    c->device_caps |= V4L2_CAP_STREAMING;
    if (kind == FAKE_OUTPUT)
        c->device_caps =
            V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_READWRITE | (f->config.out_write_only ? 0 : V4L2_CAP_STREAMING);
    c->capabilities = c->device_caps | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_META_CAPTURE;
    return 0;
}

int fake_enum_formats(const fake_v4l2 *f, struct v4l2_fmtdesc *d)
{
    if (d->type != f->type || d->index >= format_count(f))
        return fake_fail(EINVAL);
    d->pixelformat = format_at(f, d->index);
    d->flags = d->pixelformat == V4L2_PIX_FMT_MJPEG ? V4L2_FMT_FLAG_COMPRESSED : 0;
    snprintf((char *)d->description, sizeof d->description, "fake %s", pupil_v4l2_fourcc_name(d->pixelformat).text);
    return 0;
}

int fake_enum_sizes(const fake_v4l2 *f, struct v4l2_frmsizeenum *s)
{
    if (f->config.no_sizes)
        return fake_fail(ENOTTY);
    const uint32_t only = f->config.width;
    if (!has_format(f, s->pixel_format) || s->index >= (only ? 1 : sizeof sizes / sizeof sizes[0]))
        return fake_fail(EINVAL);
    s->type = V4L2_FRMSIZE_TYPE_DISCRETE;
    s->discrete.width = only ? f->width : sizes[s->index].width;
    s->discrete.height = only ? f->height : sizes[s->index].height;
    if (!only && s->pixel_format == V4L2_PIX_FMT_Y16) { /* a format that can have any size */
        if (s->index)
            return fake_fail(EINVAL);
        s->type = V4L2_FRMSIZE_TYPE_STEPWISE;
        s->stepwise = (struct v4l2_frmsize_stepwise){32, 320, 2, 24, 240, 2};
    }
    return 0;
}

int fake_enum_intervals(const fake_v4l2 *f, struct v4l2_frmivalenum *i)
{
    if (f->config.no_rate)
        return fake_fail(ENOTTY);
    if (!has_format(f, i->pixel_format) || i->index >= sizeof slower / sizeof slower[0])
        return fake_fail(EINVAL);
    i->type = V4L2_FRMIVAL_TYPE_DISCRETE;
    i->discrete = (struct v4l2_fract){1000, (uint32_t)(f->config.fps * slower[i->index] * 1000 + 0.5)};
    return 0;
}

double fake_rate(const fake_v4l2 *f)
{
    return f->config.fps * slower[f->interval];
}

uint32_t fake_areas(const fake_v4l2 *f)
{
    const uint32_t count = sizeof formats / sizeof formats[0];
    for (uint32_t i = count - MULTI_ONLY; i < count; i++)
        if (formats[i] == f->fourcc)
            return pupil_pixel_planes(pupil_v4l2_pixel_of(f->fourcc));
    return 1;
}

void fake_layout(const fake_v4l2 *f, uint32_t stride[PUPIL_V4L2_MOST_AREAS], uint32_t size[PUPIL_V4L2_MOST_AREAS])
{
    const uint32_t pixel = pupil_v4l2_pixel_of(f->fourcc), extra = (uint32_t)f->config.extra_bytes;
    const uint32_t planes = pupil_pixel_planes(pixel), areas = fake_areas(f);
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_AREAS; i++)
        stride[i] = size[i] = 0;
    for (uint32_t i = 0; i < planes; i++) {
        const uint32_t row = (uint32_t)(i ? pupil_chroma_row_bytes(pixel, f->width) : pupil_row_bytes(pixel, f->width));
        const uint32_t rows = i ? pupil_chroma_rows(pixel, f->height) : f->height;
        stride[i] = i && areas == 1 ? stride[0] / (planes == 3 ? 2 : 1) : row + extra;
        size[areas > 1 ? i : 0] += stride[i] * rows;
    }
    if (f->fourcc == V4L2_PIX_FMT_MJPEG) { /* noise can exceed its former size */
        stride[0] = 0;
        size[0] = 4096 + f->width * f->height * 4;
    }
    for (uint32_t i = 0; i < PUPIL_V4L2_MOST_AREAS; i++)
        size[i] += size[i] ? (uint32_t)f->config.data_offset : 0;
}

static void describe_multi(const fake_v4l2 *f, struct v4l2_pix_format_mplane *p)
{
    uint32_t stride[PUPIL_V4L2_MOST_AREAS], size[PUPIL_V4L2_MOST_AREAS];
    fake_layout(f, stride, size);
    memset(p, 0, sizeof *p);
    p->width = f->width;
    p->height = f->height;
    p->pixelformat = f->fourcc;
    p->field = V4L2_FIELD_NONE;
    p->num_planes = (uint8_t)fake_areas(f);
    for (uint32_t i = 0; i < fake_areas(f); i++) {
        p->plane_fmt[i].bytesperline = stride[i];
        p->plane_fmt[i].sizeimage = size[i];
    }
    p->colorspace = f->config.colorspace;
    p->ycbcr_enc = (uint8_t)f->config.ycbcr_enc;
    p->quantization = (uint8_t)f->config.quantization;
    p->xfer_func = (uint8_t)f->config.xfer_func;
}

static void describe_single(const fake_v4l2 *f, struct v4l2_pix_format *p)
{
    uint32_t stride[PUPIL_V4L2_MOST_AREAS], size[PUPIL_V4L2_MOST_AREAS];
    fake_layout(f, stride, size);
    *p = (struct v4l2_pix_format){.width = f->width,
                                  .height = f->height,
                                  .pixelformat = f->fourcc,
                                  .field = V4L2_FIELD_NONE,
                                  .bytesperline = stride[0],
                                  .sizeimage = size[0],
                                  .colorspace = f->config.colorspace,
                                  .priv = V4L2_PIX_FMT_PRIV_MAGIC,
                                  .quantization = f->config.quantization,
                                  .xfer_func = f->config.xfer_func};
    p->ycbcr_enc = f->config.ycbcr_enc;
}

/* The supported size with the nearest width. */
static void take_size(fake_v4l2 *f, uint32_t width, uint32_t height)
{
    uint32_t best = 0, best_off = UINT32_MAX;
    if (f->config.width)
        return; /* unchanged */
    if (f->fourcc == V4L2_PIX_FMT_Y16 && width >= 32 && width <= 320 && height >= 24 && height <= 240) {
        f->width = width;
        f->height = height;
        return;
    }
    for (uint32_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        const uint32_t off = width > sizes[i].width ? width - sizes[i].width : sizes[i].width - width;
        if (off < best_off) {
            best = i;
            best_off = off;
        }
    }
    f->width = sizes[best].width;
    f->height = sizes[best].height;
}

int fake_format(fake_v4l2 *f, struct v4l2_format *format, int set)
{
    const int multi = f->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    if (format->type != f->type)
        return fake_fail(EINVAL);
    if (set && f->config.format_error)
        return fake_fail(f->config.format_error);
    if (set && f->buffers)
        return fake_fail(EBUSY);
    if (set) {
        const uint32_t fourcc = multi ? format->fmt.pix_mp.pixelformat : format->fmt.pix.pixelformat;
        f->fourcc = has_format(f, fourcc) ? fourcc : format_at(f, 0);
        take_size(f, multi ? format->fmt.pix_mp.width : format->fmt.pix.width,
                  multi ? format->fmt.pix_mp.height : format->fmt.pix.height);
        f->interval = 0; /* as vivid: setting a format sets the rate again */
    }
    if (multi)
        describe_multi(f, &format->fmt.pix_mp);
    else
        describe_single(f, &format->fmt.pix);
    return 0;
}

int fake_parm(fake_v4l2 *f, struct v4l2_streamparm *p, int set)
{
    if (f->config.no_rate)
        return fake_fail(ENOTTY);
    if (p->type != f->type)
        return fake_fail(EINVAL);
    struct v4l2_captureparm *c = &p->parm.capture;
    if (set && f->buffers)
        return fake_fail(EBUSY);
    if (set && c->timeperframe.numerator) {
        const double fps = (double)c->timeperframe.denominator / c->timeperframe.numerator;
        for (uint32_t i = 0; i < sizeof slower / sizeof slower[0]; i++)
            if (f->config.fps * slower[i] > fps * 0.99 || i == 0)
                f->interval = i; /* the slowest that is not slower than asked */
    }
    *c = (struct v4l2_captureparm){.capability = V4L2_CAP_TIMEPERFRAME, .readbuffers = 2};
    c->timeperframe = (struct v4l2_fract){1000, (uint32_t)(fake_rate(f) * 1000 + 0.5)};
    return 0;
}
