/* lib/base/pixel.h: the layout of each format's pixels in memory. */
#ifndef PUPIL_BASE_PIXEL_H
#define PUPIL_BASE_PIXEL_H

#include "pupil/image.h"

typedef struct pupil_pixel_layout {
    uint8_t bytes, unit; /* `unit` pixels have `bytes` bytes in `data`; 0, 0: no such format */
    uint8_t sample;      /* alignment of addresses, bytes */
    uint8_t bits;        /* of a grey or mosaic format's samples; 0: others */
    uint8_t mosaic;
    uint8_t planes;                      /* 1; 2 with `chroma`; 3 with `cr`, too */
    uint8_t chroma_bytes;                /* of a sample in `chroma` (both of Cb Cr), and in `cr`; 0: no such plane */
    uint8_t chroma_columns, chroma_rows; /* of pixels for each of these samples */
    uint8_t yuv;                         /* Y'CbCr: bits of Y'; 0: others */
} pupil_pixel_layout;

pupil_pixel_layout pupil_pixel_layout_of(uint32_t pixel);

/* How many rows belong together: 2 for 4:2:0 and mosaics. */
uint32_t pupil_pixel_rows(uint32_t pixel);

#endif
