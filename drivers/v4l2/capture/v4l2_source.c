#include "v4l2_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/video/jpeg_frame.h"
#include "refuse.h"

#define NOMINAL_FPS 30.0 /* of a camera that does not tell its rate */
#define RETRY_MS    250

typedef struct v4l2_source {
    pupil_source base;
    pupil_v4l2_capture capture;
    pupil_v4l2_options options;
    char which[256], name[32], bus[32]; /* of the camera that was opened first */
    pupil_v4l2_frame frame;             /* that is out */
    int out;
    pupil_jpeg *jpeg;                 /* of compressed frames: their decoder ... */
    uint32_t jpeg_width, jpeg_height; /* ... and the size that it is for */
    uint64_t sequence;                /* of the last frame */
    uint32_t last_sequence;           /* the driver's for it */
    int64_t first_ns;
    int began, reopened; /* a frame was out; none since the camera was opened again */
    char label[320];
} v4l2_source;

static void take_back(v4l2_source *s)
{
    pupil_why unused;
    if (s->out)
        pupil_v4l2_capture_done(&s->capture, &s->frame, &unused); /* next will see it, too */
    s->out = 0;
}

static int64_t now_ns(const v4l2_source *s)
{
    return s->capture.device.system->now_ns(s->capture.device.system->context);
}

/* --- again --- */

static int is_same(void *closure, const pupil_v4l2_device *device, const char *path, const char *why)
{
    v4l2_source *s = closure;
    (void)why;
    if (!device || strcmp(device->name, s->name) != 0 || strcmp(device->bus, s->bus) != 0)
        return 0;
    snprintf(s->label, sizeof s->label, "%s", path);
    return 1;
}

static int try_again(v4l2_source *s, pupil_why *why)
{
    const pupil_v4l2_system *system = s->capture.device.system;
    const pupil_v4l2_counts counts = s->capture.counts;
    pupil_why unused;
    *s->label = 0; /* where it is found now */
    pupil_v4l2_devices(system, is_same, s, &unused);
    const int error = pupil_v4l2_capture_open(&s->capture, *s->label ? s->label : s->which, &s->options, why);
    s->capture.device.system = system;
    s->capture.counts = counts;
    return error;
}

/* Waits until end_ns for the camera, and starts it; `tries` of it have failed already. PUPIL_SOURCE_FRAME: it runs;
 * PUPIL_SOURCE_END: options.stop; PUPIL_SOURCE_FAILED: it did not come. */
static int reopen(v4l2_source *s, int64_t end_ns, int tries, pupil_why *why)
{
    const pupil_v4l2_system *system = s->capture.device.system;
    pupil_v4l2_capture_close(&s->capture);
    for (;; tries++) {
        if (s->options.stop && s->options.stop())
            return PUPIL_SOURCE_END;
        if (tries && now_ns(s) >= end_ns)
            break;
        if (tries)
            system->poll(system->context, NULL, 0, RETRY_MS);
        if (try_again(s, why) == 0) {
            s->capture.counts.reopened++;
            s->reopened = 1;
            return PUPIL_SOURCE_FRAME;
        }
    }
    pupil_refuse_add(why, "; it did not come back within %g seconds", s->options.reopen_s);
    return PUPIL_SOURCE_FAILED;
}

/* --- the source --- */

static void describe(v4l2_source *s, pupil_frame *frame)
{
    const pupil_v4l2_frame *f = &s->frame;
    memset(frame, 0, sizeof *frame);
    const uint32_t step = f->sequence - s->last_sequence;
    if (!s->began) {
        s->first_ns = s->options.monotonic ? 0 : f->stamp_ns;
        s->sequence = f->sequence;
    } else { /* a number that stands still, or began anew: the next one */
        s->sequence += step && step < UINT32_C(1) << 31 && !s->reopened ? step : 1;
    }
    s->last_sequence = f->sequence;
    s->began = 1;
    s->reopened = 0;
    snprintf(s->label, sizeof s->label, "%s frame %llu", s->capture.device.path, (unsigned long long)s->sequence);
    frame->image = f->image;
    frame->info.timestamp_ns = f->stamp_ns - s->first_ns;
    frame->info.sequence = s->sequence;
    frame->name = s->label;
}

/* A decoder where frames are compressed, for the size that they have now. */
static int ready_decoder(v4l2_source *s, pupil_why *why)
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
static int decode(v4l2_source *s, pupil_frame *frame, pupil_why *why)
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

static int source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    v4l2_source *s = (v4l2_source *)source;
    int64_t end_ns = 0;
    int tries = 0; /* at opening it again */
    take_back(s);
    int64_t whole_ns = now_ns(s) + (int64_t)(pupil_v4l2_capture_timeout_s(&s->capture) * 1e9);
    for (;;) {
        if (s->capture.device.fd < 0) {
            pupil_refuse(why, "%s: the camera is closed", s->which); /* it could not be opened again */
            return PUPIL_SOURCE_FAILED;
        }
        const int got = pupil_v4l2_capture_next(&s->capture, &s->frame, why);
        if (got == PUPIL_V4L2_FRAME) {
            s->out = 1;
            if (ready_decoder(s, why))
                return PUPIL_SOURCE_FAILED;
            describe(s, frame);
            if (decode(s, frame, why) == 0)
                return PUPIL_SOURCE_FRAME;
            if (now_ns(s) >= whole_ns)
                return PUPIL_SOURCE_FAILED;
            continue;
        }
        if (got == PUPIL_V4L2_END)
            return PUPIL_SOURCE_END;
        if (!(s->options.reopen_s > 0.0))
            return PUPIL_SOURCE_FAILED;
        if (!tries)
            end_ns = now_ns(s) + (int64_t)(s->options.reopen_s * 1e9);
        const int again = reopen(s, end_ns, tries++, why);
        if (again != PUPIL_SOURCE_FRAME)
            return again;
        whole_ns = now_ns(s) + (int64_t)(pupil_v4l2_capture_timeout_s(&s->capture) * 1e9);
    }
}

static void source_done(pupil_source *source, pupil_frame *frame)
{
    (void)frame;
    take_back((v4l2_source *)source);
}

static void source_close(pupil_source *source)
{
    v4l2_source *s = (v4l2_source *)source;
    take_back(s);
    pupil_v4l2_capture_close(&s->capture);
    pupil_jpeg_close(s->jpeg);
    free(s);
}

static const pupil_source_ops source_ops = {source_next, source_done, source_close};

int pupil_v4l2_source_open(const char *which, const pupil_source_options *options, const pupil_v4l2_options *more,
                           pupil_source **source, pupil_why *why)
{
    const size_t prefix = sizeof PUPIL_V4L2_PREFIX - 1;
    which += strncmp(which, PUPIL_V4L2_PREFIX, prefix) == 0 ? prefix : 0;
    v4l2_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s: not enough memory", which);
        return PUPIL_SOURCE_FAILED;
    }
    if (more)
        s->options = *more;
    if (options) {
        s->options.fps = options->fps != 0.0 ? options->fps : s->options.fps;
        s->options.width = options->width ? options->width : s->options.width;
        s->options.height = options->height ? options->height : s->options.height;
        s->options.stop = options->stop ? options->stop : s->options.stop;
    }
    snprintf(s->which, sizeof s->which, "%s", which);
    if (pupil_v4l2_capture_open(&s->capture, which, &s->options, why)) {
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    if (ready_decoder(s, why)) {
        pupil_v4l2_capture_close(&s->capture);
        free(s);
        return PUPIL_SOURCE_FAILED;
    }
    snprintf(s->name, sizeof s->name, "%s", s->capture.device.name);
    snprintf(s->bus, sizeof s->bus, "%s", s->capture.device.bus);
    s->base.ops = &source_ops;
    s->base.fps = s->capture.fps > 0.0 ? s->capture.fps : s->options.fps > 0.0 ? s->options.fps : NOMINAL_FPS;
    *source = &s->base;
    return 0;
}

const pupil_v4l2_capture *pupil_v4l2_source_capture(const pupil_source *source)
{
    return &((const v4l2_source *)source)->capture;
}

const pupil_v4l2_frame *pupil_v4l2_source_frame(const pupil_source *source)
{
    return &((const v4l2_source *)source)->frame;
}
