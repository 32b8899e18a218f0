/* drivers/file/still/upright.h: stills that are stored turned or mirrored, as their Exif orientation says. */
#ifndef PUPIL_DRIVERS_FILE_STILL_UPRIGHT_H
#define PUPIL_DRIVERS_FILE_STILL_UPRIGHT_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "still.h"

/* The orientation (TIFF 6.0, tag 274) of a TIFF, or of the Exif of a JPEG, PNG or WebP: 1 to 8. 1, as stored, where
 * there is none. */
uint32_t pupil_orientation_of(const uint8_t *bytes, size_t size);

/* Makes a still upright that was read from these bytes, unless still->as_stored. 0, or -1 and a sentence. */
int pupil_still_make_upright(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why);

#endif
