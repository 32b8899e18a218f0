/* drivers/v4l2/output/output.h: display frames as the formats that video output nodes take.
 *
 * Chroma is the mean of the pixels that share it, as the kernel's "Image Formats" place it for YUYV and NV12: between
 * them. Of an odd width or height the last column or row represents both. Every sample is within one code of the
 * formulas of Rec. ITU-R BT.601-7, items 2.5.1 to 2.5.4, or BT.709-6, items 3.2 to 3.4 and 4.6, in 8 bits of limited or
 * full range; grey is exactly Cb = Cr = 128. */
#ifndef PUPIL_DRIVERS_V4L2_OUTPUT_OUTPUT_H
#define PUPIL_DRIVERS_V4L2_OUTPUT_OUTPUT_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"
#include "sink.h"
#include "v4l2/device.h"

struct v4l2_format; /* <linux/videodev2.h> */

typedef struct pupil_v4l2_output {
    uint32_t fourcc;        /* one of pupil_v4l2_outputs */
    uint32_t pixel;         /* its pupil_pixel */
    uint32_t width, height; /* pixels */
    uint32_t stride_bytes;  /* of the rows, which planes of chroma follow */
    uint32_t chroma_stride_bytes;
    uint32_t size_bytes;  /* as the driver says */
    uint32_t needs_bytes; /* up to the last pixel */
    uint32_t field;       /* V4L2's */
    uint8_t level[256];   /* of RGB's codes */
    int32_t factor[3][3]; /* of red, green and blue in Y', Cb and Cr */
    int32_t luma_offset;  /* the code of black */
} pupil_v4l2_output;

/* The formats that frames can be written in, the simplest first. */
#define PUPIL_V4L2_OUTPUTS 13
extern const uint32_t pupil_v4l2_outputs[PUPIL_V4L2_OUTPUTS];

/* 1: frames can be written in this format. */
int pupil_v4l2_is_written(uint32_t fourcc);
/* All of them, for sentences. */
extern const char pupil_v4l2_written[];

/* From a driver's answer to VIDIOC_S_FMT, of either output type. 0, or -1 and a sentence without its subject. */
int pupil_v4l2_output_read(const struct v4l2_format *answer, pupil_v4l2_output *output, pupil_why *why);

/* Gives the driver size, format, colour and rate of the frames that will come. 0, or -1 and a sentence. */
int pupil_v4l2_output_set(const pupil_v4l2_device *device, const pupil_sink_options *options, pupil_v4l2_output *output,
                          pupil_why *why);
/* "PATH: WHAT: what errno says, in the words of displays"; -1. */
int pupil_v4l2_output_failed(const pupil_v4l2_device *device, const char *what, int error, pupil_why *why);

/* rgb8 has the output's size; to: size_bytes, of which needs_bytes are written. */
void pupil_v4l2_output_fill(const pupil_v4l2_output *output, const pupil_image_const *rgb8, unsigned char *to);

#endif
