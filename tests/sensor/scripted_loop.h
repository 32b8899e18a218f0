/* A camera with faults, light that follows a script, and the loop that they close. It does the same to the last bit
 * everywhere: exact_numbers.h. */
#ifndef PUPIL_TESTS_SCRIPTED_LOOP_H
#define PUPIL_TESTS_SCRIPTED_LOOP_H

#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { SCRIPTED_DELAY_MOST = 8, SCRIPTED_RING = 16, SCRIPTED_EVENTS = 12 };

#define SCRIPTED_LINE_S 20e-6

/* What info says. */
typedef enum telling { TOLD_TRUTH, TOLD_NOTHING, TOLD_ASKED, TOLD_FIRST, TOLD_HALF, TOLD_LATE } telling;

/* What else it says: only times; no times; the same time twice, now and then; times that go back, now and then. */
typedef enum clocks { CLOCK_RIGHT, CLOCK_UNCOUNTED, CLOCK_NONE, CLOCK_REPEATS, CLOCK_GOES_BACK } clocks;

typedef enum exposures { LINES, POWERS_OF_TWO, THREE_EXPOSURES, HALF_STOPS } exposures;
typedef enum gains { SIXTEENTHS, FOUR_GAINS, TWO_GAINS, DECIBELS, RECIPROCAL } gains;

typedef struct scripted_camera {
    const char *name;
    uint32_t delay[2], believed; /* frames; 0: 2 */
    telling told;
    exposures exposures;
    gains gains;
    double slope;                   /* slope of the picture's log2 over the light's; 0: 1 */
    double jump_gain, jump;         /* from this gain on the gain has this many times the effect */
    double weak[2];                 /* stops of light for one stop of the control; 0: 1; -1: none */
    double knee;                    /* values above it rise 16 times more slowly; 0: 1 */
    double black, white;            /* added to all values; value of saturation, 0: 1 */
    double lamp;                    /* this share of the scene is five stops brighter */
    int own_auto_from, own_auto_to; /* frames in which the camera decides itself */
    double fps;                     /* 0: 30 */
    double lamp_hz;                 /* all light flickers by 0.08 EV; 0: no flicker */
    int has_no_clock;               /* info is NULL */
    clocks clock;
    int loses; /* one frame in so many */
    uint32_t mains_hz;
    int is_curved;       /* linear = 0 */
    double key_at_night; /* below 2 EV of light; 0: none */
    double day_night_s;
    uint32_t stages;
    double highlight_ev, gain_max; /* 0: by default */
    /* shares of the frames, at random: lost; with a setting that comes a frame later; without weight; without a
     * histogram */
    double drops, jitter, dead, uncounted;
    double noise_ev; /* of the light, at most */
    int has_levels;  /* there are no statistics: pupil_sensor_scene */
} scripted_camera;

typedef enum event_kind {
    LIGHT = 1, /* has this many EV from the frame on */
    RAMP,      /* rises by this many EV in each frame */
    FLASH,     /* this many EV more for two frames */
    COVERED,   /* black for so many frames */
    HALF_DARK, /* this share of the scene is black from the frame on */
    ANNOUNCED, /* a change of light by this many EV, three frames before it comes */
    FILTER,    /* the same for a filter; where it is negative, it never comes */
    EXPOSURE_MODE,
    GAIN_MODE,
    BOTH_MODES,
    LOCK,
    GAIN_MAX,
    FRAME_PERIOD, /* 1 / 30 s times this value */
    COMPENSATION,
    BELIEVED, /* delay_frames */
    START,    /* with this total */
    EVENT_KINDS
} event_kind;

typedef struct event {
    int frame;
    event_kind kind;
    double value;
} event;

/* Events in the order of frames; the first without a kind ends it. */
typedef struct script {
    const char *name;
    event events[SCRIPTED_EVENTS];
} script;

typedef struct scripted_loop {
    const scripted_camera *camera;
    pupil_sensor_config config;
    pupil_sensor sensor;
    pupil_sensor_setting s;
    pupil_t meter[2];               /* without a histogram, and with one */
    double asked[SCRIPTED_RING][2]; /* after frame i % SCRIPTED_RING */
    double first[2];
    uint8_t is_late[SCRIPTED_RING];
    double light_ev, ramp_ev, awaited_ev;
    int flash_frames, covered_frames, awaited_frames;
    double flash_ev, dark_share;
    const event *next;
    int frame;
    uint64_t random;
    int errors; /* calls that were refused */
    /* of all frames so far: number over 0.25 EV off; settings asked for; summed errors of the setting, the shown level
     * and scene_ev; limits; changes of day and night; and a digest of every field of every setting */
    int off, settings;
    double sensor_ev, shown_ev, scene_off_ev, scene_ev;
    uint32_t limits, day_night;
    int day_changes;
    uint64_t digest;
} scripted_loop;

pupil_sensor_config scripted_config(const scripted_camera *camera);
/* The caller keeps camera and light until the last frame. */
void scripted_open(scripted_loop *loop, const scripted_camera *camera, const pupil_sensor_config *config,
                   const script *light);
/* The events of the next frame, and the frame. */
void scripted_frame(scripted_loop *loop);
/* A digest of every field of a setting, continued from `before`. */
uint64_t scripted_digest(uint64_t before, const pupil_sensor_setting *setting);

#endif
