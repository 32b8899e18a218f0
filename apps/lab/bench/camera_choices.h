/* apps/lab/bench/camera_choices.h: the choices for frames of a camera, for choices.h. */
#ifndef PUPIL_APPS_LAB_BENCH_CAMERA_CHOICES_H
#define PUPIL_APPS_LAB_BENCH_CAMERA_CHOICES_H

#include "choices.h"

enum { BENCH_CAMERA_CHOICES = 9 };

/* The runners to be raced, in this order; 0, or -1 and a sentence on stderr. Closing takes what a failed opening
 * left. */
int bench_camera_open(const bench_options *o, workers *crew, uint32_t level, bench_runner runner[BENCH_CAMERA_CHOICES]);
/* The results. */
int bench_camera_judge(const bench_runner runner[BENCH_CAMERA_CHOICES], bench_choice choice[BENCH_CAMERA_CHOICES]);
void bench_camera_close(void);

#endif
