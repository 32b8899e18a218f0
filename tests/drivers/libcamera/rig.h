/* tests/drivers/libcamera/rig.h: the loop of pupil run on a fake libcamera camera. */
#ifndef PUPIL_TESTS_LIBCAMERA_RIG_H
#define PUPIL_TESTS_LIBCAMERA_RIG_H

#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "fake_libcamera/fake_libcamera.h"
#include "live/live.h"
#include "pupil/camera_loop.h"
#include "pupil/pupil.h"

typedef struct rig {
    fake_libcamera *fake;
    pupil_live_system system;
    pupil_source *source;
    pupil_t pupil;
    pupil_stats stats;
    pupil_sensor_config config;
    pupil_camera_loop loop;
    int steers;
    pupil_frame_info info; /* of the last frame */
    uint64_t frames;       /* that were delivered */
    double wait_s;         /* processing time of each frame */
} rig;

static pupil_why why;

static inline int rig_open(rig *r, const fake_libcamera_config *config, const pupil_live_options *more)
{
    pupil_live_options options = more ? *more : (pupil_live_options){0};
    pupil_config metering;
    memset(r, 0, sizeof *r);
    r->fake = fake_libcamera_new(config);
    r->system.libcamera = fake_libcamera_layer(r->fake);
    options.system = &r->system;
    pupil_config_default(&metering);
    metering.histogram = 1;
    pupil_init(&r->pupil, &metering);
    return pupil_live_open("libcamera:", NULL, &options, &r->source, &why);
}

static inline void rig_close(rig *r)
{
    pupil_source_close(r->source);
    CHECK_MSG(fake_libcamera_opened(r->fake) == 0, "%d cameras are left open", fake_libcamera_opened(r->fake));
    fake_libcamera_free(r->fake);
}

static inline void rig_take(rig *r)
{
    pupil_camera *camera = pupil_live_camera(r->source);
    if (!camera || (r->steers && camera == r->loop.camera))
        return;
    pupil_sensor_config_default(&r->config);
    r->config.frame_s = 1.0 / r->source->fps;
    pupil_camera_configure(camera, &r->config);
    r->config.linear = 1;
    r->config.key = 0.05; /* so that eight times the light does not clip, and can be measured */
    CHECK_MSG(pupil_camera_loop_begin(&r->loop, camera, &r->config, 0.0, &why) == 0, "%s", why.text);
    r->steers = 1;
}

/* What the source says; `steered`: with the loop, as pupil run has it. */
static inline int rig_next(rig *r, int steered)
{
    pupil_frame frame;
    const int got = pupil_source_next(r->source, &frame, &why);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    r->info = frame.info;
    r->frames++;
    if (steered) {
        pupil_coding linear = *frame.image.coding;
        linear.light = PUPIL_LIGHT_LINEAR;
        frame.image.coding = &linear;
        rig_take(r);
        fake_libcamera_pass(r->fake, r->wait_s);
        pupil_stats_clear(&r->stats);
        CHECK(pupil_meter_rows(&r->pupil, &frame.image, 0, frame.image.height, &r->stats) == PUPIL_OK);
        pupil_live_mark(r->source);
        CHECK(pupil_camera_loop_frame(&r->loop, &r->stats, &frame.info) == PUPIL_OK);
    }
    pupil_source_done(r->source, &frame);
    return got;
}

static inline void rig_run(rig *r, int frames)
{
    for (int i = 0; i < frames; i++) {
        const int got = rig_next(r, 1);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "frame %d: %d, %s", i, got, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            return;
    }
}

static inline double rig_total(const rig *r, double light)
{
    return log2(light * fake_libcamera_exposure(r->fake, r->info.sequence) *
                fake_libcamera_gain(r->fake, r->info.sequence));
}

/* The light changes from `from` to `to`: settled to 0.1 EV in delay + 3 delivered frames, after those that wait, with
 * an overshoot of at most 0.1 EV. */
static inline void rig_step(rig *r, double from, double to, unsigned waiting, const char *what)
{
    const double aim = rig_total(r, from), direction = to > from ? 1.0 : -1.0;
    double over = 0.0;
    uint64_t first = 0, settled = 0;
    fake_libcamera_light(r->fake, to);
    for (int i = 0; i < 60; i++) {
        if (rig_next(r, 1) != PUPIL_SOURCE_FRAME)
            break;
        const double off = rig_total(r, to) - aim;
        first = first ? first : r->frames;
        settled = fabs(off) > 0.1 ? 0 : settled ? settled : r->frames;
        over = fmax(over, -off * direction);
    }
    CHECK_MSG(settled && settled - first <= waiting + r->config.delay_frames + 3, "%s: %llu frames, delay %u", what,
              (unsigned long long)(settled - first), r->config.delay_frames);
    CHECK_MSG(over <= 0.1, "%s: %.3f EV too far", what, over);
    printf("%s: %llu frames, delay %u, overshoot %.3f EV\n", what, (unsigned long long)(settled - first),
           r->config.delay_frames, over);
}

static inline const pupil_live_counts *rig_counts(const rig *r)
{
    return &pupil_live_get(r->source)->counts;
}

#endif
