/* apps/lab/bench/camera.h: the samples of a camera's formats for the benchmark's frames. */
#ifndef PUPIL_APPS_LAB_BENCH_CAMERA_H
#define PUPIL_APPS_LAB_BENCH_CAMERA_H

#include "pupil/image.h"

/* Whether a format is Y'CbCr. */
int bench_is_yuv(uint32_t pixel);

/* The coding of a format's samples in the benchmark; NULL: the usual. Constant. */
const pupil_coding *bench_coding(uint32_t pixel);

/* Linear RGBA of the 2 x 2 pixels that begin at an even place, row by row, to the image's memory; those outside the
 * image are left out. */
void bench_store_quad(const pupil_image_const *image, uint32_t x, uint32_t y, const float rgba[4][4]);

/* Any values that bytes can hold: Y'CbCr beyond its range; half of the grey and mosaic samples anywhere within the
 * bits, the others full, at or below black, or with bits set above the sample. `random` gives numbers in [0, 1). */
void bench_store_any(const pupil_image_const *image, double (*random)(uint64_t *state), uint64_t *state);

#endif
