/* apps/record/options.h: the command line of `pupil record`. */
#ifndef PUPIL_APPS_RECORD_OPTIONS_H
#define PUPIL_APPS_RECORD_OPTIONS_H

#include "run/options.h"

typedef struct record_options {
    run_options run; /* what it is asked for; without run.shown.inputs: a camera */
    const char *folder;
    int automatic;
} record_options;

/* As options_parse, with the defaults set before. Moves the operands to the front of argv. */
int record_options_parse(record_options *options, int argc, char **argv, pupil_why *why);

#endif
