/* tests/drivers/file/write_jpeg.h: a JPEG made of flat blocks of 8 x 8 samples, which any decoder reproduces exactly.
 *
 * All quantisers are 8, so a block's only coefficient is its value less 128. One Huffman table for all components:
 * K.3's of luminance (ITU-T T.81, annex K), or, where own_tables is set, one in which the codes are assigned again. */
#ifndef PUPIL_TESTS_DRIVERS_WRITE_JPEG_H
#define PUPIL_TESTS_DRIVERS_WRITE_JPEG_H

#include <stdint.h>
#include <string.h>

typedef struct flat_jpeg {
    uint32_t width, height;
    uint32_t components;     /* 1: grey, 3 */
    uint32_t across, down;   /* luma samples for each of chroma: 1 or 2 (4 across: 4:1:1) */
    uint64_t seed;           /* of the blocks' values */
    int own_tables;          /* 0: none at all, as a webcam's */
    int standard_tables;     /* 1: K.3's, written out */
    int progressive, extras; /* extras: application segments and a comment, with an end marker inside */
} flat_jpeg;

/* The value of a component's block. */
static inline uint8_t flat_value(const flat_jpeg *j, uint32_t component, uint32_t column, uint32_t row)
{
    uint64_t z = j->seed + UINT64_C(0x9e3779b97f4a7c15) * (1 + component + 4 * column + 65536 * (uint64_t)row);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (uint8_t)(z >> 40);
}

typedef struct flat_writer {
    uint8_t *to;
    size_t used;
    uint32_t bits, count;
} flat_writer;

static inline void flat_byte(flat_writer *w, uint32_t byte)
{
    w->to[w->used++] = (uint8_t)byte;
}

static inline void flat_bits(flat_writer *w, uint32_t value, uint32_t count)
{
    for (uint32_t i = count; i-- > 0;) {
        w->bits = w->bits << 1 | (value >> i & 1);
        if (++w->count % 8)
            continue;
        flat_byte(w, w->bits & 0xff);
        if ((w->bits & 0xff) == 0xff)
            flat_byte(w, 0);
    }
}

static inline void flat_segment(flat_writer *w, uint32_t marker, const uint8_t *content, size_t size)
{
    flat_byte(w, 0xff);
    flat_byte(w, marker);
    flat_byte(w, (uint32_t)(size + 2) >> 8);
    flat_byte(w, (uint32_t)(size + 2) & 0xff);
    memcpy(w->to + w->used, content, size);
    w->used += size;
}

/* Lengths of the codes of K.3's table of DC differences, in order: 2, five of 3, then one of each up to 9. */
static inline void flat_difference(flat_writer *w, const flat_jpeg *j, int difference)
{
    static const uint32_t lengths[] = {2, 3, 3, 3, 3, 3, 4, 5, 6, 7, 8, 9};
    static const uint32_t codes[] = {0, 2, 3, 4, 5, 6, 14, 30, 62, 126, 254, 510};
    uint32_t size = 0;
    while (difference >= 1 << size || -difference >= 1 << size)
        size++;
    const uint32_t symbol = j->own_tables ? 11 - size : size;
    flat_bits(w, codes[symbol], lengths[symbol]);
    flat_bits(w, (uint32_t)(difference > 0 ? difference : difference + (1 << size) - 1), size);
    if (!j->progressive)
        flat_bits(w, j->own_tables ? 0 : 10, j->own_tables ? 1 : 4); /* end of block */
}

static inline void flat_tables(flat_writer *w, const flat_jpeg *j)
{
    uint8_t quantisers[65] = {0}, dc[29] = {0}, ac[21] = {0x10};
    memset(quantisers + 1, 8, 64);
    flat_segment(w, 0xdb, quantisers, sizeof quantisers);
    dc[2] = 1, dc[3] = 5; /* how many codes of 2 bits, of 3, ... */
    for (int i = 4; i <= 9; i++)
        dc[i] = 1;
    for (int i = 0; i < 12; i++)
        dc[17 + i] = (uint8_t)(j->own_tables ? 11 - i : i);
    /* Of AC, only the end of block is used: the one-bit code 0; or 1010, the fourth of the four-bit codes. */
    static const uint8_t k3[] = {0x10, 0, 2, 1, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0, 4, 0x11};
    ac[1] = 1;
    if (j->own_tables || j->standard_tables)
        flat_segment(w, 0xc4, dc, sizeof dc);
    if (j->own_tables)
        flat_segment(w, 0xc4, ac, 18);
    else if (j->standard_tables)
        flat_segment(w, 0xc4, k3, sizeof k3);
}

static inline void flat_headers(flat_writer *w, const flat_jpeg *j)
{
    const uint8_t sampling = (uint8_t)(j->components == 1 ? 0x11 : j->across << 4 | j->down);
    const uint8_t frame[] = {8,
                             (uint8_t)(j->height >> 8),
                             (uint8_t)j->height,
                             (uint8_t)(j->width >> 8),
                             (uint8_t)j->width,
                             (uint8_t)j->components,
                             1,
                             sampling,
                             0,
                             2,
                             0x11,
                             0,
                             3,
                             0x11,
                             0};
    flat_byte(w, 0xff), flat_byte(w, 0xd8);
    if (j->extras) {
        static const uint8_t strange[] = "AVI1\0 with\xff\xd9 an end in it";
        flat_segment(w, 0xe0, strange, sizeof strange);
        flat_segment(w, 0xe1, strange, 3);
        flat_segment(w, 0xfe, (const uint8_t *)"CS=ITU601", 9);
        flat_byte(w, 0xff); /* fill */
    }
    flat_tables(w, j);
    flat_segment(w, j->progressive ? 0xc2 : 0xc0, frame, 6 + 3 * j->components);
    const uint8_t grey_scan[] = {1, 1, 0, 0, j->progressive ? 0 : 63, 0};
    const uint8_t scan[] = {3, 1, 0, 2, 0, 3, 0, 0, j->progressive ? 0 : 63, 0};
    flat_segment(w, 0xda, j->components == 1 ? grey_scan : scan, j->components == 1 ? sizeof grey_scan : sizeof scan);
}

/* `to` has room for 1000 bytes and 8 for each block. Bytes written. */
static inline size_t flat_write(const flat_jpeg *j, uint8_t *to)
{
    flat_writer w = {.to = to};
    const uint32_t across = j->components == 1 ? 1 : j->across, down = j->components == 1 ? 1 : j->down;
    int last[3] = {0, 0, 0};
    flat_headers(&w, j);
    for (uint32_t my = 0; my * 8 * down < j->height; my++)
        for (uint32_t mx = 0; mx * 8 * across < j->width; mx++)
            for (uint32_t c = 0; c < j->components; c++)
                for (uint32_t i = 0; i < (c ? 1 : across * down); i++) {
                    const uint32_t column = c ? mx : mx * across + i % across, row = c ? my : my * down + i / across;
                    const int value = flat_value(j, c, column, row) - 128;
                    flat_difference(&w, j, value - last[c]);
                    last[c] = value;
                }
    while (w.count % 8)
        flat_bits(&w, 1, 1);
    flat_byte(&w, 0xff), flat_byte(&w, 0xd9);
    return w.used;
}

#endif
