/* drivers/file/file_source.h: recorded frames as sources. */
#ifndef PUPIL_DRIVERS_FILE_SOURCE_H
#define PUPIL_DRIVERS_FILE_SOURCE_H

#include "pupil/error.h"
#include "source.h"

/* Opens what a user names on a command line, by what it is:
 *   still files (.exr .hdr .pic .rgbe .pfm .png .jpg .tif .webp .bmp), a folder of them, or a glob pattern: one
 * sequence in natural order (frame2 before frame10); several inputs follow one another in the order given; a video (any
 * other existing file, or "-" for standard input) through libav: PQ and HLG decoded to linear light;
 *   "pan:FILE[,key=value...]": a camera that moves through an equirectangular panorama (pan_source.h).
 * A video or a pan must be the only input. Returns 0, or PUPIL_SOURCE_FAILED and a sentence. */
int pupil_file_source_open(const char *const *inputs, size_t count, const pupil_source_options *options,
                           pupil_source **source, pupil_why *why);

/* Whether a file of a folder or of a pattern is taken for a still, by its name. */
int pupil_is_still(const char *path);

#endif
