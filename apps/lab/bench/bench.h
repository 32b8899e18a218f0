/* apps/lab/bench/bench.h: what `pupil bench` can measure. Each takes its own arguments, its name first, and returns the
 * exit status. */
#ifndef PUPIL_APPS_LAB_BENCH_BENCH_H
#define PUPIL_APPS_LAB_BENCH_BENCH_H

#include "options/option_table.h"

int bench_scene_main(int argc, char **argv);
int bench_kernels_main(int argc, char **argv);
int bench_gles_main(int argc, char **argv);
int bench_ae_main(int argc, char **argv);
int bench_deferred_main(int argc, char **argv);
int bench_veil_main(int argc, char **argv);

extern const option_command bench_scene_command, bench_kernels_command, bench_gles_command, bench_ae_command,
    bench_deferred_command, bench_veil_command;

#endif
