/* tests/drivers/live/live_camera.h: a simulated camera as a live source, and the facts of its frames. */
#ifndef PUPIL_TESTS_DRIVERS_LIVE_LIVE_CAMERA_H
#define PUPIL_TESTS_DRIVERS_LIVE_LIVE_CAMERA_H

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"

static pupil_why why;

static inline pupil_source *open_camera(fake_v4l2 *fake, const pupil_source_options *options, pupil_live_options more)
{
    pupil_source *source = NULL;
    more.capture.system = fake_v4l2_system(fake);
    CHECK_MSG(pupil_live_open("/dev/video0", options, &more, &source, &why) == 0, "%s", why.text);
    if (!source)
        exit(check_end());
    return source;
}

static inline int next_info(pupil_source *source, pupil_frame_info *info)
{
    pupil_frame frame;
    const int got = pupil_source_next(source, &frame, &why);
    if (got == PUPIL_SOURCE_FRAME) {
        *info = frame.info;
        pupil_source_done(source, &frame);
    }
    return got;
}

#endif
