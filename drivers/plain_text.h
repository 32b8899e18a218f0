/* drivers/plain_text.h: names and other people's words, before they reach a terminal.
 */
#ifndef PUPIL_DRIVERS_PLAIN_TEXT_H
#define PUPIL_DRIVERS_PLAIN_TEXT_H

#include <stddef.h>

/* Length of the UTF-8 sequence that starts here (The Unicode Standard, table 3-7), 0 where there is none. */
static inline size_t pupil_utf8_length(const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
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

/* Control characters become '?': those of ASCII, U+0080 to U+009F, which terminals obey as well, and bytes that are not
 * UTF-8, which a terminal could take for these. */
static inline void pupil_plain_text(char *text)
{
    while (*text) {
        const unsigned char *s = (const unsigned char *)text;
        const size_t length = pupil_utf8_length(text);
        if (length == 0 || *s < 0x20 || *s == 0x7f)
            *text++ = '?';
        else if (length == 2 && s[0] == 0xc2 && s[1] < 0xa0)
            text[0] = text[1] = '?';
        else
            text += length;
    }
}

#endif
