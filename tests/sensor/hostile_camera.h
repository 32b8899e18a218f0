/* A second simulated camera, which shares no code with fixtures/plant, so that tests can find faults that the first one
 * cannot have. 64 x 64 pixels, log-normal, linear; controls come into force some frames late. */
#ifndef PUPIL_TESTS_HOSTILE_CAMERA_H
#define PUPIL_TESTS_HOSTILE_CAMERA_H

#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { HOSTILE_SIDE = 64, HOSTILE_PIXELS = HOSTILE_SIDE * HOSTILE_SIDE, HOSTILE_HISTORY = 64 };

/* At light 0 this exposure time and gain 1 are right for the key, as those of pupil_sensor_init. */
#define HOSTILE_REST_S 0.01
#define HOSTILE_LINE_S 9.7e-6

typedef enum hostile_clock {
    HOSTILE_CLOCK_TRUE = 0,
    HOSTILE_CLOCK_CONSTANT, /* the same number, not 0, in each frame */
    HOSTILE_CLOCK_ZERO,
    HOSTILE_CLOCK_JUMPING, /* by up to 10 s to both sides */
    HOSTILE_CLOCK_STOPPED, /* after two seconds */
    HOSTILE_CLOCK_BACK,    /* runs backwards */
    HOSTILE_CLOCKS
} hostile_clock;

typedef struct hostile_camera {
    /* the scene; may change between frames */
    double light_ev;        /* of the whole scene; 0: HOSTILE_REST_S at gain 1 is right */
    double part_share;      /* this share of the picture, at the top ... */
    double part_ev;         /* ... has this much more light */
    double lamp_hz;         /* all light is 1 + modulation * sin(2 pi lamp_hz t), 0: no lamp */
    double lamp_modulation; /* 0..1 */
    double frame_noise_ev;  /* of each frame's light, standard deviation */

    /* the sensor */
    uint32_t bits;           /* 8, 10 or 12 */
    uint32_t delay;          /* frames from the one that was measured to the first that has the new setting */
    double frame_s;          /* a frame's period */
    double readout_s;        /* from the first row to the last */
    double saturation;       /* a saturated pixel's value, as a share of the top code; 1 */
    double saturation_noise; /* ... and up to this much more, a different amount in each pixel and frame */
    double pedestal;         /* share of the range that is added without being reported */
    double well_e, read_e;   /* electrons of a saturated pixel at gain 1, and of the read noise; 0: no noise */
    double dead_gain;        /* gains below this one do nothing; 0: all work */
    int dead_gain_continues; /* ... and those above do this much less, without a jump */
    int powers_of_two;       /* exposures are 100 us * 2^n, rounded down */

    /* what a frame says of itself */
    int info_missing;
    hostile_clock clock;

    /* the truth of the last frame, for the tests; the key is pupil's default */
    double level_ev; /* stops from the log-average of all light in the frame, unlimited, to the key */
    double exposure_s, gain;
    double bands_ev; /* brightest row over darkest, by the lamps alone */

    /* private */
    uint64_t frame, random;
    double written[HOSTILE_HISTORY][2]; /* exposure, gain: after frame i % HOSTILE_HISTORY */
    float scene[HOSTILE_PIXELS];        /* log-average 1 */
    float row_light[HOSTILE_SIDE];
    uint16_t codes[HOSTILE_PIXELS];
    pupil_t meter;
} hostile_camera;

/* 12 bits, 30 frames a second, a delay of 3 frames, no faults. Returns 0 where pupil refuses its metering. */
int hostile_camera_open(hostile_camera *camera, uint64_t seed);

/* The configuration that such a camera's integrator would write: lines, n/16 to 16, the rest by default. */
void hostile_camera_config(pupil_sensor_config *config);

/* The setting in force in the frames before the first one that a write can reach. */
void hostile_camera_write_first(hostile_camera *camera, double exposure_s, double gain);

/* The next frame. Returns 0 where pupil refuses to meter it. */
int hostile_camera_frame(hostile_camera *camera, pupil_stats *stats, pupil_frame_info *info);

/* After each frame: writes the controls. */
void hostile_camera_write(hostile_camera *camera, double exposure_s, double gain);

/* The same scene from elsewhere: pixels change places. */
void hostile_camera_turn(hostile_camera *camera);

/* The lowest aim that highlights allow, stops from the key; 0 where they do not lower it. */
double hostile_camera_highlight_ev(const hostile_camera *camera);

double hostile_uniform(hostile_camera *camera); /* [0, 1) */
double hostile_normal(hostile_camera *camera);

#endif
