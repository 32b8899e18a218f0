/* drivers/file/video/video_pixels.h: one decoded video frame as an image for the library: SDR as exact linear Rec.709
 * float, and PQ and HLG of primaries other than BT.709 and BT.2020 (P3) likewise; PQ and HLG of these two as Y'CbCr
 * 4:4:4 (video_codes.h).
 *
 * swscale is not used on purpose. Its YUV to 16-bit RGB maps white to 65283 of 65535 (0.4 % short, 0.9 % of light), but
 * RGB sources to 65535. So the same grey would depend on its pixel format. Here every sample is read as it is, chroma
 * is interpolated linearly at its true position, and the matrix is the standard's.
 *
 * The library reads 4:2:0, but does not get it from here, because it gives the four pixels of a block the same Cb and
 * Cr. For a colourful photograph as HDR10, 32 % of the samples would then differ by more than a code, and the level by
 * 0.0014 EV (drivers.file.video_hdr10). Without chroma both are the same to a code.
 *
 * Defaults of an untagged frame: the matrix is BT.2020 where the transfer is PQ or HLG or the primaries are BT.2020,
 * else BT.709 from 1280 columns or 577 rows on and BT.601 below, as players do. Primaries: BT.2020 with PQ, HLG or the
 * BT.2020 matrix, else BT.709. Range: limited for YUV, full for grey and for the old "yuvj" formats; RGB is always full
 * range. Chroma: co-sited with the left luma sample. Signals outside 0..1 are clamped before the transfer curve, light
 * is not: SDR colours outside Rec.709 come out negative.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_PIXELS_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_PIXELS_H

#include <stddef.h>
#include <stdint.h>

#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>

#include "pupil/config.h"
#include "pupil/error.h"
#include "pupil/image.h"
#include "video_light.h"

/* Everything of a frame on which the tables below depend. */
typedef struct pupil_video_kind {
    int width, height, format, space, range, transfer, primaries, chroma;
} pupil_video_kind;

/* libav's tags, with defaults for those that a frame lacks. */
typedef struct pupil_video_tags {
    int space, transfer, primaries, is_full;
} pupil_video_tags;

typedef struct pupil_video_pixels {
    pupil_video_kind kind;   /* of the tables; all zero before the first frame */
    pupil_image_const image; /* the result */
    uint32_t primaries;      /* its, a pupil_primaries */
    float code_light;        /* its, as in pupil_frame */
    const AVPixFmtDescriptor *format;
    int is_rgb, is_grey, is_coded, has_709_primaries;
    uint16_t *codes;          /* one row as stored */
    uint32_t *chroma_left;    /* for each x the chroma sample at or left of it, and the weight of the next one */
    uint32_t *chroma_eighths; /* in eighths */
    /* PQ and HLG */
    uint16_t *planes;       /* Y', Cb and Cr, width x height each */
    pupil_coding coding;    /* of the result */
    uint32_t *wide_rows[3]; /* rows of chroma in 8ths and 64ths of a code, or of R, G and B */
    float to_16[2][2];      /* of luma and chroma: from 64ths of a code to one of 16 bits and a half, factor and sum */
    /* SDR, and PQ and HLG of other primaries */
    float *pixels;            /* width x height x 3 */
    float *rows[3];           /* one row, in units of the light table's entries: luma and two chroma, or R, G and B */
    float *chroma_rows[2];    /* two rows of chroma, to interpolate between */
    float offset[3], gain[3]; /* unit = (code - offset) * gain */
    float red_v, green_u, green_v, blue_u; /* the matrix */
    float to_709[3][3];
    float light[PUPIL_LIGHT_CODES];
} pupil_video_pixels;

/* Converts the frame into pixels->image. When the kind of frame changes, memory is allocated and tables are made. 0, or
 * -1 and a sentence without a file name; the object stays usable. */
int pupil_video_pixels_convert(pupil_video_pixels *pixels, const AVFrame *frame, pupil_why *why);

void pupil_video_pixels_free(pupil_video_pixels *pixels);

/* The primaries, a pupil_primaries, of the images of frames with these tags (libav's). */
uint32_t pupil_video_primaries(int transfer, int primaries, int space);

#endif
