/* drivers/file/recording_json.h: the members of one object of JSON, one after the other, with their text as it stands:
 * a library would make doubles of 64-bit numbers. Members that hold objects or lists of anything but numbers are passed
 * over.
 */
#ifndef PUPIL_DRIVERS_FILE_RECORDING_JSON_H
#define PUPIL_DRIVERS_FILE_RECORDING_JSON_H

#include <stddef.h>
#include <stdint.h>

typedef struct pupil_json {
    const char *at;
    unsigned line; /* of `at`, from 1 */
    int begun;
} pupil_json;

typedef struct pupil_json_member {
    char name[64];     /* cut where it is longer */
    const char *value; /* in the text, not ended */
    size_t length;
    unsigned line;
} pupil_json_member;

/* `text` ends with 0 and stays the caller's. */
void pupil_json_begin(pupil_json *json, const char *text);
/* 1: a member; 0: the object is at its end, and nothing is behind it; -1: that is no JSON (json->line says where). */
int pupil_json_next(pupil_json *json, pupil_json_member *member);

/* What a member's value is; 0, or -1 where it is something else or does not fit. */
int pupil_json_whole(const pupil_json_member *member, uint64_t *value);
int pupil_json_signed(const pupil_json_member *member, int64_t *value);
int pupil_json_number(const pupil_json_member *member, double *value); /* null: NaN */
int pupil_json_numbers(const pupil_json_member *member, float *values, size_t count);
int pupil_json_string(const pupil_json_member *member, char *text, size_t text_bytes);

/* A string in quotes, with what JSON does not allow as it stands escaped, and what is no ASCII and no UTF-8 as '?'.
 * Room for 6 * strlen(text) + 3 bytes. */
void pupil_json_quote(char *quoted, const char *text);

#endif
