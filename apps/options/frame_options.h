/* apps/options/frame_options.h: the options of every command that shows frames: outputs, exposure, mapping. */
#ifndef PUPIL_APPS_OPTIONS_FRAME_OPTIONS_H
#define PUPIL_APPS_OPTIONS_FRAME_OPTIONS_H

#include <time.h>

#include "option_table.h"
#include "pupil/gles.h"
#include "pupil/veil.h"
#include "source.h"

#define FRAME_MOST_OUTPUTS 16

typedef struct frame_options {
    const char *const *inputs; /* points into argv */
    size_t input_count;
    const char *out[FRAME_MOST_OUTPUTS];
    size_t out_count;
    const char *stats, *plot, *report; /* paths, or NULL; only `pupil replay` has a report */
    const char *record;                /* the same; of `pupil run`, and of `pupil record` for
                                        * frame_options_check_paths */
    const char *control;               /* of `pupil run`, a socket; for frame_options_check_paths */
    pupil_config config;
    pupil_source_options source;
    uint64_t hold;              /* how many times each frame is shown; 1 */
    uint64_t most;              /* frames at most; 0: all */
    double start_s, duration_s; /* start and length in the source's time; 0: from its beginning, to its end */
    unsigned threads;           /* 0: one for each processor */
    int explains;               /* frame `explain` is explained in words; of `pupil replay` */
    uint64_t explain;
    int reset_each, overwrite, keep_going, quiet;
    int as_eye;                   /* --eye: frame_options_check sets config.law */
    int gles, view, loop;         /* on the GPU; in a window; at the end from the beginning again */
    uint32_t gles_version;        /* a pupil_gles_version */
    uint32_t dither;              /* 0: by the outputs; 1 off, 2 on. frame_options_check sets config.dither */
    char metering[64], white[64]; /* as the user wrote them, for the report */
    const char *veil;             /* as the user wrote it; NULL: none. Only of `pupil replay`, as is `eye` */
    pupil_veil_config eye;        /* without a size */
    int bloom;                    /* also the narrow part of `eye` */
    double bloom_above;           /* light, in the frames' unit */
    const char *compare[2];       /* --compare: options of the left and the right picture; NULL: one picture */
    const char *compare_plain;    /* the label of the picture of "" */
    const char *command;          /* the whole command line, for the report; set by the caller */
} frame_options;

/* The rows that replay and run share, by title. Offsets are those of frame_options. */
#define FRAME_OUTPUT_ROWS   3
#define FRAME_EXPOSURE_ROWS 19
#define FRAME_MAPPING_ROWS  9
extern const option_row frame_output_rows[FRAME_OUTPUT_ROWS];
extern const option_row frame_exposure_rows[FRAME_EXPOSURE_ROWS];
extern const option_row frame_mapping_rows[FRAME_MAPPING_ROWS];

/* The defaults. */
void frame_options_begin(frame_options *options);

/* Checks the shared options against each other. OPTIONS_RUN, or OPTIONS_USAGE and a sentence. */
int frame_options_check(frame_options *options, int weight_given, int key_given, pupil_why *why);

/* Refuses outputs that are named twice, are inside one another, are also an input, or exist already. */
int frame_options_check_paths(const frame_options *options, pupil_why *why);

/* Fills in the patterns of the outputs' names: those of strftime with the local time `now`; %04d, and %d if it is the
 * only pattern, with the first number whose output does not exist and that no other process has reserved. The number is
 * reserved until the process ends, or until all are released. The new names are never freed. */
int frame_options_expand_paths(frame_options *options, time_t now, pupil_why *why);
void frame_options_release_paths(void);

/* Releases those of the outputs that have been begun. */
void frame_options_release_begun(void);

#endif
