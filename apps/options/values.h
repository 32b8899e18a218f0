/* apps/options/values.h: what the options of `pupil replay` are given: texts, checked, into settings. Each returns
 * OPTIONS_RUN, or OPTIONS_USAGE and a sentence that names the option, what it was given, and what would be right. */
#ifndef PUPIL_APPS_OPTIONS_VALUES_H
#define PUPIL_APPS_OPTIONS_VALUES_H

#include "frame_options.h"
#include "pupil/error.h"

typedef struct value_text { /* of one option */
    frame_options *o;
    const char *name, *text;
    pupil_why *why;
} value_text;

/* `right` says in words what would do. */
int value_refuse(const value_text *c, const char *right);
int value_number(const value_text *c, double low, double high, const char *right, double *value);
int value_whole(const value_text *c, uint64_t low, uint64_t high, const char *right, uint64_t *value);

/* Into the fields of options that they are named after. */
int value_of_size(const value_text *c);
int value_of_metering(const value_text *c);
int value_of_roi(const value_text *c);
int value_of_trim(const value_text *c);
int value_of_meter_rows(const value_text *c);
int value_of_white(const value_text *c);
int value_of_formula(const value_text *c);
int value_of_weight(const value_text *c);
int value_of_threads(const value_text *c);
int value_of_fps(const value_text *c);
int value_of_transfer(const value_text *c);
int value_of_gles_version(const value_text *c);
int value_of_out(const value_text *c);

#endif
