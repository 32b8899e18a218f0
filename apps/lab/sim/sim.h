/* apps/lab/sim/sim.h: pupil sim: an exposure loop around a simulated camera. */
#ifndef PUPIL_APPS_LAB_SIM_SIM_H
#define PUPIL_APPS_LAB_SIM_SIM_H

#include <stdint.h>
#include <stdio.h>

#include "loop.h"
#include "pupil/error.h"
#include "verdict.h"

typedef struct sim_options {
    fixture_loop loop;
    char light[4096];  /* the script */
    double duration_s; /* 0: by the script */
    uint32_t believed; /* delay; 0: the camera's own */
    uint32_t mains_hz; /* that pupil is given, or PUPIL_SENSOR_MAINS_AUTO */
    uint32_t threads;  /* for --random; 0: one for each processor */
    const char *camera, *scene, *stats, *plot;
    const char *key_at; /* NULL: one key */
    float *luminance;   /* of the scene */
    int json, quiet, check, overwrite;
    uint64_t plants, seed; /* plants: 0 unless --random */
} sim_options;

/* Which frames are evaluated. */
typedef struct sim_run {
    const sim_options *options;
    fixture_loop_frame *frame;
    size_t frames, event, rest;
    fixture_loop_sum sum;
    fixture_verdict verdict;
} sim_run;

/* Each 0, or -1 and a sentence. */
int sim_stats(const sim_run *run, pupil_why *why);
int sim_plot(const sim_run *run, pupil_why *why);
void sim_summary(const sim_run *run, FILE *out);

/* setup.c. The controller's config, once its camera is there, as the options say. */
void sim_configure(sim_options *o);
/* How many frames the loop runs, and the frame after which there are no more events. */
size_t sim_frames(const sim_options *o, size_t *event);
enum { SIM_REST_FRAMES = 60 }; /* at the end of a run, after the last event */

/* random.c. The plant and script of a seed, with the controller of `o`. 0, or -1 and a sentence. */
int sim_random_loop(sim_options *o, uint64_t seed, pupil_why *why);
/* Many of them; the exit status. */
int sim_random(const sim_options *o);

/* random_table.c: the results of the cameras with each fault. Row FIXTURE_FAULTS_AND_LIGHTS has the cameras without a
 * fault, the row after it all cameras. */
typedef struct sim_fault_row {
    uint64_t cameras, wrong, excused;
    double shown_ev, sensor_ev; /* the worst of those within reach, and the worst of all for the sensor */
} sim_fault_row;
typedef struct sim_fault_table {
    sim_fault_row row[FIXTURE_FAULTS_AND_LIGHTS + 2];
    uint64_t pairs; /* cameras with two faults or more */
} sim_fault_table;
void sim_count_faults(sim_fault_table *table, uint32_t faults, const fixture_verdict *verdict);
void sim_print_faults(const sim_fault_table *table, int json);

/* The luminances of a recipe with all its lights on, to be freed. 0, or -1 and a sentence, and NULL. */
int sim_luminance(const char *recipe, uint32_t width, uint32_t height, float **luminance, pupil_why *why);

#endif
