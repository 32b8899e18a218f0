/* drivers/live/live.h: a camera as a source of frames. Each frame brings the exposure time and gain that it was taken
 * with, and the controls can be asked for others.
 *
 *     open -> next -> (use the frame, ask) -> done -> ... -> close
 *
 * Which kind of camera it is shows in its name: "libcamera:ID" is libcamera's (libcamera/libcamera.h), all else V4L2's.
 *
 * Frames are in the kernel's buffers; nothing is copied. JPEGs are decoded, and handed out both ways. Damaged frames
 * are left out and counted. info.sequence is the driver's number, extended to 64 bits. It continues over a wrap and
 * over a camera that is opened again; a gap is a frame lost. info.timestamp_ns is the driver's stamp
 * (pupil_live_get(..)->times says of which moment), less that of the first frame unless options.capture.monotonic is 1.
 *
 * The controls are a pupil_camera (pupil/camera_controls.h): of V4L2 on files of its own, and the sensor's subdevice is
 * found in the media graph. What the driver turns on again at STREAMON is turned off again. Close puts every control
 * back. A camera without a control of exposure is no error: frames come without exposure and gain, and
 * pupil_live_no_controls has the sentence. With options.hands_off no control is read or touched.
 *
 * An unplugged camera, a stream that stops and a signal that changes are errors with a sentence each. Where
 * options.capture.reopen_s is above 0, next waits that long for the camera and its first frame, and continues. The
 * camera has the same path or name, or the same name and socket on another node. Its frames may have another size. The
 * controls follow some frames later. options.stop ends the stream like its own end.
 *
 * Threads: as every source; asking is allowed from any thread.
 */
#ifndef PUPIL_DRIVERS_LIVE_H
#define PUPIL_DRIVERS_LIVE_H

#include "live_source.h"
#include "pupil/camera_controls.h"
#include "pupil/error.h"
#include "sink.h"
#include "source.h"
#include "v4l2/capture/capture.h"

/* The calls by which cameras and output nodes are reached, so that fakes can take their place. NULL: the machine's own.
 */
typedef struct pupil_live_system {
    const pupil_v4l2_system *v4l2;                 /* NULL: the kernel */
    const struct pupil_libcamera_layer *libcamera; /* NULL: none */
} pupil_live_system;

typedef struct pupil_live_options {
    const pupil_live_system *system; /* NULL: capture.system, or the machine's own */
    pupil_v4l2_options capture;      /* for any kind of camera, except the memory and the V4L2 system */
    uint32_t mains_hz;               /* 50, 60; 0: as it is */
    uint32_t delay; /* frames that a control takes to act; 0: as is known of the sensor, or 3, until frames show it
                     * (pupil_camera_learn) */
    int hands_off;  /* 1: no control is read or touched */
} pupil_live_options;

/* 1: a camera's name: "libcamera:...", "v4l2:...", "/dev/video...", "/dev/v4l/...". */
int pupil_live_is_camera(const char *name);

/* which: as pupil_v4l2_device_open has it, with or without "v4l2:" before it. `options` (fps, width, height, stop)
 * takes precedence over `more`; both may be NULL. 0, or PUPIL_SOURCE_FAILED and a sentence. */
int pupil_live_open(const char *which, const pupil_source_options *options, const pupil_live_options *more,
                    pupil_source **source, pupil_why *why);

/* Lists every camera. `seen` is called with each; it may take the modes and leave none, else they are freed. `is` NULL
 * and a sentence: it could not be asked; without a sentence: it is no camera. `is` and a sentence: some of its modes
 * are missing. `seen` returns nonzero to end the walk. 0, or -1 and a sentence: cameras cannot be listed. */
typedef int pupil_live_seen(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *why);
int pupil_live_cameras(const pupil_live_system *system, int with_modes, pupil_live_seen *seen, void *closure,
                       pupil_why *why);
/* What a camera reports of itself. 0, or -1 and a sentence; its modes are to be freed (pupil_live_modes_free), after a
 * failure too. */
int pupil_live_offers_read(pupil_live_offers *offers, const pupil_live_system *system, const char *which,
                           pupil_why *why);

/* Display frames into a video output node (v4l2/output/v4l2_sink.h). */
int pupil_live_is_output(const char *path);
int pupil_live_output_open(pupil_sink **sink, const char *path, const pupil_sink_options *options,
                           const pupil_live_system *system, pupil_why *why);

/* --- of a source that was opened here --- */

/* What it is, what it counted, and when its last frame was taken; good until the source is closed. */
static inline const pupil_live *pupil_live_get(const pupil_source *source)
{
    return (const pupil_live *)source;
}

/* Good until the next `next` of it: a camera that was opened again has other ones, some frames later. NULL: there are
 * no controls (now), and why. */
pupil_camera *pupil_live_camera(const pupil_source *source);
const char *pupil_live_no_controls(const pupil_source *source);
/* Now, by the source's clock, which times.taken_ns uses, too. */
int64_t pupil_live_now_ns(const pupil_source *source);
/* For pupil_sensor_config.linear: 1: the frames' values are proportional to light, as of raw sensors, and where the
 * driver says so. 0: there may be a tone curve. This is so for Y'CbCr and RGB, even if they are decoded by the transfer
 * function that the driver names: a camera's picture processing is seldom that alone. It is also so for grey of a UVC
 * camera whose driver does not call it linear. */
int pupil_live_is_linear(const pupil_source *source);
/* What is known of the sensor behind it: 1; 0: nothing. */
int pupil_live_find_sensor(const pupil_source *source, pupil_camera_sensor *sensor);
/* Call it before asking for a setting if much time has passed since `next`: it finds the frame that is being exposed
 * now, and so from which one on the setting will be in force. */
void pupil_live_mark(pupil_source *source);
/* Puts every control back, as close does, and says what could not be: 0, or -1 and a sentence. There are no controls
 * after it. Waits up to a second for a write that hangs, which then puts everything back when it ends. */
int pupil_live_give_back(pupil_source *source, pupil_why *why);
/* Call it before a program ends, which ends such a write's thread, too. Waits until all controls of closed sources are
 * back, at most most_s, or until `stop` (NULL: never) returns 1. 0, or -1: some are not. */
int pupil_live_await(double most_s, int (*stop)(void));
/* Puts every control back, by system calls alone: for handlers of fatal signals. */
void pupil_live_restore(const pupil_source *source);

/* --- of V4L2's alone --- */

/* The capture; another one after the camera was opened again (capture->counts.reopened). */
const pupil_v4l2_capture *pupil_live_capture(const pupil_source *source);
/* The frame that is out: its buffer, stamps and losses. */
const pupil_v4l2_frame *pupil_live_frame(const pupil_source *source);

#endif
