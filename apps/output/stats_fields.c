#include "stats_fields.h"

#define NUMBER(name)                                                                                                   \
    {                                                                                                                  \
#name, STATS_NUMBER, offsetof(frame_log_entry, name)                                                           \
    }

enum { LIVE_FIELDS = 16 }; /* a live camera's, the last ones */

const pupil_stats_field pupil_stats_fields[] = {
    {"frame", STATS_COUNT, offsetof(frame_log_entry, frame)},
    {"name", STATS_TEXT, offsetof(frame_log_entry, name)},
    NUMBER(time_s),
    NUMBER(dt_s),
    NUMBER(metered_ev),
    NUMBER(adapted_ev),
    NUMBER(scale),
    NUMBER(white),
    NUMBER(p01_ev),
    NUMBER(p50_ev),
    NUMBER(p99_ev),
    NUMBER(output_level),
    NUMBER(key),
    NUMBER(black_share),
    NUMBER(clipped_share),
    NUMBER(bad_share),
    NUMBER(output_black_share),
    NUMBER(output_white_share),
    NUMBER(read_us),
    NUMBER(process_us),
    NUMBER(write_us),
    NUMBER(held_back_ev),
    NUMBER(aimed_level),
    {"state", STATS_TEXT, offsetof(frame_log_entry, state)},
    {"reason", STATS_TEXT, offsetof(frame_log_entry, reason)},
    {"sequence", STATS_COUNT, offsetof(frame_log_entry, sequence)},
    {"lost", STATS_COUNT, offsetof(frame_log_entry, lost)},
    {"flagged", STATS_COUNT, offsetof(frame_log_entry, flagged)},
    {"late", STATS_COUNT, offsetof(frame_log_entry, late)},
    NUMBER(exposure_s),
    NUMBER(gain),
    NUMBER(asked_exposure_s),
    NUMBER(asked_gain),
    {"in_force_from", STATS_COUNT, offsetof(frame_log_entry, in_force_from)},
    NUMBER(digital),
    NUMBER(scene_ev),
    NUMBER(camera_key),
    NUMBER(latency_us),
    {"sensor", STATS_TEXT, offsetof(frame_log_entry, sensor)},
    {"sensor_reason", STATS_TEXT, offsetof(frame_log_entry, sensor_reason)},
    {"day_night", STATS_TEXT, offsetof(frame_log_entry, day_night)},
};
const size_t pupil_stats_live_field_count = sizeof pupil_stats_fields / sizeof pupil_stats_fields[0];
const size_t pupil_stats_field_count = sizeof pupil_stats_fields / sizeof pupil_stats_fields[0] - LIVE_FIELDS;
/* If pointers have eight bytes, so has every field except `live`. */
_Static_assert(sizeof(void *) != 8 ||
                   (sizeof pupil_stats_fields / sizeof pupil_stats_fields[0] * 8 + 8 == sizeof(frame_log_entry) &&
                    LIVE_FIELDS * 8 + offsetof(frame_log_entry, sequence) == sizeof(frame_log_entry)),
               "a field that is added to the record is written");

size_t pupil_stats_fields_of(const frame_log_entry *record)
{
    return record->live ? pupil_stats_live_field_count : pupil_stats_field_count;
}

static const void *at(const frame_log_entry *record, const pupil_stats_field *field)
{
    return (const char *)record + field->offset;
}

uint64_t pupil_stats_count(const frame_log_entry *record, const pupil_stats_field *field)
{
    return *(const uint64_t *)at(record, field);
}

const char *pupil_stats_text(const frame_log_entry *record, const pupil_stats_field *field)
{
    const char *text = *(const char *const *)at(record, field);
    return text ? text : "";
}

double pupil_stats_number(const frame_log_entry *record, const pupil_stats_field *field)
{
    return *(const double *)at(record, field);
}
