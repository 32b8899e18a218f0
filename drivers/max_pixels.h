/* drivers/max_pixels.h: the largest frames that a user allows (source.h: max_pixels). */
#ifndef PUPIL_DRIVERS_MAX_PIXELS_H
#define PUPIL_DRIVERS_MAX_PIXELS_H

#include "refuse.h"
#include "source.h"

/* For a source that knows its frames' size before it makes or reads one. Returns -1 if they are larger, and a sentence
 * about `name`, with `prefix` before it. options may be NULL. */
static inline int pupil_check_max_pixels(const pupil_source_options *options, uint32_t width, uint32_t height,
                                         const char *prefix, const char *name, pupil_why *why)
{
    if (!options || !options->max_pixels || (uint64_t)width * height <= options->max_pixels)
        return 0;
    return pupil_refuse(why, "%s%s: frames of %u x %u pixels; at most %llu pixels can be read (--max-pixels)", prefix,
                        name, width, height, (unsigned long long)options->max_pixels);
}

#endif
