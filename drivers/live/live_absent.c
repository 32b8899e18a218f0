/* drivers/live/live_absent.c: in the place of live cameras where they are not built in. */
#include <stdio.h>

#include "live.h"
#include "refuse.h"

int pupil_live_open(const char *which, const pupil_source_options *options, const pupil_live_options *more,
                    pupil_source **source, pupil_why *why)
{
    (void)options, (void)more, (void)source;
    pupil_refuse(why, "%s: this program was built without cameras (PUPIL_V4L2=OFF)", which);
    return PUPIL_SOURCE_FAILED;
}

/* Nobody has a source to ask with. */
pupil_camera *pupil_live_camera(const pupil_source *source)
{
    (void)source;
    return NULL;
}

const char *pupil_live_no_controls(const pupil_source *source)
{
    (void)source;
    return "";
}

const pupil_v4l2_capture *pupil_live_capture(const pupil_source *source)
{
    (void)source;
    return NULL;
}

int64_t pupil_live_now_ns(const pupil_source *source)
{
    (void)source;
    return 0;
}

int pupil_live_is_linear(const pupil_source *source)
{
    (void)source;
    return 0;
}

const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source)
{
    (void)source;
    return NULL;
}

void pupil_live_mark(pupil_source *source)
{
    (void)source;
}

int pupil_live_give_back(pupil_source *source, pupil_why *why)
{
    (void)source, (void)why;
    return 0;
}

int pupil_live_await(double most_s, int (*stop)(void))
{
    (void)most_s, (void)stop;
    return 0;
}

void pupil_live_restore(const pupil_source *source)
{
    (void)source;
}
