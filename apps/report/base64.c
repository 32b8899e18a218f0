#include "base64.h"

static void group(FILE *out, const unsigned char *bytes, size_t count)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t word = (uint32_t)bytes[0] << 16 | (count > 1 ? (uint32_t)bytes[1] << 8 : 0) | (count > 2 ? bytes[2] : 0u);
    putc(digit[word >> 18], out);
    putc(digit[word >> 12 & 63], out);
    putc(count > 1 ? digit[word >> 6 & 63] : '=', out);
    putc(count > 2 ? digit[word & 63] : '=', out);
}

int base64_write(FILE *out, FILE *in, uint64_t most)
{
    unsigned char bytes[3 * 4096]; /* whole groups, so that only the last can be padded */
    size_t got;
    while (most && (got = fread(bytes, 1, sizeof bytes < most ? sizeof bytes : (size_t)most, in)) > 0) {
        for (size_t i = 0; i < got; i += 3)
            group(out, bytes + i, got - i < 3 ? got - i : 3);
        most -= got;
    }
    if (ferror(in))
        return -1;
    return most == 0 && getc(in) != EOF;
}
