/* What the still readers share: refusals, sizes, room for pixels, numbers. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "still_private.h"

int pupil_still_fail(pupil_why *why, const char *format, ...)
{
    va_list arguments;
    if (!why)
        return -1;
    va_start(arguments, format);
    vsnprintf(why->text, sizeof why->text, format, arguments);
    va_end(arguments);
    for (char *c = why->text; *c; c++)
        if (*c < 0x20 || *c > 0x7e)
            *c = '?';
    return -1;
}

int pupil_still_size_ok(uint64_t width, uint64_t height, pupil_why *why)
{
    if (!width || !height)
        return pupil_still_fail(why, "the header promises %llu x %llu pixels; at least 1 x 1 are needed",
                                (unsigned long long)width, (unsigned long long)height);
    if (width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return pupil_still_fail(why, "the header promises %llu x %llu pixels; at most %u a side are read",
                                (unsigned long long)width, (unsigned long long)height, PUPIL_MAX_SIDE_PX);
    if (width * height > PUPIL_STILL_MAX_PIXELS)
        return pupil_still_fail(
            why, "the header promises %llu x %llu pixels; at most %llu in all (8192 x 8192) are read",
            (unsigned long long)width, (unsigned long long)height, (unsigned long long)PUPIL_STILL_MAX_PIXELS);
    return 0;
}

uint64_t pupil_still_most(const pupil_still *still)
{
    return still->most ? still->most : PUPIL_STILL_MAX_PIXELS;
}

int pupil_still_reserve(pupil_still *still, uint64_t width, uint64_t height, uint32_t pixel, pupil_why *why)
{
    size_t need;
    if (pupil_still_size_ok(width, height, why))
        return -1;
    if (width * height > pupil_still_most(still))
        return pupil_still_fail(why, "has %llu x %llu pixels; at most %llu%s are read (--max-pixels)",
                                (unsigned long long)width, (unsigned long long)height,
                                (unsigned long long)pupil_still_most(still),
                                still->max_pixels ? "" : " of a file of so few bytes");
    need = (size_t)(width * height) * pupil_pixel_bytes(pixel);
    if (need > still->capacity_bytes) {
        free(still->pixels);
        still->pixels = malloc(need);
        still->capacity_bytes = still->pixels ? need : 0;
        if (!still->pixels)
            return pupil_still_fail(why, "no memory for %llu x %llu pixels", (unsigned long long)width,
                                    (unsigned long long)height);
    }
    still->width = (uint32_t)width;
    still->height = (uint32_t)height;
    still->pixel = pixel;
    still->exposure_s = 0;
    still->code_light = 0;
    still->notice.text[0] = 0;
    memset(still->window, 0, sizeof still->window);
    return 0;
}
