/* drivers/gstreamer/colorimetry.h: the colours that caps give a stream, in pupil's terms.
 *
 * In: range, matrix, transfer and primaries are obeyed. Unknown: the range of the format, BT.601 up to 576 rows and
 * BT.709 above, sRGB's curve (GRAY16_LE: linear light), BT.709's primaries.
 * Out: the picture is coded as sRGB, with the primaries of BT.709, or of BT.2020 where downstream asks for those.
 */
#ifndef PUPIL_DRIVERS_GSTREAMER_COLORIMETRY_H
#define PUPIL_DRIVERS_GSTREAMER_COLORIMETRY_H

#include <gst/video/video.h>

#include "pupil/coding.h"
#include "pupil/config.h"
#include "pupil/error.h"

/* Sets `coding`, and of `config` the primaries of the input. 0; -1 and a sentence: pupil has no such colours. */
int colorimetry_in(const GstVideoInfo *info, pupil_coding *coding, pupil_config *config, pupil_why *why);

/* Sets `coding`, and of `config` those of the output. 0; -1 and a sentence: a picture cannot be made so. */
int colorimetry_out(const GstVideoInfo *info, pupil_coding *coding, pupil_config *config, pupil_why *why);

/* Fixes the colorimetry in the caps of a picture: the format's own if it is open, the first that a picture can have if
 * it is a list. */
void colorimetry_fixate(GstStructure *structure, GstVideoFormat format);

#endif
