/* A camera of libcamera as a source: its stream and its frames. */
#include <linux/videodev2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "libcamera_private.h"
#include "refuse.h"
#include "v4l2/offers/offers.h"

#define USUAL_BUFFERS 4 /* few: a setting waits for the requests before it */
#define NOMINAL_FPS   30.0
#define WAIT_MS       100
#define RETRY_MS      250 /* of a camera that is gone */

static libcamera_source *of(const pupil_source *source)
{
    return (libcamera_source *)(uintptr_t)source;
}

/* ---- a frame ---- */

static void take_back(libcamera_source *s)
{
    if (s->is_out)
        libcamera_queue(s, s->index, 1);
    s->is_out = 0;
}

static void number(libcamera_source *s, const pupil_libcamera_done *done)
{
    const uint32_t step = done->sequence - s->driver_sequence;
    if (!s->began) {
        s->first_ns = s->options.monotonic ? 0 : s->stamp_ns;
        s->sequence = done->sequence;
    } else if (step && step < UINT32_C(1) << 31 && !s->reopened) {
        s->sequence += step;
        s->live.counts.lost += step - 1 > s->left_out ? step - 1 - s->left_out : 0;
        pupil_live_pace_frame(&s->pace, step - 1);
    } else { /* a number that did not rise, or began again */
        s->live.counts.repeated += !step;
        s->sequence++;
    }
    s->driver_sequence = done->sequence;
    s->began = 1;
    s->reopened = 0;
}

/* `sequence` and `stamp_ns` are of the frame before; numbers rise. */
static void measure_period(libcamera_source *s, uint64_t sequence, int64_t stamp_ns)
{
    const double passed_ns = (double)(s->stamp_ns - stamp_ns);
    if (s->period_ns > 0.0 && passed_ns > 0.0)
        s->period_ns = passed_ns / (double)(s->sequence - sequence);
    else
        s->period_ns = 1e9 / s->live.base.fps;
}

static const unsigned char *plane_at(const libcamera_source *s, uint32_t plane)
{
    const pupil_libcamera_buffer *b = s->layer->buffer(s->camera, s->index);
    return plane < b->planes ? b->memory[plane] : b->memory[0] + s->format.plane_bytes[plane];
}

/* The planes of the image, as plane_at finds them. */
static void describe_shared(libcamera_source *s, pupil_frame *frame)
{
    const pupil_libcamera_buffer *b = s->layer->buffer(s->camera, s->index);
    const uint32_t planes = pupil_pixel_planes(s->format.pixel);
    int is_shared = 1;
    for (uint32_t i = 0; i < planes; i++) {
        const uint32_t plane = i && s->format.cr_first ? 3 - i : i, own = plane < b->planes ? plane : 0;
        s->dmabuf.fd[i] = b->dmabuf[own];
        s->dmabuf.offset_bytes[i] = b->offset_bytes[own] + (own == plane ? 0 : (uint32_t)s->format.plane_bytes[plane]);
        is_shared &= b->dmabuf[own] >= 0;
    }
    s->dmabuf.stream = s->live.counts.reopened;
    frame->dmabuf = is_shared ? &s->dmabuf : NULL;
}

static void describe(libcamera_source *s, const pupil_libcamera_done *done, pupil_frame *frame)
{
    const pupil_v4l2_format *f = &s->format;
    const uint32_t planes = pupil_pixel_planes(f->pixel), chroma = f->cr_first ? 2 : 1, cr = 3 - chroma;
    const uint32_t bits = pupil_pixel_bits(f->pixel);
    memset(frame, 0, sizeof *frame);
    if (bits && done->black >= 0.0)
        s->coding.black = (float)(done->black / (double)(UINT32_C(1) << (16 - bits)));
    frame->image = (pupil_image_const){.data = plane_at(s, 0),
                                       .stride_bytes = (ptrdiff_t)f->stride_bytes[0],
                                       .width = f->width,
                                       .height = f->height,
                                       .pixel = f->pixel,
                                       .coding = &s->coding};
    if (planes > 1) {
        frame->image.chroma = plane_at(s, chroma);
        frame->image.chroma_stride_bytes = (ptrdiff_t)f->stride_bytes[chroma];
    }
    if (planes > 2) {
        frame->image.cr = plane_at(s, cr);
        frame->image.cr_stride_bytes = (ptrdiff_t)f->stride_bytes[cr];
    }
    snprintf(s->label, sizeof s->label, "%s frame %llu", s->live.is.path, (unsigned long long)s->sequence);
    describe_shared(s, frame);
    frame->name = s->label;
    frame->info.timestamp_ns = s->stamp_ns - s->first_ns;
    frame->info.sequence = s->sequence;
}

/* uvcvideo stamps the start of a frame's exposure. For others libcamera does not say: the end is assumed. */
static uint32_t stamp_of(const libcamera_source *s)
{
    return libcamera_is_webcam(s->id) ? PUPIL_LIVE_STAMP_START_OF_EXPOSURE : PUPIL_LIVE_STAMP_END_OF_FRAME;
}

static void take_frame(libcamera_source *s, const pupil_libcamera_done *done, pupil_frame *frame)
{
    const uint64_t sequence = s->sequence;
    const int64_t stamp_ns = s->stamp_ns, taken_ns = libcamera_now_ns(s);
    s->index = done->index;
    s->is_out = 1;
    s->stamp_ns = done->stamp_ns ? done->stamp_ns : taken_ns;
    s->live.counts.unstamped += !done->stamp_ns;
    s->live.counts.frames++;
    number(s, done);
    describe(s, done, frame);
    measure_period(s, sequence, stamp_ns);
    s->live.times = (pupil_live_times){!done->stamp_ns ? PUPIL_LIVE_STAMP_NONE : stamp_of(s), s->stamp_ns, taken_ns};
    if (!s->controls)
        return;
    libcamera_controls_told(s->controls, s->sequence, done->exposure_s, done->gain);
    libcamera_mark(s);
    pupil_camera_in_force(&s->controls->base, s->sequence, &frame->info);
}

/* ---- begin, again, end ---- */

static void close_camera(libcamera_source *s)
{
    pupil_why unused;
    pupil_camera_close(s->live.camera, &unused);
    s->live.camera = NULL;
    s->controls = NULL;
    if (s->camera) {
        s->layer->stop(s->camera);
        s->layer->close(s->camera);
    }
    s->camera = NULL;
    s->is_out = 0;
    memset(s->request, 0, sizeof s->request);
}

static int read_format(libcamera_source *s, pupil_why *why)
{
    const pupil_libcamera_stream *from = &s->stream;
    struct v4l2_format answer = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    const uint32_t width = s->options.width ? s->options.width : from->width;
    const uint32_t height = s->options.height ? s->options.height : from->height;
    pupil_why words;
    if (width != from->width || height != from->height)
        return pupil_refuse(why, "%s: has no frames of %ux%u; the nearest are of %ux%u ('pupil list' shows its sizes)",
                            s->live.is.path, width, height, from->width, from->height);
    answer.fmt.pix = (struct v4l2_pix_format){.width = from->width,
                                              .height = from->height,
                                              .pixelformat = from->fourcc,
                                              .field = V4L2_FIELD_NONE,
                                              .bytesperline = from->stride_bytes,
                                              .sizeimage = from->size_bytes,
                                              .colorspace = from->colorspace,
                                              .priv = V4L2_PIX_FMT_PRIV_MAGIC,
                                              .ycbcr_enc = from->ycbcr_enc,
                                              .quantization = from->quantization,
                                              .xfer_func = from->xfer_func};
    if (pupil_v4l2_format_read(&answer, &s->format, &words))
        return pupil_refuse(why, "%s: %.900s", s->live.is.path, words.text);
    if (s->format.compressed)
        return pupil_refuse(why,
                            "%s: only compressed frames, which are not read through libcamera; V4L2's are: "
                            "v4l2:/dev/video... ('pupil list')",
                            s->live.is.path);
    s->coding = s->format.coding;
    return 0;
}

static void describe_stream(libcamera_source *s)
{
    pupil_live_stream *stream = &s->live.stream;
    pupil_live_identity *is = &s->live.is;
    snprintf(stream->format, sizeof stream->format, "%s", pupil_v4l2_fourcc_name(s->format.fourcc).text);
    stream->width = s->format.width;
    stream->height = s->format.height;
    stream->buffers = s->stream.buffers;
    pupil_v4l2_colour_names(&s->format, stream);
    stream->reading = "mapped";
    snprintf(is->driver, sizeof is->driver, "libcamera");
    snprintf(is->bus, sizeof is->bus, "%.255s", s->id);
    if (libcamera_is_webcam(s->id) && !s->options.hands_off)
        pupil_refuse(&s->live.remark,
                     "%s is a webcam: libcamera has no true scale of its gain, so that the exposure alone is "
                     "controlled; v4l2:... controls both ('pupil list')",
                     is->name);
}

static void choose_rate(libcamera_source *s)
{
    const pupil_libcamera_range *r = &s->can.frame_s;
    double frame_s = s->can.controls & PUPIL_LIBCAMERA_CAN_FRAME ? r->usual : 0.0;
    if (!(frame_s > 0.0) && r->most > 0.0)
        frame_s = fmin(fmax(1.0 / NOMINAL_FPS, r->least), r->most);
    if (s->options.fps > 0.0)
        frame_s = 1.0 / s->options.fps;
    s->live.base.fps = frame_s > 0.0 ? 1.0 / frame_s : NOMINAL_FPS;
}

static int open_camera(libcamera_source *s, pupil_why *why)
{
    const pupil_libcamera_options *o = &s->options;
    const pupil_libcamera_wanted wanted = {o->fourcc, o->width, o->height, o->buffers ? o->buffers : USUAL_BUFFERS};
    s->camera = s->layer->open(s->layer->context, s->id, why);
    if (!s->camera)
        return -1;
    if (s->layer->configure(s->camera, &wanted, &s->stream, why) || read_format(s, why))
        return -1;
    s->layer->offers(s->camera, NULL, &s->can);
    snprintf(s->live.is.name, sizeof s->live.is.name, "%s", s->can.model);
    if (o->fps > 0.0 && !(s->can.controls & PUPIL_LIBCAMERA_CAN_FRAME))
        return pupil_refuse(why, "%s: libcamera cannot set the frame rate of this camera; v4l2:... may ('pupil list')",
                            s->live.is.path);
    choose_rate(s);
    describe_stream(s);
    s->live.base.primaries = s->format.primaries;
    pupil_refuse(&s->live.no_controls, "%s: its controls are left alone", s->live.is.path);
    if (!o->hands_off) {
        pupil_why words;
        s->controls = libcamera_controls_open(&s->can, s->id, o, s->stream.buffers,
                                              o->fps > 0.0 ? 1.0 / o->fps : 1.0 / s->live.base.fps, &words);
        s->live.camera = s->controls ? &s->controls->base : NULL;
        if (s->controls)
            s->live.base.fps = 1.0 / s->controls->frame_s;
        if (!s->controls)
            pupil_refuse(&s->live.no_controls, "%s: %.900s", s->live.is.path, words.text);
    }
    return libcamera_start(s, why);
}

/* PUPIL_SOURCE_FRAME: it runs again; else what ended it. Adds to the sentence in `why`. */
static int reopen(libcamera_source *s, int64_t end_ns, pupil_why *why)
{
    pupil_why unused;
    close_camera(s);
    for (;;) {
        if (s->options.stop && s->options.stop())
            return PUPIL_SOURCE_END;
        if (libcamera_now_ns(s) >= end_ns)
            break;
        if (open_camera(s, &unused) == 0) {
            s->live.counts.reopened++;
            s->reopened = 1;
            s->period_ns = 0.0;
            return PUPIL_SOURCE_FRAME;
        }
        close_camera(s);
        libcamera_pause_ms(RETRY_MS);
    }
    pupil_refuse_add(why, "; it did not come back within %g seconds", s->options.reopen_s);
    return PUPIL_SOURCE_FAILED;
}

static int source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    libcamera_source *s = of(source);
    pupil_libcamera_done done;
    int64_t end_ns = 0;
    take_back(s);
    for (;;) {
        if (!s->camera) {
            pupil_refuse(why, "%s: the camera is closed", s->live.is.path);
            return PUPIL_SOURCE_FAILED;
        }
        const int got = libcamera_next_done(s, &done, why);
        if (got == PUPIL_SOURCE_FRAME)
            break;
        if (got == PUPIL_SOURCE_END)
            return got;
        if (!(s->options.reopen_s > 0.0)) {
            close_camera(s);
            return PUPIL_SOURCE_FAILED;
        }
        end_ns = end_ns ? end_ns : libcamera_now_ns(s) + (int64_t)(s->options.reopen_s * 1e9);
        const int again = reopen(s, end_ns, why);
        if (again != PUPIL_SOURCE_FRAME)
            return again;
    }
    take_frame(s, &done, frame);
    return PUPIL_SOURCE_FRAME;
}

static void source_done(pupil_source *source, pupil_frame *frame)
{
    (void)frame;
    take_back(of(source));
}

/* For a webcam whose node was not found: turns on at least its automatic exposure, and waits until this is done. */
static void turn_on_again(libcamera_source *s)
{
    const pupil_libcamera_ask automatic = {.automatic = 1};
    pupil_libcamera_done done;
    if (s->controls->node.fd >= 0 || !(s->can.controls & PUPIL_LIBCAMERA_CAN_AE))
        return;
    for (int i = 0; i < 20 && !s->is_out; i++)
        if (s->layer->wait(s->camera, &done, WAIT_MS) == 1) {
            s->request[done.index].queued = 0;
            s->index = done.index;
            s->is_out = 1;
        }
    if (!s->is_out || s->layer->queue(s->camera, s->index, &automatic))
        return;
    s->request[s->index] = (libcamera_request){.queued = 1, .at = s->came_back, .ask = automatic};
    s->is_out = 0;
    for (int i = 0; i < 20; i++)
        if (s->layer->wait(s->camera, &done, WAIT_MS) == 1) {
            s->request[done.index].queued = 0;
            if (done.index == s->index)
                break;
        }
    for (uint32_t i = 0; i < s->stream.buffers; i++)
        if (!s->request[i].queued)
            libcamera_queue(s, i, 0);
}

static int give_back(pupil_source *source, pupil_why *why)
{
    libcamera_source *s = of(source);
    pupil_why reason;
    pupil_camera *camera = s->live.camera;
    if (camera)
        turn_on_again(s);
    s->live.camera = NULL;
    s->controls = NULL;
    s->options.hands_off = 1;
    pupil_refuse(&s->live.no_controls, "%s: its controls were given back", s->live.is.path);
    if (pupil_camera_close(camera, &reason) >= 0)
        return 0;
    return pupil_refuse(why, "%s: %s", s->live.is.path, reason.text);
}

static void source_close(pupil_source *source)
{
    libcamera_source *s = of(source);
    pupil_why unused;
    give_back(source, &unused);
    close_camera(s);
    free(s);
}

static const pupil_source_ops source_ops = {source_next, source_done, source_close};

/* ---- what is known ---- */

static int64_t now_ns(const pupil_source *source)
{
    return libcamera_now_ns(of(source));
}

static int is_linear(const pupil_source *source)
{
    const libcamera_source *s = of(source);
    const uint32_t light = s->format.coding.light;
    const int is_grey = pupil_pixel_bits(s->format.pixel) && !pupil_pixel_is_mosaic(s->format.pixel);
    if (light != PUPIL_LIGHT_DEFAULT)
        return light == PUPIL_LIGHT_LINEAR;
    return pupil_pixel_is_mosaic(s->format.pixel) || (is_grey && !libcamera_is_webcam(s->id));
}

static int find_sensor(const pupil_source *source, pupil_camera_sensor *sensor)
{
    pupil_why unused;
    return pupil_camera_find_sensor(NULL, of(source)->live.is.name, sensor, &unused) == 1;
}

static void mark_source(pupil_source *source)
{
    libcamera_mark(of(source));
}

static void restore(const pupil_source *source)
{
    pupil_camera_restore(of(source)->live.camera);
}

static const pupil_live_ops live_ops = {now_ns, is_linear, find_sensor, mark_source, give_back, restore};

int pupil_libcamera_open(const char *which, const pupil_libcamera_options *options, pupil_source **source,
                         pupil_why *why)
{
    libcamera_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s%s: not enough memory", PUPIL_LIBCAMERA_PREFIX, which);
        return PUPIL_SOURCE_FAILED;
    }
    s->options = *options;
    s->layer = options->layer;
    if (libcamera_find(options->layer, which, s->id, sizeof s->id, why)) {
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    snprintf(s->live.is.path, sizeof s->live.is.path, PUPIL_LIBCAMERA_PREFIX "%.255s", s->id);
    s->live.base.ops = &source_ops;
    s->live.base.obeys = PUPIL_SOURCE_FPS | PUPIL_SOURCE_SIZE;
    s->live.ops = &live_ops;
    if (open_camera(s, why)) {
        close_camera(s);
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    *source = &s->live.base;
    return 0;
}
