/* In the place of the scene renderer where it is not built in. */
#include <stdio.h>

#include "synth/scene_source.h"

int pupil_scene_source_open(const char *recipe, const pupil_source_options *options, pupil_source **source, char *why,
                            size_t why_bytes)
{
    (void)options;
    (void)source;
    snprintf(why, why_bytes, "synth:%s: this build has walk alone: no scene renderer (configured with PUPIL_LAB=OFF)",
             recipe);
    return PUPIL_SOURCE_FAILED;
}
