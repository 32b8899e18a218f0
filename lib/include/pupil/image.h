/* pupil/image.h: a picture in memory, and what is known of the moment it was taken.
 *
 * Shapes: `height` rows of `width` pixels; the first row is the top one. `stride_bytes` is the distance from one row to
 * the next in bytes and may be negative (a picture stored bottom-up: `data` points at its top row, which is the last in
 * memory). Samples of one pixel lie side by side in the order of the format's name, in the machine's byte order.
 * `data` and `stride_bytes` are multiples of the sample's size (4, 2 or 1 bytes).
 *
 * Threads: these are plain values; the library keeps no pointer to them after a call returns.
 */
#ifndef PUPIL_IMAGE_H
#define PUPIL_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest width and height, so that every sum in pupil_stats provably fits its integer. */
#define PUPIL_MAX_SIDE_PX 16384u

/* Pixel formats. "linear": the sample is proportional to light. "sRGB": coded with the curve of IEC 61966-2-1.
 * Integer samples stand for 0..1: code / (2^bits - 1). Alpha is never light: it is not metered, and is copied to
 * outputs that have it (rounded, clamped to 0..1, NaN to 0; outputs of inputs without alpha are opaque). */
typedef enum pupil_pixel {
    PUPIL_PIXEL_NONE = 0,
    PUPIL_PIXEL_RGBA32F, /* in: 4 x IEEE binary32, linear */
    PUPIL_PIXEL_RGB32F,  /* in: 3 x IEEE binary32, linear */
    PUPIL_PIXEL_RGBA16F, /* in: 4 x IEEE binary16, linear */
    PUPIL_PIXEL_RGBA16,  /* in: 4 x unsigned 16 bit, linear */
    PUPIL_PIXEL_RGB16,   /* in: 3 x unsigned 16 bit, linear */
    PUPIL_PIXEL_RGBA8,   /* in: 4 x unsigned 8 bit, sRGB; out: in the configured transfer */
    PUPIL_PIXEL_RGB8,    /* in: 3 x unsigned 8 bit, sRGB; out: in the configured transfer */
    PUPIL_PIXEL_BGRX8,   /* out only: blue, green, red, 255 (DRM XRGB8888, the usual frame buffer) */
    PUPIL_PIXEL_COUNT
} pupil_pixel;

typedef struct pupil_image {
    void *data;             /* the top row */
    ptrdiff_t stride_bytes; /* from one row to the next; may be negative */
    uint32_t width;         /* pixels, 1..PUPIL_MAX_SIDE_PX */
    uint32_t height;        /* rows, 1..PUPIL_MAX_SIDE_PX */
    uint32_t pixel;         /* a pupil_pixel */
} pupil_image;

typedef struct pupil_image_const {
    const void *data;
    ptrdiff_t stride_bytes;
    uint32_t width;
    uint32_t height;
    uint32_t pixel;
} pupil_image_const;

/* What is known of a frame beside its pixels. All zero means: nothing is known. */
typedef struct pupil_frame_info {
    int64_t timestamp_ns; /* the middle of the exposure, in ns of a monotonic clock. The library takes dt as the
                           * difference of two frames' timestamps; back in time counts as dt = 0. Two frames in a row
                           * stamped 0 are taken as unstamped and config.nominal_frame_s apart. */
    uint64_t sequence;    /* the driver's frame number; carried, not interpreted */
    double exposure_s;    /* exposure time in seconds; 0 where unknown */
    double gain;          /* total gain, 1 = none; 0 where unknown */
} pupil_frame_info;

/* Bytes of one pixel (16 for RGBA32F ... 3 for RGB8), 0 for anything that is no pupil_pixel. */
PUPIL_API size_t pupil_pixel_bytes(uint32_t pixel);

/* The rows [first_row, first_row + rows) of an image, as an image. The caller keeps them inside the image. */
static inline pupil_image_const pupil_image_rows(pupil_image_const image, uint32_t first_row, uint32_t rows)
{
    image.data = (const unsigned char *)image.data + (ptrdiff_t)first_row * image.stride_bytes;
    image.height = rows;
    return image;
}

static inline pupil_image_const pupil_image_as_const(pupil_image image)
{
    pupil_image_const c;
    c.data = image.data;
    c.stride_bytes = image.stride_bytes;
    c.width = image.width;
    c.height = image.height;
    c.pixel = image.pixel;
    return c;
}

#ifdef __cplusplus
}
#endif

#endif
