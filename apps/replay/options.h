/* apps/replay/options.h: the command line of `pupil replay`. */
#ifndef PUPIL_APPS_REPLAY_OPTIONS_H
#define PUPIL_APPS_REPLAY_OPTIONS_H

#include "options/frame_options.h"

/* As options_parse, with the defaults set before. Moves the inputs to the front of argv. */
int replay_options_parse(frame_options *options, int argc, char **argv, pupil_why *why);

#endif
