/* drivers/v4l2/modes.h: what a camera offers: formats, their sizes, their rates. */
#ifndef PUPIL_DRIVERS_V4L2_MODES_H
#define PUPIL_DRIVERS_V4L2_MODES_H

#include "device.h"
#include "live_source.h"
#include "pupil/error.h"

/* 0, or -1 and a sentence. Free what it filled in, after a failure too. */
int pupil_v4l2_modes_read(const pupil_v4l2_device *device, pupil_live_modes *modes, pupil_why *why);

#endif
