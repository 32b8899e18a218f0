/* apps/output/stats_json.c: a record as an object of JSON. Only a text with odd characters allocates memory. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/common/utf8.h"
#include "stats_fields.h"
#include "stats_json.h"

int pupil_stats_json_check(const char *path, pupil_why *why)
{
    (void)path;
    (void)why;
    return 0;
}

/* Whether a text needs no escapes in JSON. */
static int is_plain(const char *text)
{
    for (; *text; text++)
        if (*text < ' ' || *text > '~' || *text == '"' || *text == '\\')
            return 0;
    return 1;
}

static int write_text(FILE *file, const char *text)
{
    if (is_plain(text))
        return fprintf(file, "\"%s\"", text) < 0 ? -1 : 0;
    char *copy = utf8_of(text);
    cJSON *string = copy ? cJSON_CreateString(copy) : NULL;
    char *quoted = string ? cJSON_PrintUnformatted(string) : NULL;
    const int failed = !quoted;
    if (quoted)
        fputs(quoted, file);
    cJSON_free(quoted);
    cJSON_Delete(string);
    free(copy);
    return failed ? -1 : 0;
}

int pupil_stats_json_object(FILE *file, const frame_log_entry *record)
{
    for (size_t i = 0; i < pupil_stats_fields_of(record); i++) {
        const pupil_stats_field *field = &pupil_stats_fields[i];
        fprintf(file, "%c\"%s\":", i ? ',' : '{', field->name);
        if (field->kind == STATS_COUNT)
            fprintf(file, "%llu", (unsigned long long)pupil_stats_count(record, field));
        else if (field->kind == STATS_TEXT && write_text(file, pupil_stats_text(record, field)))
            return -1;
        else if (field->kind == STATS_NUMBER && isfinite(pupil_stats_number(record, field)))
            fprintf(file, "%.17g", pupil_stats_number(record, field)); /* enough digits to restore every double */
        else if (field->kind == STATS_NUMBER)
            fputs("null", file);
    }
    fputc('}', file);
    return 0;
}
