/* drivers/file/video/video_light.h: what a video's tags say about light: transfer curves and primaries, to linear
 * Rec.709. PQ and HLG of BT.709 and BT.2020 are the library's (video_codes.h).
 *
 * Tags are libav's, whose numbers are those of Rec. ITU-T H.273. A table's 1.0 is peak white, of PQ 100 cd/m2. BT.709,
 * BT.601, BT.2020 SDR, sRGB and untagged video all go through the inverse of the sRGB curve. Not BT.1886: pupil's
 * outputs are coded with the sRGB curve, and a well exposed clip that is passed through keeps its codes only if both
 * sides use one curve. Gamma 2.2, gamma 2.8 and linear video is decoded as tagged.
 *
 * Threads: pure functions.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_LIGHT_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_LIGHT_H

#include <libavutil/pixfmt.h>

#define PUPIL_LIGHT_CODES 65536 /* a table's entries: entry i is the light of the signal i / 65535 */

/* Fills the table. -1 for an unknown transfer (the table is untouched). */
int pupil_light_table(float table[PUPIL_LIGHT_CODES], enum AVColorTransferCharacteristic transfer);

/* Row by row, linear RGB of these primaries to linear Rec.709. White goes to white: grey stays grey, also for the
 * cinema primaries whose white is not D65. Unspecified primaries count as Rec.709. -1 for unknown primaries. */
int pupil_light_to_rec709(double matrix[9], enum AVColorPrimaries primaries);

/* The weights of red and blue in luma, from which every matrix of H.273 (table 4) of this kind is made; the
 * chromaticity-derived matrix has the weights of the primaries. -1 for a matrix that is not of this kind (constant
 * luminance, ICtCp, YCgCo) or unspecified. */
int pupil_light_luma(double *red, double *blue, enum AVColorSpace space, enum AVColorPrimaries primaries);

#endif
