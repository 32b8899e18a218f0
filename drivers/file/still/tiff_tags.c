/* What the first directory of a TIFF 6.0 says. */
#include "tiff_tags.h"

#include <string.h>

enum { SHORT = 3, ENTRY_BYTES = 12 };

uint32_t pupil_number_at(const uint8_t *at, int bytes, int big)
{
    uint32_t n = 0;
    for (int i = 0; i < bytes; i++)
        n |= (uint32_t)at[i] << 8 * (big ? bytes - 1 - i : i);
    return n;
}

static int is_big(const uint8_t *bytes)
{
    return memcmp(bytes, "MM\0*", 4) == 0;
}

int pupil_is_tiff(const uint8_t *bytes, size_t size)
{
    return size >= 8 && (is_big(bytes) || memcmp(bytes, "II*\0", 4) == 0);
}

int pupil_tiff_find(const uint8_t *bytes, size_t size, uint32_t tag, uint32_t *value)
{
    if (!pupil_is_tiff(bytes, size))
        return 0;
    const int big = is_big(bytes);
    const uint64_t first = pupil_number_at(bytes + 4, 4, big);
    if (first + 2 > size)
        return 0;
    const uint32_t entries = pupil_number_at(bytes + first, 2, big);
    for (uint32_t i = 0; i < entries && first + 2 + ENTRY_BYTES * (uint64_t)(i + 1) <= size; i++) {
        const uint8_t *entry = bytes + first + 2 + ENTRY_BYTES * (uint64_t)i;
        if (pupil_number_at(entry, 2, big) != tag)
            continue;
        *value = pupil_number_at(entry + 8, pupil_number_at(entry + 2, 2, big) == SHORT ? 2 : 4, big);
        return 1;
    }
    return 0;
}
