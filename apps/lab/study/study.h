/* apps/lab/study/study.h: repeats the study of temporal tone mapping that pupil grew from: four light scenarios, four
 * formulas, twenty weights, and the frame at which the picture has arrived. docs/study.md explains it.
 *
 *     images -> lights (their log-averages) -> runs (the state over time) -> u* (where the picture has arrived)
 *            -> cells (the tables) -> acceptance
 *
 * u = ln(X / X_target) of the exposure scale X = key / L is the error of the state: positive is too bright. A cell is a
 * frame: the first one after the last change of light whose 8-bit picture is within a Manhattan distance D of the last
 * picture of the run of weight 1.
 */
#ifndef PUPIL_APPS_LAB_STUDY_STUDY_H
#define PUPIL_APPS_LAB_STUDY_STUDY_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "frame/workers.h"
#include "pupil/error.h"
#include "pupil/pupil.h"

#define STUDY_FORMULAS   4
#define STUDY_CASES      4
#define STUDY_WEIGHTS    20
#define STUDY_THRESHOLDS 4
#define STUDY_FPS        30
#define STUDY_FRAMES     1800 /* a minute */
#define STUDY_LAST       (STUDY_FRAMES - 1)

extern const double study_weights[STUDY_WEIGHTS];

/* --- images.c: the scene in its two states of light --- */

typedef struct study_images {
    uint32_t width, height;
    float *state[2]; /* off, on: linear RGB, tightly packed, of half precision (study_images_round) */
} study_images;

/* scene.c. The scene of a name: "spheres", two lamps over shaded spheres, computed by formula, or a recipe of the scene
 * renderer, whose darkest and brightest frames are the two states; 600x600 unless given otherwise. 0, or -1 and a
 * sentence. Unless it is NULL, `stop` is asked now and then whether to give up. */
int study_images_open(study_images *images, const char *scene, uint32_t width, uint32_t height, unsigned threads,
                      int (*stop)(void), pupil_why *why);
int study_images_reserve(study_images *images, uint32_t width, uint32_t height, pupil_why *why);
int study_images_spheres(study_images *images, uint32_t width, uint32_t height, pupil_why *why);
void study_images_free(study_images *images);

/* Rounds to the nearest binary16 (ties to even) within its range: the original study had its picture in such a
 * buffer. */
void study_images_round(float *samples, size_t count);

/* All light times 2^shift: exact. */
void study_images_scale(study_images *images, int shift);

/* The images metered by the library, with the floor times 2^shift. 0 or a code of pupil/error.h. */
typedef struct study_lights {
    pupil_config config; /* the study's: key 0.18, no white point, gamma 2.2 */
    pupil_stats stats[2];
    double ev[2]; /* log2 of the log-average: off, on */
} study_lights;

int study_lights_meter(study_lights *lights, const study_images *images, int shift);

/* --- recursion.c: the state over time --- */

/* Cases 0..3 (1..4 in tables): on at 1 s; off at 1 s; on at 1 s and off at 2 s; off at 1 s and on at 2 s. */
int study_light_of(unsigned which_case, unsigned fps, uint32_t frame); /* 0 off, 1 on */
uint32_t study_start(unsigned which_case, unsigned fps);               /* b: the last change shows in frame b + 1 */
static inline int study_final(unsigned which_case)                     /* the last state of light */
{
    return which_case == 0 || which_case == 3;
}

typedef struct study_run {
    unsigned formula;    /* 0..3, or 4: the library's own law, in seconds */
    unsigned which_case; /* 0..3 */
    double weight;       /* of a frame; for formula 4, of a frame of 1/fps */
    unsigned fps;
    uint32_t frames;
} study_run;

/* u of every frame, by the library's adaptation. 0 or a code of pupil/error.h. */
int study_run_library(const study_lights *lights, const study_run *run, double *u);

/* The same by the original study's recursions, in binary32: w new + (1 - w) old, and expf(w logf(new) + (1 - w)
 * logf(old)). luminance[]: before the first change, until the second, after it. */
void study_run_float32(const float luminance[3], const study_run *run, double *u);

/* All runs of the tables: u[formula][case][weight][frame]. */
typedef struct study_states {
    double u[STUDY_FORMULAS][STUDY_CASES][STUDY_WEIGHTS][STUDY_FRAMES];
} study_states;

int study_run_any(const study_lights *lights, const study_run *run, int float32, double *u);
int study_states_make(study_states *states, const study_lights *lights, int float32);

/* The closed form: |u| after n updates from r = L_on / L_off, and the first n at which |u| <= u_star (at least 1). */
double study_closed_u(unsigned formula, unsigned which_case, double weight, double ln_r, double n);
double study_closed_n(unsigned formula, unsigned which_case, double weight, double ln_r, double u_star);

/* --- distance.c: how far a picture is from its target --- */

typedef struct study_target {
    size_t pixels;
    const float *rgb;         /* of study_images */
    double scale, gamut;      /* X of the target; pupil_curve's gamut without a white point */
    double bound[257];        /* light at which a code begins: bound[1..255]; the ends are out of reach */
    uint8_t *code;            /* the target's picture */
    _Atomic uint64_t renders; /* pictures compared so far */
} study_target;

int study_target_open(study_target *target, const study_images *images, const study_lights *lights, int light);
void study_target_close(study_target *target);

/* Manhattan distance of the picture at scale X_target exp(u) to the target's, or any number above `limit` if the
 * distance is larger. The mapping is pupil.h's (white none), in double: the distance is then monotone in |u| on either
 * side. */
uint64_t study_distance(study_target *target, double u, uint64_t limit);

/* How many samples of the library's own map of the target's frame have another code, and the largest difference. */
int study_distance_library(const study_target *target, const study_images *images, const study_lights *lights,
                           int light, uint64_t *differ, unsigned *largest);

/* --- cells.c: the tables --- */

typedef struct study_cells {
    uint32_t width, height;
    uint64_t threshold[STUDY_THRESHOLDS]; /* the frame's pixels, 600, 60, 0 */
    double u_star[2][STUDY_THRESHOLDS];   /* by final light: the largest |u| with D <= threshold, by bisection */
    uint16_t frame[STUDY_FORMULAS][STUDY_CASES][STUDY_WEIGHTS][STUDY_THRESHOLDS];
} study_cells;

/* Called now and then with the work done and the total; returns non-zero to stop. */
typedef int study_progress(void *context, unsigned done, unsigned total);

/* `targets`: off, on. -1: stopped. The cells do not depend on the number of workers. */
int study_cells_make(study_cells *cells, const study_images *images, study_target targets[2],
                     const study_states *states, workers *team, study_progress *progress, void *context);

/* --- accept.c, accept_states.c: A1 to A11 --- */

typedef struct study_test {
    const char *name, *text;
    unsigned long checked, violations;
} study_test;

#define STUDY_TESTS 11

/* A1 to A7, tests[0..6]: they need only the cells. */
void study_accept_cells(study_test tests[STUDY_TESTS], const study_cells *cells, double ln_r);

/* A2, A3 and A5 of any tables. */
void study_accept_order(study_test *test, const study_cells *cells);
void study_accept_equal(study_test *test, const study_cells *cells);
void study_accept_one_number(study_test *test, const study_cells *cells, double ln_r);

/* A8, A9 and A11: they need the states. 0 or a code of pupil/error.h, or PUPIL_ERR_NULL if memory is short. */
int study_accept_states(study_test tests[STUDY_TESTS], const study_cells *cells, const study_lights *lights,
                        const study_states *states, int float32, workers *team);

/* A10: the tables again from light times 2^shift. */
void study_accept_scaled(study_test *test, const study_cells *cells, const study_cells *scaled);

/* --- regression.c: the original study's own tables again, from numbers alone --- */

typedef struct study_regression {
    unsigned cells, exact, within_1, within_2; /* of `cells`, misprints left out */
    unsigned misprints;
    unsigned unfinished, stalled; /* our cells of 1799; those that never arrive, however long the run */
    unsigned rounded;             /* cells in which binary32 differs from the closed form, which never stalls */
    study_cells seeds, ours;      /* only the frames; misprints corrected */
} study_regression;

/* Against a table of the layout of study_csv. 0, or -1 and a sentence. */
int study_regression_make(study_regression *regression, const char *csv, pupil_why *why);

/* --- look.c: how the picture looks while it adapts --- */

typedef struct study_look {
    const char *scene;
    double weight;     /* of a frame, of the formulas */
    double unit_cd_m2; /* of a luminance of 1, for the eye's law */
} study_look;

/* Tables of the four formulas, the default law and the eye's, as Markdown. 0, or -1 and a sentence. */
int study_look_at(const study_images *images, const study_look *look, FILE *out, pupil_why *why);

/* --- tables.c, plot.c, video.c: what is written --- */

typedef struct study_result {
    const char *scene, *command;
    int float32;
    const study_cells *cells;
    const study_lights *lights;
    const study_states *states;
    const study_test *tests;
    uint64_t renders, library_differ[2], samples;
    unsigned library_largest;
} study_result;

/* csv.c */
int study_csv_read(study_cells *cells, const char *path, pupil_why *why); /* only the frames */
void study_csv(FILE *out, const study_cells *cells);
void study_markdown(FILE *out, const study_result *result);
void study_html(FILE *out, const study_result *result);

/* Writes a complete file, or none. */
typedef void study_writer(FILE *out, const study_result *result);
int study_write(const char *path, study_writer *writer, const study_result *result, pupil_why *why);

/* The level over time of a case, the four formulas at three weights. */
int study_plot(const char *path, const study_result *result, unsigned which_case, pupil_why *why);

/* 1000x800, the twenty weights as 5x4 tiles in the order of the tables. -1 and a sentence; 1: stopped. */
int study_video(const char *path, const study_images *images, const study_lights *lights, unsigned which_case,
                unsigned formula, study_progress *progress, void *context, pupil_why *why);

#endif
