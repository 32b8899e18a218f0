/* tests/drivers/file/write_dng.h: a small DNG (1.4): one strip of 16-bit samples, of a mosaic or linear. */
#ifndef PUPIL_TESTS_WRITE_DNG_H
#define PUPIL_TESTS_WRITE_DNG_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct dng {
    uint32_t width, height;
    int is_linear;          /* three samples per pixel; else an RGGB mosaic */
    uint32_t black, white;  /* codes */
    uint32_t neutral[3];    /* of a white surface, in thousandths of white */
    uint16_t orientation;   /* of TIFF; 1: upright */
    const uint16_t *sample; /* row by row */
} dng;

enum { DNG_TAGS = 21, DNG_HEAD = 8 + 2 + 12 * DNG_TAGS + 4, DNG_MORE = 160 };

typedef struct dng_writer {
    uint8_t *bytes;
    uint32_t tags, more; /* written so far, and where the next values go */
} dng_writer;

static inline void dng_put(uint8_t *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

/* Values of `each` bytes, inline if they fit into four. */
static inline void dng_tag(dng_writer *w, uint32_t tag, uint32_t type, uint32_t count, int each, const uint32_t *values)
{
    uint8_t *entry = w->bytes + 10 + 12 * w->tags++;
    const uint32_t items = type == 5 || type == 10 ? 2 * count : count;
    dng_put(entry, tag, 2);
    dng_put(entry + 2, type, 2);
    dng_put(entry + 4, count, 4);
    uint8_t *to = entry + 8;
    if (items * (uint32_t)each > 4) {
        dng_put(entry + 8, w->more, 4);
        to = w->bytes + w->more;
        w->more += items * (uint32_t)each;
    }
    for (uint32_t i = 0; i < items; i++)
        dng_put(to + i * (uint32_t)each, values[i], each);
}

static inline void dng_short(dng_writer *w, uint32_t tag, uint32_t value)
{
    dng_tag(w, tag, 3, 1, 2, &value);
}

static inline void dng_long(dng_writer *w, uint32_t tag, uint32_t value)
{
    dng_tag(w, tag, 4, 1, 4, &value);
}

/* XYZ to the camera's RGB, here Rec.709 with D65 (IEC 61966-2-1), in ten thousandths. */
static const int32_t dng_matrix[9] = {32406, -15372, -4986, -9689, 18758, 415, 557, -2040, 10570};

/* The file's size in bytes, at most DNG_HEAD + DNG_MORE + 2 a sample. */
static inline size_t dng_make(const dng *d, uint8_t *bytes)
{
    dng_writer w = {bytes, 0, DNG_HEAD};
    const uint32_t samples = d->is_linear ? 3 : 1, data = DNG_HEAD + DNG_MORE;
    const uint32_t size = d->width * d->height * samples * 2, none = 0, bits[3] = {16, 16, 16};
    const uint32_t model[8] = {'p', 'u', 'p', 'i', 'l', ' ', '1', 0}, version[4] = {1, 4, 0, 0};
    const uint32_t dim[2] = {2, 2}, pattern[4] = {0, 1, 1, 2};
    uint32_t matrix[18], neutral[6];
    for (int i = 0; i < 9; i++) {
        matrix[2 * i] = (uint32_t)dng_matrix[i];
        matrix[2 * i + 1] = 10000;
    }
    for (int i = 0; i < 3; i++) {
        neutral[2 * i] = d->neutral[i];
        neutral[2 * i + 1] = 1000;
    }
    memset(bytes, 0, data);
    memcpy(bytes, "II*\0\10\0\0\0", 8);
    dng_long(&w, 254, none);
    dng_long(&w, 256, d->width);
    dng_long(&w, 257, d->height);
    dng_tag(&w, 258, 3, samples, 2, bits);
    dng_short(&w, 259, 1);
    dng_short(&w, 262, d->is_linear ? 34892 : 32803);
    dng_tag(&w, 271, 2, 8, 1, model);
    dng_tag(&w, 272, 2, 8, 1, model);
    dng_long(&w, 273, data);
    dng_short(&w, 274, d->orientation);
    dng_short(&w, 277, samples);
    dng_long(&w, 278, d->height);
    dng_long(&w, 279, size);
    dng_short(&w, 284, 1);
    if (!d->is_linear) {
        dng_tag(&w, 33421, 3, 2, 2, dim);
        dng_tag(&w, 33422, 1, 4, 1, pattern);
    }
    dng_tag(&w, 50706, 1, 4, 1, version);
    dng_long(&w, 50714, d->black);
    dng_long(&w, 50717, d->white);
    dng_tag(&w, 50721, 10, 9, 4, matrix);
    dng_tag(&w, 50728, 5, 3, 4, neutral);
    dng_put(bytes + 8, w.tags, 2);
    for (uint32_t i = 0; i < size / 2; i++)
        dng_put(bytes + data + 2 * i, d->sample[i], 2);
    return data + size;
}

#endif
