#include "file/common/utf8.h"

#include <stdlib.h>
#include <string.h>

/* Length of the UTF-8 sequence that starts here (The Unicode Standard, table 3-7), 0 where there is none. */
static size_t utf8_length(const unsigned char *s)
{
    size_t length = s[0] < 0x80 ? 1 : s[0] >= 0xc2 && s[0] < 0xe0 ? 2 : (s[0] & 0xf0) == 0xe0 ? 3 : 0;
    if (s[0] >= 0xf0 && s[0] <= 0xf4)
        length = 4;
    for (size_t i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80) /* the end of the text, too, stops here */
            return 0;
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf0 && s[1] < 0x90) ||
        (s[0] == 0xf4 && s[1] > 0x8f))
        return 0;
    return length;
}

char *utf8_of(const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
    char *copy = malloc(3 * strlen(text) + 1), *out = copy;
    while (copy && *s) {
        size_t length = utf8_length(s);
        memcpy(out, length ? (const char *)s : "\xef\xbf\xbd", length ? length : 3);
        out += length ? length : 3;
        s += length ? length : 1;
    }
    if (copy)
        *out = 0;
    return copy;
}
