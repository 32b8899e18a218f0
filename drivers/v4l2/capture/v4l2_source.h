/* drivers/v4l2/capture/v4l2_source.h: a camera as a source of frames.
 *
 * Frames lie in the kernel's buffers; nothing is copied. JPEGs are decoded, and handed out both ways. Damaged frames
 * are left out and counted. info.sequence is the
 * driver's number, made of 64 bits: it goes on over a wrap and over a camera that is opened again; a gap is a frame
 * lost. info.timestamp_ns is the driver's stamp (pupil_v4l2_source_frame tells of which moment), less that of the first
 * frame unless options.monotonic is 1. Exposure and gain are unknown here.
 *
 * An unplugged camera, a stream that stops and a signal that changes are errors with a sentence each; where
 * options.reopen_s is above 0, next waits so long for the camera and its first frame (the same path or name, or the
 * same name and socket on another node), and goes on, with frames of another size perhaps. options.stop ends the stream
 * as its end does.
 */
#ifndef PUPIL_DRIVERS_V4L2_CAPTURE_V4L2_SOURCE_H
#define PUPIL_DRIVERS_V4L2_CAPTURE_V4L2_SOURCE_H

#include "capture.h"
#include "pupil/error.h"
#include "source.h"

#define PUPIL_V4L2_PREFIX "v4l2:"

/* which: as pupil_v4l2_device_open has it, with or without "v4l2:" before it. What `options` says (fps, width, height,
 * stop) goes before what `more` says; both may be NULL. 0, or PUPIL_SOURCE_FAILED and a sentence. */
int pupil_v4l2_source_open(const char *which, const pupil_source_options *options, const pupil_v4l2_options *more,
                           pupil_source **source, pupil_why *why);

/* Of a source that was opened here. The capture moves on with next, and is another one after the camera was opened
 * again (capture->counts.reopened). */
const pupil_v4l2_capture *pupil_v4l2_source_capture(const pupil_source *source);
/* The frame that is out: its buffer, stamp and losses. */
const pupil_v4l2_frame *pupil_v4l2_source_frame(const pupil_source *source);

#endif
