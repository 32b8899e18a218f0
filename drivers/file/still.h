/* drivers/file/still.h: one HDR still in memory, and the readers that make it: one file a format, one function each.
 *
 * A reader takes the whole file as bytes (so that a fuzzer can call it as it is) and leaves linear Rec.709 float
 * pixels. Limits: at most PUPIL_STILL_MAX_PIXELS pixels and PUPIL_MAX_SIDE_PX a side; a header that promises more than
 * the file can hold is refused before memory is taken.
 */
#ifndef PUPIL_DRIVERS_FILE_STILL_H
#define PUPIL_DRIVERS_FILE_STILL_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/image.h"

#define PUPIL_STILL_MAX_PIXELS (UINT64_C(1) << 26) /* 8192 x 8192; 805 MB as RGB float */

typedef struct pupil_still {
    void *pixels; /* malloc'ed; kept and reused by the next read where it is large enough */
    size_t capacity_bytes;
    uint32_t width, height;
    uint32_t pixel;    /* PUPIL_PIXEL_RGB32F, or _RGBA32F, _RGB16... as the reader likes */
    double exposure_s; /* 0 where unknown. Carried for information only where the format's convention is that pixel
                        * values already are scene light (EXR's expTime, Radiance's EXPOSURE is divided out here) */
} pupil_still;

void pupil_still_free(pupil_still *still);

/* Makes room; a sentence without a file name on failure (the caller puts the name in front). */
int pupil_still_reserve(pupil_still *still, uint64_t width, uint64_t height, uint32_t pixel, char *why,
                        size_t why_bytes);

/* 0, or -1 and a sentence without a file name ("the header promises 40000 x 40000 pixels, at most ..."). On failure the
 * still holds nothing of use but can be read into again. */
typedef int pupil_still_reader(pupil_still *still, const uint8_t *bytes, size_t size, char *why, size_t why_bytes);

pupil_still_reader pupil_read_exr;
pupil_still_reader pupil_read_radiance;
pupil_still_reader pupil_read_pfm;
pupil_still_reader pupil_read_png;

/* Reads a file into memory and by its first bytes (not by its name) into pixels; the sentence begins with the path. */
int pupil_still_load(pupil_still *still, const char *path, char *why, size_t why_bytes);

#endif
