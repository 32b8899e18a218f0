#include "stats_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "common/reader.h"
#include "file/common/pending.h"
#include "file/sink/sink_common.h"
#include "refuse.h"
#include "stats_fields.h"
#include "stats_json.h"

struct pupil_stats_file {
    FILE *file;
    char *path; /* as the user wrote it */
    pupil_pending pending;
    int is_stream, is_csv, is_array; /* .json: one array */
    uint64_t lines;
};

/* RFC 4180, 2.6 and 2.7: quoted if it has a comma, a quote or a line end; quotes are doubled. */
static void csv_text(FILE *file, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

static void csv_field(FILE *file, const frame_log_entry *record, const pupil_stats_field *field)
{
    if (field->kind == STATS_COUNT)
        fprintf(file, "%llu", (unsigned long long)pupil_stats_count(record, field));
    else if (field->kind == STATS_TEXT)
        csv_text(file, pupil_stats_text(record, field));
    else if (isfinite(pupil_stats_number(record, field))) /* else the field is empty */
        fprintf(file, "%.17g", pupil_stats_number(record, field));
}

/* The header or a record. Lines end with \r\n, by RFC 4180, 2.1. */
static void csv_line(FILE *file, const frame_log_entry *record, int header)
{
    for (size_t i = 0; i < pupil_stats_fields_of(record); i++) {
        if (i)
            fputc(',', file);
        if (!header)
            csv_field(file, record, &pupil_stats_fields[i]);
        else
            fputs(pupil_stats_fields[i].name, file);
    }
    fputs("\r\n", file);
}

static int has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path), part = strlen(ending);
    return length > part && strcasecmp(path + length - part, ending) == 0;
}

static int cannot_write(const pupil_stats_file *f, pupil_why *why)
{
    return pupil_refuse(why, "%s: the statistics cannot be written: %s", f->is_stream ? "standard output" : f->path,
                        strerror(errno));
}

int pupil_stats_file_check(const char *path, pupil_why *why)
{
    return strcmp(path, "-") == 0 || has_ending(path, ".csv") || has_ending(path, ".json") || has_ending(path, ".jsonl")
               ? 0
               : pupil_refuse(why, "%s: statistics are written as .jsonl, .json or .csv", path);
}

static int begin(pupil_stats_file *f, const char *path, int overwrite, pupil_why *why)
{
    if (pupil_stats_file_check(path, why))
        return -1;
    f->is_stream = strcmp(path, "-") == 0;
    f->is_csv = has_ending(path, ".csv");
    f->is_array = has_ending(path, ".json");
    if (!f->is_csv && pupil_stats_json_check(path, why))
        return -1;
    f->path = strdup(path);
    if (!f->path)
        return pupil_refuse(why, "%s: not enough memory", path);
    if (f->is_stream) {
        f->file = stdout;
        return 0;
    }
    if (pupil_pending_file(&f->pending, path, overwrite, why))
        return -1;
    f->file = pupil_pending_stream(&f->pending);
    if (!f->file)
        return cannot_write(f, why);
    return 0;
}

int pupil_stats_file_open(pupil_stats_file **file, const char *path, int overwrite, pupil_why *why)
{
    pupil_stats_file *f = calloc(1, sizeof *f);
    if (!f)
        return pupil_refuse(why, "%s: not enough memory", path);
    if (begin(f, path, overwrite, why)) {
        pupil_stats_file_discard(f);
        return -1;
    }
    *file = f;
    return 0;
}

int pupil_stats_file_write(pupil_stats_file *f, const frame_log_entry *record, pupil_why *why)
{
    if (f->is_csv) {
        if (!f->lines)
            csv_line(f->file, record, 1);
        csv_line(f->file, record, 0);
    } else {
        if (f->is_array)
            fputs(f->lines ? ",\n" : "[\n", f->file);
        if (pupil_stats_json_object(f->file, record))
            return pupil_refuse(why, "%s: not enough memory", f->path);
        if (!f->is_array)
            fputc('\n', f->file);
    }
    f->lines++;
    /* A stream is read while it is written, so each line is flushed. */
    if (ferror(f->file) || (f->is_stream && fflush(f->file) != 0))
        return cannot_write(f, why);
    return 0;
}

int pupil_stats_reader_gone(const pupil_stats_file *f)
{
    return f->is_stream && reader_gone();
}

int pupil_stats_file_finish(pupil_stats_file *f, pupil_why *why)
{
    int failed;
    if (!f->lines && !f->is_stream) {
        failed = pupil_refuse(why, "%s: nothing was written, for there is no frame", f->path);
    } else if (f->is_stream) {
        failed = fflush(f->file) != 0 ? cannot_write(f, why) : 0;
    } else {
        if (f->is_array)
            fputs("\n]\n", f->file);
        failed = ferror(f->file) ? cannot_write(f, why) : 0;
        if (fclose(f->file) != 0 && !failed)
            failed = cannot_write(f, why);
        f->file = NULL;
        if (!failed)
            failed = pupil_pending_commit(&f->pending, why);
    }
    pupil_stats_file_discard(f);
    return failed;
}

void pupil_stats_file_discard(pupil_stats_file *f)
{
    if (!f)
        return;
    if (f->file && !f->is_stream)
        fclose(f->file);
    pupil_pending_discard(&f->pending);
    free(f->path);
    free(f);
}
