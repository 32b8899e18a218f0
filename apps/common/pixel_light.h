/* apps/common/pixel_light.h: the light that a pixel represents, as image.h and coding.h define it for each format, in
 * double.
 *
 * This is the one reference for how pixels are read. The program measures the library's error against it (replay
 * --report, bench), and so do the tests. It is independent of the library: it calls only what describes a format
 * (pupil_pixel_bits, pupil_pixel_is_mosaic), whose values tests/core states one by one. A mistake here therefore makes
 * a test fail and cannot hide a mistake of the library. */
#ifndef PUPIL_APPS_COMMON_PIXEL_LIGHT_H
#define PUPIL_APPS_COMMON_PIXEL_LIGHT_H

#include "pupil/image.h"

/* The colour that a mosaic has at a place: 0 red, 1 green, 2 blue. */
unsigned pixel_colour(uint32_t bayer, uint32_t x, uint32_t y);

/* Linear red, green, blue, and alpha (1 where there is none) of a pixel of any input format. A mosaic is interpolated
 * bilinearly, or (`quad`) the four pixels that begin there are taken; then the camera's matrix is applied. The image is
 * a whole frame. */
void pixel_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, double rgba[4]);

#endif
