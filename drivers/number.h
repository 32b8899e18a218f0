/* drivers/number.h: numbers in files and in texts, which have a point in every locale. In a header, because all symbols
 * of libpupil-camera.a begin with pupil_camera_. */
#ifndef PUPIL_DRIVERS_NUMBER_H
#define PUPIL_DRIVERS_NUMBER_H

#include <locale.h>
#include <stdlib.h>

/* strtod as in the C locale, whatever locale the program runs in. */
static inline double pupil_parse_double(const char *text, char **end)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    double value;
    if (!c)
        return strtod(text, end);
    value = strtod_l(text, end, c);
    freelocale(c);
    return value;
}

#endif
