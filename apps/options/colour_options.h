/* apps/options/colour_options.h: --white-balance, --matrix and --black-level: what is asked of the colour of raw
 * frames. */
#ifndef PUPIL_APPS_OPTIONS_COLOUR_OPTIONS_H
#define PUPIL_APPS_OPTIONS_COLOUR_OPTIONS_H

#include <stddef.h>

#include "live/colour.h"
#include "pupil/error.h"

/* Each takes the option's value. 0, or -1 and a sentence that names the option and what would be right. */
int colour_option_balance(pupil_colour_options *options, const char *text, pupil_why *why);
int colour_option_matrix(pupil_colour_options *options, const char *text, pupil_why *why);
int colour_option_black(pupil_colour_options *options, const char *text, pupil_why *why);

#endif
