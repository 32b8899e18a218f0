#include "upright.h"

#include <stdlib.h>
#include <string.h>

#include "file/video/video_turn.h"
#include "jpeg_segments.h"
#include "tiff_tags.h"

/* Exif begins as a TIFF; some programs put this in front of it, as in JPEG. */
static const uint8_t exif_mark[6] = {'E', 'x', 'i', 'f', 0, 0};

static uint32_t orientation_in(const uint8_t *exif, size_t size)
{
    enum { ORIENTATION = 274 };
    uint32_t value = 1;
    if (size >= sizeof exif_mark && memcmp(exif, exif_mark, sizeof exif_mark) == 0) {
        exif += sizeof exif_mark;
        size -= sizeof exif_mark;
    }
    return pupil_tiff_find(exif, size, ORIENTATION, &value) && value >= 1 && value <= 8 ? value : 1;
}

/* Of several Exif segments the last, as libav takes it. */
static uint32_t orientation_of_jpeg(const uint8_t *bytes, size_t size)
{
    uint32_t orientation = 1;
    pupil_jpeg_segment s;
    for (size_t at = 0; pupil_jpeg_next_segment(bytes, size, &at, &s);)
        if (pupil_jpeg_segment_is(&s, PUPIL_JPEG_APP1, (const char *)exif_mark, sizeof exif_mark))
            orientation = orientation_in(s.at, s.size);
    return orientation;
}

/* Chunks of PNG: length, name, data, checksum. */
static uint32_t orientation_of_png(const uint8_t *bytes, size_t size)
{
    for (size_t at = 8; size >= 12 && at <= size - 12;) {
        const size_t length = pupil_number_at(bytes + at, 4, 1), left = size - at - 12;
        if (length > left)
            break;
        if (memcmp(bytes + at + 4, "eXIf", 4) == 0)
            return orientation_in(bytes + at + 8, length);
        at += 12 + length;
    }
    return 1;
}

/* Chunks of WebP: name, length, data, one byte of padding where the length is odd. */
static uint32_t orientation_of_webp(const uint8_t *bytes, size_t size)
{
    for (size_t at = 12; size >= 8 && at <= size - 8;) {
        const size_t length = pupil_number_at(bytes + at + 4, 4, 0), left = size - at - 8;
        if (length > left)
            break;
        if (memcmp(bytes + at, "EXIF", 4) == 0)
            return orientation_in(bytes + at + 8, length);
        at += 8 + length + length % 2;
    }
    return 1;
}

uint32_t pupil_orientation_of(const uint8_t *bytes, size_t size)
{
    if (pupil_is_jpeg(bytes, size))
        return orientation_of_jpeg(bytes, size);
    if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        return orientation_of_png(bytes, size);
    if (size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0)
        return orientation_of_webp(bytes, size);
    return orientation_in(bytes, size);
}

int pupil_still_make_upright(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    /* xx, xy, yx, yy (video_turn.h): 2 and 4 are mirrored, 3 is upside down, 6 and 8 lie on a side, 5 and 7 both. */
    static const int8_t ways[9][4] = {
        [2] = {-1, 0, 0, 1}, [3] = {-1, 0, 0, -1}, [4] = {1, 0, 0, -1}, [5] = {0, 1, 1, 0},
        [6] = {0, -1, 1, 0}, [7] = {0, -1, -1, 0}, [8] = {0, 1, -1, 0}};
    const int8_t *way = ways[still->as_stored ? 1 : pupil_orientation_of(bytes, size)];
    pupil_video_turn turn = {.xx = way[0], .xy = way[1], .yx = way[2], .yy = way[3]};
    pupil_image_const image = pupil_image_const_of(still->pixels, still->width, still->height, still->pixel);
    if (pupil_video_turn_image(&turn, &image, why))
        return -1;
    if (turn.room) {
        free(still->pixels);
        still->pixels = turn.room;
        still->capacity_bytes = turn.room_bytes;
        still->width = image.width;
        still->height = image.height;
    }
    return 0;
}
