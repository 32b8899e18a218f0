/* apps/options/key_at.h: --key-at: the key as a function of the scene's light. */
#ifndef PUPIL_APPS_OPTIONS_KEY_AT_H
#define PUPIL_APPS_OPTIONS_KEY_AT_H

#include "pupil/config.h"

extern const char key_at_right[]; /* the right form, for a sentence */

/* Parses "EV:KEY,EV:KEY,..." into the points of a configuration. 0; -1: not as key_at_right says; nothing is
 * written. */
int key_at_parse(const char *text, pupil_key_point key_at[PUPIL_KEY_POINTS], uint32_t *key_points);

#endif
