#include "jpeg_segments.h"

#include <string.h>

#include "tiff_tags.h"

/* ITU-T T.81, table B.1. */
enum { DHT = 0xc4, SOI = 0xd8, DQT = 0xdb, DRI = 0xdd, APP0 = 0xe0, COM = 0xfe };

int pupil_is_jpeg(const uint8_t *bytes, size_t size)
{
    return size >= 2 && bytes[0] == 0xff && bytes[1] == SOI;
}

int pupil_jpeg_next_segment(const uint8_t *bytes, size_t size, size_t *at, pupil_jpeg_segment *segment)
{
    if (!*at && pupil_is_jpeg(bytes, size))
        *at = 2;
    if (!*at || size < 4 || *at > size - 4)
        return 0;
    const uint8_t *marker = bytes + *at;
    const size_t length = pupil_number_at(marker + 2, 2, 1);
    const int is_table = marker[1] == DHT || marker[1] == DQT || marker[1] == DRI;
    if (marker[0] != 0xff || length < 2 || length > size - *at - 2)
        return 0;
    if (!is_table && marker[1] != COM && (marker[1] & 0xf0) != APP0)
        return 0;
    *segment = (pupil_jpeg_segment){marker[1], marker + 4, length - 2};
    *at += 2 + length;
    return 1;
}

size_t pupil_jpeg_next_picture(const uint8_t *bytes, size_t size, size_t from)
{
    static const uint8_t first[3] = {0xff, SOI, 0xff};
    const uint8_t *at = from < size ? memmem(bytes + from, size - from, first, sizeof first) : NULL;
    return at ? (size_t)(at - bytes) : size;
}

int pupil_jpeg_segment_is(const pupil_jpeg_segment *segment, uint32_t marker, const char *name, size_t length)
{
    return segment->marker == marker && segment->size >= length && memcmp(segment->at, name, length) == 0;
}
