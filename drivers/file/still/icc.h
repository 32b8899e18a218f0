/* drivers/file/still/icc.h: the ICC profile of a JPEG, TIFF, WebP or PNG: a display profile (ICC.1:2010), with three
 * primaries and a curve for each. Profiles with tables (of printers), of grey and of CMYK are ignored, and so are
 * profiles in several JPEG segments, as only those large ones are.
 */
#ifndef PUPIL_DRIVERS_FILE_STILL_ICC_H
#define PUPIL_DRIVERS_FILE_STILL_ICC_H

#include "still_private.h"

/* Converts linear RGB pixels, which were decoded with the sRGB curve as Rec.709, by the profile in the file's bytes.
 * Does nothing where there is none, or sRGB's. 0; -1 and a sentence: no memory. */
int pupil_icc_apply(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_why *why);

/* The same with the profile itself (PNG's is compressed). 1: it is not sRGB's, and the pixels were converted; 0:
 * nothing to do, or a profile that is ignored; -1 and a sentence: no memory. Without pixels it only answers. */
int pupil_icc_apply_profile(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_why *why);

#endif
