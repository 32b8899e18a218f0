/* apps/lab/sim/sim.h: pupil sim: an exposure loop around a simulated camera. */
#ifndef PUPIL_APPS_LAB_SIM_SIM_H
#define PUPIL_APPS_LAB_SIM_SIM_H

#include <stdint.h>
#include <stdio.h>

#include "loop.h"
#include "pupil/error.h"

typedef struct sim_options {
    fixture_loop loop;
    char light[4096];  /* the script */
    double duration_s; /* 0: by the script */
    uint32_t believed; /* delay; 0: the camera's own */
    uint32_t mains_hz; /* that pupil is given, or PUPIL_SENSOR_MAINS_AUTO */
    uint32_t threads;  /* for --random; 0: one a processor */
    const char *camera, *scene, *stats, *plot;
    const char *key_at; /* NULL: one key */
    float *luminance;   /* of the scene */
    int json, quiet;
    uint64_t plants, seed; /* plants: 0 unless --random */
} sim_options;

/* Which frames are evaluated. */
typedef struct sim_run {
    const sim_options *options;
    fixture_loop_frame *frame;
    size_t frames, event, rest;
    fixture_loop_sum sum;
} sim_run;

/* Each 0, or -1 and a sentence. */
int sim_stats(const sim_run *run, pupil_why *why);
int sim_plot(const sim_run *run, pupil_why *why);
void sim_summary(const sim_run *run, FILE *out);

/* setup.c. The controller's config, once its camera is there: what the options say of it. */
void sim_configure(sim_options *o);
/* How long the loop runs, and from which frame on nothing happens any more. */
size_t sim_frames(const sim_options *o, size_t *event);
enum { SIM_REST_FRAMES = 60 }; /* at the end of a run, after the last event */

/* random.c. The plant and script of a seed, with the controller of `o`. 0, or -1 and a sentence. */
int sim_random_loop(sim_options *o, uint64_t seed, pupil_why *why);
enum { SIM_RANDOM_REST = 120 }; /* frames at the end of such a run in which nothing may swing */
/* Many of them; the exit status. */
int sim_random(const sim_options *o);

/* Whether the frames end in a limit cycle: what is asked turns by 0.1 EV at least four times while nothing happens. */
int sim_cycles(const fixture_loop_sum *sum);

/* The luminances of a recipe with all its lights on, to be freed. 0, or -1 and a sentence, and NULL. */
int sim_luminance(const char *recipe, uint32_t width, uint32_t height, float **luminance, pupil_why *why);

/* The names of pupil's states and reasons. */
const char *sim_state_name(uint32_t state);
const char *sim_reason_name(uint32_t reason);

#endif
