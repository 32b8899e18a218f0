/* apps/lab/study/options.h: the command line of `pupil study`. */
#ifndef PUPIL_APPS_LAB_STUDY_OPTIONS_H
#define PUPIL_APPS_LAB_STUDY_OPTIONS_H

#include "options/option_table.h"

#define STUDY_MOST_VIDEOS 16

typedef struct study_options {
    const char *scene;      /* "room" */
    const char *out;        /* a folder; NULL: nothing is written */
    const char *regression; /* the original table; NULL: the study */
    uint32_t width, height; /* 0: 600x600 */
    unsigned threads;       /* 0: one for each processor */
    int check, float32, overwrite, quiet;
    int look;         /* `study look`: how the picture looks while it adapts */
    double eye_cd_m2; /* of a luminance of 1, for `look` */
    struct {
        unsigned which_case, formula; /* from 0 */
    } video[STUDY_MOST_VIDEOS];
    unsigned videos;
} study_options;

/* As options_parse, with the defaults set before. */
int study_options_parse(study_options *options, int argc, char **argv, pupil_why *why);

#endif
