/* apps/run/choose.h: what a live run chooses before it begins. */
#ifndef PUPIL_APPS_RUN_CHOOSE_H
#define PUPIL_APPS_RUN_CHOOSE_H

#include "options.h"
#include "pupil/error.h"

/* Replaces RUN_BEST by a mode, with a remark for the user if it is not the best. -1 and a sentence: the camera lacks
 * what the options ask for. */
int run_choose_mode(run_options *options, const pupil_source *source, pupil_why *remark, pupil_why *why);

/* Refuses outputs that collide with each other or with the camera: OPTIONS_USAGE and a sentence. */
int run_choose_outputs(const run_options *options, pupil_why *why);

#endif
