/* A live camera: frames and controls of one device, in step. */
#include "live.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "live_private.h"
#include "refuse.h"

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
    const pupil_v4l2_frame *f = &s->frame;
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
    frame->info.timestamp_ns = f->stamp_ns - s->first_ns;
    frame->info.sequence = s->sequence;
    frame->name = s->label;
}

/* A decoder where frames are compressed, for the size that they have now. */
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

/* From what the driver's numbers and stamps say, for a camera's rate may follow the light. `sequence` and `stamp_ns`
 * are of the frame before. */
static void measure_period(live_source *s, uint64_t sequence, int64_t stamp_ns)
{
    const double passed_ns = (double)(s->stamp_ns - stamp_ns);
    if (s->period_ns > 0.0 && s->sequence > sequence && passed_ns > 0.0)
        s->period_ns = passed_ns / (double)(s->sequence - sequence);
    else
        s->period_ns = 1e9 / s->base.fps;
}

void pupil_live_mark(pupil_source *source)
{
    const live_source *s = of(source);
    if (!s->camera || !(s->period_ns > 0.0)) /* before the first frame none is in progress */
        return;
    int64_t end_ns = s->stamp_ns;
    if (s->frame.stamp == PUPIL_V4L2_STAMP_START_OF_EXPOSURE)
        end_ns += (int64_t)s->period_ns;
    pupil_camera_frame(s->camera, pupil_camera_newest(s->sequence, end_ns, live_now_ns(s), s->period_ns * 1e-9), 0);
}

static int source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    live_source *s = of(source);
    const uint64_t sequence = s->sequence;
    const int64_t stamp_ns = s->stamp_ns;
    take_back(s);
    const int got = next_whole(s, frame, why);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    live_follow_controls(s);
    measure_period(s, sequence, stamp_ns);
    if (!s->camera)
        return got;
    if (!s->told) /* some drivers set their controls again at STREAMON, or with the first frame */
        pupil_camera_reapply(s->camera);
    s->told = 1;
    pupil_live_mark(source);
    pupil_camera_in_force(s->camera, frame->info.sequence, &frame->info);
    return got;
}

static void source_done(pupil_source *source, pupil_frame *frame)
{
    (void)frame;
    take_back(of(source));
}

/* ---- begin and end ---- */

int pupil_live_give_back(pupil_source *source, pupil_why *why)
{
    live_source *s = of(source);
    pupil_why reason;
    pupil_camera *camera = s->camera;
    s->camera = NULL;
    s->options.hands_off = 1;
    pupil_refuse(&s->why, "%s: its controls were given back", s->controls_of.path);
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
    pupil_live_give_back(source, &unused);
    take_back(s);
    pupil_v4l2_capture_close(&s->capture);
    pupil_jpeg_close(s->jpeg);
    free(s);
}

static const pupil_source_ops source_ops = {source_next, source_done, source_close};

static void take_options(live_source *s, const pupil_source_options *options, const pupil_live_options *more)
{
    if (more)
        s->options = *more;
    if (!options)
        return;
    pupil_v4l2_options *capture = &s->options.capture;
    capture->fps = options->fps != 0.0 ? options->fps : capture->fps;
    capture->width = options->width ? options->width : capture->width;
    capture->height = options->height ? options->height : capture->height;
    capture->stop = options->stop ? options->stop : capture->stop;
}

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
    s->base.primaries = s->capture.format.primaries;
    s->base.fps = s->capture.fps > 0.0 ? s->capture.fps : asked_fps > 0.0 ? asked_fps : NOMINAL_FPS;
    return 0;
}

int pupil_live_open(const char *which, const pupil_source_options *options, const pupil_live_options *more,
                    pupil_source **source, pupil_why *why)
{
    const size_t prefix = sizeof PUPIL_V4L2_PREFIX - 1;
    which += strncmp(which, PUPIL_V4L2_PREFIX, prefix) == 0 ? prefix : 0;
    live_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s: not enough memory", which);
        return PUPIL_SOURCE_FAILED;
    }
    take_options(s, options, more);
    snprintf(s->which, sizeof s->which, "%s", which);
    if (open_frames(s, why)) {
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    s->base.ops = &source_ops;
    s->controls_of.mains_hz = s->options.mains_hz;
    s->controls_of.delay = s->options.delay;
    live_name_controls(s);
    pupil_refuse(&s->why, "%s: its controls are left alone", s->controls_of.path);
    if (!s->options.hands_off)
        s->camera = live_controls_open(&s->controls_of, &s->why);
    *source = &s->base;
    return 0;
}

/* ---- what is known ---- */

pupil_camera *pupil_live_camera(const pupil_source *source)
{
    return of(source)->camera;
}

const char *pupil_live_no_controls(const pupil_source *source)
{
    return of(source)->why.text;
}

const pupil_v4l2_capture *pupil_live_capture(const pupil_source *source)
{
    return &of(source)->capture;
}

const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source)
{
    return &of(source)->frame;
}

int64_t pupil_live_now_ns(const pupil_source *source)
{
    return live_now_ns(of(source));
}

int pupil_live_is_linear(const pupil_source *source)
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

void pupil_live_restore(const pupil_source *source)
{
    pupil_camera_restore(of(source)->camera);
}
