/* drivers/file/recording_text.c: recording.json, and the lines of frames.jsonl. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "file/recording_format.h"
#include "file/recording_json.h"
#include "refuse.h"

#define ABOUT_MOST_BYTES 65536 /* of a recording.json; ours have about 600 */

static const char *const matrices[] = {"bt601", "bt709", "bt2020"};
static const char *const ranges[] = {"limited", "full"};
static const char *const lights[] = {"usual", "linear", "srgb", "bt709"};
static const char *const bayers[] = {"rggb", "grbg", "gbrg", "bggr"};
static const char *const stored[] = {"raw", "jpeg"};

#define LENGTH(list) (sizeof(list) / sizeof(list)[0])

/* ---- writing ---- */

static void print_floats(FILE *out, const char *name, const float *values, int count)
{
    fprintf(out, ",\n  \"%s\": [", name);
    for (int i = 0; i < count; i++)
        fprintf(out, "%s%.9g", i ? ", " : "", (double)values[i]); /* 9 digits bring every float back */
    fputc(']', out);
}

char *pupil_recording_about_text(const pupil_recording_about *a)
{
    const pupil_coding *c = &a->coding;
    char camera[6 * sizeof a->camera + 3], *text = NULL;
    size_t bytes;
    FILE *out = open_memstream(&text, &bytes);
    if (!out)
        return NULL;
    pupil_json_quote(camera, a->camera);
    fprintf(out, "{\n  \"format\": \"pupil recording\",\n  \"version\": %d,\n  \"camera\": %s,\n",
            PUPIL_RECORDING_VERSION, camera);
    fprintf(out,
            "  \"pixel\": \"%s\",\n  \"width\": %u,\n  \"height\": %u,\n  \"fps\": %.17g,\n  \"stored\": \"%s\",\n",
            pupil_recording_pixel_name(a->pixel), a->width, a->height, a->fps, stored[a->jpeg]);
    fprintf(out, "  \"matrix\": \"%s\",\n  \"range\": \"%s\",\n  \"light\": \"%s\",\n  \"bayer\": \"%s\",\n",
            matrices[c->matrix], ranges[c->range], lights[c->light], bayers[c->bayer]);
    fprintf(out, "  \"shift\": %u,\n  \"black\": %.9g,\n  \"white\": %.9g", c->shift, (double)c->black,
            (double)c->white);
    print_floats(out, "balance", c->balance, 3);
    print_floats(out, "rgb_from_camera", c->rgb_from_camera, 9);
    fputs("\n}\n", out);
    const int failed = ferror(out);
    if (fclose(out) == 0 && !failed)
        return text;
    free(text);
    return NULL;
}

static void print_number(char text[32], double number)
{
    if (isfinite(number))
        snprintf(text, 32, "%.17g", number); /* 17 digits bring every double back */
    else
        strcpy(text, "null");
}

size_t pupil_recording_line(char line[PUPIL_RECORDING_LINE_BYTES], uint64_t frame, const pupil_frame_info *info,
                            const float balance[3])
{
    char exposure[32], gain[32], own[96] = "";
    if (balance) /* 9 digits bring every float back */
        snprintf(own, sizeof own, ",\"balance\":[%.9g,%.9g,%.9g]", (double)balance[0], (double)balance[1],
                 (double)balance[2]);
    print_number(exposure, info->exposure_s);
    print_number(gain, info->gain);
    return (size_t)snprintf(line, PUPIL_RECORDING_LINE_BYTES,
                            "{\"frame\":%" PRIu64 ",\"sequence\":%" PRIu64 ",\"timestamp_ns\":%" PRId64
                            ",\"exposure_s\":%s,\"gain\":%s%s}\n",
                            frame, info->sequence, info->timestamp_ns, exposure, gain, own);
}

/* ---- reading ---- */

enum {
    FORMAT,
    VERSION,
    CAMERA,
    PIXEL,
    WIDTH,
    HEIGHT,
    FPS,
    STORED,
    MATRIX,
    RANGE,
    LIGHT,
    BAYER,
    SHIFT,
    BLACK,
    WHITE,
    BALANCE,
    RGB_FROM_CAMERA,
    FIELDS
};

/* In this order, with what each must be. All but the camera's name are wanted. */
static const struct {
    const char *name, *right;
} fields[FIELDS] = {
    {"format", "\"pupil recording\""},
    {"version", "1, the only one that this program reads"},
    {"camera", "a string of at most 255 characters"},
    {"pixel", "a pixel format as pupil record writes it (yuyv, nv12, bayer10, ...)"},
    {"width", "a whole number of pixels"},
    {"height", "a whole number of pixels"},
    {"fps", "a number above 0"},
    {"stored", "\"raw\" or \"jpeg\""},
    {"matrix", "\"bt601\", \"bt709\" or \"bt2020\""},
    {"range", "\"limited\" or \"full\""},
    {"light", "\"usual\", \"linear\", \"srgb\" or \"bt709\""},
    {"bayer", "\"rggb\", \"grbg\", \"gbrg\" or \"bggr\""},
    {"shift", "a whole number"},
    {"black", "a number"},
    {"white", "a number"},
    {"balance", "a list of three numbers"},
    {"rgb_from_camera", "a list of nine numbers"},
};

static int take_word(const pupil_json_member *member, const char *const *words, size_t count, uint32_t *value)
{
    char text[64];
    if (pupil_json_string(member, text, sizeof text))
        return -1;
    for (size_t i = 0; i < count; i++)
        if (words[i] && strcmp(words[i], text) == 0) {
            *value = (uint32_t)i;
            return 0;
        }
    return -1;
}

static int take_pixel(const pupil_json_member *member, uint32_t *pixel)
{
    const char *names[PUPIL_PIXEL_COUNT];
    for (uint32_t i = 0; i < PUPIL_PIXEL_COUNT; i++)
        names[i] = pupil_recording_pixel_name(i);
    return take_word(member, names, PUPIL_PIXEL_COUNT, pixel);
}

static int take_u32(const pupil_json_member *member, uint32_t *value)
{
    uint64_t whole;
    if (pupil_json_whole(member, &whole) || whole > UINT32_MAX)
        return -1;
    *value = (uint32_t)whole;
    return 0;
}

static int take_float(const pupil_json_member *member, float *value)
{
    double number;
    if (pupil_json_number(member, &number) || !(fabs(number) <= 1e30))
        return -1;
    *value = strtof(member->value, NULL); /* not by way of the double: rounded once */
    return 0;
}

static int take_coding(int field, const pupil_json_member *m, pupil_coding *c)
{
    switch (field) {
    case MATRIX:
        return take_word(m, matrices, LENGTH(matrices), &c->matrix);
    case RANGE:
        return take_word(m, ranges, LENGTH(ranges), &c->range);
    case LIGHT:
        return take_word(m, lights, LENGTH(lights), &c->light);
    case BAYER:
        return take_word(m, bayers, LENGTH(bayers), &c->bayer);
    case SHIFT:
        return take_u32(m, &c->shift);
    case BLACK:
        return take_float(m, &c->black);
    case WHITE:
        return take_float(m, &c->white);
    case BALANCE:
        return pupil_json_numbers(m, c->balance, 3);
    default:
        return pupil_json_numbers(m, c->rgb_from_camera, 9);
    }
}

static int take(int field, const pupil_json_member *m, pupil_recording_about *a)
{
    static const char *const format[] = {"pupil recording"};
    uint32_t word = 0;
    switch (field) {
    case FORMAT:
        return take_word(m, format, 1, &word);
    case VERSION:
        return take_u32(m, &word) || word != PUPIL_RECORDING_VERSION ? -1 : 0;
    case CAMERA:
        return pupil_json_string(m, a->camera, sizeof a->camera);
    case PIXEL:
        return take_pixel(m, &a->pixel);
    case WIDTH:
        return take_u32(m, &a->width);
    case HEIGHT:
        return take_u32(m, &a->height);
    case FPS:
        return pupil_json_number(m, &a->fps) || !(a->fps > 0.0) ? -1 : 0;
    case STORED:
        if (take_word(m, stored, LENGTH(stored), &word))
            return -1;
        a->jpeg = (int)word;
        return 0;
    default:
        return take_coding(field, m, &a->coding);
    }
}

static int parse(const char *path, const char *text, pupil_recording_about *about, char *why, size_t why_bytes)
{
    pupil_json json;
    pupil_json_member member;
    unsigned seen = 0;
    int got, field;
    pupil_json_begin(&json, text);
    while ((got = pupil_json_next(&json, &member)) > 0) {
        for (field = 0; field < FIELDS && strcmp(fields[field].name, member.name); field++)
            ;
        if (field == FIELDS)
            continue; /* of a later version, which says so where that matters */
        if (take(field, &member, about))
            return pupil_refuse(why, why_bytes, "%s:%u: \"%s\" must be %s", path, member.line, fields[field].name,
                                fields[field].right);
        seen |= 1u << field;
    }
    if (got < 0)
        return pupil_refuse(why, why_bytes, "%s:%u: that is no JSON; an object as pupil record writes it was expected",
                            path, json.line);
    for (field = 0; field < FIELDS; field++)
        if (field != CAMERA && !(seen & 1u << field))
            return pupil_refuse(why, why_bytes, "%s: \"%s\" is missing; it must be %s", path, fields[field].name,
                                fields[field].right);
    return 0;
}

/* The whole file, ended with 0. Its length, or -1. */
static ssize_t read_whole(const char *path, char *text, size_t text_bytes)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    size_t used = 0;
    ssize_t got = fd < 0 ? -1 : 1;
    while (got > 0 && used < text_bytes - 1) {
        got = read(fd, text + used, text_bytes - 1 - used);
        used += got > 0 ? (size_t)got : 0;
    }
    const int error = errno;
    if (fd >= 0)
        close(fd);
    errno = error;
    text[used] = 0;
    return got < 0 ? -1 : (ssize_t)used;
}

int pupil_recording_about_read(const char *folder, pupil_recording_about *about, char *why, size_t why_bytes)
{
    char path[PATH_MAX], words[256];
    if (pupil_recording_path(path, folder, PUPIL_RECORDING_ABOUT))
        return pupil_refuse(why, why_bytes, "%s: the name is too long", folder);
    char *text = malloc(ABOUT_MOST_BYTES);
    if (!text)
        return pupil_refuse(why, why_bytes, "%s: not enough memory", path);
    memset(about, 0, sizeof *about);
    const ssize_t length = read_whole(path, text, ABOUT_MOST_BYTES);
    int failed = 0;
    if (length < 0)
        failed = pupil_refuse(why, why_bytes, "%s: cannot be read: %s", path, strerror(errno));
    else if (length == ABOUT_MOST_BYTES - 1 || strlen(text) != (size_t)length)
        failed = pupil_refuse(why, why_bytes, "%s: that is no recording.json: too long, or no text", path);
    else
        failed = parse(path, text, about, why, why_bytes);
    free(text);
    if (!failed && pupil_recording_check(about, words, sizeof words))
        failed = pupil_refuse(why, why_bytes, "%s: %s", path, words);
    return failed;
}

/* Of one frame: three factors that a coding can have. */
static int take_balance(const pupil_json_member *member, float balance[3])
{
    pupil_coding coding = {0};
    if (pupil_json_numbers(member, coding.balance, 3) ||
        pupil_coding_check(&coding, PUPIL_PIXEL_BAYER16, NULL) != PUPIL_OK)
        return -1;
    memcpy(balance, coding.balance, sizeof coding.balance);
    return 0;
}

int pupil_recording_line_read(const char *line, uint64_t *frame, pupil_frame_info *info, float balance[3], char *why,
                              size_t why_bytes)
{
    static const char *const names[] = {"frame", "sequence", "timestamp_ns", "exposure_s", "gain"};
    pupil_json json;
    pupil_json_member m;
    unsigned seen = 0;
    int got;
    memset(info, 0, sizeof *info);
    pupil_json_begin(&json, line);
    while ((got = pupil_json_next(&json, &m)) > 0) {
        size_t field = 0;
        if (strcmp(m.name, "balance") == 0 && take_balance(&m, balance))
            return pupil_refuse(why, why_bytes, "\"balance\" must be a list of three factors from 2^-10 to 2^10");
        while (field < LENGTH(names) && strcmp(names[field], m.name))
            field++;
        if (field == LENGTH(names))
            continue;
        const int wrong = field == 0   ? pupil_json_whole(&m, frame)
                          : field == 1 ? pupil_json_whole(&m, &info->sequence)
                          : field == 2 ? pupil_json_signed(&m, &info->timestamp_ns)
                          : field == 3 ? pupil_json_number(&m, &info->exposure_s)
                                       : pupil_json_number(&m, &info->gain);
        if (wrong)
            return pupil_refuse(why, why_bytes, "\"%s\" must be a %snumber", names[field], field < 3 ? "whole " : "");
        seen |= 1u << field;
    }
    if (got < 0)
        return pupil_refuse(why, why_bytes, "that is no JSON; a line as pupil record writes it was expected");
    if (isnan(info->exposure_s)) /* null: unknown */
        info->exposure_s = 0;
    if (isnan(info->gain))
        info->gain = 0;
    for (size_t field = 0; field < LENGTH(names); field++)
        if (!(seen & 1u << field))
            return pupil_refuse(why, why_bytes, "\"%s\" is missing", names[field]);
    return 0;
}
