/* apps/replay/options.h: the command line of `pupil replay`. */
#ifndef PUPIL_APPS_REPLAY_OPTIONS_H
#define PUPIL_APPS_REPLAY_OPTIONS_H

#include "pupil/error.h"
#include "pupil/gles.h"
#include "source.h"

#define REPLAY_MOST_OUTPUTS 16

typedef struct replay_options {
    const char *const *inputs; /* points into argv */
    size_t input_count;
    const char *out[REPLAY_MOST_OUTPUTS];
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
} replay_options;

enum { REPLAY_RUN = 0, REPLAY_HELP = 1, REPLAY_USAGE = 2 };

/* REPLAY_RUN; REPLAY_HELP where help was asked for; REPLAY_USAGE and a sentence that names the option. */
int replay_options_parse(replay_options *options, int argc, char **argv, pupil_why *why);

/* Refuses outputs that are named twice, that lie in one another or are also an input, or that would share standard
 * output. */
int replay_options_check_paths(const replay_options *options, pupil_why *why);

extern const char replay_help[];

#endif
