/* apps/options/colour_options.h: --white-balance, --matrix, --black-level and --knees: the colour of raw frames. */
#ifndef PUPIL_APPS_OPTIONS_COLOUR_OPTIONS_H
#define PUPIL_APPS_OPTIONS_COLOUR_OPTIONS_H

#include "colour/white_balance.h"
#include "option_table.h"

/* For rows whose offset is that of a pupil_colour_options. */
int colour_option_balance(const option_value *value);
int colour_option_matrix(const option_value *value);
int colour_option_black(const option_value *value);
int colour_option_knees(const option_value *value);

#endif
