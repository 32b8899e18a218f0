/* The requests of a libcamera stream: how they are queued with the wanted setting, and what is done if they are
 * cancelled or do not come back. */
#include <string.h>
#include <time.h>

#include "libcamera_private.h"
#include "refuse.h"

#define USUAL_TIMEOUT_S 5.0
#define WAIT_MS         100 /* in which options.stop is asked once */
#define LOST_AFTER      16  /* so many that were queued later came back: then a request is lost */
#define LEAST_ALIVE     2   /* requests: with fewer the stream would stall */
#define MANY_CANCELLED  16  /* without a frame between them: then they are not queued again at once */
#define MOST_CANCELLED  64  /* without one: then none is expected any more */

int64_t libcamera_now_ns(const libcamera_source *s)
{
    return s->layer->now_ns(s->layer->context);
}

static double timeout_s(const libcamera_source *s)
{
    return s->options.timeout_s > 0.0 ? s->options.timeout_s : USUAL_TIMEOUT_S;
}

void libcamera_pause_ms(int ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000L};
    nanosleep(&t, NULL);
}

/* ---- requests ---- */

void libcamera_mark(libcamera_source *s)
{
    int64_t end_ns = s->stamp_ns;
    if (!s->controls || !(s->period_ns > 0.0)) /* before the first frame none is in progress */
        return;
    if (s->live.times.stamp == PUPIL_LIVE_STAMP_START_OF_EXPOSURE)
        end_ns += (int64_t)s->period_ns;
    pupil_camera_frame(&s->controls->base,
                       pupil_camera_newest(s->sequence, end_ns, libcamera_now_ns(s), s->period_ns * 1e-9), 0);
}

/* `asks`: with what is asked for now. */
void libcamera_queue(libcamera_source *s, uint32_t index, int asks)
{
    libcamera_request *r = &s->request[index];
    r->ask = (pupil_libcamera_ask){0};
    if (asks && s->controls) {
        libcamera_mark(s); /* using the frame took time */
        r->ask = libcamera_controls_next(s->controls);
    } else if (asks && s->wants_rate) {
        r->ask.frame_least_s = r->ask.frame_most_s = 1.0 / s->options.fps;
        s->wants_rate = 0;
    }
    r->at = s->came_back;
    r->queued = s->layer->queue(s->camera, index, &r->ask) == 0;
    if (!r->queued && s->controls)
        libcamera_controls_refused(s->controls, &r->ask);
}

int libcamera_start(libcamera_source *s, pupil_why *why)
{
    if (s->layer->start(s->camera, why))
        return -1;
    s->wants_rate = !s->controls && s->options.fps > 0.0;
    for (uint32_t i = 0; i < s->stream.buffers; i++)
        libcamera_queue(s, i, 1);
    return 0;
}

/* Stopping gives all requests back, also lost ones. */
static int restart(libcamera_source *s, pupil_why *why)
{
    s->layer->stop(s->camera);
    memset(s->request, 0, sizeof s->request);
    s->live.counts.restarted++;
    s->reopened = 1; /* the driver counts from 0 again */
    if (s->controls)
        libcamera_controls_restart(s->controls);
    return libcamera_start(s, why);
}

static uint32_t alive(const libcamera_source *s)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->stream.buffers; i++)
        count += s->request[i].queued && s->came_back - s->request[i].at < LOST_AFTER;
    return count;
}

/* 1: it is a frame; 0: not, and it was queued again. */
static int is_frame(libcamera_source *s, const pupil_libcamera_done *done)
{
    libcamera_request *r = &s->request[done->index];
    r->queued = 0;
    s->came_back++;
    if (done->cancelled) {
        s->live.counts.cancelled++;
        if (s->controls)
            libcamera_controls_refused(s->controls, &r->ask);
        if (++s->cancelled > MANY_CANCELLED)
            libcamera_pause_ms(10);
        libcamera_queue(s, done->index, 0);
        return 0;
    }
    s->cancelled = 0;
    const uint32_t needs_bytes = s->format.needs_bytes[0] / (done->used[1] ? 2 : 1);
    if (done->damaged || (done->used[0] && done->used[0] < needs_bytes)) {
        s->live.counts.flagged += done->damaged != 0;
        s->live.counts.cut += !done->damaged;
        libcamera_queue(s, done->index, 1);
        return 0;
    }
    return 1;
}

/* The newest of those that wait: the older ones are queued again. */
static void skip_late(libcamera_source *s, pupil_libcamera_done *done)
{
    pupil_libcamera_done later;
    s->left_out = 0;
    while (pupil_live_wants_newest(s->options.late, &s->pace) && s->layer->wait(s->camera, &later, 0) == 1) {
        if (!is_frame(s, &later))
            continue;
        libcamera_queue(s, done->index, 1);
        s->live.counts.late++;
        s->left_out++;
        *done = later;
    }
}

/* PUPIL_SOURCE_FRAME, PUPIL_SOURCE_END, LIBCAMERA_GONE or LIBCAMERA_STALLED. */
int libcamera_next_done(libcamera_source *s, pupil_libcamera_done *done, pupil_why *why)
{
    int64_t end_ns = libcamera_now_ns(s) + (int64_t)(timeout_s(s) * 1e9);
    for (int restarts = 0;;) {
        if (s->options.stop && s->options.stop())
            return PUPIL_SOURCE_END;
        const int is_short = alive(s) < (s->stream.buffers < LEAST_ALIVE ? s->stream.buffers : LEAST_ALIVE);
        const int got = is_short ? 0 : s->layer->wait(s->camera, done, WAIT_MS);
        if (got < 0) {
            pupil_refuse(why, "%s: the camera was unplugged", s->live.is.path);
            return LIBCAMERA_GONE;
        }
        if (got > 0 && is_frame(s, done)) {
            skip_late(s, done);
            return PUPIL_SOURCE_FRAME;
        }
        const int late = libcamera_now_ns(s) >= end_ns || s->cancelled > MOST_CANCELLED;
        if (!late && !is_short)
            continue;
        if (restarts++ || restart(s, why)) {
            pupil_refuse(why,
                         "%s: no frame within %g seconds, and none after the stream was started again; is it still "
                         "plugged in?",
                         s->live.is.path, timeout_s(s));
            return LIBCAMERA_STALLED;
        }
        end_ns = libcamera_now_ns(s) + (int64_t)(timeout_s(s) * 1e9);
        s->cancelled = 0;
    }
}
