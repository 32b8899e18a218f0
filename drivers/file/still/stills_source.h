/* drivers/file/still/stills_source.h: still files as a sequence of frames. file_source.h chooses. */
#ifndef PUPIL_DRIVERS_FILE_STILL_STILLS_SOURCE_H
#define PUPIL_DRIVERS_FILE_STILL_STILLS_SOURCE_H

#include "source.h"

int pupil_stills_source_open(const char *const *paths, size_t count, const pupil_source_options *options,
                             pupil_source **source, pupil_why *why);

#endif
