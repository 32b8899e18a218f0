/* Radiance picture: a header of text lines, a resolution line, then scanlines of four bytes a pixel. These are three
 * mantissas and one exponent, flat or run-length coded in the old or the new way (Ward, "Real Pixels", Graphics Gems
 * II; the Radiance reference manual's file formats). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "number.h"
#include "still_private.h"

typedef struct radiance {
    const uint8_t *at, *end;
    uint64_t width, height;
    uint64_t lines, line_pixels;            /* as they are in the file */
    ptrdiff_t first, line_step, pixel_step; /* where they go, in pixels */
    double divide[3];                       /* EXPOSURE and COLORCORR */
    pupil_still_colour colour;
} radiance;

/* The next header line without its end, cut to the length that relevant lines need; 0 at the end of the file. */
static int next_line(radiance *r, char line[256])
{
    const uint8_t *newline;
    size_t length;
    if (r->at >= r->end)
        return 0;
    newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
    if (!newline)
        return 0;
    length = (size_t)(newline - r->at);
    if (length && newline[-1] == '\r')
        length--;
    if (length > 255)
        length = 255;
    memcpy(line, r->at, length);
    line[length] = 0;
    r->at = newline + 1;
    return 1;
}

/* Reads up to `count` numbers; returns how many there are. */
static int numbers(const char *text, double *values, int count)
{
    int n = 0;
    char *end;
    for (; n < count; n++, text = end) {
        values[n] = pupil_parse_double(text, &end);
        if (end == text)
            break;
    }
    return n;
}

static int divide_by(radiance *r, const char *line, const char *text, int count, pupil_why *why)
{
    double given[3];
    const int has_number = numbers(text, given, count) == count;
    if (!has_number)
        given[0] = 0;
    for (int c = 0; c < 3; c++) {
        double v = given[count == 3 ? c : 0];
        if (count == 1 && has_number && v == 0) /* EXPOSURE=0 cannot be a factor of the light: unknown */
            break;
        r->divide[c] *= v;
        if (!(v > 0 && isfinite(v) && r->divide[c] > 1e-30 && r->divide[c] < 1e30))
            return pupil_still_fail(why, "the header line \"%.100s\" needs %s above 0, within 1e-30 and 1e30 in all",
                                    line, count == 3 ? "three numbers" : "a number");
    }
    return 0;
}

static int read_header(radiance *r, pupil_why *why)
{
    /* XYZE: the axes of XYZ as primaries, its equal-energy white as white. */
    static const pupil_chromaticities xyz = {{1, 0, 0, 1, 0, 0, 1. / 3, 1. / 3}};
    pupil_chromaticities given;
    int is_xyz = 0, has_primaries = 0;
    char line[256];
    if (!next_line(r, line) || strncmp(line, "#?", 2))
        return pupil_still_fail(why, "a Radiance file must begin with a line \"#?RADIANCE\"");
    for (;;) {
        if (!next_line(r, line))
            return pupil_still_fail(why, "the Radiance header does not end with an empty line");
        if (!*line)
            break;
        if (strncmp(line, "FORMAT=", 7) == 0) {
            const char *format = line + 7 + strspn(line + 7, " \t");
            is_xyz = strncmp(format, "32-bit_rle_xyze", 15) == 0;
            if (!is_xyz && strncmp(format, "32-bit_rle_rgbe", 15) != 0)
                return pupil_still_fail(why, "FORMAT is \"%.60s\"; 32-bit_rle_rgbe and 32-bit_rle_xyze are read",
                                        format);
        } else if (strncmp(line, "EXPOSURE=", 9) == 0) {
            if (divide_by(r, line, line + 9, 1, why))
                return -1;
        } else if (strncmp(line, "COLORCORR=", 10) == 0) {
            if (divide_by(r, line, line + 10, 3, why))
                return -1;
        } else if (strncmp(line, "PRIMARIES=", 10) == 0) {
            has_primaries = numbers(line + 10, given.xy, 8) == 8;
        }
    }
    pupil_still_colour_from(is_xyz ? &xyz : has_primaries ? &given : NULL, &r->colour);
    return 0;
}

/* One half of the resolution line: "-Y 512". */
static int axis(const char **text, char *sign, char *letter, uint64_t *value)
{
    const char *t = *text + strspn(*text, " \t");
    *sign = t[0];
    if (*sign != '-' && *sign != '+')
        return 0;
    *letter = t[1];
    if (*letter != 'X' && *letter != 'Y')
        return 0;
    t += 2;
    t += strspn(t, " \t");
    if (*t < '0' || *t > '9')
        return 0;
    for (*value = 0; *t >= '0' && *t <= '9'; t++)
        *value = *value > UINT32_MAX ? *value : *value * 10 + (uint64_t)(*t - '0');
    *text = t;
    return 1;
}

static int read_resolution(radiance *r, pupil_why *why)
{
    char line[256], sign[2], letter[2];
    const char *text = line;
    ptrdiff_t step[2];
    if (!next_line(r, line))
        return pupil_still_fail(why, "the file ends before its resolution line (\"-Y 512 +X 1024\")");
    if (!axis(&text, &sign[0], &letter[0], &r->lines) || !axis(&text, &sign[1], &letter[1], &r->line_pixels) ||
        letter[0] == letter[1] || text[strspn(text, " \t")])
        return pupil_still_fail(why, "the resolution line \"%.60s\" is not of the form \"-Y 512 +X 1024\"", line);
    r->height = letter[0] == 'Y' ? r->lines : r->line_pixels;
    r->width = letter[0] == 'Y' ? r->line_pixels : r->lines;
    if (pupil_still_size_ok(r->width, r->height, why))
        return -1;
    r->first = 0;
    for (int i = 0; i < 2; i++) {
        int vertical = letter[i] == 'Y';
        ptrdiff_t count = (ptrdiff_t)(i ? r->line_pixels : r->lines);
        step[i] = vertical ? (ptrdiff_t)r->width : 1;
        if (sign[i] == (vertical ? '+' : '-')) { /* Y counts upwards, X to the right */
            r->first += (count - 1) * step[i];
            step[i] = -step[i];
        }
    }
    r->line_step = step[0];
    r->pixel_step = step[1];
    return 0;
}

/* A line of the old kind: pixels as they are; 1 1 1 n repeats the one before n times, and directly following repeats
 * are further digits of n to base 256. */
static const char *old_line(radiance *r, uint8_t *line)
{
    uint64_t done = 0;
    int shift = 0;
    while (done < r->line_pixels) {
        if (r->end - r->at < 4)
            return "ends early";
        if (r->at[0] == 1 && r->at[1] == 1 && r->at[2] == 1) {
            uint64_t count = shift < 24 ? (uint64_t)r->at[3] << shift : r->at[3] ? UINT64_MAX : 0;
            if (done == 0)
                return "begins with a repeat";
            if (count > r->line_pixels - done)
                return "has a run over its end";
            for (; count; count--, done++)
                memcpy(line + 4 * done, line + 4 * (done - 1), 4);
            shift += shift < 24 ? 8 : 0;
        } else {
            memcpy(line + 4 * done++, r->at, 4);
            shift = 0;
        }
        r->at += 4;
    }
    return NULL;
}

/* A line of the new kind: a mark, then the four components one after the other; a count above 128 is a run. */
static const char *new_line(radiance *r, uint8_t *line)
{
    r->at += 4;
    for (int component = 0; component < 4; component++) {
        for (uint64_t done = 0; done < r->line_pixels;) {
            unsigned code, count;
            if (r->end - r->at < 2)
                return "ends early";
            code = *r->at++;
            count = code > 128 ? code - 128 : code;
            if (count == 0)
                return "has a run of no length";
            if (count > r->line_pixels - done)
                return "has a run over its end";
            if (code <= 128 && (size_t)(r->end - r->at) < count)
                return "ends early";
            for (unsigned i = 0; i < count; i++)
                line[4 * (done + i) + (unsigned)component] = code > 128 ? r->at[0] : r->at[i];
            r->at += code > 128 ? 1 : count;
            done += count;
        }
    }
    return NULL;
}

/* The new kind is used for lines of 8 to 32767 pixels and begins with 2, 2 and the length. */
static const char *any_line(radiance *r, uint8_t *line)
{
    const uint8_t *b = r->at;
    if (r->line_pixels < 8 || r->line_pixels > 32767 || r->end - b < 4 || b[0] != 2 || b[1] != 2 || b[2] > 127)
        return old_line(r, line);
    if (((uint64_t)b[2] << 8 | b[3]) != r->line_pixels)
        return "is marked with another length than the resolution line";
    return new_line(r, line);
}

static int read_lines(radiance *r, float *pixels, uint8_t *line, pupil_why *why)
{
    double scale[256][3];
    for (int e = 0; e < 256; e++) /* exponent 0: black, regardless of the mantissas */
        for (int c = 0; c < 3; c++)
            scale[e][c] = e ? ldexp(1, e - 136) / r->divide[c] : 0;
    for (uint64_t i = 0; i < r->lines; i++) {
        float *out = pixels + 3 * (r->first + (ptrdiff_t)i * r->line_step);
        const char *fault = any_line(r, line);
        if (fault)
            return pupil_still_fail(why, "scanline %llu of %llu %s", (unsigned long long)i + 1,
                                    (unsigned long long)r->lines, fault);
        for (uint64_t j = 0; j < r->line_pixels; j++, out += 3 * r->pixel_step)
            for (int c = 0; c < 3; c++)
                out[c] = (float)(line[4 * j + (unsigned)c] * scale[line[4 * j + 3]][c]);
    }
    return 0;
}

int pupil_read_radiance(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    radiance r = {.at = bytes, .end = bytes + size, .divide = {1, 1, 1}};
    uint64_t least;
    uint8_t *line;
    int result;
    if (read_header(&r, why) || read_resolution(&r, why))
        return -1;
    /* The shortest line is an old one: a pixel, then repeats that count to base 256. */
    least = r.lines * 4 * (r.line_pixels == 1 ? 1 : r.line_pixels <= 256 ? 2 : 3);
    if ((uint64_t)(r.end - r.at) < least)
        return pupil_still_fail(why, "%llu x %llu pixels need at least %llu bytes after the header; the file has %llu",
                                (unsigned long long)r.width, (unsigned long long)r.height, (unsigned long long)least,
                                (unsigned long long)(r.end - r.at));
    if (pupil_still_reserve(still, r.width, r.height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    line = malloc((size_t)r.line_pixels * 4);
    if (!line)
        return pupil_still_fail(why, "no memory for a scanline");
    result = read_lines(&r, still->pixels, line, why);
    free(line);
    if (result == 0)
        pupil_still_colour_apply(&r.colour, still->pixels, r.width * r.height);
    return result;
}
