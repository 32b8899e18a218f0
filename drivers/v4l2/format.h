/* drivers/v4l2/format.h: V4L2's pixel formats as the library's, with what the driver says of their colour.
 *
 * Sources: the kernel's documentation of V4L2, "Image Formats" and "Colorspaces"; the defaults are those of
 * V4L2_MAP_COLORSPACE_DEFAULT and its sisters in <linux/videodev2.h>. Two liberties, both about grey: its range is full
 * and its light linear unless the driver names another quantization or transfer function. The defaults, limited and
 * sRGB, are those of a picture's luma, and drivers of sensors leave the fields empty. And one about JPEG: it is as in
 * JFIF (BT.601 of full range) unless the driver names another; its colour space is ignored.
 *
 * V4L2_XFER_FUNC_SMPTE2084 is PUPIL_LIGHT_PQ. V4L2 has no number for HLG: a driver that captures it names another
 * function, which is then used. */
#ifndef PUPIL_DRIVERS_V4L2_FORMAT_H
#define PUPIL_DRIVERS_V4L2_FORMAT_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

struct v4l2_format; /* <linux/videodev2.h> */

/* Memory areas of a frame: one, or one for each plane. */
#define PUPIL_V4L2_MOST_AREAS 3

/* What a frame looks like in its buffer, or, with NM12, YM12 and their like, in its two or three. */
typedef struct pupil_v4l2_format {
    uint32_t fourcc;
    uint32_t pixel;                               /* a pupil_pixel; of a JPEG NONE: each frame has its own */
    uint32_t compressed;                          /* 1: frames are JPEGs, of any number of bytes */
    uint32_t width, height;                       /* pixels */
    uint32_t buffers;                             /* memory areas of a frame */
    uint32_t cr_first;                            /* 1: of three planes the second one is Cr (YV12) */
    uint32_t stride_bytes[PUPIL_V4L2_MOST_AREAS]; /* of each plane */
    uint32_t plane_bytes[PUPIL_V4L2_MOST_AREAS];  /* where each plane begins in its area */
    uint32_t size_bytes[PUPIL_V4L2_MOST_AREAS];   /* of each area, as the driver says */
    uint32_t needs_bytes[PUPIL_V4L2_MOST_AREAS];  /* of each area up to the last pixel: a frame of fewer is cut short */
    uint32_t primaries;                           /* a pupil_primaries, BT.709 or BT.2020, for pupil_config */
    pupil_coding coding;
    uint32_t colorspace, ycbcr_enc, quantization, xfer_func; /* V4L2's, without any DEFAULT */
} pupil_v4l2_format;

/* The pupil_pixel of a V4L2 format; PUPIL_PIXEL_NONE: not read natively. */
uint32_t pupil_v4l2_pixel_of(uint32_t fourcc);
/* Of a mosaic, a pupil_bayer; else 0. */
uint32_t pupil_v4l2_bayer_of(uint32_t fourcc);
/* 1: read natively, or a JPEG. */
int pupil_v4l2_is_read(uint32_t fourcc);

/* "RG10" and so on; where bits beyond the four letters say big-endian, "-BE" behind it. */
typedef struct pupil_v4l2_name {
    char text[12];
} pupil_v4l2_name;
pupil_v4l2_name pupil_v4l2_fourcc_name(uint32_t fourcc);

/* The fourcc of a name of four letters (fewer: blanks are added); 0: no such. */
uint32_t pupil_v4l2_fourcc(const char *name);

/* Every format that is read, for sentences. */
extern const char pupil_v4l2_natives[];

/* From a driver's answer to VIDIOC_G_FMT or VIDIOC_S_FMT, of either buffer type. 0, or -1 and a sentence without its
 * subject that says what is not handled and what would be. */
int pupil_v4l2_format_read(const struct v4l2_format *answer, pupil_v4l2_format *format, pupil_why *why);

#endif
