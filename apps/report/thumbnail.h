/* apps/report/thumbnail.h: display frames made small. */
#ifndef PUPIL_APPS_REPORT_THUMBNAIL_H
#define PUPIL_APPS_REPORT_THUMBNAIL_H

#include "pupil/image.h"

#define THUMBNAIL_MOST_PX 320 /* a side */

typedef struct thumbnail {
    unsigned char *rgb; /* sRGB, rows without gaps; NULL: none */
    uint32_t width, height;
} thumbnail;

/* An RGB8 sRGB image at no more than THUMBNAIL_MOST_PX a side: each pixel is the mean of the light that falls on it. An
 * image that is small enough is copied. 0, or -1: out of memory. */
int thumbnail_make(thumbnail *small, const pupil_image_const *rgb8);
void thumbnail_free(thumbnail *small);
pupil_image_const thumbnail_image(const thumbnail *small);

#endif
