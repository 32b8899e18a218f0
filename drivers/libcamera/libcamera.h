/* drivers/libcamera/libcamera.h: libcamera's cameras as live sources (live_source.h): "libcamera:ID".
 *
 * ID is what `cam --list` and `pupil list` print, or a part of it or of the model's name that only one camera has, or
 * the number of the camera from 0, or empty: the first one.
 *
 * Frames are raw if the camera has such: pupil then does metering, exposure and picture. Else they are processed. The
 * exposure of libcamera is turned off by the first request, and exposure, gain and frame duration are asked for in one
 * request. What is in force in a frame is what its metadata says. A camera whose frames do not report it (webcams) is
 * treated as V4L2's are: by what was taken when, and what frames show of the delay.
 *
 * A request that is cancelled because its setting was refused brings no frame: it is queued again without the setting,
 * counted, and the refusal is in pupil_camera_status, so that camera_loop.h asks again. Requests that do not come back
 * are lost; where too few are left, the stream is started again. No frame in time is an error with a sentence.
 *
 * Webcams: V4L2 is better ("v4l2:..."). libcamera's gain of a webcam is an invented scale, so only the exposure is
 * controlled here; live.remark says so.
 *
 * Giving back: libcamera's exposure is turned on again, where it has the controls for that. A webcam's own controls
 * keep their values when a program ends; so they are noted at its V4L2 node when it is opened, and put back at the end.
 *
 * Sensors' black level comes from the metadata, else from the table of sensors, by the model's name.
 */
#ifndef PUPIL_DRIVERS_LIBCAMERA_LIBCAMERA_H
#define PUPIL_DRIVERS_LIBCAMERA_LIBCAMERA_H

#include "layer.h"
#include "pupil/error.h"
#include "source.h"
#include "v4l2/system.h"

#define PUPIL_LIBCAMERA_PREFIX "libcamera:"

typedef struct pupil_libcamera_options {
    const pupil_libcamera_layer *layer; /* NULL: refused */
    const pupil_v4l2_system *v4l2;      /* of webcams' nodes; NULL: the kernel */
    uint32_t fourcc, width, height;     /* 0: the camera's choice */
    double fps;                         /* 0: the camera's choice */
    uint32_t buffers;                   /* 2..32; 0: 4. Few: a setting waits for the requests before it */
    double timeout_s;                   /* after so long without a frame the stream has failed; 0: 5 */
    double reopen_s;                    /* how long to wait for a camera that is gone; 0: that is an error */
    int late;                           /* a pupil_live_late */
    int monotonic;                      /* 1: timestamps are CLOCK_MONOTONIC's; 0: the first frame's is 0 */
    int (*stop)(void);                  /* asked while waiting; nonzero ends the stream; NULL: never */
    uint32_t delay;                     /* frames that a control takes to act; 0: as found */
    int hands_off;                      /* 1: no control is touched */
} pupil_libcamera_options;

/* `which` without its prefix. 0, or PUPIL_SOURCE_FAILED and a sentence. */
int pupil_libcamera_open(const char *which, const pupil_libcamera_options *options, pupil_source **source,
                         pupil_why *why);

/* Every camera that libcamera has: who it is and its modes, which are freed after the call. `seen` returns nonzero to
 * end the walk. 0, or -1 and a sentence. layer NULL: there are none. */
typedef int pupil_libcamera_seen(void *closure, const pupil_live_identity *is, pupil_live_modes *modes,
                                 const char *why);
int pupil_libcamera_cameras(const pupil_libcamera_layer *layer, pupil_libcamera_seen *seen, void *closure,
                            pupil_why *why);
/* As pupil_live_offers_read, `which` without its prefix. */
int pupil_libcamera_offers_read(pupil_live_offers *offers, const pupil_libcamera_layer *layer, const char *which,
                                pupil_why *why);

#endif
