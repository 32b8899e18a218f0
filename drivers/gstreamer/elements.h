/* drivers/gstreamer/elements.h: the elements of the plugin, one file each. */
#ifndef PUPIL_DRIVERS_GSTREAMER_ELEMENTS_H
#define PUPIL_DRIVERS_GSTREAMER_ELEMENTS_H

#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(pupilae)

#endif
