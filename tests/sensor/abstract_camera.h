/* A third simulated camera, with few states and no pixels: test_exhaustive.c walks through every sequence of events
 * with it. A frame is sixteen samples of light, from which the statistics are made. It has no pointers: a copy of its
 * bytes is another camera in the same state. */
#ifndef PUPIL_TESTS_ABSTRACT_CAMERA_H
#define PUPIL_TESTS_ABSTRACT_CAMERA_H

#include "pupil/sensor.h"
#include "pupil/stats.h"

enum { ABSTRACT_LEVELS = 10, ABSTRACT_USUAL_LEVEL = 4, ABSTRACT_MOST_DELAY = 4 };

/* Light of the levels, stops. At 0 this total, with which pupil_sensor_init begins, is right for the key. */
#define ABSTRACT_REST_S 0.01
extern const double abstract_light_ev[ABSTRACT_LEVELS];

/* Faults that stay until they end, as bits. Of the three faults of info the latest counts. */
enum {
    ABSTRACT_EXPOSURE_DEAD = 1, /* it keeps the value of the frame before */
    ABSTRACT_GAIN_DEAD = 2,
    ABSTRACT_OWN_AUTO = 4, /* the camera's own automatic holds both controls, at a setting of its own */
    ABSTRACT_INFO_MISSING = 8,
    ABSTRACT_INFO_CONSTANT = 16, /* the true values of the frame before */
    ABSTRACT_INFO_ASKED = 32,    /* what was asked for last, which is in force some frames later */
    ABSTRACT_INFO = 8 | 16 | 32
};

/* Faults of one frame. */
typedef enum abstract_frame {
    ABSTRACT_FRAME_FINE = 0,
    ABSTRACT_FRAME_LOST,
    ABSTRACT_FRAME_WHITE, /* all samples are saturated, whatever the setting */
    ABSTRACT_FRAME_BLACK
} abstract_frame;

typedef struct abstract_camera {
    uint32_t delay;    /* frames from the one that was measured to the first that has the new setting: 1..4 */
    uint32_t level;    /* of abstract_light_ev */
    uint32_t faults;   /* bits */
    uint32_t frame;    /* number of the next one */
    double saturation; /* value of a saturated sample, as a share of the top code */
    double written[ABSTRACT_MOST_DELAY][2]; /* exposure, gain: after the last frame, the one before, ... */
    double in_force[2];                     /* in the last frame */
    double dead[2], constant[2];            /* while there are such faults */
} abstract_camera;

/* The configuration that its integrator would write: lines of 20 us, n/16 to 16, the rest by default. */
void abstract_camera_config(pupil_sensor_config *config, uint32_t delay_frames);

/* A camera to which this exposure and gain have been written. */
abstract_camera abstract_camera_open(uint32_t delay, double saturation, double exposure_s, double gain);

/* Begins or ends faults; the values they hold are those of the frame before. */
void abstract_camera_set_faults(abstract_camera *camera, uint32_t faults);

/* The next frame. Returns 0 where it is lost. The statistics are valid until the next call. */
int abstract_camera_frame(abstract_camera *camera, abstract_frame fault, const pupil_stats **stats,
                          pupil_frame_info *info);

/* After each frame. */
void abstract_camera_write(abstract_camera *camera, double exposure_s, double gain);

/* Whether the camera has this setting. */
int abstract_camera_has(const pupil_sensor_config *config, double exposure_s, double gain);

/* How far the last frame's light was above the key, stops, without clipping and black. */
double abstract_camera_off_ev(const abstract_camera *camera);

/* Of all settings that its faults leave, the nearest ones above and below the key, in stops from the key; NAN where
 * there is none on that side. */
typedef struct abstract_reach {
    double above_ev, below_ev;
} abstract_reach;
abstract_reach abstract_camera_reach(const abstract_camera *camera, const pupil_sensor_config *config);

#endif
