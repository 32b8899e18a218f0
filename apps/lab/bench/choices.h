/* apps/lab/bench/choices.h: the choices of a user, each with its speed and its error, to be drawn. */
#ifndef PUPIL_APPS_LAB_BENCH_CHOICES_H
#define PUPIL_APPS_LAB_BENCH_CHOICES_H

#include <stddef.h>

#include "subject.h"

typedef enum bench_group {
    BENCH_GROUP_NATURAL, /* metering; the error is of the easy frame */
    BENCH_GROUP_STRIPED, /* the same; of a frame whose every eighth row is four stops brighter */
    BENCH_GROUP_FRAME,   /* whole frames to RGBA8, by pupil */
    BENCH_GROUP_ENCODER, /* encoding alone, in plain C */
    BENCH_GROUP_CAMERA,  /* whole frames of NV12; the error is the mean of codes */
    BENCH_GROUP_MOSAIC,  /* the same of a Bayer mosaic of 10 bits */
    BENCH_GROUPS
} bench_group;

typedef struct bench_choice {
    char name[64];
    bench_group group;
    double ns_per_px;
    double error; /* EV, the share of samples that differ, or the mean in codes; 0: exact */
    int code_max; /* the largest difference */
} bench_choice;

enum { BENCH_MOST_CHOICES = 32 };

/* Measures them; 0, or -1: interrupted, or it failed and said so. */
int bench_choices(const bench_options *o, workers *crew, const bench_flush *flush, uint32_t level,
                  bench_choice choice[BENCH_MOST_CHOICES], size_t *count);

#endif
