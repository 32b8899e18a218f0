/* A camera that was unplugged, or whose stream stopped or changed, opened again: its frames, then its controls. */
#include <stdio.h>
#include <string.h>

#include "live_private.h"
#include "refuse.h"

#define RETRY_MS 250

/* ---- frames ---- */

static int is_same(void *closure, const pupil_v4l2_device *device, const char *path, const char *why)
{
    live_source *s = closure;
    (void)why;
    if (!device || strcmp(device->name, s->name) != 0 || strcmp(device->bus, s->bus) != 0)
        return 0;
    snprintf(s->label, sizeof s->label, "%s", path);
    return 1;
}

static int try_again(live_source *s, pupil_why *why)
{
    const pupil_v4l2_system *system = s->capture.device.system;
    const pupil_live_counts counts = s->capture.counts;
    pupil_why unused;
    *s->label = 0; /* becomes the path where it is found now */
    pupil_v4l2_devices(system, is_same, s, &unused);
    const int error = pupil_v4l2_capture_open(&s->capture, *s->label ? s->label : s->which, &s->options.capture, why);
    s->capture.device.system = system;
    s->capture.counts = counts;
    return error;
}

int live_reopen(live_source *s, int64_t end_ns, int tries, pupil_why *why)
{
    const pupil_v4l2_system *system = s->capture.device.system;
    const pupil_v4l2_options *options = &s->options.capture;
    pupil_v4l2_capture_close(&s->capture);
    for (;; tries++) {
        if (options->stop && options->stop())
            return PUPIL_SOURCE_END;
        if (tries && live_now_ns(s) >= end_ns)
            break;
        if (tries)
            system->poll(system->context, NULL, 0, RETRY_MS);
        if (try_again(s, why) == 0) {
            s->capture.counts.reopened++;
            s->reopened = 1;
            return PUPIL_SOURCE_FRAME;
        }
    }
    pupil_refuse_add(why, "; it did not come back within %g seconds", options->reopen_s);
    return PUPIL_SOURCE_FAILED;
}

/* ---- controls ---- */

void live_name_controls(live_source *s)
{
    s->controls_of.system = s->capture.device.system;
    snprintf(s->controls_of.path, sizeof s->controls_of.path, "%s", s->capture.device.path);
    s->controls_of.width = s->capture.format.width;
    s->controls_of.height = s->capture.format.height;
}

void live_follow_controls(live_source *s)
{
    const uint64_t reopened = s->capture.counts.reopened;
    if (s->change && live_change_done(&s->change, &s->live.camera, &s->live.no_controls))
        s->told = 0;
    if (reopened == s->controls_reopened || s->change || s->options.hands_off)
        return;
    pupil_camera *old = s->live.camera;
    s->live.camera = NULL;
    s->controls_reopened = reopened;
    s->period_ns = 0.0;
    live_name_controls(s);
    pupil_refuse(&s->live.no_controls, "%s: its controls are being opened again", s->controls_of.path);
    s->change = live_change_start(old, &s->controls_of);
    if (!s->change)
        pupil_refuse(&s->live.no_controls, "%s: not enough memory for its controls", s->controls_of.path);
}
