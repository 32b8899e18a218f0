/* drivers/v4l2/v4l2_sink.h: display frames into a video output node: v4l2loopback, an HDMI output, vivid's.
 *
 * Written as the node's own format of RGB24, BGR24, XR24 (BGRX), YUYV or NV12, in this order of preference, with
 * colour space sRGB, its quantization and encoding told to the driver. A node cannot take anything back: discard only
 * stops. A write waits for a buffer for `timeout_s` at most, then fails.
 */
#ifndef PUPIL_DRIVERS_V4L2_SINK_H
#define PUPIL_DRIVERS_V4L2_SINK_H

#include "sink.h"
#include "v4l2/system.h"

/* 1: a name that outputs call a node: "/dev/video...", "/dev/v4l/...", "v4l2:...". */
int pupil_is_v4l2_output(const char *path);
/* system NULL: the kernel. */
int pupil_v4l2_sink_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                         const pupil_v4l2_system *system, char *why, size_t why_bytes);

#endif
