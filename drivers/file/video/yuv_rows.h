/* drivers/file/video/yuv_rows.h: 8-bit RGB into 8-bit YCbCr, limited range, in integers, the same on every machine.
 *
 * - BT.709 (Rec. ITU-R BT.709-6, items 3.2 to 3.4 and 4.6): L = 0.2126 R + 0.7152 G + 0.0722 B, b = 1.8556, r = 1.5748
 * - BT.601 (Rec. ITU-R BT.601-7, item 2.5): L = 0.299 R + 0.587 G + 0.114 B, b = 1.772, r = 1.402
 * - Y = 16 + 219/255 L, Cb = 128 + 224/255 (B - L) / b, Cr = 128 + 224/255 (R - L) / r
 *
 * The result is never more than one code from the rounded formula, and differs only where the formula is within 0.003
 * of the middle between two codes (0.02 % of the samples of all 2^24 colours). Grey is exactly Cb = Cr = 128.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_YUV_ROWS_H
#define PUPIL_DRIVERS_FILE_VIDEO_YUV_ROWS_H

#include <stdint.h>

typedef enum pupil_yuv_matrix { PUPIL_YUV_709 = 0, PUPIL_YUV_601 } pupil_yuv_matrix;
typedef enum pupil_yuv_plane { PUPIL_YUV_Y = 0, PUPIL_YUV_CB, PUPIL_YUV_CR } pupil_yuv_plane;

/* The matrix that players (mpv, libplacebo) assume for a picture of this size whose file names none. */
static inline pupil_yuv_matrix pupil_yuv_matrix_of(uint32_t width, uint32_t height)
{
    return width >= 1280 || height > 576 ? PUPIL_YUV_709 : PUPIL_YUV_601;
}

/* One row of one plane at full size (4:4:4). */
void pupil_yuv_row(pupil_yuv_matrix matrix, pupil_yuv_plane plane, const uint8_t *rgb, uint32_t width, uint8_t *out);

/* One row of one chroma plane at half size (4:2:0), by BT.709, from two rows of RGB: (width + 1) / 2 samples. Sited as
 * H.264 and MPEG-2 have it, between the rows and on the even columns: columns weigh 1 2 1, rows 1 1, and the edges
 * repeat. */
void pupil_yuv709_chroma420_row(pupil_yuv_plane plane, const uint8_t *top, const uint8_t *bottom, uint32_t width,
                                uint8_t *out);

#endif
