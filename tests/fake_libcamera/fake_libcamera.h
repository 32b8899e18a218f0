/* tests/fake_libcamera/fake_libcamera.h: libcamera's table (drivers/libcamera/layer.h) answered in this process, with a
 * clock of its own: frames come as it advances, and waiting advances it.
 *
 * Two kinds of pipelines. Webcams set a control when its request is queued, have no metadata, and refuse an exposure
 * time while automatic exposure is on (until an earlier request has turned it off). Sensors set it when it is the
 * request's turn, and each frame's metadata says what it was taken with.
 *
 * The picture is a ramp of two stops, of light x exposure x gain: 0.18 of full scale in the middle at light 1, 10 ms.
 */
#ifndef PUPIL_TESTS_FAKE_LIBCAMERA_H
#define PUPIL_TESTS_FAKE_LIBCAMERA_H

#include "libcamera/layer.h"

typedef struct fake_libcamera_config {
    int sensor;     /* 0: a webcam */
    const char *id; /* NULL: the default of its kind */
    int twin;       /* imx219_wide, which cannot be opened, is listed before it */
    uint32_t fourcc, width, height, padding_bytes, buffers;
    double fps;
    uint32_t delay;     /* frames from the one in progress (sensors: the request's turn) to the first with a setting */
    int no_metadata;    /* of a sensor */
    int no_exposure;    /* it has no controls */
    double black;       /* of the metadata, of 65535; 0: none */
    uint64_t refuse_at; /* the first request whose setting is refused, from 1; 0: none ... */
    uint64_t refuse;    /* ... and how many are */
    uint64_t lose_at;   /* the first request that never comes back, from 1; 0: none ... */
    uint64_t lose;      /* ... and how many do not; those that stop returns are no longer lost */
    uint64_t unplug_at; /* after so many frames; 0: never */
    double back_s;      /* how long after that it is back; 0: never */
    int no_list;        /* libcamera does not start */
    int cancels;        /* every request is cancelled */
    int dead;           /* no frame comes */
} fake_libcamera_config;

/* What each request asked for, in the order of queuing. */
typedef struct fake_libcamera_log {
    pupil_libcamera_ask ask;
    int refused;
} fake_libcamera_log;

typedef struct fake_libcamera fake_libcamera;

void fake_libcamera_config_default(fake_libcamera_config *config); /* a webcam: GREY, 64 x 48, 30 frames a second */
fake_libcamera *fake_libcamera_new(const fake_libcamera_config *config);
void fake_libcamera_free(fake_libcamera *fake);
const pupil_libcamera_layer *fake_libcamera_layer(fake_libcamera *fake);

void fake_libcamera_light(fake_libcamera *fake, double light);
/* Lets time pass without taking frames: they wait in their requests, and then are lost. */
void fake_libcamera_pass(fake_libcamera *fake, double s);
/* What the frame of this number was taken with; exposure x gain x light. */
double fake_libcamera_exposure(const fake_libcamera *fake, uint64_t sequence);
double fake_libcamera_gain(const fake_libcamera *fake, uint64_t sequence);
size_t fake_libcamera_logged(const fake_libcamera *fake, const fake_libcamera_log **log);
int fake_libcamera_automatic(const fake_libcamera *fake);
int fake_libcamera_opened(const fake_libcamera *fake); /* open cameras */

#endif
