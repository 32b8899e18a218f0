/* apps/options/veil_option.h: --veil: the age of the eye, or the Gaussians. */
#ifndef PUPIL_APPS_OPTIONS_VEIL_OPTION_H
#define PUPIL_APPS_OPTIONS_VEIL_OPTION_H

#include "pupil/veil.h"

/* "eye", "eye:AGE" or a file: lines of a standard deviation in degrees and a share of the light; # begins a comment.
 * Sets psf, age_years and the Gaussians of a configuration. 0; -1 and a sentence: nothing is set. */
int veil_option_parse(const char *text, pupil_veil_config *config, pupil_why *why);

#endif
