/* What the rows of test_hostile.c share: the loop around the hostile camera, and what is measured there. */
#ifndef PUPIL_TESTS_HOSTILE_ROWS_H
#define PUPIL_TESTS_HOSTILE_ROWS_H

#include "hostile_camera.h"

typedef struct hostile_row hostile_row;

struct hostile_row {
    const char *name;
    double (*measure)(const hostile_row *row);
    double a, b; /* their meaning depends on `measure` */
    int info_missing;
    double limit;
    const char *unit, *before, *rpi, *libipa; /* the figures of 2026-11: this loop's, real code's; "": not measured */
};

/* The loop after its last frame. */
typedef struct hostile_loop {
    hostile_camera camera;
    pupil_sensor sensor;
    pupil_sensor_config config;
    pupil_sensor_setting setting;
    double sensor_ev;    /* of the last frame: stops above the key */
    double shown_ev;     /* ... with the digital factor */
    double seen_gain_ev; /* log2 of what the controls and the digital factor did to its light */
    double converged_ev; /* the worst shown_ev of a converged frame in this row */
    int is_judged;       /* ... where the loop could know better */
} hostile_loop;

extern hostile_loop hostile;

/* Frames of still light before an event; frames after which the level has to be right, with a configured delay of 4
 * frames (60, or 12 * delay_frames where that is more); frames that are checked then. */
enum { REST = 90, PROMISED = 60, WATCHED = 240 };

void hostile_prepare(const hostile_row *row, uint64_t seed);
void hostile_begin(double start_ev); /* with a first setting this many stops too bright; 0: pupil_sensor_init's */
void hostile_frame(void);
void hostile_frames(int count);

/* Distance of the last frame from the key, or from where highlights may hold the level: the worse of sensor and shown.
 * The worst of it once the promised frames have passed. */
double hostile_wrong_ev(void);
double hostile_worst_wrong(void);

double hostile_saturation(const hostile_row *row);
double hostile_saturation_8_bits(const hostile_row *row);
double hostile_saturation_noise(const hostile_row *row);
double hostile_lens_cap_first(const hostile_row *row);
double hostile_lens_cap_later(const hostile_row *row);
double hostile_street_lamps(const hostile_row *row);
double hostile_pan(const hostile_row *row);
double hostile_part_of_picture(const hostile_row *row);
double hostile_ramp_jump(const hostile_row *row);
double hostile_ramp_mean(const hostile_row *row);
double hostile_timestamps(const hostile_row *row);
double hostile_bands(const hostile_row *row);
double hostile_dead_gain_swing(const hostile_row *row);
double hostile_dead_gain_wrong(const hostile_row *row);
double hostile_black_level(const hostile_row *row);
double hostile_black_level_unnamed(const hostile_row *row);
double hostile_powers_of_two_shown(const hostile_row *row);
double hostile_powers_of_two_sensor(const hostile_row *row);
double hostile_step(const hostile_row *row);
double hostile_start(const hostile_row *row);
double hostile_rest(const hostile_row *row);
double hostile_blink(const hostile_row *row);
double hostile_beat(const hostile_row *row);
double hostile_strobe(const hostile_row *row);

#endif
