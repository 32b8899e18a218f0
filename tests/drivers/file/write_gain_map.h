/* tests/drivers/file/write_gain_map.h: a JPEG with a gain map, made of flat blocks (write_jpeg.h), with metadata in
 * each form. */
#ifndef PUPIL_TESTS_DRIVERS_WRITE_GAIN_MAP_H
#define PUPIL_TESTS_DRIVERS_WRITE_GAIN_MAP_H

#include <stdio.h>

#include "still_check.h"
#include "write_icc.h"
#include "write_jpeg.h"

/* What a file says, and how. */
typedef struct gain_map_file {
    flat_jpeg base, map;
    const char *xmp;    /* attributes and elements of the map, of namespace hdrgm; NULL: no XMP */
    int names_map;      /* the first picture's XMP says that there is a map */
    int has_iso;        /* ISO 21496-1, with these numbers */
    uint32_t iso_flags; /* 8: with a common denominator */
    double iso[3][5];   /* of each channel: min, max, gamma and the offsets */
    double headroom[2]; /* of the first picture, and of the other one */
    int index;          /* of pictures, MPF: 'M' or 'I', its byte order; 0: none */
    int previews;       /* other pictures in front of the map */
    uint32_t orientation;
    const text *profile; /* of the map; NULL: none */
} gain_map_file;

static inline void add_number(bytes *b, uint32_t value, int count, int order)
{
    for (int i = 0; i < count; i++) {
        const uint8_t byte = (uint8_t)(value >> 8 * (order == 'M' ? count - 1 - i : i));
        add(b, &byte, 1);
    }
}

static inline void add_segment(bytes *b, uint32_t marker, const char *name, size_t name_bytes, const bytes *content)
{
    add_number(b, 0xff00 | marker, 2, 'M');
    add_number(b, (uint32_t)(2 + name_bytes + content->size), 2, 'M');
    add(b, name, name_bytes);
    add(b, content->data, content->size);
}

static inline void add_xmp(bytes *b, const char *properties)
{
    static bytes x;
    char said[3000];
    snprintf(said, sizeof said,
             "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">"
             "<rdf:Description rdf:about=\"\" xmlns:hdrgm=\"http://ns.adobe.com/hdr-gain-map/1.0/\"\n%s"
             "</rdf:Description></rdf:RDF></x:xmpmeta>",
             properties);
    x.size = 0;
    add_text(&x, said);
    add_segment(b, 0xe1, "http://ns.adobe.com/xap/1.0/", 29, &x);
}

static inline void add_fraction(bytes *b, double value, uint32_t common)
{
    const uint32_t under = common ? common : 1000000;
    add_number(b, (uint32_t)(int32_t)lround(value * under), 4, 'M');
    if (!common)
        add_number(b, under, 4, 'M');
}

static inline void add_iso(bytes *b, const gain_map_file *f)
{
    static bytes i;
    const uint32_t common = f->iso_flags & 8 ? 1 << 16 : 0;
    i.size = 0;
    add_number(&i, 0, 4, 'M');
    add_number(&i, f->iso_flags, 1, 'M');
    if (common)
        add_number(&i, common, 4, 'M');
    for (int k = 0; k < 2; k++)
        add_fraction(&i, f->headroom[k], common);
    for (int c = 0; c < (f->iso_flags & 0x80 ? 3 : 1); c++)
        for (int k = 0; k < 5; k++)
            add_fraction(&i, f->iso[c][k], common);
    add_segment(b, 0xe2, "urn:iso:std:iso:ts:21496:-1", 28, &i);
}

/* A JPEG whose first bytes the caller has added. */
static inline void add_jpeg(bytes *b, const flat_jpeg *j)
{
    static uint8_t whole[65536];
    const size_t size = flat_write(j, whole);
    add(b, whole + 2, size - 2);
}

static inline void add_map(bytes *b, const gain_map_file *f)
{
    static bytes icc;
    add(b, "\xff\xd8", 2);
    if (f->xmp)
        add_xmp(b, f->xmp);
    if (f->has_iso)
        add_iso(b, f);
    if (f->profile) {
        icc.size = 0;
        add(&icc, "\1\1", 2);
        add(&icc, f->profile->at, f->profile->size);
        add_segment(b, 0xe2, "ICC_PROFILE", 12, &icc);
    }
    add_jpeg(b, &f->map);
}

/* The index of pictures, whose entries are filled in later: 16 bytes a picture, from `*entries` on; places count from
 * `*from`. */
static inline void add_index(bytes *b, const gain_map_file *f, size_t *from, size_t *entries)
{
    static bytes m;
    const uint32_t pictures = 2 + (uint32_t)f->previews;
    const char order = (char)f->index;
    m.size = 0;
    add(&m, order == 'M' ? "MM\0*" : "II*\0", 4);
    add_number(&m, 8, 4, order);
    add_number(&m, 2, 2, order);
    add_number(&m, 0xb001, 2, order), add_number(&m, 4, 2, order);
    add_number(&m, 1, 4, order), add_number(&m, pictures, 4, order);
    add_number(&m, 0xb002, 2, order), add_number(&m, 7, 2, order);
    add_number(&m, 16 * pictures, 4, order), add_number(&m, (uint32_t)m.size + 8, 4, order);
    add_number(&m, 0, 4, order);
    *entries = m.size;
    for (uint32_t i = 0; i < pictures; i++)
        for (int k = 0; k < 4; k++)
            add_number(&m, 0, 4, order);
    *from = b->size + 8;
    *entries += *from;
    add_segment(b, 0xe2, "MPF", 4, &m);
}

static inline void set_number(bytes *b, size_t at, size_t value, int order)
{
    const size_t size = b->size;
    b->size = at;
    add_number(b, (uint32_t)value, 4, order);
    b->size = size;
}

static inline void add_orientation(bytes *b, uint32_t orientation)
{
    static bytes e;
    e.size = 0;
    add(&e, "MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0", 19);
    add_number(&e, orientation, 1, 'M');
    add(&e, "\0\0\0\0\0\0", 6);
    add_segment(b, 0xe1, "Exif\0", 6, &e);
}

/* The whole file. Returns where the map begins. */
static inline size_t write_gain_map(const gain_map_file *f, bytes *b)
{
    size_t from = 0, entries = 0, at = 0;
    b->size = 0;
    add(b, "\xff\xd8", 2);
    if (f->orientation)
        add_orientation(b, f->orientation);
    if (f->names_map)
        add_xmp(b, "hdrgm:Version=\"1.0\">");
    if (f->index)
        add_index(b, f, &from, &entries);
    add_jpeg(b, &f->base);
    for (int i = 1; i < 2 + f->previews; i++) {
        at = b->size;
        if (i <= f->previews) {
            add(b, "\xff\xd8", 2);
            if (f->names_map)
                add_xmp(b, "hdrgm:Version=\"1.0\">");
            add_jpeg(b, &f->map);
        } else {
            add_map(b, f);
        }
        if (f->index) {
            set_number(b, entries + 16 * (size_t)i + 4, b->size - at, f->index);
            set_number(b, entries + 16 * (size_t)i + 8, at - from, f->index);
        }
    }
    return at;
}

#endif
