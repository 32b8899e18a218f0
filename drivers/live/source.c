/* A live camera of V4L2: frames and controls of one device, in step. */
#include "live.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kinds_private.h"
#include "live_private.h"
#include "refuse.h"
#include "v4l2/media/media.h"
#include "v4l2/offers/offers.h"

#define NOMINAL_FPS 30.0 /* of a camera that does not report its rate */

static live_source *of(const pupil_source *source)
{
    return (live_source *)(uintptr_t)source;
}

static void take_back(live_source *s)
{
    pupil_why unused;
    if (s->is_out)
        pupil_v4l2_capture_done(&s->capture, &s->frame, &unused); /* next will see it, too */
    s->is_out = 0;
}

/* ---- a frame ---- */

static void describe(live_source *s, pupil_frame *frame)
{
    pupil_v4l2_frame *f = &s->frame;
    memset(frame, 0, sizeof *frame);
    const uint32_t step = f->sequence - s->driver_sequence;
    if (!s->began) {
        s->first_ns = s->options.capture.monotonic ? 0 : f->stamp_ns;
        s->sequence = f->sequence;
    } else { /* a number that did not rise, or began again: the next one */
        s->sequence += step && step < UINT32_C(1) << 31 && !s->reopened ? step : 1;
    }
    s->driver_sequence = f->sequence;
    s->stamp_ns = f->stamp_ns;
    s->began = 1;
    s->reopened = 0;
    snprintf(s->label, sizeof s->label, "%s frame %llu", s->capture.device.path, (unsigned long long)s->sequence);
    frame->image = f->image;
    f->dmabuf.stream = s->capture.counts.reopened;
    frame->dmabuf = f->is_shared ? &f->dmabuf : NULL;
    frame->info.timestamp_ns = f->stamp_ns - s->first_ns;
    frame->info.sequence = s->sequence;
    frame->name = s->label;
}

/* A decoder if frames are compressed, for their present size. */
static int ready_decoder(live_source *s, pupil_why *why)
{
    const pupil_v4l2_format *f = &s->capture.format;
    pupil_why words;
    if (!f->compressed || (s->jpeg && s->jpeg_width == f->width && s->jpeg_height == f->height))
        return 0;
    pupil_jpeg_close(s->jpeg);
    s->jpeg_width = f->width;
    s->jpeg_height = f->height;
    if (pupil_jpeg_open(&s->jpeg, f->width, f->height, &f->coding, &words) == 0)
        return 0;
    pupil_refuse(why, "%s: %s of %s: %s", s->capture.device.path, pupil_v4l2_fourcc_name(f->fourcc).text,
                 s->capture.device.name, words.text);
    return PUPIL_SOURCE_FAILED;
}

/* A frame that was described: decoded where it is compressed. -1 and a sentence: it cannot be, and is left out. */
static int decode(live_source *s, pupil_frame *frame, pupil_why *why)
{
    pupil_why words;
    if (!s->capture.format.compressed)
        return 0;
    frame->coded = s->frame.coded;
    frame->coded_bytes = s->frame.coded_bytes;
    if (pupil_jpeg_decode(s->jpeg, frame->coded, frame->coded_bytes, &frame->image, &words) == 0)
        return 0;
    pupil_refuse(why, "%s: no whole frame within %g seconds; the last one is %s", s->capture.device.path,
                 pupil_v4l2_capture_timeout_s(&s->capture), words.text);
    s->capture.counts.damaged++;
    take_back(s);
    return -1;
}

static int64_t timeout_from_now_ns(const live_source *s)
{
    return live_now_ns(s) + (int64_t)(pupil_v4l2_capture_timeout_s(&s->capture) * 1e9);
}

/* The next whole frame, of a camera that may have to be opened again first. */
static int next_whole(live_source *s, pupil_frame *frame, pupil_why *why)
{
    const double reopen_s = s->options.capture.reopen_s;
    int64_t end_ns = 0;
    int tries = 0; /* at opening it again */
    int64_t whole_ns = timeout_from_now_ns(s);
    for (;;) {
        if (s->capture.device.fd < 0) { /* it could not be opened again */
            pupil_refuse(why, "%s: the camera is closed", s->which);
            return PUPIL_SOURCE_FAILED;
        }
        const int got = pupil_v4l2_capture_next(&s->capture, &s->frame, why);
        if (got == PUPIL_V4L2_FRAME) {
            s->is_out = 1;
            if (ready_decoder(s, why))
                return PUPIL_SOURCE_FAILED;
            describe(s, frame);
            if (decode(s, frame, why) == 0)
                return PUPIL_SOURCE_FRAME;
            if (live_now_ns(s) >= whole_ns)
                return PUPIL_SOURCE_FAILED;
            continue;
        }
        if (got == PUPIL_V4L2_END)
            return PUPIL_SOURCE_END;
        if (!(reopen_s > 0.0))
            return PUPIL_SOURCE_FAILED;
        if (!tries)
            end_ns = live_now_ns(s) + (int64_t)(reopen_s * 1e9);
        const int again = live_reopen(s, end_ns, tries++, why);
        if (again != PUPIL_SOURCE_FRAME)
            return again;
        whole_ns = timeout_from_now_ns(s);
    }
}

/* From the driver's numbers and stamps, because a camera's rate may follow the light. `sequence` and `stamp_ns` are of
 * the frame before; numbers rise. */
static void measure_period(live_source *s, uint64_t sequence, int64_t stamp_ns)
{
    const double passed_ns = (double)(s->stamp_ns - stamp_ns);
    if (s->period_ns > 0.0 && passed_ns > 0.0)
        s->period_ns = passed_ns / (double)(s->sequence - sequence);
    else
        s->period_ns = 1e9 / s->live.base.fps;
}

static void mark(pupil_source *source)
{
    const live_source *s = of(source);
    if (!s->live.camera || !(s->period_ns > 0.0)) /* before the first frame none is in progress */
        return;
    int64_t end_ns = s->stamp_ns;
    if (s->frame.stamp == PUPIL_LIVE_STAMP_START_OF_EXPOSURE)
        end_ns += (int64_t)s->period_ns;
    pupil_camera_frame(s->live.camera, pupil_camera_newest(s->sequence, end_ns, live_now_ns(s), s->period_ns * 1e-9),
                       0);
}

/* Updates what users of the source see. */
static void show(live_source *s)
{
    s->live.counts = s->capture.counts;
    s->live.times = (pupil_live_times){s->frame.stamp, s->frame.stamp_ns, s->frame.taken_ns};
}

static void describe_stream(live_source *s)
{
    const pupil_v4l2_capture *c = &s->capture;
    pupil_live_stream *stream = &s->live.stream;
    pupil_v4l2_identify(&c->device, &s->live.is);
    snprintf(stream->format, sizeof stream->format, "%s", pupil_v4l2_fourcc_name(c->format.fourcc).text);
    stream->width = c->format.width;
    stream->height = c->format.height;
    stream->buffers = c->buffers;
    pupil_v4l2_colour_names(&c->format, stream);
    stream->reading = pupil_v4l2_reading_name(c->reading);
    snprintf(stream->heap, sizeof stream->heap, "%s", c->heap ? c->heap : "");
    stream->read_bytes_s = c->speed.bytes_s;
    stream->ordinary_bytes_s = c->speed.ordinary;
    s->described = c->counts.reopened;
}

static int source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    live_source *s = of(source);
    const uint64_t sequence = s->sequence;
    const int64_t stamp_ns = s->stamp_ns;
    take_back(s);
    const int got = next_whole(s, frame, why);
    show(s);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    if (s->described != s->capture.counts.reopened)
        describe_stream(s);
    live_follow_controls(s);
    measure_period(s, sequence, stamp_ns);
    if (!s->live.camera)
        return got;
    if (!s->told) /* some drivers set their controls again at STREAMON, or with the first frame */
        pupil_camera_reapply(s->live.camera);
    s->told = 1;
    mark(source);
    pupil_camera_in_force(s->live.camera, frame->info.sequence, &frame->info);
    return got;
}

static void source_done(pupil_source *source, pupil_frame *frame)
{
    (void)frame;
    take_back(of(source));
}

/* ---- begin and end ---- */

static int give_back(pupil_source *source, pupil_why *why)
{
    live_source *s = of(source);
    pupil_why reason;
    pupil_camera *camera = s->live.camera;
    s->live.camera = NULL;
    s->options.hands_off = 1;
    pupil_refuse(&s->live.no_controls, "%s: its controls were given back", s->controls_of.path);
    live_change_end(s->change);
    s->change = NULL;
    if (pupil_camera_close(camera, &reason) >= 0)
        return 0;
    return pupil_refuse(why, "%s: %s", s->controls_of.path, reason.text);
}

static void source_close(pupil_source *source)
{
    live_source *s = of(source);
    pupil_why unused;
    give_back(source, &unused);
    take_back(s);
    pupil_v4l2_capture_close(&s->capture);
    pupil_jpeg_close(s->jpeg);
    free(s);
}

static const pupil_source_ops source_ops = {source_next, source_done, source_close};

static int open_frames(live_source *s, pupil_why *why)
{
    if (pupil_v4l2_capture_open(&s->capture, s->which, &s->options.capture, why))
        return PUPIL_SOURCE_FAILED;
    if (ready_decoder(s, why)) {
        pupil_v4l2_capture_close(&s->capture);
        return PUPIL_SOURCE_FAILED;
    }
    const double asked_fps = s->options.capture.fps;
    snprintf(s->name, sizeof s->name, "%s", s->capture.device.name);
    snprintf(s->bus, sizeof s->bus, "%s", s->capture.device.bus);
    s->live.base.primaries = s->capture.format.primaries;
    s->live.base.fps = s->capture.fps > 0.0 ? s->capture.fps : asked_fps > 0.0 ? asked_fps : NOMINAL_FPS;
    return 0;
}

/* ---- what is known ---- */

const pupil_v4l2_capture *pupil_live_capture(const pupil_source *source)
{
    return &of(source)->capture;
}

const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source)
{
    return &of(source)->frame;
}

static int64_t now_ns(const pupil_source *source)
{
    return live_now_ns(of(source));
}

static int find_sensor(const pupil_source *source, pupil_camera_sensor *known)
{
    pupil_v4l2_sensor sensor;
    pupil_why unused;
    return pupil_v4l2_media_sensor(&of(source)->capture.device, &sensor, &unused) == 0 &&
           pupil_camera_find_sensor(NULL, sensor.entity, known, &unused) == 1;
}

static int is_linear(const pupil_source *source)
{
    const pupil_v4l2_capture *capture = &of(source)->capture;
    const uint32_t pixel = capture->format.pixel;
    const uint32_t light = capture->format.coding.light;
    const int is_raw = pupil_pixel_is_mosaic(pixel);
    const int is_grey = pupil_pixel_bits(pixel) && !is_raw;
    if (light != PUPIL_LIGHT_DEFAULT || capture->format.compressed)
        return light == PUPIL_LIGHT_LINEAR;
    return is_raw || (is_grey && strcmp(capture->device.driver, "uvcvideo") != 0);
}

static void restore(const pupil_source *source)
{
    pupil_camera_restore(of(source)->live.camera);
}

static const pupil_live_ops live_ops = {now_ns, is_linear, find_sensor, mark, give_back, restore};

/* ---- open ---- */

int live_v4l2_open(const char *which, const pupil_live_options *options, pupil_source **source, pupil_why *why)
{
    live_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s: not enough memory", which);
        return PUPIL_SOURCE_FAILED;
    }
    s->options = *options;
    snprintf(s->which, sizeof s->which, "%s", which);
    if (open_frames(s, why)) {
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    s->live.base.ops = &source_ops;
    s->live.base.obeys = PUPIL_SOURCE_FPS | PUPIL_SOURCE_SIZE;
    s->live.ops = &live_ops;
    s->controls_of.mains_hz = s->options.mains_hz;
    s->controls_of.delay = s->options.delay;
    live_name_controls(s);
    describe_stream(s);
    pupil_refuse(&s->live.no_controls, "%s: its controls are left alone", s->controls_of.path);
    if (!s->options.hands_off)
        s->live.camera = live_controls_open(&s->controls_of, &s->live.no_controls);
    *source = &s->live.base;
    return 0;
}
