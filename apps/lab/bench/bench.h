/* apps/lab/bench/bench.h: what `pupil bench` can measure. Each takes its own arguments, its name first, and returns the
 * exit status. */
#ifndef PUPIL_APPS_LAB_BENCH_BENCH_H
#define PUPIL_APPS_LAB_BENCH_BENCH_H

#include <stdint.h>

int bench_scene_main(int argc, char **argv);
int bench_kernels_main(int argc, char **argv);
int bench_gles_main(int argc, char **argv);
int bench_ae_main(int argc, char **argv);

/* Values of options; 0, or -1 and a sentence on standard error. */
int bench_number(const char *option, const char *text, unsigned long least, unsigned long most, unsigned *value);
int bench_size(const char *text, uint32_t *width, uint32_t *height);

#endif
