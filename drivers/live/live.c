/* Live cameras of any kind: which one a name means, and the calls of their tables. */
#include "live.h"

#include <string.h>

#include "kinds_private.h"
#include "libcamera/libcamera.h"
#include "v4l2/modes.h"
#include "v4l2/offers/offers.h"
#include "v4l2/output/v4l2_sink.h"

static int starts_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

static const pupil_v4l2_system *v4l2_of(const pupil_live_system *system)
{
    return system ? system->v4l2 : NULL;
}

static const pupil_libcamera_layer *libcamera_of(const pupil_live_system *system)
{
    return system ? system->libcamera : pupil_libcamera_library();
}

static int is_libcamera(const char *which)
{
    return starts_with(which, PUPIL_LIBCAMERA_PREFIX);
}

static const char *without_prefix(const char *which)
{
    if (is_libcamera(which))
        return which + strlen(PUPIL_LIBCAMERA_PREFIX);
    return which + (starts_with(which, PUPIL_V4L2_PREFIX) ? strlen(PUPIL_V4L2_PREFIX) : 0);
}

int pupil_live_is_camera(const char *name)
{
    return is_libcamera(name) || starts_with(name, PUPIL_V4L2_PREFIX) || starts_with(name, "/dev/video") ||
           starts_with(name, "/dev/v4l/");
}

/* Options of any source take precedence over those of a camera. */
static void merge(pupil_live_options *to, const pupil_source_options *options)
{
    pupil_v4l2_options *capture = &to->capture;
    if (v4l2_of(to->system))
        capture->system = to->system->v4l2;
    if (!options)
        return;
    capture->fps = options->fps != 0.0 ? options->fps : capture->fps;
    capture->width = options->width ? options->width : capture->width;
    capture->height = options->height ? options->height : capture->height;
    capture->stop = options->stop ? options->stop : capture->stop;
}

static int open_libcamera(const char *which, const pupil_live_options *all, pupil_source **source, pupil_why *why)
{
    const pupil_v4l2_options *c = &all->capture;
    const pupil_libcamera_options options = {.layer = libcamera_of(all->system),
                                             .v4l2 = c->system,
                                             .fourcc = c->fourcc,
                                             .width = c->width,
                                             .height = c->height,
                                             .fps = c->fps,
                                             .buffers = c->buffers,
                                             .timeout_s = c->timeout_s,
                                             .reopen_s = c->reopen_s,
                                             .late = c->late,
                                             .monotonic = c->monotonic,
                                             .stop = c->stop,
                                             .delay = all->delay,
                                             .hands_off = all->hands_off};
    return pupil_libcamera_open(which, &options, source, why);
}

int pupil_live_open(const char *which, const pupil_source_options *options, const pupil_live_options *more,
                    pupil_source **source, pupil_why *why)
{
    pupil_live_options all = more ? *more : (pupil_live_options){0};
    merge(&all, options);
    const int error = is_libcamera(which) ? open_libcamera(without_prefix(which), &all, source, why)
                                          : live_v4l2_open(without_prefix(which), &all, source, why);
    if (!error)
        ((pupil_live *)*source)->system = all.system;
    return error;
}

/* ---- what there is ---- */

typedef struct walk {
    int with_modes;
    pupil_live_seen *seen;
    void *closure;
    int ended;
} walk;

static int seen_node(void *closure, const pupil_v4l2_device *device, const char *path, const char *why)
{
    walk *w = closure;
    pupil_live_identity is;
    pupil_live_modes modes = {0};
    pupil_why words = {""};
    (void)path;
    if (!device)
        return w->ended = w->seen(w->closure, NULL, NULL, why);
    pupil_v4l2_identify(device, &is);
    if (w->with_modes)
        pupil_v4l2_modes_read(device, &modes, &words);
    w->ended = w->seen(w->closure, &is, &modes, words.text);
    pupil_live_modes_free(&modes);
    return w->ended;
}

int pupil_live_cameras(const pupil_live_system *system, int with_modes, pupil_live_seen *seen, void *closure,
                       pupil_why *why)
{
    walk w = {with_modes, seen, closure, 0};
    if (pupil_v4l2_devices(v4l2_of(system), seen_node, &w, why) < 0)
        return -1;
    pupil_why words;
    if (!w.ended && pupil_libcamera_cameras(libcamera_of(system), seen, closure, &words))
        seen(closure, NULL, NULL, words.text); /* V4L2's are listed nevertheless */
    return 0;
}

int pupil_live_offers_read(pupil_live_offers *offers, const pupil_live_system *system, const char *which,
                           pupil_why *why)
{
    if (is_libcamera(which))
        return pupil_libcamera_offers_read(offers, libcamera_of(system), without_prefix(which), why);
    return pupil_v4l2_offers_read(offers, v4l2_of(system), without_prefix(which), why);
}

int pupil_live_is_output(const char *path)
{
    return pupil_is_v4l2_output(path);
}

int pupil_live_output_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                           const pupil_live_system *system, pupil_why *why)
{
    return pupil_v4l2_sink_open(sink, path, options, v4l2_of(system), why);
}

/* ---- of a source ---- */

pupil_camera *pupil_live_camera(const pupil_source *source)
{
    return pupil_live_get(source)->camera;
}

const char *pupil_live_no_controls(const pupil_source *source)
{
    return pupil_live_get(source)->no_controls.text;
}

int64_t pupil_live_now_ns(const pupil_source *source)
{
    return pupil_live_get(source)->ops->now_ns(source);
}

int pupil_live_is_linear(const pupil_source *source)
{
    return pupil_live_get(source)->ops->is_linear(source);
}

int pupil_live_find_sensor(const pupil_source *source, pupil_camera_sensor *sensor)
{
    return pupil_live_get(source)->ops->find_sensor(source, sensor);
}

void pupil_live_mark(pupil_source *source)
{
    pupil_live_get(source)->ops->mark(source);
}

int pupil_live_give_back(pupil_source *source, pupil_why *why)
{
    return pupil_live_get(source)->ops->give_back(source, why);
}

void pupil_live_restore(const pupil_source *source)
{
    pupil_live_get(source)->ops->restore(source);
}
