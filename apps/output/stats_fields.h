/* apps/output/stats_fields.h: the fields of a line of statistics: name, kind and place in a frame_log_entry. */
#ifndef PUPIL_APPS_OUTPUT_STATS_FIELDS_H
#define PUPIL_APPS_OUTPUT_STATS_FIELDS_H

#include <stddef.h>

#include "frame_log.h"

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

#endif
