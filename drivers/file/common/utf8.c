#include "file/common/utf8.h"

#include <stdlib.h>
#include <string.h>

#include "plain_text.h"

char *utf8_of(const char *text)
{
    char *copy = malloc(3 * strlen(text) + 1), *out = copy;
    while (copy && *text) {
        size_t length = pupil_utf8_length(text);
        memcpy(out, length ? text : "\xef\xbf\xbd", length ? length : 3);
        out += length ? length : 3;
        text += length ? length : 1;
    }
    if (copy)
        *out = 0;
    return copy;
}
