/* Frames and controls of one camera, in step. */
#include "live.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "live_private.h"
#include "refuse.h"
#include "v4l2/capture/v4l2_source.h"

#define MOST_LATE PUPIL_V4L2_MOST_BUFFERS /* frames in the queue, behind the one that is out */

typedef struct live_source {
    pupil_source base;
    pupil_source *frames;
    live_which which;
    int hands_off;
    pupil_camera *camera; /* NULL: none (now), and why */
    pupil_why why;
    live_again *again; /* NULL: the controls are those of the camera that streams */
    uint64_t reopened; /* as often as the capture says when the controls were opened */
    int told;          /* the camera was told that the stream has started */
    int64_t stamp_ns;  /* of the last frame, */
    uint64_t sequence; /* its number, */
    double period_ns;  /* and what lay between two numbers before it */
} live_source;

static live_source *of(const pupil_source *source)
{
    return (live_source *)(uintptr_t)source;
}

static void name_which(live_source *s)
{
    const pupil_v4l2_capture *capture = pupil_v4l2_source_capture(s->frames);
    s->which.system = capture->device.system;
    s->period_ns = 0.0;
    snprintf(s->which.path, sizeof s->which.path, "%s", capture->device.path);
    s->which.width = capture->format.width;
    s->which.height = capture->format.height;
}

/* After the camera was opened again: its controls, too. Frames do not wait for them. */
static void follow(live_source *s)
{
    const uint64_t reopened = pupil_v4l2_source_capture(s->frames)->counts.reopened;
    if (s->again && live_again_ready(&s->again, &s->camera, &s->why))
        s->told = 0;
    if (reopened == s->reopened || s->again || s->hands_off)
        return;
    pupil_camera *old = s->camera;
    s->camera = NULL;
    s->reopened = reopened;
    name_which(s);
    pupil_refuse(&s->why, "%s: its controls are being opened again", s->which.path);
    s->again = live_again_start(old, &s->which);
    if (!s->again)
        pupil_refuse(&s->why, "%s: not enough memory for its controls", s->which.path);
}

/* From what the driver's numbers and stamps say, for a camera's rate may follow the light. */
static void measure_period(live_source *s, uint64_t sequence)
{
    const int64_t stamp_ns = pupil_v4l2_source_frame(s->frames)->stamp_ns;
    const double passed_ns = (double)(stamp_ns - s->stamp_ns);
    if (s->period_ns > 0.0 && sequence > s->sequence && passed_ns > 0.0)
        s->period_ns = passed_ns / (double)(sequence - s->sequence);
    else
        s->period_ns = 1e9 / s->base.fps;
    s->stamp_ns = stamp_ns;
    s->sequence = sequence;
}

void pupil_live_mark(pupil_source *source)
{
    live_source *s = of(source);
    const pupil_v4l2_frame *f = pupil_v4l2_source_frame(s->frames);
    const pupil_v4l2_system *system = s->which.system;
    if (!s->camera || !(s->period_ns > 0.0)) /* before the first frame none is under way */
        return;
    double frames = (double)(system->now_ns(system->context) - s->stamp_ns) / s->period_ns;
    if (f->stamp == PUPIL_V4L2_STAMP_START_OF_EXPOSURE)
        frames -= 1.0;
    const uint64_t since = frames >= 1.0 ? frames < MOST_LATE ? (uint64_t)frames : MOST_LATE : 0;
    pupil_camera_frame(s->camera, s->sequence + since, 0);
}

static int source_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    live_source *s = of(source);
    const int got = pupil_source_next(s->frames, frame, why);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    follow(s);
    measure_period(s, frame->info.sequence);
    if (!s->camera)
        return got;
    if (!s->told) /* some drivers set their controls anew at STREAMON, or with the first frame */
        pupil_camera_reapply(s->camera);
    s->told = 1;
    pupil_live_mark(source);
    pupil_camera_in_force(s->camera, frame->info.sequence, &frame->info);
    return got;
}

static void source_done(pupil_source *source, pupil_frame *frame)
{
    pupil_source_done(of(source)->frames, frame);
}

int pupil_live_give_back(pupil_source *source, pupil_why *why)
{
    live_source *s = of(source);
    pupil_why reason;
    pupil_camera *camera = s->camera;
    s->camera = NULL;
    s->hands_off = 1;
    pupil_refuse(&s->why, "%s: its controls were given back", s->which.path);
    live_again_end(s->again);
    s->again = NULL;
    if (pupil_camera_close(camera, &reason) >= 0)
        return 0;
    pupil_refuse(why, "%s: %.760s", s->which.path, reason.text);
    return -1;
}

static void source_close(pupil_source *source)
{
    live_source *s = of(source);
    pupil_why unused;
    pupil_live_give_back(source, &unused);
    pupil_source_close(s->frames);
    free(s);
}

static const pupil_source_ops source_ops = {source_next, source_done, source_close};

int pupil_live_open(const char *which, const pupil_source_options *options, const pupil_live_options *more,
                    pupil_source **source, pupil_why *why)
{
    live_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s: not enough memory", which);
        return PUPIL_SOURCE_FAILED;
    }
    const int error = pupil_v4l2_source_open(which, options, more ? &more->capture : NULL, &s->frames, why);
    if (error) {
        free(s);
        return error;
    }
    s->base = *s->frames;
    s->base.ops = &source_ops;
    s->hands_off = more && more->hands_off;
    s->which.mains_hz = more ? more->mains_hz : 0;
    s->which.delay = more ? more->delay : 0;
    name_which(s);
    pupil_refuse(&s->why, "%s: its controls are left alone", s->which.path);
    if (!s->hands_off)
        s->camera = live_controls_open(&s->which, &s->why);
    *source = &s->base;
    return 0;
}

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
    return pupil_v4l2_source_capture(of(source)->frames);
}

int64_t pupil_live_now_ns(const pupil_source *source)
{
    const pupil_v4l2_system *system = pupil_live_capture(source)->device.system;
    return system->now_ns(system->context);
}

int pupil_live_is_linear(const pupil_source *source)
{
    const pupil_v4l2_capture *capture = pupil_live_capture(source);
    const uint32_t pixel = capture->format.pixel, light = capture->format.coding.light;
    const int is_grey = pixel >= PUPIL_PIXEL_GREY8 && pixel <= PUPIL_PIXEL_GREY16;
    const int is_raw = pupil_pixel_is_mosaic(pixel);
    if (light != PUPIL_LIGHT_DEFAULT || capture->format.compressed)
        return light == PUPIL_LIGHT_LINEAR;
    return is_raw || (is_grey && strcmp(capture->device.driver, "uvcvideo") != 0);
}

const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source)
{
    return pupil_v4l2_source_frame(of(source)->frames);
}

void pupil_live_restore(const pupil_source *source)
{
    pupil_camera_restore(of(source)->camera);
}
