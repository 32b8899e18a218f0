/* apps/record/options.h: the command line of `pupil record`. */
#ifndef PUPIL_APPS_RECORD_OPTIONS_H
#define PUPIL_APPS_RECORD_OPTIONS_H

#include "pupil/error.h"
#include "source.h"

typedef struct record_options {
    const char *const *inputs; /* points into argv; none: a camera */
    size_t input_count;
    const char *camera; /* what -d said; NULL */
    const char *folder;
    pupil_source_options source;
    uint32_t fourcc;         /* 0: as the camera is set */
    uint64_t most;           /* frames; 0: no limit */
    double seconds;          /* 0: no limit */
    double exposure_s, gain; /* by hand; 0: as it is */
    int automatic, overwrite, quiet;
} record_options;

enum { RECORD_RUN = 0, RECORD_HELP = 1, RECORD_USAGE = 2 };

/* RECORD_RUN; RECORD_HELP where help was asked for; RECORD_USAGE and a sentence that names the option. */
int record_options_parse(record_options *options, int argc, char **argv, pupil_why *why);

extern const char record_help[];

#endif
