/* pupil/image.h: a picture in memory, and its metadata.
 *
 * Shapes: `height` rows of `width` pixels; the first row is the top one. `stride_bytes` is the distance from one row to
 * the next in bytes. It is negative for a picture stored bottom-up: `data` points at its top row, which is the last in
 * memory. Samples of one pixel are adjacent, in the order of the format's name, in the machine's byte order.
 * `data` and `stride_bytes` are multiples of the sample's size (4, 2 or 1 bytes); so are those of the other planes.
 *
 * Threads: these are plain values; the library keeps no pointer to them after a call returns.
 */
#ifndef PUPIL_IMAGE_H
#define PUPIL_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/coding.h"
#include "pupil/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest width and height, so that every sum in pupil_stats provably fits its integer. */
#define PUPIL_MAX_SIDE_PX 16384u

/* White: the light that a value of 1.0 represents. Levels and EV are relative to it where frames bring no exposure time
 * and gain.
 *
 * - 8-bit RGB, RGB10A2 and Y'CbCr, coded with sRGB or BT.709: the code of white (255, 1023; Y' 235 or 940 in limited
 *   range). Nothing is brighter.
 * - PQ: 100 cd/m2. The largest code is 100.0, which is 10000 cd/m2.
 * - HLG: the scene light of the largest code. Reference white, a signal of 75 %, is 0.265.
 * - RGB of 16 bits: code 65535.
 * - Grey and mosaics: coding.white, usually the sensor's clipping. A mosaic's balance and matrix come after it.
 * - Float and half: the frame's own unit. Renderers and EXR files usually have diffuse white at 1, with light above it.
 * - Outputs: the brightest light that the display shows. Float and half outputs are linear display light from 0 to 1,
 *   before config.transfer, which is for 8 bits. Applied to the floats, it gives the 8-bit output's codes; from halves,
 *   which are rounded, a code may be one off. There is no output of 10 bits, PQ or HLG.
 *
 * Pixel formats. "linear": the sample is proportional to light. "sRGB": coded with the curve of IEC 61966-2-1.
 * Integer samples represent 0..1: code / (2^bits - 1), unless the image's coding says otherwise. Alpha is never light:
 * it is not metered. It is copied to outputs that have it: rounded, clamped to 0..1, NaN to 0, and 1 for inputs without
 * alpha. Names in parentheses are those of V4L2. */
typedef enum pupil_pixel {
    PUPIL_PIXEL_NONE = 0,
    PUPIL_PIXEL_RGBA32F, /* in and out: 4 x IEEE binary32, linear */
    PUPIL_PIXEL_RGB32F,  /* in and out: 3 x IEEE binary32, linear */
    PUPIL_PIXEL_RGBA16F, /* in and out: 4 x IEEE binary16, linear */
    PUPIL_PIXEL_RGBA16,  /* in: 4 x unsigned 16 bit, linear */
    PUPIL_PIXEL_RGB16,   /* in: 3 x unsigned 16 bit, linear */
    PUPIL_PIXEL_RGBA8,   /* in: 4 x unsigned 8 bit, sRGB; out: in the configured transfer */
    PUPIL_PIXEL_RGB8,    /* in: 3 x unsigned 8 bit, sRGB; out: in the configured transfer */
    PUPIL_PIXEL_BGRX8,   /* in: blue, green, red and a byte that is ignored, sRGB; out: 255 there (XR24, DRM XRGB8888,
                          * the usual frame buffer) */

    PUPIL_PIXEL_YUYV,   /* in: two pixels in Y' Cb Y' Cr (YUYV). An odd width's last pixel has 4 bytes, too */
    PUPIL_PIXEL_NV12,   /* in and out: Y' in `data`; Cb Cr of each 2 x 2 pixels in `chroma` (NV12, NM12). If both
                         * planes are in one buffer, as in V4L2's NV12, chroma is data + height * stride and has the
                         * same stride. Odd sizes: the last column's and row's Cb Cr have bytes of their own */
    PUPIL_PIXEL_GREY8,  /* in: 8 bit (GREY) */
    PUPIL_PIXEL_GREY10, /* in: 10 bit in 16-bit words (Y10) */
    PUPIL_PIXEL_GREY12, /* in: 12 bit in 16-bit words (Y12) */
    PUPIL_PIXEL_GREY16, /* in: 16 bit (Y16) */

    /* Mosaics: one colour a pixel, in the order that the coding names. Width and height are even. */
    PUPIL_PIXEL_BAYER8,   /* in: 8 bit (RGGB ...) */
    PUPIL_PIXEL_BAYER10,  /* in: 10 bit in 16-bit words (RG10 ...) */
    PUPIL_PIXEL_BAYER12,  /* in: 12 bit in 16-bit words (RG12 ...) */
    PUPIL_PIXEL_BAYER14,  /* in: 14 bit in 16-bit words (RG14 ...) */
    PUPIL_PIXEL_BAYER16,  /* in: 16 bit (RG16 ...) */
    PUPIL_PIXEL_BAYER10P, /* in: 4 pixels in 5 bytes, the lowest bits in the last (MIPI CSI-2 RAW10; pRAA ...); the
                           * width is a multiple of 4 */
    PUPIL_PIXEL_BAYER12P, /* in: 2 pixels in 3 bytes, the lowest bits in the last (MIPI CSI-2 RAW12; pRCC ...) */

    PUPIL_PIXEL_I420,  /* in and out: Y' in `data`; Cb of each 2 x 2 pixels in `chroma`, Cr in `cr` (YU12). YV12 is the
                        * same with the pointers exchanged. Odd sizes as NV12 */
    PUPIL_PIXEL_NV21,  /* in: as NV12, with Cr before Cb (NV21) */
    PUPIL_PIXEL_NV16,  /* in: as NV12, with a row of Cb Cr for each row of Y' (NV16); rows do not come in pairs */
    PUPIL_PIXEL_UYVY,  /* in: two pixels in Cb Y' Cr Y' (UYVY); odd widths as YUYV */
    PUPIL_PIXEL_BGR8,  /* in: 3 x unsigned 8 bit, blue first, sRGB; out: in the configured transfer (BGR3; OpenCV) */
    PUPIL_PIXEL_RGBX8, /* in: as RGBA8, and the fourth byte is ignored (XB24) */

    PUPIL_PIXEL_GREY10P, /* in: 4 pixels in 5 bytes as BAYER10P (Y10P); any width, and whole groups of 5 bytes */
    PUPIL_PIXEL_GREY12P, /* in: 2 pixels in 3 bytes as BAYER12P (Y12P); any width, and whole groups of 3 bytes */
    PUPIL_PIXEL_BGR32F,  /* in and out: 3 x IEEE binary32, blue first, linear (OpenCV) */
    PUPIL_PIXEL_RGB16F,  /* in and out: 3 x IEEE binary16, linear */

    PUPIL_PIXEL_P010,    /* in: NV12 of 10 bits, in the upper ones of 16-bit words; the lower ones are ignored (P010) */
    PUPIL_PIXEL_I420_10, /* in: I420 of 10 bits, in the lower ones of 16-bit words, the upper ones 0 (yuv420p10,
                          * I420_10LE) */
    PUPIL_PIXEL_RGB10A2, /* in: a 32-bit word, red in the lowest 10 bits, then green, blue, and 2 bits of alpha; sRGB
                          * unless the coding says otherwise (DRM ABGR2101010, GL_RGB10_A2) */
    PUPIL_PIXEL_I444_16, /* in: Y' in `data`, Cb in `chroma`, Cr in `cr`, of every pixel, in 16-bit words (yuv444p16,
                          * Y444_16LE). No V4L2 name */
    PUPIL_PIXEL_COUNT
} pupil_pixel;

/* A mosaic is metered at half its size, by quads of 2 x 2 pixels: red, the mean of both greens, blue. The statistics
 * count quads as pixels. It is mapped to a picture of its own size by bilinear interpolation. To an `out` of half its
 * width and height it is mapped quad by quad.
 *
 * Rows of 4:2:0 (NV12, NV21, I420, P010, I420_10) and of mosaics come in pairs. A group of rows begins at an even row,
 * and has an odd number of rows only at the end of a 4:2:0 frame. When a mosaic is mapped to NV12 or I420 of half its
 * size, rows come in fours, which are a pair there.
 *
 * To interpolate a mosaic, the rows next to the group are read too, if rows_above and rows_below are not 0. Where they
 * are 0, at the frame's edges, the picture is mirrored. pupil_image_rows sets both. */
typedef struct pupil_image {
    uint32_t size_bytes;           /* abi.h; or 0 */
    uint32_t pixel;                /* a pupil_pixel */
    void *data;                    /* the top row */
    ptrdiff_t stride_bytes;        /* from one row to the next; may be negative */
    uint32_t width;                /* pixels, 1..PUPIL_MAX_SIDE_PX */
    uint32_t height;               /* rows, 1..PUPIL_MAX_SIDE_PX */
    void *chroma;                  /* NV12, NV21, NV16, P010: the top row of Cb and Cr; I420, I420_10, I444_16: of Cb */
    ptrdiff_t chroma_stride_bytes; /* may be negative; pupil_chroma_row_bytes is its least */
    void *cr;                      /* I420, I420_10, I444_16: the top row of Cr */
    ptrdiff_t cr_stride_bytes;     /* as chroma_stride_bytes */
    const pupil_coding *coding;    /* NULL: all zero. Outputs NV12 and I420 use its matrix and range */
} pupil_image;

typedef struct pupil_image_const {
    uint32_t size_bytes;
    uint32_t pixel;
    const void *data;
    ptrdiff_t stride_bytes;
    uint32_t width;
    uint32_t height;
    const void *chroma;
    ptrdiff_t chroma_stride_bytes;
    const void *cr;
    ptrdiff_t cr_stride_bytes;
    const pupil_coding *coding;
    uint32_t rows_above; /* mosaics: rows of the same picture in memory before the first, and after the last row */
    uint32_t rows_below;
} pupil_image_const;

/* Metadata of a frame. All zero means: nothing is known. */
typedef struct pupil_frame_info {
    uint32_t size_bytes;  /* abi.h; or 0 */
    uint32_t reserved;    /* 0 */
    int64_t timestamp_ns; /* the middle of the exposure, in ns of a monotonic clock. dt is the difference of two
                           * frames' timestamps; going back counts as dt = 0. Two frames in a row with timestamp 0
                           * count as frames without timestamps, config.nominal_frame_s apart. */
    uint64_t sequence;    /* the driver's frame number; sensor.h counts lost frames by it */
    double exposure_s;    /* exposure time in seconds; unknown if 0 or not from 2^-64 to 2^64 */
    double gain;          /* total gain, 1 = none; unknown if 0 or not from 2^-64 to 2^64 */
} pupil_frame_info;

/* Bytes of one pixel in `data` (16 for RGBA32F ... 1 for NV12); 0 for anything that is no pupil_pixel, and for packed
 * samples, which are no whole number of bytes. */
PUPIL_API size_t pupil_pixel_bytes(uint32_t pixel);

/* Bytes of a row in `data`; 0 for anything that is no pupil_pixel. */
PUPIL_API size_t pupil_row_bytes(uint32_t pixel, uint32_t width);

/* Planes of a format: 1; 2 with `chroma`; 3 with `chroma` and `cr`. 0 for anything that is no pupil_pixel. */
PUPIL_API uint32_t pupil_pixel_planes(uint32_t pixel);

/* Bytes of a row in `chroma` and in `cr`, and the number of their rows; 0 for formats without these planes. */
PUPIL_API size_t pupil_chroma_row_bytes(uint32_t pixel, uint32_t width);
PUPIL_API uint32_t pupil_chroma_rows(uint32_t pixel, uint32_t height);

/* Bits of a sample of a grey format or a mosaic, 8 to 16; 0 for all others. */
PUPIL_API uint32_t pupil_pixel_bits(uint32_t pixel);

/* 1 for a mosaic, 0 for all others. */
PUPIL_API int pupil_pixel_is_mosaic(uint32_t pixel);

/* The row of `chroma` and `cr` for an image's row. */
static inline ptrdiff_t pupil_chroma_row_of(uint32_t pixel, uint32_t row)
{
    return (ptrdiff_t)(pixel == PUPIL_PIXEL_NV16 || pixel == PUPIL_PIXEL_I444_16 ? row : row / 2);
}

/* The rows [first_row, first_row + rows) of an image, as an image. The caller keeps them inside the image. */
static inline pupil_image_const pupil_image_rows(pupil_image_const image, uint32_t first_row, uint32_t rows)
{
    const ptrdiff_t chroma_row = pupil_chroma_row_of(image.pixel, first_row);
    image.rows_above += first_row;
    image.rows_below += image.height - first_row - rows;
    image.data = (const unsigned char *)image.data + (ptrdiff_t)first_row * image.stride_bytes;
    if (image.chroma)
        image.chroma = (const unsigned char *)image.chroma + chroma_row * image.chroma_stride_bytes;
    if (image.cr)
        image.cr = (const unsigned char *)image.cr + chroma_row * image.cr_stride_bytes;
    image.height = rows;
    return image;
}

/* The same for an output. */
static inline pupil_image pupil_image_out_rows(pupil_image image, uint32_t first_row, uint32_t rows)
{
    const ptrdiff_t chroma_row = pupil_chroma_row_of(image.pixel, first_row);
    image.data = (unsigned char *)image.data + (ptrdiff_t)first_row * image.stride_bytes;
    if (image.chroma)
        image.chroma = (unsigned char *)image.chroma + chroma_row * image.chroma_stride_bytes;
    if (image.cr)
        image.cr = (unsigned char *)image.cr + chroma_row * image.cr_stride_bytes;
    image.height = rows;
    return image;
}

static inline pupil_image_const pupil_image_as_const(pupil_image image)
{
    pupil_image_const c;
    c.size_bytes = sizeof c;
    c.data = image.data;
    c.stride_bytes = image.stride_bytes;
    c.width = image.width;
    c.height = image.height;
    c.pixel = image.pixel;
    c.chroma = image.chroma;
    c.chroma_stride_bytes = image.chroma_stride_bytes;
    c.coding = image.coding;
    c.rows_above = 0;
    c.rows_below = 0;
    c.cr = image.cr;
    c.cr_stride_bytes = image.cr_stride_bytes;
    return c;
}

/* --- a picture without padding --- */

/* Its bytes: rows without a gap, and the planes one after another, as decoders and pipes write them. */
static inline size_t pupil_image_bytes(uint32_t pixel, uint32_t width, uint32_t height)
{
    const size_t chroma = pupil_chroma_row_bytes(pixel, width) * pupil_chroma_rows(pixel, height);
    return pupil_row_bytes(pixel, width) * height + (pupil_pixel_planes(pixel) == 3 ? 2 * chroma : chroma);
}

/* Such a picture at `data`. Set what differs (padded rows, planes elsewhere, a coding) afterwards. */
static inline pupil_image pupil_image_of(void *data, uint32_t width, uint32_t height, uint32_t pixel)
{
    const size_t row = pupil_row_bytes(pixel, width), chroma_row = pupil_chroma_row_bytes(pixel, width);
    const uint32_t planes = data ? pupil_pixel_planes(pixel) : 0;
    unsigned char *const top = (unsigned char *)data;
    pupil_image image;
    image.size_bytes = sizeof image;
    image.pixel = pixel;
    image.data = data;
    image.stride_bytes = (ptrdiff_t)row;
    image.width = width;
    image.height = height;
    image.chroma = planes > 1 ? top + row * height : NULL;
    image.chroma_stride_bytes = (ptrdiff_t)chroma_row;
    image.cr = planes > 2 ? top + row * height + chroma_row * pupil_chroma_rows(pixel, height) : NULL;
    image.cr_stride_bytes = planes > 2 ? (ptrdiff_t)chroma_row : 0;
    image.coding = NULL;
    return image;
}

static inline pupil_image_const pupil_image_const_of(const void *data, uint32_t width, uint32_t height, uint32_t pixel)
{
    return pupil_image_as_const(pupil_image_of((void *)(uintptr_t)data, width, height, pixel)); /* never written to */
}

#ifdef __cplusplus
}
#endif

#endif
