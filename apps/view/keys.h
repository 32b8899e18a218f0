/* apps/view/keys.h: what the window's keys do to the settings. */
#ifndef PUPIL_APPS_VIEW_KEYS_H
#define PUPIL_APPS_VIEW_KEYS_H

#include <stddef.h>

#include "pupil/config.h"

/* 1: the key has changed a setting, and `said` names it; 0: the key changes no setting. Keys as of window.h. */
int view_keys_take(int key, pupil_config *config, char *said, size_t said_bytes);

/* "SECONDS, TAU 0.3 AND 0.9 S", "FORMULA 2, WEIGHT 0.05". */
void view_keys_law(const pupil_config *config, char *text, size_t text_bytes);

extern const char view_keys_help[];

#endif
