/* lib/base/pixel.h: the layout of each format's pixels in memory. */
#ifndef PUPIL_BASE_PIXEL_H
#define PUPIL_BASE_PIXEL_H

#include "pupil/image.h"

typedef struct pupil_pixel_layout {
    uint8_t bytes, unit; /* `unit` pixels have `bytes` bytes in `data`; 0, 0: no such format */
    uint8_t sample;      /* bytes that an address is a multiple of */
    uint8_t bits;        /* of a grey or mosaic format's samples; 0: others */
    uint8_t mosaic;
} pupil_pixel_layout;

pupil_pixel_layout pupil_pixel_layout_of(uint32_t pixel);

/* How many rows belong together: 2 for NV12 and mosaics. */
uint32_t pupil_pixel_rows(uint32_t pixel);

#endif
