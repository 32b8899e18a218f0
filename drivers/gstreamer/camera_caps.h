/* drivers/gstreamer/camera_caps.h: sizes and rates of a camera as caps. */
#ifndef PUPIL_DRIVERS_GSTREAMER_CAMERA_CAPS_H
#define PUPIL_DRIVERS_GSTREAMER_CAMERA_CAPS_H

#include <gst/gst.h>

#include "live_source.h"
#include "pupil/error.h"

/* What a camera is asked for; 0: as it is set. */
typedef struct camera_asked {
    uint32_t width, height;
    double fps;
} camera_asked;

/* From what downstream takes (not empty). Fixed sizes and rates are asked for as they are, open ones stay as the camera
 * is set, and within ranges and lists the mode that is nearest to 1280x720 at 30 a second is taken. `fourcc`: of this
 * format alone; 0: of all that are read. 0, or -1 and a sentence: the camera has no such mode. */
int camera_caps_ask(GstCaps *wanted, const pupil_live_modes *modes, uint32_t fourcc, camera_asked *asked,
                    pupil_why *why);

/* The fixed caps of the stream, in a format that downstream wants. NULL and a sentence: it takes none of `formats`. */
GstCaps *camera_caps_of_stream(GstCaps *wanted, const GstCaps *formats, uint32_t width, uint32_t height, double fps,
                               pupil_why *why);

#endif
