/* drivers/libcamera/libcamera_absent.c: in the place of libcamera's cameras where V4L2's are not built in. */
#include "libcamera.h"
#include "refuse.h"

static int absent(const char *which, pupil_why *why)
{
    return pupil_refuse(why, "%s%s: this program was built without cameras (PUPIL_V4L2=OFF)", PUPIL_LIBCAMERA_PREFIX,
                        which);
}

int pupil_libcamera_open(const char *which, const pupil_libcamera_options *options, pupil_source **source,
                         pupil_why *why)
{
    (void)options, (void)source;
    absent(which, why);
    return PUPIL_SOURCE_FAILED;
}

int pupil_libcamera_cameras(const pupil_libcamera_layer *layer, pupil_libcamera_seen *seen, void *closure,
                            pupil_why *why)
{
    (void)layer, (void)seen, (void)closure, (void)why;
    return 0;
}

int pupil_libcamera_offers_read(pupil_live_offers *offers, const pupil_libcamera_layer *layer, const char *which,
                                pupil_why *why)
{
    (void)offers, (void)layer;
    return absent(which, why);
}
