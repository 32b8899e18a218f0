/* Portable float map: "PF", "Pf" or "PF4", width, height, a scale whose sign is the byte order, then rows from the
 * bottom up (Debevec; netpbm's pfm). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "number.h"
#include "still_private.h"

typedef struct pfm {
    uint64_t width, height;
    uint32_t channels;
    int big_endian;
    size_t start; /* of the samples */
} pfm;

static int is_space(uint8_t c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* The next word of the header, NUL-terminated; 0 where there is none of a sane length. */
static int word(const uint8_t *bytes, size_t size, size_t *at, char text[32])
{
    size_t length = 0;
    while (*at < size && is_space(bytes[*at]))
        ++*at;
    while (*at < size && !is_space(bytes[*at]) && length < 31)
        text[length++] = (char)bytes[(*at)++];
    text[length] = 0;
    return length > 0 && *at < size && is_space(bytes[*at]);
}

static int side(const char *text, uint64_t *value)
{
    *value = 0;
    for (; *text >= '0' && *text <= '9'; text++)
        *value = *value > UINT32_MAX ? *value : *value * 10 + (uint64_t)(*text - '0');
    return *text == 0;
}

static int read_header(pfm *p, const uint8_t *bytes, size_t size, pupil_why *why)
{
    char text[32], *end;
    double scale;
    size_t at = 0;
    if (!word(bytes, size, &at, text) || (strcmp(text, "PF") && strcmp(text, "Pf") && strcmp(text, "PF4")))
        return pupil_still_fail(why, "the PFM header must begin with a line PF, Pf or PF4");
    p->channels = text[1] == 'f' ? 1 : text[2] == '4' ? 4 : 3;
    if (!word(bytes, size, &at, text) || !side(text, &p->width))
        return pupil_still_fail(why, "the PFM header's width \"%s\" is not a whole number of pixels", text);
    if (!word(bytes, size, &at, text) || !side(text, &p->height))
        return pupil_still_fail(why, "the PFM header's height \"%s\" is not a whole number of pixels", text);
    if (pupil_still_size_ok(p->width, p->height, why))
        return -1;
    if (!word(bytes, size, &at, text))
        return pupil_still_fail(why, "the PFM header ends before its scale");
    scale = pupil_parse_double(text, &end);
    if (end == text || *end || !isfinite(scale) || scale == 0)
        return pupil_still_fail(why, "the PFM header's scale \"%s\" is not a number above or below 0 (-1.0 is usual)",
                                text);
    p->big_endian = scale > 0;
    p->start = at + 1;
    return 0;
}

static float sample(const uint8_t *b, int big_endian)
{
    uint32_t bits = big_endian ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | (uint32_t)b[3]
                               : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | (uint32_t)b[0];
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

int pupil_read_pfm(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    uint64_t need;
    pfm p = {0};
    if (read_header(&p, bytes, size, why))
        return -1;
    need = p.width * p.height * p.channels * 4;
    /* A header with CR LF: the LF belongs to it, unless the file is then one byte short. */
    if (bytes[p.start - 1] == '\r' && p.start < size && bytes[p.start] == '\n' && size - p.start > need)
        p.start++;
    if (size - p.start < need)
        return pupil_still_fail(why, "%llu x %llu pixels need %llu bytes of samples; the file has %llu",
                                (unsigned long long)p.width, (unsigned long long)p.height, (unsigned long long)need,
                                (unsigned long long)(size - p.start));
    if (pupil_still_reserve(still, p.width, p.height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    for (uint64_t y = 0; y < p.height; y++) {
        const uint8_t *in = bytes + p.start + (p.height - 1 - y) * p.width * p.channels * 4;
        float *out = (float *)still->pixels + y * p.width * 3;
        for (uint64_t x = 0; x < p.width; x++, in += p.channels * 4, out += 3)
            for (uint32_t c = 0; c < 3; c++)
                out[c] = sample(in + (p.channels == 1 ? 0 : c * 4), p.big_endian);
    }
    return 0;
}
