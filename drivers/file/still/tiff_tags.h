/* drivers/file/still/tiff_tags.h: what the first directory of a TIFF says. */
#ifndef PUPIL_DRIVERS_FILE_STILL_TIFF_TAGS_H
#define PUPIL_DRIVERS_FILE_STILL_TIFF_TAGS_H

#include <stddef.h>
#include <stdint.h>

/* Whether the bytes begin as a TIFF 6.0 with a header. */
int pupil_is_tiff(const uint8_t *bytes, size_t size);

/* The value of a tag of the first directory of a TIFF 6.0, the first where it has several. 0: it has none, or the bytes
 * are no TIFF. */
int pupil_tiff_find(const uint8_t *bytes, size_t size, uint32_t tag, uint32_t *value);

/* A number of 1 to 4 bytes, with the highest byte first (big) or last. */
uint32_t pupil_number_at(const uint8_t *at, int bytes, int big);

#endif
