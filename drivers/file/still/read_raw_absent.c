/* Replaces read_raw.c where LibRaw is not installed. */
#include "still.h"

#include "still_private.h"

int pupil_read_raw(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    (void)still, (void)bytes, (void)size;
    return pupil_still_fail(why,
                            "is a DNG or another camera's raw file, and this build of pupil reads none (LibRaw was not "
                            "found when it was configured)");
}
