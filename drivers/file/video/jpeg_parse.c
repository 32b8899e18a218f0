#include "jpeg_parse.h"

#include <string.h>

#include "refuse.h"

/* Markers, ITU-T T.81, table B.1. */
enum {
    SOF0 = 0xc0,
    SOF2 = 0xc2, /* progressive */
    DHT = 0xc4,
    JPG = 0xc8,
    DAC = 0xcc,
    SOF15 = 0xcf,
    RST0 = 0xd0,
    RST7 = 0xd7,
    SOI = 0xd8,
    EOI = 0xd9,
    SOS = 0xda,
    DQT = 0xdb,
    APP0 = 0xe0,
    APP14 = 0xee, /* Adobe's: which colour space */
    APP15 = 0xef,
    COM = 0xfe,
    TEM = 0x01
};

typedef struct parser {
    const uint8_t *bytes;
    size_t size, at;
    uint8_t *to;
    size_t used;
    pupil_jpeg_shape *shape;
    int quantised, scanned;
} parser;

static void copy(parser *p, size_t from, size_t end)
{
    memcpy(p->to + p->used, p->bytes + from, end - from);
    p->used += end - from;
}

static int read_frame(parser *p, const uint8_t *s, size_t length, int marker, pupil_why *why)
{
    if (marker > SOF2)
        return pupil_refuse(why, "a JPEG of process %d; baseline and progressive ones can be read", marker - SOF0);
    if (p->shape->width)
        return pupil_refuse(why, "a damaged JPEG: two frame headers in it");
    if (length < 6 || length < 6 + 3 * (size_t)s[5])
        return pupil_refuse(why, "a damaged JPEG: its frame header has %zu bytes", length);
    if (s[0] != 8)
        return pupil_refuse(why, "a JPEG of %u bits; 8 can be read", s[0]);
    p->shape->height = (uint32_t)s[1] << 8 | s[2];
    p->shape->width = (uint32_t)s[3] << 8 | s[4];
    p->shape->components = s[5];
    if (!p->shape->width || !p->shape->height)
        return pupil_refuse(why, "a damaged JPEG: its frame header says %u x %u pixels", p->shape->width,
                            p->shape->height);
    return 0;
}

/* From a scan's header to the next marker other than a restart. In coded data, each 0xff is followed by 0. */
static void skip_scan(parser *p)
{
    while (p->at < p->size) {
        const uint8_t *found = memchr(p->bytes + p->at, 0xff, p->size - p->at);
        p->at = found ? (size_t)(found - p->bytes) : p->size;
        if (p->at + 1 >= p->size)
            break;
        const uint8_t next = p->bytes[p->at + 1];
        if (next != 0 && next != 0xff && (next < RST0 || next > RST7))
            return;
        p->at += next == 0xff ? 1 : 2;
    }
    p->at = p->size;
}

/* A segment with its marker at `from`. 0; 1: it was the end; -1 and a sentence. */
static int take_segment(parser *p, size_t from, int marker, pupil_why *why)
{
    if (marker == EOI) {
        p->to[p->used++] = 0xff;
        p->to[p->used++] = EOI;
        return 1;
    }
    const size_t left = p->size - p->at;
    const size_t length = left >= 2 ? (size_t)p->bytes[p->at] << 8 | p->bytes[p->at + 1] : 0;
    if (left < 2 || length > left)
        return pupil_refuse(why, "a JPEG that is cut short: it ends in its headers, after %zu bytes", p->size);
    if (length < 2)
        return pupil_refuse(why, "a damaged JPEG: a segment of %zu bytes at byte %zu", length, from);
    const uint8_t *content = p->bytes + p->at + 2;
    p->at += length;
    if (marker >= SOF0 && marker <= SOF15 && marker != DHT && marker != JPG && marker != DAC) {
        if (read_frame(p, content, length - 2, marker, why))
            return -1;
    }
    p->shape->has_huffman_tables |= marker == DHT;
    p->quantised |= marker == DQT;
    if (marker == SOS) {
        if (!p->shape->width || !p->quantised)
            return pupil_refuse(why, "a damaged JPEG: it has no %s before its picture",
                                p->shape->width ? "quantisation table" : "frame header");
        p->scanned = 1;
        skip_scan(p);
    }
    if (!(marker >= APP0 && marker <= APP15 && marker != APP14) && marker != COM)
        copy(p, from, p->at);
    return 0;
}

size_t pupil_jpeg_parse(const uint8_t *bytes, size_t size, uint8_t *to, pupil_jpeg_shape *shape, pupil_why *why)
{
    parser p = {.bytes = bytes, .size = size, .to = to, .shape = shape};
    *shape = (pupil_jpeg_shape){0};
    if (size < 4 || bytes[0] != 0xff || bytes[1] != SOI) {
        pupil_refuse(why, "no JPEG: its %zu bytes do not begin with one", size);
        return 0;
    }
    p.at = 2;
    copy(&p, 0, 2);
    while (p.at + 1 < size) {
        const size_t from = p.at;
        const int marker = bytes[from + 1];
        if (bytes[from] != 0xff || marker == 0 || marker == TEM || (marker >= RST0 && marker <= SOI)) {
            pupil_refuse(why, "a damaged JPEG: no segment at byte %zu", from);
            return 0;
        }
        p.at += marker == 0xff ? 1 : 2; /* fill bytes, B.1.1.2 */
        const int got = marker == 0xff ? 0 : take_segment(&p, from, marker, why);
        if (got < 0)
            return 0;
        if (got > 0 && p.scanned)
            return p.used;
        if (got > 0)
            break;
    }
    if (p.at + 1 < size || p.scanned == 0)
        pupil_refuse(why, "a damaged JPEG: there is no picture in its %zu bytes", size);
    else
        pupil_refuse(why, "a JPEG that is cut short: its %zu bytes have no end", size);
    return 0;
}
