/* drivers/v4l2/output/v4l2_sink.h: display frames into a video output node: v4l2loopback, an HDMI output, vivid's.
 *
 * Written as the format that the node is set to, if that is one of pupil_v4l2_outputs (output.h; 'v4l2-ctl -d NODE
 * --set-fmt-video-out pixelformat=YUYV'). Else it is the first of these that it takes. The driver is given
 * colour space sRGB; what it answers (601 or 709, full or limited range) is what is written. Frames go through the
 * driver's own buffers where it has some, else through write(). The rate is given, too; a node may have one of its own.
 *
 * A node cannot take anything back: discard only stops. A write waits for a buffer for five seconds at most, then
 * fails; finish waits as long for what is queued to be shown.
 */
#ifndef PUPIL_DRIVERS_V4L2_OUTPUT_V4L2_SINK_H
#define PUPIL_DRIVERS_V4L2_OUTPUT_V4L2_SINK_H

#include "pupil/error.h"
#include "sink.h"
#include "v4l2/system.h"

/* 1: a name that outputs call a node: "/dev/video...", "/dev/v4l/...", "v4l2:..." (a path or a number). */
int pupil_is_v4l2_output(const char *path);
/* system NULL: the kernel. */
int pupil_v4l2_sink_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                         const pupil_v4l2_system *system, pupil_why *why);

#endif
