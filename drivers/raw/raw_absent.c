/* In place of raw_source.c and raw_layout.c in a build without V4L2, whose names the formats have. */
#include "raw_source.h"

#include "refuse.h"

int pupil_raw_source_open(const char *text, const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    (void)options;
    *source = NULL;
    pupil_refuse(why, "raw:%s: this build of pupil reads no raw files (it was configured with PUPIL_V4L2=OFF)", text);
    return PUPIL_SOURCE_FAILED;
}
