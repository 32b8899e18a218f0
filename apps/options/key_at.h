/* apps/options/key_at.h: --key-at: what the key is to be by the light of the scene. */
#ifndef PUPIL_APPS_OPTIONS_KEY_AT_H
#define PUPIL_APPS_OPTIONS_KEY_AT_H

#include "pupil/sensor.h"

extern const char key_at_right[]; /* what would be right, for a sentence */

/* "EV:KEY,EV:KEY,..." into key_at of a config that is otherwise right. 0; -1: it is not as key_at_right says, and the
 * config is as it was. */
int key_at_parse(const char *text, pupil_sensor_config *config);

#endif
