/* apps/output/stats_file.h: --stats: every record of a run as a line of a file, JSON (.jsonl, .json) or CSV (.csv) by
 * its name; "-" is JSON on standard output. docs/stats.md has the fields. A file is complete or absent
 * (file/common/pending.h).
 */
#ifndef PUPIL_APPS_OUTPUT_STATS_FILE_H
#define PUPIL_APPS_OUTPUT_STATS_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "frame_log.h"
#include "pupil/error.h"

typedef struct pupil_stats_file pupil_stats_file;

/* 0, or -1 and a sentence that names the path. */
int pupil_stats_file_open(pupil_stats_file **file, const char *path, pupil_why *why);
int pupil_stats_file_write(pupil_stats_file *file, const frame_log_entry *record, pupil_why *why);

/* 1: it goes to standard output, and its reader is gone. */
int pupil_stats_reader_gone(const pupil_stats_file *file);

/* Puts the file in its place. It is gone afterwards, whether that succeeded or not. */
int pupil_stats_file_finish(pupil_stats_file *file, pupil_why *why);

/* Leaves nothing. Takes NULL. */
void pupil_stats_file_discard(pupil_stats_file *file);

/* --- for the writers of lines --- */

/* The fields of a record in the order of the file, each with its name and place. */
typedef struct pupil_stats_field {
    const char *name;
    enum { STATS_COUNT, STATS_TEXT, STATS_NUMBER } kind;
    size_t offset;
} pupil_stats_field;

extern const pupil_stats_field pupil_stats_fields[];
extern const size_t pupil_stats_field_count;      /* of a replay's records, */
extern const size_t pupil_stats_live_field_count; /* and with those of a live camera's, which follow */
size_t pupil_stats_fields_of(const frame_log_entry *record);

uint64_t pupil_stats_count(const frame_log_entry *record, const pupil_stats_field *field);
const char *pupil_stats_text(const frame_log_entry *record, const pupil_stats_field *field); /* never NULL */
double pupil_stats_number(const frame_log_entry *record, const pupil_stats_field *field);

/* One record as one line of JSON; -1: not enough memory. What cannot be written is left to ferror. */
int pupil_stats_json_line(FILE *file, const frame_log_entry *record);

/* 0, or -1 and a sentence where this program was built without JSON. */
int pupil_stats_json_check(const char *path, pupil_why *why);

#endif
