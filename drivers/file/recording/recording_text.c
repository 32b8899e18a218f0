/* drivers/file/recording/recording_text.c: recording.json, and the lines of frames.jsonl, by cJSON. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "file/common/regular.h"
#include "file/common/utf8.h"
#include "recording_format.h"
#include "refuse.h"

#define ABOUT_MOST_BYTES 65536 /* of a recording.json; ours have about 600 */
/* Up to here doubles, to which cJSON and most readers convert numbers, hold each whole number, and no other number is
 * rounded to it. */
#define EXACT_MOST (0x1p53 - 1.0)

/* --- recording.json --- */

typedef enum kind {
    WORD,  /* uint32_t: index of the word; `words` NULL: a pixel format */
    WHOLE, /* uint32_t */
    FLOAT, /* `count` floats; more than one are a list */
    RATE   /* a double above 0 */
} kind;

typedef struct field {
    const char *name, *right;
    kind kind;
    uint32_t count; /* of the words, or the floats */
    const char *const *words;
    size_t offset;
} field;

typedef struct whole_text {
    uint32_t format;
    pupil_recording_about about;
} whole_text;

static const char *const formats[] = {"pupil recording"};
static const char *const stored[] = {"raw", "jpeg"};
static const char *const matrices[] = {"bt601", "bt709", "bt2020"};
static const char *const ranges[] = {"limited", "full"};
static const char *const lights[] = {"usual", "linear", "srgb", "bt709", "pq", "hlg"};
static const char *const primaries[] = {"bt709", "bt2020"};
static const char *const bayers[] = {"rggb", "grbg", "gbrg", "bggr"};

#define AT(member) offsetof(whole_text, member)
static const field fields[] = {
    {"format", "\"pupil recording\"", WORD, 1, formats, AT(format)},
    {"pixel", "a pixel format as pupil record writes it (yuyv, nv12, bayer10, ...)", WORD, PUPIL_PIXEL_COUNT, NULL,
     AT(about.pixel)},
    {"width", "a whole number of pixels", WHOLE, 1, NULL, AT(about.width)},
    {"height", "a whole number of pixels", WHOLE, 1, NULL, AT(about.height)},
    {"fps", "a number above 0", RATE, 1, NULL, AT(about.fps)},
    {"stored", "\"raw\" or \"jpeg\"", WORD, 2, stored, AT(about.jpeg)},
    {"matrix", "\"bt601\", \"bt709\" or \"bt2020\"", WORD, 3, matrices, AT(about.coding.matrix)},
    {"range", "\"limited\" or \"full\"", WORD, 2, ranges, AT(about.coding.range)},
    {"light", "\"usual\", \"linear\", \"srgb\", \"bt709\", \"pq\" or \"hlg\"", WORD, 6, lights, AT(about.coding.light)},
    {"bayer", "\"rggb\", \"grbg\", \"gbrg\" or \"bggr\"", WORD, 4, bayers, AT(about.coding.bayer)},
    {"shift", "a whole number", WHOLE, 1, NULL, AT(about.coding.shift)},
    {"black", "a number", FLOAT, 1, NULL, AT(about.coding.black)},
    {"white", "a number", FLOAT, 1, NULL, AT(about.coding.white)},
    {"balance", "a list of three numbers", FLOAT, 3, NULL, AT(about.coding.balance)},
    {"rgb_from_camera", "a list of nine numbers", FLOAT, 9, NULL, AT(about.coding.rgb_from_camera)},
    {"knees", "a whole number", WHOLE, 1, NULL, AT(about.coding.knees)},
    {"knee_code", "a list of eight numbers", FLOAT, PUPIL_KNEES, NULL, AT(about.coding.knee_code)},
    {"knee_light", "a list of eight numbers", FLOAT, PUPIL_KNEES, NULL, AT(about.coding.knee_light)},
    {"primaries", "\"bt709\" or \"bt2020\"", WORD, 2, primaries, AT(about.primaries)},
};
#define FIELDS (sizeof fields / sizeof *fields)
#define ALWAYS (FIELDS - 4) /* then those of companded sensors alone, and primaries, which else are BT.709 */

static const char *word(const field *f, uint32_t number)
{
    return f->words ? f->words[number] : pupil_recording_pixel_name(number);
}

/* cJSON prints 15 digits where it considers these enough; 17 restore every double. */
static cJSON *number_item(double number)
{
    char text[32];
    snprintf(text, sizeof text, "%.17g", number);
    return cJSON_CreateRaw(text);
}

static cJSON *list_item(const float *values, uint32_t count)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; list && i < count; i++)
        if (!cJSON_AddItemToArray(list, number_item((double)values[i]))) {
            cJSON_Delete(list);
            return NULL;
        }
    return list;
}

static cJSON *item_of(const field *f, const whole_text *t)
{
    const void *at = (const char *)t + f->offset;
    switch (f->kind) {
    case WORD:
        return cJSON_CreateString(word(f, *(const uint32_t *)at));
    case WHOLE:
        return number_item(*(const uint32_t *)at);
    case FLOAT:
        return f->count > 1 ? list_item(at, f->count) : number_item((double)*(const float *)at);
    default:
        return number_item(*(const double *)at);
    }
}

char *pupil_recording_about_text(const pupil_recording_about *about, const char *camera)
{
    const whole_text t = {.about = *about};
    char *name = utf8_of(camera ? camera : ""), *text = NULL;
    cJSON *object = name ? cJSON_CreateObject() : NULL;
    int whole = object != NULL;
    for (size_t i = 0; whole && i < FIELDS; i++) {
        if (i >= ALWAYS && !(i + 1 < FIELDS ? about->coding.knees : about->primaries))
            continue;
        whole = cJSON_AddItemToObject(object, fields[i].name, item_of(&fields[i], &t));
        if (whole && i == 0) /* behind "format" */
            whole = cJSON_AddNumberToObject(object, "version", PUPIL_RECORDING_VERSION) &&
                    cJSON_AddStringToObject(object, "camera", name);
    }
    if (whole)
        text = cJSON_Print(object);
    cJSON_Delete(object);
    free(name);
    return text;
}

static int take_number(const cJSON *item, double *number)
{
    *number = cJSON_GetNumberValue(item); /* NaN where it is none */
    return isfinite(*number) ? 0 : -1;
}

static int take_word(const field *f, const cJSON *item, uint32_t *value)
{
    for (uint32_t i = 0; cJSON_IsString(item) && i < f->count; i++)
        if (word(f, i) && strcmp(word(f, i), item->valuestring) == 0) {
            *value = i;
            return 0;
        }
    return -1;
}

/* The way through a double does not change them: the text has more digits than a float needs. */
static int take_floats(const cJSON *item, uint32_t count, float *values)
{
    const cJSON *one = count > 1 ? item->child : item;
    double number;
    if (count > 1 && (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != (int)count))
        return -1;
    for (uint32_t i = 0; i < count; i++, one = one->next) {
        if (take_number(one, &number) || !(fabs(number) <= 1e30))
            return -1;
        values[i] = (float)number;
    }
    return 0;
}

static int take(const field *f, const cJSON *item, whole_text *t)
{
    void *at = (char *)t + f->offset;
    double number;
    switch (f->kind) {
    case WORD:
        return take_word(f, item, at);
    case WHOLE:
        if (take_number(item, &number) || !(number >= 0 && number <= UINT32_MAX) || number != floor(number))
            return -1;
        *(uint32_t *)at = (uint32_t)number;
        return 0;
    case FLOAT:
        return take_floats(item, f->count, at);
    default:
        return take_number(item, at) || !(*(double *)at > 0.0) ? -1 : 0;
    }
}

static int take_all(const char *path, const cJSON *object, whole_text *t, pupil_why *why)
{
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(object, "version");
    for (size_t i = 0; i < FIELDS; i++) {
        const field *f = &fields[i];
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, f->name);
        if (!item && i >= ALWAYS)
            continue;
        if (!item || take(f, item, t))
            return pupil_refuse(why, "%s: \"%s\" %s %s", path, f->name, item ? "must be" : "is missing; it must be",
                                f->right);
        if (i == 0 && cJSON_GetNumberValue(version) != PUPIL_RECORDING_VERSION)
            return pupil_refuse(why, "%s: \"version\" must be %d, the only one that this program reads", path,
                                PUPIL_RECORDING_VERSION);
    }
    return 0;
}

static unsigned line_of(const char *text, const char *at)
{
    unsigned line = 1;
    for (; text < at; text++)
        line += *text == '\n';
    return line;
}

static int parse(const char *path, const char *text, pupil_recording_about *about, pupil_why *why)
{
    const char *end = text;
    whole_text t = {0};
    cJSON *object = cJSON_ParseWithOpts(text, &end, 1);
    int failed;
    if (cJSON_IsObject(object))
        failed = take_all(path, object, &t, why);
    else
        failed = pupil_refuse(why, "%s:%u: that is not JSON; an object as pupil record writes it was expected", path,
                              line_of(text, end));
    cJSON_Delete(object);
    *about = t.about;
    return failed;
}

int pupil_recording_about_read(const char *folder, pupil_recording_about *about, pupil_why *why)
{
    char path[PATH_MAX];
    pupil_why words;
    if (pupil_recording_path(path, folder, PUPIL_RECORDING_ABOUT))
        return pupil_refuse(why, "%s: the name is too long", folder);
    FILE *file = pupil_regular_open(path, why);
    if (!file)
        return -1;
    char *text = calloc(1, ABOUT_MOST_BYTES);
    const size_t length = text ? fread(text, 1, ABOUT_MOST_BYTES, file) : 0;
    int failed = 0;
    if (!text || ferror(file))
        failed = pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    else if (length == ABOUT_MOST_BYTES || strlen(text) != length)
        failed = pupil_refuse(why, "%s: that is not a recording.json: too long, or no text", path);
    else
        failed = parse(path, text, about, why);
    fclose(file);
    free(text);
    if (!failed && pupil_recording_check(about, &words))
        failed = pupil_refuse(why, "%s: %s", path, words.text);
    return failed;
}

/* --- a line of frames.jsonl --- */

static void print_whole(char text[32], int negative, uint64_t size)
{
    const char *quote = size > (uint64_t)EXACT_MOST ? "\"" : "";
    snprintf(text, 32, "%s%s%" PRIu64 "%s", quote, negative ? "-" : "", size, quote);
}

static void print_number(char text[32], double number)
{
    snprintf(text, 32, isfinite(number) ? "%.17g" : "null", number);
}

/* Not by cJSON, which would allocate memory for every frame. */
size_t pupil_recording_line(char line[PUPIL_RECORDING_LINE_BYTES], uint64_t frame, const pupil_frame_info *info,
                            const float balance[3])
{
    char number[32], sequence[32], stamp[32], exposure[32], gain[32], own[96] = "";
    const int64_t ns = info->timestamp_ns;
    if (balance) /* 9 digits restore every float */
        snprintf(own, sizeof own, ",\"balance\":[%.9g,%.9g,%.9g]", (double)balance[0], (double)balance[1],
                 (double)balance[2]);
    print_whole(number, 0, frame);
    print_whole(sequence, 0, info->sequence);
    print_whole(stamp, ns < 0, ns < 0 ? -(uint64_t)ns : (uint64_t)ns);
    print_number(exposure, info->exposure_s);
    print_number(gain, info->gain);
    return (size_t)snprintf(line, PUPIL_RECORDING_LINE_BYTES,
                            "{\"frame\":%s,\"sequence\":%s,\"timestamp_ns\":%s,\"exposure_s\":%s,\"gain\":%s"
                            "%s}\n",
                            number, sequence, stamp, exposure, gain, own);
}

/* In quotes where it is too large for a double. */
static int take_signed(const cJSON *item, int64_t *value)
{
    double number;
    char *end;
    errno = 0;
    if (cJSON_IsString(item)) {
        *value = strtoll(item->valuestring, &end, 10);
        return errno || *end || end == item->valuestring ? -1 : 0;
    }
    if (take_number(item, &number) || !(fabs(number) <= EXACT_MOST) || number != floor(number))
        return -1;
    *value = (int64_t)number;
    return 0;
}

static int take_whole(const cJSON *item, uint64_t *value)
{
    int64_t number;
    char *end;
    errno = 0;
    if (cJSON_IsString(item)) {
        *value = strtoull(item->valuestring, &end, 10);
        return errno || *end || end == item->valuestring || strchr(item->valuestring, '-') ? -1 : 0;
    }
    if (take_signed(item, &number) || number < 0)
        return -1;
    *value = (uint64_t)number;
    return 0;
}

static int take_known(const cJSON *item, double *number)
{
    *number = 0;
    return cJSON_IsNull(item) ? 0 : take_number(item, number); /* null: unknown */
}

/* Of one frame: three factors that a coding can have. */
static int take_balance(const cJSON *item, float balance[3])
{
    pupil_coding coding = {0};
    if (take_floats(item, 3, coding.balance) || pupil_coding_check(&coding, PUPIL_PIXEL_BAYER16, NULL) != PUPIL_OK)
        return -1;
    memcpy(balance, coding.balance, sizeof coding.balance);
    return 0;
}

static int take_line(const cJSON *object, uint64_t *frame, pupil_frame_info *info, float balance[3], pupil_why *why)
{
    static const char *const names[] = {"frame", "sequence", "timestamp_ns", "exposure_s", "gain", "balance"};
    for (int i = 0; i < 6; i++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, names[i]);
        if (!item && i < 5)
            return pupil_refuse(why, "\"%s\" is missing", names[i]);
        const int wrong = !item    ? 0
                          : i == 0 ? take_whole(item, frame)
                          : i == 1 ? take_whole(item, &info->sequence)
                          : i == 2 ? take_signed(item, &info->timestamp_ns)
                          : i == 3 ? take_known(item, &info->exposure_s)
                          : i == 4 ? take_known(item, &info->gain)
                                   : take_balance(item, balance);
        if (wrong)
            return pupil_refuse(why, "\"%s\" must be %s", names[i],
                                i < 3   ? "a whole number, in quotes where it is 2^53 or more"
                                : i < 5 ? "a number"
                                        : "a list of three factors from 2^-10 to 2^10");
    }
    return 0;
}

int pupil_recording_line_read(const char *line, uint64_t *frame, pupil_frame_info *info, float balance[3],
                              pupil_why *why)
{
    cJSON *object = cJSON_ParseWithOpts(line, NULL, 1);
    memset(info, 0, sizeof *info);
    const int failed = cJSON_IsObject(object)
                           ? take_line(object, frame, info, balance, why)
                           : pupil_refuse(why, "that is not JSON; a line as pupil record writes it was expected");
    cJSON_Delete(object);
    return failed;
}
