/* apps/report/camera_light.h: the light that a camera's formats (Y'CbCr, grey, mosaics) stand for, as coding.h and
 * image.h define it, in double: what the library's own is held against. */
#ifndef PUPIL_APPS_REPORT_CAMERA_LIGHT_H
#define PUPIL_APPS_REPORT_CAMERA_LIGHT_H

#include "pupil/image.h"

int camera_is_camera(uint32_t pixel); /* one of these formats */
int camera_is_mosaic(uint32_t pixel);

/* Of a sample; and the colour that a mosaic has at a place: 0 red, 1 green, 2 blue. */
unsigned camera_bits(uint32_t pixel);
unsigned camera_colour(uint32_t bayer, uint32_t x, uint32_t y);

/* Linear light of a pixel; of a mosaic's by bilinear interpolation, or (`quad`) of the four pixels that begin there. A
 * mosaic's has gone through the camera's matrix. The image is a whole frame. */
void camera_light(const pupil_image_const *image, uint32_t x, uint32_t y, int quad, double rgb[3]);

#endif
