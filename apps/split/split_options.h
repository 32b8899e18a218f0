/* apps/split/split_options.h: the options of pupil meter, pupil adapt and pupil map. */
#ifndef PUPIL_APPS_SPLIT_SPLIT_OPTIONS_H
#define PUPIL_APPS_SPLIT_SPLIT_OPTIONS_H

#include "options/frame_options.h"

typedef struct split_options {
    frame_options frames;
    const char *out;          /* of meter and adapt */
    const char *curves;       /* of map */
    uint64_t first, end;      /* frames first .. end - 1 */
    int metering_given;       /* of adapt: an option that only pupil meter obeys */
    const char *const *words; /* of adapt: the parts */
    size_t word_count;
} split_options;

/* OPTIONS_RUN, OPTIONS_HELP, or OPTIONS_USAGE and a sentence. */
int meter_options_parse(split_options *o, int argc, char **argv, pupil_why *why);
int map_options_parse(split_options *o, int argc, char **argv, pupil_why *why);

/* `config`: the settings to begin with; NULL: only the parts are looked for. */
int adapt_options_parse(split_options *o, int argc, char **argv, const pupil_config *config, pupil_why *why);

/* Refuses outputs that would replace an input or each other; "-" is allowed only for --stats. */
int split_options_check_paths(const split_options *o, pupil_why *why);

#endif
