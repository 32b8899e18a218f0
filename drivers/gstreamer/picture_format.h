/* drivers/gstreamer/picture_format.h: GStreamer's raw video formats and pupil's, and frames as images. */
#ifndef PUPIL_DRIVERS_GSTREAMER_PICTURE_FORMAT_H
#define PUPIL_DRIVERS_GSTREAMER_PICTURE_FORMAT_H

#include <gst/video/video.h>

#include "pupil/image.h"

/* For pad templates and lists: what pupil reads and GStreamer 1.22 has; and what pupil writes. RGBA64_LE is missing
 * among those that are read: pupil takes 16-bit RGB for linear light, and GStreamer's is coded as sRGB. */
#define PICTURE_FORMATS_IN                                                                                             \
    "{ P010_10LE, I420_10LE, Y444_16LE, RGB10A2_LE, NV12, I420, YV12, NV21, NV16, YUY2, UYVY, RGBA, RGBx, BGRx, RGB, " \
    "BGR, GRAY16_LE, GRAY8 }"
#define PICTURE_FORMATS_OUT "{ NV12, I420, YV12, RGBA, RGBx, BGRx, RGB, BGR }"

/* "Caps" of one of these. */
#define PICTURE_CAPS(formats)                                                                                          \
    "video/x-raw, format = (string) " formats ", width = (int) [ 1, 16384 ], height = (int) [ 1, 16384 ], "            \
    "framerate = (fraction) [ 0, max ]"

/* A pupil_pixel; PUPIL_PIXEL_NONE where pupil does not read (or write) it. */
uint32_t picture_pixel_in(GstVideoFormat format);
uint32_t picture_pixel_out(GstVideoFormat format);

/* A mapped frame, with the strides that it has. */
pupil_image_const picture_in(const GstVideoFrame *frame, const pupil_coding *coding);
pupil_image picture_out(const GstVideoFrame *frame, const pupil_coding *coding);

#endif
