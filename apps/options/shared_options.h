/* apps/options/shared_options.h: the options that `pupil replay` and `pupil run` have in common. */
#ifndef PUPIL_APPS_OPTIONS_SHARED_OPTIONS_H
#define PUPIL_APPS_OPTIONS_SHARED_OPTIONS_H

#include <getopt.h>

#include "pupil/error.h"
#include "values.h"

enum {
    OPTION_STATS = 256,
    OPTION_PLOT,
    OPTION_FPS,
    OPTION_SIZE,
    OPTION_TAU_LIGHT,
    OPTION_TAU_DARK,
    OPTION_FORMULA,
    OPTION_WEIGHT,
    OPTION_KEY,
    OPTION_EV,
    OPTION_LOCK,
    OPTION_METERING,
    OPTION_ROI,
    OPTION_TRIM,
    OPTION_METER_ROWS,
    OPTION_WHITE,
    OPTION_TRANSFER,
    OPTION_FUSED,
    OPTION_GLES,
    OPTION_GLES_VERSION,
    OPTION_VIEW,
    OPTION_THREADS,
    OPTION_OWN /* the first of a command's own */
};

/* Rows of a command's table. */
#define SHARED_OPTIONS                                                                                                 \
    {"out", required_argument, NULL, 'o'}, {"stats", required_argument, NULL, OPTION_STATS},                           \
        {"plot", required_argument, NULL, OPTION_PLOT}, {"overwrite", no_argument, NULL, 'y'},                         \
        {"fps", required_argument, NULL, OPTION_FPS}, {"size", required_argument, NULL, OPTION_SIZE},                  \
        {"frames", required_argument, NULL, 'n'}, {"tau-light", required_argument, NULL, OPTION_TAU_LIGHT},            \
        {"tau-dark", required_argument, NULL, OPTION_TAU_DARK}, {"formula", required_argument, NULL, OPTION_FORMULA},  \
        {"weight", required_argument, NULL, OPTION_WEIGHT}, {"key", required_argument, NULL, OPTION_KEY},              \
        {"ev", required_argument, NULL, OPTION_EV}, {"lock", no_argument, NULL, OPTION_LOCK},                          \
        {"metering", required_argument, NULL, OPTION_METERING}, {"roi", required_argument, NULL, OPTION_ROI},          \
        {"trim", required_argument, NULL, OPTION_TRIM}, {"meter-rows", required_argument, NULL, OPTION_METER_ROWS},    \
        {"white", required_argument, NULL, OPTION_WHITE}, {"transfer", required_argument, NULL, OPTION_TRANSFER},      \
        {"fused", no_argument, NULL, OPTION_FUSED}, {"gles", no_argument, NULL, OPTION_GLES},                          \
        {"gles-version", required_argument, NULL, OPTION_GLES_VERSION}, {"view", no_argument, NULL, OPTION_VIEW},      \
        {"threads", required_argument, NULL, OPTION_THREADS}, {"quiet", no_argument, NULL, 'q'},                       \
        {"help", no_argument, NULL, 'h'},                                                                              \
    {                                                                                                                  \
        NULL, 0, NULL, 0                                                                                               \
    }

/* The long name, for sentences. */
const char *option_name(const struct option *options, int option);

/* A path that is not empty, as value_number takes a number. */
int option_path(const value_text *c, const char **where);

/* An option without a value: 1, or 0 where it is none of these. */
int shared_option_flag(int option, frame_options *o);

/* An option with a value; all but a command's own. OPTIONS_RUN, or OPTIONS_USAGE and a sentence. */
int shared_option_take(int option, const value_text *c);

/* What they ask of one another. weight_given: OPTION_WEIGHT was there. */
int shared_options_check(const frame_options *o, int weight_given, pupil_why *why);

#endif
