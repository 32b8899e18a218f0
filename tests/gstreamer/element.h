/* tests/gstreamer/element.h: an element of the plugin in a GstHarness, and frames for it. */
#ifndef PUPIL_TESTS_GSTREAMER_ELEMENT_H
#define PUPIL_TESTS_GSTREAMER_ELEMENT_H

#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include "pupil/pupil.h"

/* A picture without padding, with random bytes or none; to be freed. */
pupil_image picture_make(uint32_t pixel, uint32_t width, uint32_t height, int is_random);

/* "video/x-raw, format=..." with 30 frames a second. `colorimetry` may be NULL. */
gchar *caps_text(const char *format, uint32_t width, uint32_t height, const char *colorimetry);

/* A buffer of this format with the picture's samples. `padding`: extra bytes per row, described by a GstVideoMeta. */
GstBuffer *buffer_of(const char *format, const pupil_image *picture, uint32_t padding, GstClockTime pts);

/* 1: the buffer's samples are those of the picture, in each plane; the buffer is as these caps say. */
int is_same(GstBuffer *buffer, const GstCaps *caps, const pupil_image *picture);

/* The structure of the element's next message, to be freed; NULL: there is none. */
GstStructure *next_message(GstBus *bus);

#endif
