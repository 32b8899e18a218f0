/* drivers/file/video/jpeg_parse.h: what a JPEG's segments say, without decoding it (ITU-T T.81, annex B). */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_JPEG_PARSE_H
#define PUPIL_DRIVERS_FILE_VIDEO_JPEG_PARSE_H

#include "pupil/error.h"
#include <stddef.h>
#include <stdint.h>

typedef struct pupil_jpeg_shape {
    uint32_t width, height, components;
    int has_huffman_tables;
} pupil_jpeg_shape;

/* Parses all of it, up to its end, and copies what a decoder needs to `to`, which has room for `size` bytes. Returns
 * the number of bytes copied; 0 and a sentence without its subject where this is no whole JPEG. */
size_t pupil_jpeg_parse(const uint8_t *bytes, size_t size, uint8_t *to, pupil_jpeg_shape *shape, pupil_why *why);

#endif
