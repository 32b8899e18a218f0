/* Where the gain map of a JPEG is, and what its metadata say. */
#include "gain_map.h"

#include <string.h>

#include "jpeg_segments.h"
#include "number.h"
#include "refuse.h"
#include "tiff_tags.h"

/* Pictures of a file that are looked at: cameras write two to four. */
#define MOST_PICTURES 32

/* What segments begin with: XMP specification part 3, 1.1.3; ISO 21496-1:2025, annex on JPEG; CIPA DC-007, 5.2. */
static const char xmp_mark[] = "http://ns.adobe.com/xap/1.0/";
static const char iso_mark[] = "urn:iso:std:iso:ts:21496:-1";
static const char mpf_mark[] = "MPF";
static const char gain_map_namespace[] = "http://ns.adobe.com/hdr-gain-map/1.0/";

typedef struct span {
    const uint8_t *at;
    size_t size;
} span;

/* The numbers of a map: names of Adobe's Gain Map specification 1.0, its defaults, and the values that are believed. In
 * the order of ISO 21496-1. */
static const struct property {
    const char *name;
    size_t offset; /* in pupil_gain_map: a double[3] */
    double usual, least, most;
    int is_needed, is_signed; /* signed: in ISO's form */
} properties[] = {
    {"GainMapMin", offsetof(pupil_gain_map, min_ev), 0, -32, 32, 0, 1},
    {"GainMapMax", offsetof(pupil_gain_map, max_ev), 0, -32, 32, 1, 1},
    {"Gamma", offsetof(pupil_gain_map, gamma), 1, 1 / 64., 64, 0, 0},
    {"OffsetSDR", offsetof(pupil_gain_map, sdr_offset), 1 / 64., 0, 1024, 0, 1},
    {"OffsetHDR", offsetof(pupil_gain_map, hdr_offset), 1 / 64., 0, 1024, 0, 1},
};
enum { PROPERTIES = sizeof properties / sizeof *properties };

/* What the metadata of a picture say; -1: they are damaged, and there is a sentence. */
enum { NO_MAP, MAP_TO_HDR, MAP_TO_SDR };

/* Its three numbers. */
static double *numbers_of(pupil_gain_map *map, const struct property *p)
{
    return (double *)(void *)((char *)map + p->offset);
}

static int set_number(pupil_gain_map *map, const struct property *p, int channel, double value, pupil_why *why)
{
    if (!(value >= p->least && value <= p->most))
        return pupil_refuse(why, "it has the %s %g; %g to %g is read", p->name, value, p->least, p->most);
    numbers_of(map, p)[channel] = value;
    return 0;
}

/* --- XMP --- */

/* The place of a text behind `from`; its size where there is none. */
static size_t find(span in, size_t from, const char *text)
{
    const uint8_t *at = from < in.size ? memmem(in.at + from, in.size - from, text, strlen(text)) : NULL;
    return at ? (size_t)(at - in.at) : in.size;
}

static int is_space(uint8_t c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static size_t skip_spaces(span in, size_t at)
{
    while (at < in.size && is_space(in.at[at]))
        at++;
    return at;
}

/* What a property holds: the value of an attribute, or all between the tags of an element. An `at` of NULL: the text
 * lacks it, or it does not end. */
static span value_of(span xmp, const char *name)
{
    char end[40];
    const int length = snprintf(end, sizeof end, "</hdrgm:%s", name) - 2;
    const char *full = end + 2;
    for (size_t at = find(xmp, 1, full); at < xmp.size; at = find(xmp, at + 1, full)) {
        size_t from = skip_spaces(xmp, at + (size_t)length), to = xmp.size;
        if (xmp.at[at - 1] == '<') {
            from = find(xmp, from, ">") + 1;
            to = find(xmp, from, end);
        } else if (is_space(xmp.at[at - 1]) && from < xmp.size && xmp.at[from] == '=') {
            from = skip_spaces(xmp, from + 1) + 1;
            to = from < xmp.size ? find(xmp, from, xmp.at[from - 1] == '\'' ? "'" : "\"") : xmp.size;
        } else {
            continue;
        }
        return to < xmp.size ? (span){xmp.at + from, to - from} : (span){NULL, 0};
    }
    return (span){NULL, 0};
}

/* A number that fills the text, but for spaces around it. 0: it is none. */
static int read_number(span text, double *value)
{
    char copy[40], *end;
    size_t from = skip_spaces(text, 0), to = text.size;
    while (to > from && is_space(text.at[to - 1]))
        to--;
    if (to == from || to - from >= sizeof copy)
        return 0;
    memcpy(copy, text.at + from, to - from);
    copy[to - from] = 0;
    *value = pupil_parse_double(copy, &end);
    return !*end;
}

/* The three items of a list (rdf:Seq of rdf:li), or one; of anything else the number itself. Returns how many there
 * are; 0: none, or one that is no number. */
static int read_numbers(span text, double values[3])
{
    static const char item[] = "<rdf:li";
    int count = 0;
    for (size_t at = find(text, 0, item); at < text.size && count < 3; at = find(text, at, item)) {
        const size_t from = find(text, at, ">") + 1, to = find(text, at + 1, "<");
        if (from > to || to >= text.size || !read_number((span){text.at + from, to - from}, &values[count++]))
            return 0;
        at = to;
    }
    return count == 2 ? 0 : count ? count : read_number(text, values);
}

static int read_xmp(span xmp, pupil_gain_map *map, pupil_why *why)
{
    const span version = value_of(xmp, "Version"), is_hdr = value_of(xmp, "BaseRenditionIsHDR");
    if (version.at && (version.size < 2 || memcmp(version.at, "1.", 2) != 0))
        return pupil_refuse(why, "its metadata are of another version than 1.0");
    for (int i = 0; i < PROPERTIES; i++) {
        const struct property *p = &properties[i];
        const span text = value_of(xmp, p->name);
        double value[3] = {p->usual};
        const int count = text.at ? read_numbers(text, value) : !p->is_needed;
        if (!count)
            return pupil_refuse(why, "its metadata have no %s that is a number", p->name);
        for (int c = 0; c < 3; c++)
            if (set_number(map, p, c, value[count == 3 ? c : 0], why))
                return -1;
    }
    return is_hdr.at && is_hdr.size == 4 && memcmp(is_hdr.at, "True", 4) == 0 ? MAP_TO_SDR : MAP_TO_HDR;
}

/* --- ISO 21496-1 --- */

/* A fraction: the numerator, and behind it (or once for all) the denominator. Moves on; 0: the bytes have ended. */
static int read_fraction(span *in, uint32_t common, int is_signed, double *value)
{
    if (in->size < (common ? 4u : 8u))
        return 0;
    const uint32_t over = pupil_number_at(in->at, 4, 1), under = common ? common : pupil_number_at(in->at + 4, 4, 1);
    *value = (is_signed && over >> 31 ? (double)over - 0x1p32 : over) / under; /* of 0: infinite, or no number */
    in->at += common ? 4 : 8;
    in->size -= common ? 4 : 8;
    return 1;
}

/* The versions are two numbers of 2 bytes, then come the flags. A common denominator, and the direction, are those of
 * libultrahdr's files. */
static int read_iso(span in, pupil_gain_map *map, pupil_why *why)
{
    enum { HEAD = 5, THREE = 0x80, BASE_PRIMARIES = 0x40, COMMON = 8, TO_SDR = 4 };
    static const char cut[] = "its metadata (ISO 21496-1) are cut short";
    const uint32_t flags = in.size >= HEAD ? in.at[4] : 0;
    uint32_t common = 0;
    double base_ev = 0, other_ev = 0, value = 0;
    if (in.size < HEAD + 4)
        return pupil_refuse(why, "%s", cut);
    if (pupil_number_at(in.at, 2, 1) != 0)
        return pupil_refuse(why, "its metadata (ISO 21496-1) are of version %u; 0 is read",
                            pupil_number_at(in.at, 2, 1));
    in = (span){in.at + HEAD, in.size - HEAD};
    if (flags & COMMON) {
        common = pupil_number_at(in.at, 4, 1);
        in = (span){in.at + 4, in.size - 4};
        if (!common)
            return pupil_refuse(why, "its metadata (ISO 21496-1) have a denominator of 0");
    }
    if (!read_fraction(&in, common, 0, &base_ev) || !read_fraction(&in, common, 0, &other_ev))
        return pupil_refuse(why, "%s", cut);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < PROPERTIES; i++) {
            const struct property *p = &properties[i];
            if (c && !(flags & THREE))
                value = numbers_of(map, p)[0];
            else if (!read_fraction(&in, common, p->is_signed, &value))
                return pupil_refuse(why, "%s", cut);
            if (set_number(map, p, c, value, why))
                return -1;
        }
    map->has_own_primaries = !(flags & BASE_PRIMARIES);
    return flags & TO_SDR || base_ev > other_ev ? MAP_TO_SDR : MAP_TO_HDR;
}

/* --- where it is --- */

/* The namespace's property in an XMP segment: a map's, or that of a picture with a map. */
static int is_gain_map_xmp(const pupil_jpeg_segment *s)
{
    return pupil_jpeg_segment_is(s, PUPIL_JPEG_APP1, xmp_mark, sizeof xmp_mark) &&
           find((span){s->at, s->size}, sizeof xmp_mark, gain_map_namespace) < s->size;
}

/* The first picture: whether it says that the file has a map (a version alone), and its index of pictures. Returns
 * where its segments end. */
static size_t read_first(span file, int *is_promised, span *index)
{
    pupil_jpeg_segment s;
    size_t at = 0;
    *is_promised = 0;
    *index = (span){NULL, 0};
    while (pupil_jpeg_next_segment(file.at, file.size, &at, &s)) {
        *is_promised |= (is_gain_map_xmp(&s) && value_of((span){s.at, s.size}, "Version").at) ||
                        pupil_jpeg_segment_is(&s, PUPIL_JPEG_APP2, iso_mark, sizeof iso_mark);
        if (pupil_jpeg_segment_is(&s, PUPIL_JPEG_APP2, mpf_mark, sizeof mpf_mark))
            *index = (span){s.at + sizeof mpf_mark, s.size - sizeof mpf_mark};
    }
    return at;
}

/* The metadata of one picture. *end: how far its segments go. */
static int read_picture(span picture, pupil_gain_map *map, size_t *end, pupil_why *why)
{
    pupil_jpeg_segment s;
    span iso = {NULL, 0}, xmp = {NULL, 0};
    *end = 0;
    while (pupil_jpeg_next_segment(picture.at, picture.size, end, &s))
        if (pupil_jpeg_segment_is(&s, PUPIL_JPEG_APP2, iso_mark, sizeof iso_mark))
            iso = (span){s.at + sizeof iso_mark, s.size - sizeof iso_mark};
        else if (is_gain_map_xmp(&s))
            xmp = (span){s.at + sizeof xmp_mark, s.size - sizeof xmp_mark};
    *map = (pupil_gain_map){.jpeg = picture.at, .jpeg_bytes = picture.size};
    const int by_iso = iso.at ? read_iso(iso, map, why) : -1;
    if (by_iso >= 0 || !xmp.at)
        return iso.at ? by_iso : NO_MAP;
    map->has_own_primaries = 0;
    return read_xmp(xmp, map, why);
}

/* The same of one of several: what was found before, where it has no map. */
static int read_another(span picture, int before, pupil_gain_map *map, size_t *end, pupil_why *why)
{
    const int found = read_picture(picture, map, end, why);
    return found == NO_MAP ? before : found;
}

/* CIPA DC-007, 5.2.3: a TIFF's directory, whose entries are 16 bytes a picture: attributes, size, place. Places count
 * from the index's own beginning; 0 is the first picture. */
static int find_by_index(span file, span index, pupil_gain_map *map, pupil_why *why)
{
    enum { NUMBER_OF_IMAGES = 0xb001, MP_ENTRY = 0xb002, ENTRY = 16 };
    const int big = index.size && index.at[0] == 'M';
    uint32_t pictures = 0, entries = 0;
    size_t end;
    int found = NO_MAP;
    if (!pupil_tiff_find(index.at, index.size, NUMBER_OF_IMAGES, &pictures) ||
        !pupil_tiff_find(index.at, index.size, MP_ENTRY, &entries))
        return NO_MAP;
    for (uint32_t i = 1; i < pictures && i < MOST_PICTURES && found <= NO_MAP; i++) {
        const uint64_t entry = entries + (uint64_t)i * ENTRY;
        if (entry + ENTRY > index.size)
            break;
        const uint64_t size = pupil_number_at(index.at + entry + 4, 4, big);
        const uint64_t from = pupil_number_at(index.at + entry + 8, 4, big), at = (uint64_t)(index.at - file.at) + from;
        if (from && at < file.size)
            found = read_another((span){file.at + at, size && size < file.size - at ? size : file.size - at}, found,
                                 map, &end, why);
    }
    return found;
}

/* Among the pictures that follow. */
static int find_behind(span file, size_t at, pupil_gain_map *map, pupil_why *why)
{
    int found = NO_MAP;
    for (int i = 0; i < MOST_PICTURES && found <= NO_MAP; i++) {
        size_t end;
        at = pupil_jpeg_next_picture(file.at, file.size, at);
        if (at >= file.size)
            break;
        found = read_another((span){file.at + at, file.size - at}, found, map, &end, why);
        at += end;
    }
    return found;
}

int pupil_gain_map_find(const uint8_t *bytes, size_t size, pupil_gain_map *map, pupil_why *why)
{
    const span file = {bytes, size};
    span index;
    int is_promised;
    const size_t end = read_first(file, &is_promised, &index);
    int found = index.at ? find_by_index(file, index, map, why) : NO_MAP;
    if (found == NO_MAP && is_promised) {
        found = find_behind(file, end, map, why);
        if (found == NO_MAP)
            return pupil_refuse(why, "it is not in the file, which was cut, or written again without it");
    }
    return found < 0 ? -1 : found == MAP_TO_HDR;
}
