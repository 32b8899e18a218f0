/* apps/stats_json.c: a record as a line of JSON. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stats_file.h"
#include "utf8.h"

int pupil_stats_json_check(const char *path, char *why, size_t why_bytes)
{
    (void)path;
    (void)why;
    (void)why_bytes;
    return 0;
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
    char *text = utf8_of(pupil_stats_text(record, field));
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
