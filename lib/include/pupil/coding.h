/* pupil/coding.h: what the samples of a camera's formats mean.
 *
 * Float, half and RGB formats need none of this. A pupil_coding describes a frame of Y'CbCr, of grey or of a sensor's
 * mosaic. All zero, or no coding at all, means the usual case, which each field names.
 *
 * Threads: plain values.
 */
#ifndef PUPIL_CODING_H
#define PUPIL_CODING_H

#include <stdint.h>

#include "pupil/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* From Y'CbCr to R'G'B': Kr and Kb of the standard. V4L2: V4L2_YCBCR_ENC_601, _709 and _BT2020. */
typedef enum pupil_matrix {
    PUPIL_MATRIX_BT601 = 0, /* Kr 0.299, Kb 0.114 (Rec. ITU-R BT.601-7, item 2.5.1): webcams, JPEG */
    PUPIL_MATRIX_BT709,     /* Kr 0.2126, Kb 0.0722 (Rec. ITU-R BT.709-6, item 3.2): HD */
    PUPIL_MATRIX_BT2020,    /* Kr 0.2627, Kb 0.0593 (Rec. ITU-R BT.2020-2, table 4, not constant luminance) */
    PUPIL_MATRIX_COUNT
} pupil_matrix;

/* V4L2: V4L2_QUANTIZATION_LIM_RANGE and _FULL_RANGE. */
typedef enum pupil_range {
    PUPIL_RANGE_LIMITED = 0, /* Y' 16..235, Cb and Cr 16..240; in 10 bits 4 times, in 16 bits 256 times that */
    PUPIL_RANGE_FULL,        /* 0..255: JPEG, and frames decoded from it; in 10 bits 0..1023, in 16 bits 0..65535 */
    PUPIL_RANGE_COUNT
} pupil_range;

/* How a coded value from 0 to 1 represents light. */
typedef enum pupil_light {
    PUPIL_LIGHT_DEFAULT = 0, /* Y'CbCr and RGB10A2: sRGB; grey and mosaics: linear */
    PUPIL_LIGHT_LINEAR,
    PUPIL_LIGHT_SRGB,  /* IEC 61966-2-1 */
    PUPIL_LIGHT_BT709, /* inverse of the camera's curve of Rec. ITU-R BT.709-6, item 1.2 */
    PUPIL_LIGHT_PQ,  /* SMPTE ST 2084 as in Rec. ITU-R BT.2100-2, table 4: display light; 1.0 is 100 cd/m2, the largest
                      * code 100.0 */
    PUPIL_LIGHT_HLG, /* Rec. ITU-R BT.2100-2, table 5: scene light from 0 to 1 */
    PUPIL_LIGHT_COUNT
} pupil_light;

/* The colours of the first two pixels of a mosaic's first row, then of its second: SRGGB ... in V4L2's names. A cropped
 * or flipped frame begins with another colour. */
typedef enum pupil_bayer {
    PUPIL_BAYER_RGGB = 0,
    PUPIL_BAYER_GRBG,
    PUPIL_BAYER_GBRG,
    PUPIL_BAYER_BGGR,
    PUPIL_BAYER_COUNT
} pupil_bayer;

/* The largest number of knees of a companding sensor. */
#define PUPIL_KNEES 8

/* How samples become light:
 *
 * - Y'CbCr and RGB10A2: R'G'B' is clamped to 0..1. Light is interpolated between that of the 256 codes, within 7e-6 of
 *   the curve (BT.709: 3.6e-5 at 0.081, where the standard's curve itself has a step of 5.5e-5). PQ is interpolated
 *   between 4093 and HLG between 2047 points, with a relative error of at most 7e-5 (PQ) and 3.3e-4 (HLG) for light of
 *   at least 2^-14, and without an error in the mean.
 * - Grey: (code - black) / (white - black). With a curve it is clamped to 0..1 and interpolated as Y'CbCr.
 * - Mosaics: as grey, then the balance, then the matrix. After the balance every channel is clamped to the value at
 *   which the least amplified channel saturates, so clipped highlights are white and not magenta.
 * - Grey and mosaics of a companding sensor (knees above 0), which squeezes the light of 16 to 24 bits into codes of 10
 *   to 16: instead of (code - black) / (white - black), light follows straight lines from (black, 0) through the knees
 *   to (white, 1), for each sample before any interpolation. The first line continues below black, the last one above
 *   white. So sensors that merge several exposures into one companded frame, as those of car cameras do, can be read.
 *   Sensors that send the exposures line by line or frame by frame (line-interleaved, staggered or DOL HDR) are not
 *   supported: their rows differ in exposure, and nothing here merges them.
 *
 * Linear light below black is negative, as the noise of a dark sensor is. Grey codes above white are light above 1.
 *
 * Fields by format:
 *
 * - Y'CbCr: matrix and range, also of an output; light, of an input.
 * - RGB10A2: light.
 * - Grey: light, shift, black, white and knees; light default or linear where there are knees.
 * - Mosaics: bayer, balance, rgb_from_camera, shift, black, white and knees; light default or linear. */
typedef struct pupil_coding {
    uint32_t size_bytes; /* abi.h; or 0 */
    uint32_t matrix;     /* a pupil_matrix */
    uint32_t range;      /* a pupil_range */
    uint32_t light;      /* a pupil_light; mosaics: default or linear */
    uint32_t bayer;      /* a pupil_bayer */
    uint32_t shift;      /* formats of 10, 12 or 14 bits in 16-bit words: bits below the sample, 0..16 - bits. 0: the
                          * sample is in the lower bits; bits above it count too */
    float black;      /* code of no light, after the shift; white or 2^bits - 1 is at least 1 above it; 0. Few sensors
                       * have 0; the driver or the data sheet has the level. With a wrong 0, black becomes grey */
    float white;      /* code of the largest light, after the shift, up to 65535; 0: 2^bits - 1 */
    float balance[3]; /* white balance: factors of R, G, B, 2^-10..2^10; all 0: 1, 1, 1 */
    float rgb_from_camera[9]; /* row by row, -16..16; from the balanced camera's RGB to that of config.primaries; all 0:
                               * none. A mosaic is metered before the matrix, with weights that give the luminance after
                               * it. */
    uint32_t knees;           /* how many of the following are used, 0..PUPIL_KNEES; 0: linear from black to white */
    float knee_code[PUPIL_KNEES];  /* codes after the shift, each at least 1 above the one before; the first at least 1
                                    * above black, the last at least 1 below white */
    float knee_light[PUPIL_KNEES]; /* their light, white being 1: above 2^-30, rising, below 1. Data sheets give linear
                                    * codes: divide them by that of white */
} pupil_coding;

/* Whether images of the format `pixel` (a pupil_pixel, image.h) can have this coding. Fields that the format does not
 * use must be in their range, too. PUPIL_OK or PUPIL_ERR_CODING. `why` may be NULL; else *why is a sentence (constant
 * text) that names the first wrong field and what would be right. */
PUPIL_API int pupil_coding_check(const pupil_coding *coding, uint32_t pixel, const char **why);

#ifdef __cplusplus
}
#endif

#endif
