/* drivers/gstreamer/elements.h: the elements of the plugin, one file each. */
#ifndef PUPIL_DRIVERS_GSTREAMER_ELEMENTS_H
#define PUPIL_DRIVERS_GSTREAMER_ELEMENTS_H

#include <gst/gst.h>

#include "live/live.h"

GST_ELEMENT_REGISTER_DECLARE(pupilae)
GST_ELEMENT_REGISTER_DECLARE(pupilsrc)

/* The calls by which pupilsrc reaches cameras; a fake can replace them. NULL: the machine's own. */
extern const pupil_live_system *pupilsrc_system;

#endif
