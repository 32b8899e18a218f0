/* drivers/gstreamer/camera_stream.h: frames of a live camera: metered, its exposure steered, balanced and mapped, as
 * `pupil run` does it. One thread.
 */
#ifndef PUPIL_DRIVERS_GSTREAMER_CAMERA_STREAM_H
#define PUPIL_DRIVERS_GSTREAMER_CAMERA_STREAM_H

#include "colour/white_balance.h"
#include "live/live.h"
#include "pupil/camera_loop.h"
#include "pupil/pupil.h"

typedef struct camera_settings {
    pupil_config picture;                  /* except for what the camera's frames report */
    double exposure_min_s, exposure_max_s; /* within those of the camera; 0: its own */
    double gain_min, gain_max;             /* the same */
    uint32_t mains_hz;                     /* 50, 60, 0 or PUPIL_SENSOR_MAINS_AUTO */
    uint32_t lock;                         /* 1: exposure, gain and level stay */
} camera_settings;

typedef struct camera_stream {
    pupil_source *source; /* NULL: closed */
    camera_settings settings;
    pupil_exposure exposure; /* of the last frame */
    pupil_frame_info info;   /* the same; exposure_s and gain as they were in force */

    /* private */
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_colour_options colours;
    pupil_white_balance colour;
    int has_colour;
    pupil_camera *camera;
    pupil_camera_loop loop;
} camera_stream;

/* In an object that is all zero, or closed. 0, or -1 and a sentence. */
int camera_stream_open(camera_stream *s, const char *device, const pupil_live_options *options,
                       const pupil_colour_options *colours, const camera_settings *settings, pupil_why *why);
/* Gives the camera's controls back. 0, or -1 and a sentence: one could not be. Of a closed one: 0. */
int camera_stream_close(camera_stream *s, pupil_why *why);

/* Other settings from the next frame on. 0, or -1 and a sentence: they are refused, and the old ones stay. */
int camera_stream_retune(camera_stream *s, const camera_settings *settings, pupil_why *why);

/* A frame of the source, to `out`, which has its size. 0, or -1 and a sentence. */
int camera_stream_show(camera_stream *s, pupil_frame *frame, const pupil_image *out, pupil_why *why);

/* The state of the sensor's loop if the exposure is steered, else of the level. Constant text. */
const char *camera_stream_state(const camera_stream *s);
const char *camera_stream_reason(const camera_stream *s);

#endif
