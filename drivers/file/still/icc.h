/* drivers/file/still/icc.h: the ICC profile of a JPEG, TIFF, WebP or PNG: a display profile (ICC.1:2010), with three
 * primaries and a curve for each. Profiles with tables (of printers), of grey and of CMYK are ignored, and so are
 * profiles in several JPEG segments, as only those large ones are.
 */
#ifndef PUPIL_DRIVERS_FILE_STILL_ICC_H
#define PUPIL_DRIVERS_FILE_STILL_ICC_H

#include "still_private.h"

/* Corrects linear RGB pixels, which were decoded with the sRGB curve, by the curves of the profile in the file's bytes.
 * `colour` becomes that of its primaries, for pupil_still_colour_apply; all zero where there is no profile, or one that
 * is ignored: then nothing is done. 0; -1 and a sentence: no memory. Without pixels it only gives the colour. */
int pupil_icc_apply_curves(const uint8_t *bytes, size_t size, float *rgb, uint64_t pixels, pupil_still_colour *colour,
                           pupil_why *why);

/* Curves and primaries, by the profile itself (PNG's is compressed). 1: it is not sRGB's, and the pixels were
 * converted; 0: nothing to do, or a profile that is ignored; -1 and a sentence: no memory. Without pixels it only
 * answers. */
int pupil_icc_apply_profile(const uint8_t *profile, size_t size, float *rgb, uint64_t pixels, pupil_why *why);

#endif
