/* In the place of the scene renderer where it is not built in. */
#include <stdio.h>

#include "refuse.h"
#include "synth/scene_source.h"

int pupil_scene_source_open(const char *recipe, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why)
{
    (void)options;
    (void)source;
    pupil_refuse(why, "synth:%s: this build has walk alone: no scene renderer (configured with PUPIL_LAB=OFF)", recipe);
    return PUPIL_SOURCE_FAILED;
}
