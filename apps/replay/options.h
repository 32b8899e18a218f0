/* apps/replay/options.h: the command line of `pupil replay`. */
#ifndef PUPIL_APPS_REPLAY_OPTIONS_H
#define PUPIL_APPS_REPLAY_OPTIONS_H

#include "options/frame_options.h"
#include "pupil/error.h"

/* OPTIONS_RUN; OPTIONS_HELP where help was asked for; OPTIONS_USAGE and a sentence that names the option. */
int replay_options_parse(frame_options *options, int argc, char **argv, pupil_why *why);

extern const char replay_help[];

#endif
