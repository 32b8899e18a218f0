#include "number.h"

#include <locale.h>
#include <stdlib.h>

double pupil_parse_double(const char *text, char **end)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    double value;
    if (!c)
        return strtod(text, end);
    value = strtod_l(text, end, c);
    freelocale(c);
    return value;
}
