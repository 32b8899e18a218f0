/* drivers/file/video/video_pixels.h: one decoded video frame to linear Rec.709 float, exactly.
 *
 * swscale is not used on purpose. Its YUV to 16-bit RGB maps white to 65283 of 65535 (0.4 % short, 0.9 % of light), but
 * RGB sources to 65535. So the same grey would differ by its pixel format. Here every sample is read as it is, chroma
 * is interpolated linearly at its true position, and the matrix is the standard's.
 *
 * Nor is a frame handed to the library as the Y'CbCr that it is, although the library reads it: there the four pixels
 * of a 4:2:0 block share Cb and Cr. Of a colourful photograph as HDR10, 31 % of the samples then differ by more than a
 * code, and the level by 0.0014 EV (drivers.file.video_hdr10). Without chroma both are the same to a code.
 *
 * What an untagged frame is taken for: the matrix is BT.2020 where the transfer is PQ or HLG or the primaries are
 * BT.2020, else BT.709 from 720 rows on and BT.601 below, as players do. Primaries: BT.2020 with PQ, HLG or the BT.2020
 * matrix, else BT.709. Range: limited for YUV, full for grey and for the old "yuvj" formats; RGB is always full range.
 * Chroma: co-sited with the left luma sample. Signals outside 0..1 are clamped before the transfer curve, light is not:
 * BT.2020 colours outside Rec.709 come out negative.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_PIXELS_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_PIXELS_H

#include <stddef.h>
#include <stdint.h>

#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>

#include "pupil/error.h"
#include "pupil/image.h"
#include "video_light.h"

/* Everything of a frame on which the tables below depend. */
typedef struct pupil_video_kind {
    int width, height, format, space, range, transfer, primaries, chroma;
} pupil_video_kind;

typedef struct pupil_video_pixels {
    pupil_video_kind kind; /* of the tables; all zero before the first frame */
    const AVPixFmtDescriptor *format;
    int is_rgb, is_grey, has_709_primaries;
    float *pixels;         /* width x height x 3: the result */
    uint16_t *codes;       /* one row as stored */
    float *rows[3];        /* one row, in units of the light table's entries: luma and two chroma, or R, G and B */
    float *chroma_rows[2]; /* two rows of chroma, to interpolate between */
    uint32_t *chroma_left; /* for each x the chroma sample at or left of it, and the share of the next one */
    float *chroma_share;
    float offset[3], gain[3];              /* unit = (code - offset) * gain */
    float red_v, green_u, green_v, blue_u; /* the matrix */
    float to_709[3][3];
    float light[PUPIL_LIGHT_CODES];
} pupil_video_pixels;

/* Converts the frame into pixels->pixels (packed rows). Memory is taken and tables are made when the kind of frame
 * changes. 0, or -1 and a sentence without a file name; the object stays usable. */
int pupil_video_pixels_convert(pupil_video_pixels *pixels, const AVFrame *frame, pupil_why *why);

void pupil_video_pixels_free(pupil_video_pixels *pixels);

#endif
