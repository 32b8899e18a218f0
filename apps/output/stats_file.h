/* apps/output/stats_file.h: --stats: every record of a run as a line of JSON (.jsonl) or CSV (.csv), or as an element
 * of one array (.json), by the file's name; "-" is lines of JSON on standard output. docs/stats.md has the fields. A
 * file is complete or absent (file/common/pending.h).
 */
#ifndef PUPIL_APPS_OUTPUT_STATS_FILE_H
#define PUPIL_APPS_OUTPUT_STATS_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "frame_log.h"
#include "pupil/error.h"

typedef struct pupil_stats_file pupil_stats_file;

/* Whether the name has a known ending: 0, or -1 and a sentence. Nothing is opened. */
int pupil_stats_file_check(const char *path, pupil_why *why);

/* An existing file is refused, unless overwrite. 0, or -1 and a sentence that names the path. */
int pupil_stats_file_open(pupil_stats_file **file, const char *path, int overwrite, pupil_why *why);
int pupil_stats_file_write(pupil_stats_file *file, const frame_log_entry *record, pupil_why *why);

/* 1: it goes to standard output, and its reader is gone. */
int pupil_stats_reader_gone(const pupil_stats_file *file);

/* Puts the file in its place. `file` is freed, whether that succeeded or not. */
int pupil_stats_file_finish(pupil_stats_file *file, pupil_why *why);

/* Leaves nothing. Takes NULL. */
void pupil_stats_file_discard(pupil_stats_file *file);

#endif
