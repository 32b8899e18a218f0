/* apps/bench_frames.h: frames for the kernels' benchmark: an easy one, like what a camera sees, and a hard one, with
 * what none should deliver. The same bytes in every run. */
#ifndef PUPIL_APPS_BENCH_FRAMES_H
#define PUPIL_APPS_BENCH_FRAMES_H

#include "pupil/pupil.h"

/* An aligned frame of a format, to be given to free() by its data; data NULL: no memory. */
pupil_image_const bench_frame(uint32_t pixel, uint32_t width, uint32_t height, int hard);

/* Input formats by name, ended by NULL; in the order of pupil_pixel from 1 on. */
extern const char *const bench_format_names[];

#endif
