/* apps/options/frame_options.h: what every command that shows frames can be asked for: outputs, exposure, mapping. */
#ifndef PUPIL_APPS_OPTIONS_FRAME_OPTIONS_H
#define PUPIL_APPS_OPTIONS_FRAME_OPTIONS_H

#include "pupil/gles.h"
#include "source.h"

#define FRAME_MOST_OUTPUTS 16

typedef struct frame_options {
    const char *const *inputs; /* points into argv */
    size_t input_count;
    const char *out[FRAME_MOST_OUTPUTS];
    size_t out_count;
    const char *stats, *plot, *report; /* paths, or NULL */
    const char *record;                /* the same; of a live run alone */
    pupil_config config;
    pupil_source_options source;
    uint64_t hold;    /* how many times each frame is shown; 1 */
    uint64_t most;    /* frames to replay at most; 0: all */
    unsigned threads; /* 0: one a processor */
    int reset_each, overwrite, keep_going, quiet;
    int gles, view, loop;         /* on the GPU; in a window, by the GPU where it can be had; again and again */
    uint32_t gles_version;        /* a pupil_gles_version */
    char metering[64], white[64]; /* as the user said them, for the report */
    const char *command;          /* the whole command line, for the report; set by whoever has it */
} frame_options;

enum { OPTIONS_RUN = 0, OPTIONS_HELP = 1, OPTIONS_USAGE = -1 };

/* Refuses outputs that are named twice, that lie in one another or are also an input, or that would share standard
 * output. */
int frame_options_check_paths(const frame_options *options, pupil_why *why);

#endif
