/* drivers/v4l2/offers/offers.h: what a camera says of itself, in the words of live_source.h. */
#ifndef PUPIL_DRIVERS_V4L2_OFFERS_OFFERS_H
#define PUPIL_DRIVERS_V4L2_OFFERS_OFFERS_H

#include "live_source.h"
#include "pupil/error.h"
#include "v4l2/device.h"
#include "v4l2/format.h"

void pupil_v4l2_identify(const pupil_v4l2_device *device, pupil_live_identity *is);

/* What V4L2's numbers of the format's colour are called: into colorspace, transfer, encoding and range. */
void pupil_v4l2_colour_names(const pupil_v4l2_format *format, pupil_live_stream *stream);

/* Of one camera, into an empty one. 0, or -1 and a sentence. Its modes are to be freed, after a failure too. */
int pupil_v4l2_offers_read(pupil_live_offers *offers, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why);

#endif
