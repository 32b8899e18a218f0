/* apps/bench.h: what `pupil bench` can measure. Each takes its own arguments, its name first, and returns the exit
 * status. */
#ifndef PUPIL_APPS_BENCH_H
#define PUPIL_APPS_BENCH_H

int bench_scene_main(int argc, char **argv);
int bench_kernels_main(int argc, char **argv);
int bench_gles_main(int argc, char **argv);

#endif
