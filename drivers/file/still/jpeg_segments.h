/* drivers/file/still/jpeg_segments.h: what a JPEG has in front of its picture: application segments, comments and
 * tables (ITU-T T.81, B.1.1 and B.2.4). */
#ifndef PUPIL_DRIVERS_FILE_STILL_JPEG_SEGMENTS_H
#define PUPIL_DRIVERS_FILE_STILL_JPEG_SEGMENTS_H

#include <stddef.h>
#include <stdint.h>

/* The second byte of the markers of application segments. */
enum { PUPIL_JPEG_APP1 = 0xe1, PUPIL_JPEG_APP2 = 0xe2 };

typedef struct pupil_jpeg_segment {
    uint32_t marker;   /* its second byte */
    const uint8_t *at; /* the content, behind the length */
    size_t size;
} pupil_jpeg_segment;

int pupil_is_jpeg(const uint8_t *bytes, size_t size);

/* The segment at *at, which is moved behind it; an *at of 0 is the first. 0: the picture begins there, or the bytes are
 * no segment, or the segment is not whole. */
int pupil_jpeg_next_segment(const uint8_t *bytes, size_t size, size_t *at, pupil_jpeg_segment *segment);

/* Where the next picture in the file begins, behind the segments that end at `from`: coded pictures do not contain the
 * bytes that a JPEG begins with. size: no other follows. */
size_t pupil_jpeg_next_picture(const uint8_t *bytes, size_t size, size_t from);

/* Whether the content begins with a name, `length` bytes with the zero bytes behind it. */
int pupil_jpeg_segment_is(const pupil_jpeg_segment *segment, uint32_t marker, const char *name, size_t length);

#endif
