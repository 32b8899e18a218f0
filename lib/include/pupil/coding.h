/* pupil/coding.h: what the samples of a camera's formats mean.
 *
 * Float, half and RGB formats need none of this. A frame of Y'CbCr, of grey or of a sensor's mosaic is described by a
 * pupil_coding; all zero (or none at all) stands for the usual case, which each field names.
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
    PUPIL_RANGE_LIMITED = 0, /* Y' 16..235, Cb and Cr 16..240 */
    PUPIL_RANGE_FULL,        /* 0..255: JPEG, and what is decoded from it */
    PUPIL_RANGE_COUNT
} pupil_range;

/* How a coded value from 0 to 1 stands for light. */
typedef enum pupil_light {
    PUPIL_LIGHT_USUAL = 0, /* Y'CbCr: sRGB; grey and mosaics: linear */
    PUPIL_LIGHT_LINEAR,
    PUPIL_LIGHT_SRGB,  /* IEC 61966-2-1 */
    PUPIL_LIGHT_BT709, /* inverse of the camera's curve of Rec. ITU-R BT.709-6, item 1.2 */
    PUPIL_LIGHT_COUNT
} pupil_light;

/* The colours of the first two pixels of a mosaic's first row, then of its second: SRGGB ... in V4L2's names. A frame
 * that is cropped or flipped begins with another one. */
typedef enum pupil_bayer {
    PUPIL_BAYER_RGGB = 0,
    PUPIL_BAYER_GRBG,
    PUPIL_BAYER_GBRG,
    PUPIL_BAYER_BGGR,
    PUPIL_BAYER_COUNT
} pupil_bayer;

/* Y'CbCr: R'G'B' beyond 0..1 is clamped; light is interpolated between the 256 codes' own, within 7e-6 of the curve.
 * Grey: (code - black) / (white - black); with a curve clamped to 0..1 and interpolated as Y'CbCr is. Mosaics: the
 * same, then the balance; no channel is let above the value at which the least amplified channel is full, so that what
 * is full in the sensor is white and not magenta; then the matrix. Linear light below black is negative, as the noise
 * of a dark sensor is, and light above white is above 1 in grey.
 * What a field is for: matrix and range for Y'CbCr, also that of an output; light for that of an input and for
 * grey; bayer, balance and rgb_from_camera for mosaics; shift, black and white for grey and mosaics. */
typedef struct pupil_coding {
    uint32_t size_bytes; /* abi.h; or 0 */
    uint32_t matrix;     /* a pupil_matrix */
    uint32_t range;      /* a pupil_range */
    uint32_t light;      /* a pupil_light; mosaics: usual or linear */
    uint32_t bayer;      /* a pupil_bayer */
    uint32_t shift;      /* formats of 10, 12 or 14 bits in 16-bit words: bits below the sample, 0..16 - bits. 0: the
                          * sample is in the lower bits; what lies above it counts too */
    float black;      /* code of no light, after the shift; white or 2^bits - 1 is at least 1 above it; 0. Few sensors
                       * have 0: the driver or the data sheet has the level, at which all that is dark would be grey */
    float white;      /* code of the largest light, after the shift, up to 65535; 0: 2^bits - 1 */
    float balance[3]; /* white balance: factors of R, G, B, 2^-10..2^10; all 0: 1, 1, 1 */
    float rgb_from_camera[9]; /* row by row, -16..16; from the balanced camera's RGB to that of config.primaries; all 0:
                               * none. A mosaic is metered before it, with the luminance that it leads to. */
} pupil_coding;

/* Whether images of the format `pixel` (a pupil_pixel, image.h) can have this coding; fields that the format has no use
 * for must be in their range all the same. PUPIL_OK, or PUPIL_ERR_CODING and, where `why` is not NULL, a sentence in
 * *why (constant text) that names the first wrong field and what would be right. */
PUPIL_API int pupil_coding_check(const pupil_coding *coding, uint32_t pixel, const char **why);

#ifdef __cplusplus
}
#endif

#endif
