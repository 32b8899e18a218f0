/* drivers/live/live_absent.c: in the place of V4L2's cameras where they are not built in. */
#include "kinds_private.h"
#include "refuse.h"

int live_v4l2_open(const char *which, const pupil_live_options *options, pupil_source **source, pupil_why *why)
{
    (void)options, (void)source;
    pupil_refuse(why, "%s: this program was built without cameras (PUPIL_V4L2=OFF)", which);
    return PUPIL_SOURCE_FAILED;
}

/* Never called: there are no such sources. */
const pupil_v4l2_capture *pupil_live_capture(const pupil_source *source)
{
    (void)source;
    return NULL;
}

const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source)
{
    (void)source;
    return NULL;
}

int pupil_live_await(double most_s, int (*stop)(void))
{
    (void)most_s, (void)stop;
    return 0;
}
