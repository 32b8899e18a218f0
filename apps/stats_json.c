/* apps/stats_json.c: a record as a line of JSON. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stats_file.h"

int pupil_stats_json_check(const char *path, char *why, size_t why_bytes)
{
    (void)path;
    (void)why;
    (void)why_bytes;
    return 0;
}

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

/* JSON is UTF-8, a file's name any bytes: what is no UTF-8 becomes U+FFFD. To be freed; NULL: out of memory. */
static char *as_utf8(const char *text)
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

static int add_field(cJSON *line, const pupil_record *record, const pupil_stats_field *field)
{
    if (field->kind == STATS_NUMBER) {
        char digits[32]; /* 17 significant digits bring every double back */
        double number = pupil_stats_number(record, field);
        snprintf(digits, sizeof digits, "%.17g", number);
        return (isfinite(number) ? cJSON_AddRawToObject(line, field->name, digits)
                                 : cJSON_AddNullToObject(line, field->name)) != NULL;
    }
    if (field->kind == STATS_COUNT) {
        char digits[32];
        snprintf(digits, sizeof digits, "%llu", (unsigned long long)pupil_stats_count(record, field));
        return cJSON_AddRawToObject(line, field->name, digits) != NULL;
    }
    char *text = as_utf8(pupil_stats_text(record, field));
    int added = text && cJSON_AddStringToObject(line, field->name, text);
    free(text);
    return added;
}

char *pupil_stats_json_line(const pupil_record *record)
{
    cJSON *line = cJSON_CreateObject();
    char *text = NULL;
    size_t i = 0;
    while (line && i < pupil_stats_field_count && add_field(line, record, &pupil_stats_fields[i]))
        i++;
    if (i == pupil_stats_field_count)
        text = cJSON_PrintUnformatted(line);
    cJSON_Delete(line);
    return text;
}
