/* apps/run/choose.h: what a live run chooses before it begins. */
#ifndef PUPIL_APPS_RUN_CHOOSE_H
#define PUPIL_APPS_RUN_CHOOSE_H

#include "options.h"
#include "pupil/error.h"

/* Puts the mode in the place of RUN_BEST, with a remark for the user if that is less than the best. -1 and a
 * sentence: the camera has not got what the options ask for. */
int run_choose_mode(run_options *options, const pupil_source *source, pupil_why *remark, pupil_why *why);

/* Outputs that would be in each other's way or in the camera's: OPTIONS_USAGE and a sentence. */
int run_choose_outputs(const run_options *options, pupil_why *why);

#endif
