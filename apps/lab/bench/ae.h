/* apps/lab/bench/ae.h: pupil bench ae: exposure loops on a simulated camera, side by side. */
#ifndef PUPIL_APPS_LAB_BENCH_AE_H
#define PUPIL_APPS_LAB_BENCH_AE_H

#include "loop.h"
#include "pupil/error.h"

typedef struct bench_ae_row {
    const fixture_controller *law;
    const char *test;     /* what is tested ... */
    const char *of;       /* ... in words, if the numbers do not say it; "" */
    const char *unit;     /* of value and limit: frames or EV */
    const char *gain_law; /* of the camera */
    uint32_t delay, believed;
    double step_ev; /* NAN: no step */
    double value;   /* NAN: never reached */
    double limit;
    int pass;
} bench_ae_row;

typedef struct bench_ae {
    const fixture_controller *law; /* NULL: all */
    const char *test;              /* NULL: all */
    const char *plot;              /* a file to plot to instead; NULL */
    int overwrite;                 /* the file is replaced */
    void (*see)(void *context, const bench_ae_row *row);
    void *context;
    fixture_loop_frame *frame; /* BENCH_AE_FRAMES */
    pupil_why why;             /* what made it fail; "" */
} bench_ae;

enum { BENCH_AE_FRAMES = 2000, BENCH_AE_TESTS = 11 };

/* `of` of pupil without its test for a strobe. */
#define BENCH_AE_NO_FLASH "flash_frames 0"

extern const char *const bench_ae_tests[BENCH_AE_TESTS];

/* Runs them in order and shows each row. 0, or -1: interrupted, or `why` has a sentence. */
int bench_ae_run(bench_ae *b);

/* Draws the answers of all loops to a step up and a step down into b->plot. Returns the same. */
int bench_ae_plot(bench_ae *b);

/* --- between the files of the tests --- */

/* The knowledge of an owner who has only the camera's data sheet: pupil has its own default for the delay; the
 * published laws are given the right delay. */
void bench_ae_begin(fixture_loop *loop, const fixture_controller *law, uint32_t delay, fixture_gain_law gain);
/* The script, then the loop; 0, or -1 and a sentence in b->why. */
int bench_ae_loop(bench_ae *b, fixture_loop *loop, size_t frames, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* One row; value is NAN if it was never reached. */
void bench_ae_show(bench_ae *b, const fixture_loop *loop, const char *test, const char *of, double step_ev,
                   double value, double limit);

int bench_ae_settle(bench_ae *b, const fixture_controller *law);
int bench_ae_hunt(bench_ae *b, const fixture_controller *law);
int bench_ae_identify(bench_ae *b, const fixture_controller *law);
int bench_ae_calm(bench_ae *b, const fixture_controller *law);
int bench_ae_seam(bench_ae *b, const fixture_controller *law);
int bench_ae_flicker(bench_ae *b, const fixture_controller *law);
int bench_ae_mains(bench_ae *b, const fixture_controller *law);
int bench_ae_strobe(bench_ae *b, const fixture_controller *law);
int bench_ae_curve(bench_ae *b, const fixture_controller *law);
int bench_ae_lies(bench_ae *b, const fixture_controller *law);

#endif
