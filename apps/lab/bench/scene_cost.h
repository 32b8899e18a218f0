/* apps/lab/bench/scene_cost.h: what `pupil bench scene` measures of one scene. */
#ifndef PUPIL_APPS_LAB_BENCH_SCENE_COST_H
#define PUPIL_APPS_LAB_BENCH_SCENE_COST_H

#include <stdint.h>
#include <stdio.h>

#include "pupil/error.h"
#include "recipe.h"

#define BENCH_MOST_LIGHTS (FIXTURE_MOST_LAMPS + 1)

typedef struct bench_sums { /* medians of one race */
    double sum_s, copy_s, read_s;
} bench_sums;

/* A plain value: a child process fills it in memory that it shares. */
typedef struct bench_scene {
    char name[256];
    uint32_t width, height;
    unsigned threads;
    uint64_t frames, lights;
    double load_s, prepare_s;          /* from the recipe to a tree; the pictures of all lights, in one pass */
    double light_s[BENCH_MOST_LIGHTS]; /* the picture of each alone */
    double frames_s, sums_s;           /* making all frames; making their sums alone, again */
    bench_sums warm, cold;             /* sums of all lights; a memcpy of one picture and a read of all */
    uint64_t image_bytes, geometry_bytes;
    uint64_t peak_bytes; /* growth of the process's peak memory until all frames were made */
    int done;
    pupil_why why;
} bench_scene;

double bench_scene_total_s(const bench_scene *s);

void bench_scene_json(FILE *out, const bench_scene *s);
void bench_scene_table(FILE *out, const bench_scene *s, size_t scenes);

#endif
