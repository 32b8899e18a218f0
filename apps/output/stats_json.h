/* apps/output/stats_json.h: records of statistics as JSON. */
#ifndef PUPIL_APPS_OUTPUT_STATS_JSON_H
#define PUPIL_APPS_OUTPUT_STATS_JSON_H

#include <stdio.h>

#include "frame_log.h"
#include "pupil/error.h"

/* One record as an object of JSON, without a line end; -1: not enough memory. The caller checks ferror for write
 * errors. */
int pupil_stats_json_object(FILE *file, const frame_log_entry *record);

/* 0, or -1 and a sentence if this program was built without JSON. */
int pupil_stats_json_check(const char *path, pupil_why *why);

#endif
