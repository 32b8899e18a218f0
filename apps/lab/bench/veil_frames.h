/* apps/lab/bench/veil_frames.h: frames with a veil, with bloom and without. */
#ifndef PUPIL_APPS_LAB_BENCH_VEIL_FRAMES_H
#define PUPIL_APPS_LAB_BENCH_VEIL_FRAMES_H

#include <stdint.h>

#include "common/progress.h"

typedef struct veil_frames_options {
    uint64_t rounds;
    uint32_t width, height;
    double above;        /* of the bloom with a bright pass */
    const char *picture; /* NULL: an even frame with grain */
} veil_frames_options;

/* Measures and prints: 0; -1: not enough memory, or interrupted; 1: the picture cannot be read, and a sentence was
 * printed. */
int veil_frames_run(const veil_frames_options *options, progress *shown);

#endif
