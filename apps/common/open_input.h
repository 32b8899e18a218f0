/* apps/common/open_input.h: opens an input that a user names as a source. */
#ifndef PUPIL_APPS_COMMON_OPEN_INPUT_H
#define PUPIL_APPS_COMMON_OPEN_INPUT_H

#include "pupil/error.h"
#include "source.h"

/* "synth:NAME" is a synthetic scene, "raw:FILE,..." frames without a header, a name that live/live.h takes for a camera
 * a camera, a folder with a recording.json a recording; these must be the only input. Everything else is a file
 * (file/file_source.h). */
int open_input(const char *const *inputs, size_t count, const pupil_source_options *options, pupil_source **source,
               pupil_why *why);

#endif
