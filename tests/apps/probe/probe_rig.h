/* tests/apps/probe/probe_rig.h: one probe of a camera in this process, which must be left as it was. */
#ifndef PUPIL_TESTS_APPS_PROBE_RIG_H
#define PUPIL_TESTS_APPS_PROBE_RIG_H

#include "check.h"

#include <linux/videodev2.h>

#include "fake_v4l2/fake_v4l2.h"
#include "probe/probe.h"
#include "pupil/error.h"

static inline fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.flat = 500; /* a constant scene */
    return config;
}

static inline int32_t control(fake_v4l2 *fake, uint32_t id, int set, int32_t value)
{
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    struct v4l2_control c = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    CHECK(fd >= 0 && system->ioctl(system->context, fd, set ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &c) == 0);
    system->close(system->context, fd);
    return c.value;
}

static int stops_left = -1; /* -1: never */

static inline int stop(void)
{
    if (stops_left > 0)
        stops_left--;
    return stops_left == 0;
}

/* The light as a factor, by the number of frames so far; NULL: constant. */
static double (*motion)(unsigned long frames);
static fake_v4l2 *moving;
static unsigned long moved_frames;
static double moved_light;

static inline int move_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    const int result = fake_v4l2_system(moving)->ioctl(context, fd, request, argument);
    if (motion && request == VIDIOC_DQBUF && result == 0)
        fake_v4l2_light(moving, moved_light * motion(moved_frames++));
    return result;
}

static const uint32_t ids[] = {V4L2_CID_EXPOSURE_AUTO, V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_GAIN,
                               V4L2_CID_EXPOSURE_AUTO_PRIORITY};
static const int32_t left_at[] = {3, 77, 40, 1}; /* as its user had them */

typedef struct probed {
    probe_report report;
    int result;
    pupil_why why;
} probed;

/* The result of one probe; checks that the camera is as before in any case. */
static inline void probe(probed *p, const fake_v4l2_config *config, int quick, double light)
{
    const probe_options options = {.quick = quick, .seconds = 30, .stop = stop};
    fake_v4l2 *fake = fake_v4l2_new(config);
    if (!fake)
        abort();
    *p = (probed){.result = -1};
    fake_v4l2_light(fake, light);
    for (int i = 0; i < 4; i++)
        control(fake, ids[i], 1, left_at[i]);
    pupil_v4l2_system moved = *fake_v4l2_system(fake);
    const pupil_live_system live = {.v4l2 = &moved};
    moved.ioctl = move_ioctl;
    moving = fake;
    moved_frames = 0;
    moved_light = light;
    CHECK_MSG(pupil_live_offers_read(&p->report.offers, &live, "/dev/video0", &p->why) == 0, "%s", p->why.text);
    for (int i = 0; i < 4; i++)
        CHECK(control(fake, ids[i], 0, 0) == left_at[i]); /* only asked */
    p->result = probe_measure(&p->report, &live, &options, &p->why);
    for (int i = 0; i < 4 && !config->unplug_at; i++)
        CHECK_MSG(control(fake, ids[i], 0, 0) == left_at[i], "control %d is left at %d", i,
                  control(fake, ids[i], 0, 0));
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(fake);
}

#endif
