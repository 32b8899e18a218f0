/* apps/replay/options.h: the command line of `pupil replay`. */
#ifndef PUPIL_APPS_REPLAY_OPTIONS_H
#define PUPIL_APPS_REPLAY_OPTIONS_H

#include "options/frame_options.h"

/* As options_parse, with the defaults set before. Moves the inputs to the front of argv. */
int replay_options_parse(frame_options *options, int argc, char **argv, pupil_why *why);

/* One of the two of --compare. */
typedef struct replay_side {
    frame_options options;
    const char *label; /* the label of its picture */
    char words[1024];  /* `options` points into it */
} replay_side;

/* The parsed `options`, and in addition those of options->compare[which]. OPTIONS_RUN, or OPTIONS_USAGE and a
 * sentence. */
int replay_options_side(const frame_options *options, int which, replay_side *side, pupil_why *why);

#endif
