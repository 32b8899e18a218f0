/* apps/open_input.h: what a user names as an input, as a source. */
#ifndef PUPIL_APPS_OPEN_INPUT_H
#define PUPIL_APPS_OPEN_INPUT_H

#include "source.h"

/* "synth:NAME" is a synthetic scene and must be the only input; everything else is a file (file/file_source.h). */
int open_input(const char *const *inputs, size_t count, const pupil_source_options *options, pupil_source **source,
               char *why, size_t why_bytes);

#endif
