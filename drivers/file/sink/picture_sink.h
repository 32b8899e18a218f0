/* drivers/file/sink/picture_sink.h: frames into one picture, or into a folder of them. */
#ifndef PUPIL_DRIVERS_FILE_SINK_PICTURE_SINK_H
#define PUPIL_DRIVERS_FILE_SINK_PICTURE_SINK_H

#include <stdio.h>

#include "pupil/error.h"
#include "sink.h"

/* Display frames into one JPEG, PNG or TIFF, or a folder of PNG: frame_NNNNNN.png, counted from 0, or (options.named)
 * by the name of each frame, with a number where a name repeats; such a folder may hold other files, and keeps them.
 * file_sink.h chooses. */
int pupil_jpeg_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);
int pupil_tiff_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);
int pupil_png_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);
int pupil_folder_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

/* A sink of PUPIL_PIXEL_RGB32F in linear Rec.709, rows in any stride. The kind by the path: .exr (32-bit float, not
 * compressed), .pfm or .hdr (8 bits a channel and an exponent) one picture. Anything without an extension, or with a
 * trailing slash, a folder of frame_NNNNNN.exr by the frames' sequence. Anything else is refused with the list of
 * kinds. */
int pupil_linear_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

/* Whether a path names one of these, and whether it takes one picture only. */
int pupil_is_linear_path(const char *path, int *single);

/* An OpenEXR file of any channels of 32-bit float. */
typedef struct pupil_exr_channel {
    const char *name;       /* "R", "Z", "N.X": the channels are in the order of their names */
    const float *data;      /* the first pixel's */
    size_t step;            /* floats from pixel to pixel */
    ptrdiff_t stride_bytes; /* from row to row */
} pupil_exr_channel;
int pupil_write_exr_channels(FILE *file, uint32_t width, uint32_t height, const pupil_exr_channel *channel,
                             size_t count);

/* The file formats: writes a picture to a stream; 0, or -1 where the stream fails. (write_linear.c) */
int pupil_write_exr(FILE *file, const pupil_image_const *image);
int pupil_write_pfm(FILE *file, const pupil_image_const *image);
int pupil_write_hdr(FILE *file, const pupil_image_const *image);

#endif
