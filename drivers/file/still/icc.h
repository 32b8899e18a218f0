/* drivers/file/still/icc.h: the ICC profile of a JPEG, TIFF, WebP or PNG: that of a display (ICC.1:2010), with three
 * primaries and a curve for each. Those of tables (of printers), of grey and of CMYK are left out, and so is one that
 * is cut into several segments of JPEG, which only such large ones are.
 */
#ifndef PUPIL_DRIVERS_FILE_STILL_ICC_H
#define PUPIL_DRIVERS_FILE_STILL_ICC_H

#include "still_private.h"

/* Linear RGB pixels that were decoded with the sRGB curve and taken for Rec.709 become what the profile in the file's
 * bytes says. Nothing where it has none, or sRGB's. 0; -1 and a sentence: no memory. */
int pupil_icc_apply(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_why *why);

/* The same with the profile itself (PNG's is compressed). 1: it is not sRGB's, and the pixels were converted; 0:
 * nothing to do, or a profile that is left out; -1 and a sentence: no memory. Without pixels it only answers. */
int pupil_icc_apply_profile(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_why *why);

#endif
