/* Replaces read_exr.c and read_png.c in a build without the media libraries. */
#include "still.h"

#include "refuse.h"
#include <stdio.h>

int pupil_read_exr(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    (void)still, (void)bytes, (void)size;
    return pupil_refuse(why, "this build of pupil reads no EXR (it was configured with PUPIL_MEDIA=OFF)");
}

int pupil_read_png(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    (void)still, (void)bytes, (void)size;
    return pupil_refuse(why, "this build of pupil reads no PNG (it was configured with PUPIL_MEDIA=OFF)");
}

int pupil_read_libav(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    (void)still, (void)bytes, (void)size;
    return pupil_refuse(
        why, "is not a Radiance or PFM file, the only ones that this build of pupil reads (PUPIL_MEDIA=OFF)");
}
