/* apps/list/list.h: pupil list: the cameras of the system. */
#ifndef PUPIL_APPS_LIST_LIST_H
#define PUPIL_APPS_LIST_LIST_H

#include <stdio.h>

#include "live/live.h"

typedef struct list_camera {
    pupil_live_identity is;
    pupil_live_modes modes;
} list_camera;

/* Writes the list to `out`, and to `err` a sentence for each node that could not be queried. Returns the program's exit
 * status. */
int list_cameras(const pupil_live_system *system, int json, FILE *out, FILE *err);

/* All of them as one array of JSON; to be freed; NULL: out of memory. */
char *list_json(const list_camera *cameras, size_t count);
/* Why there is no JSON in this build, or NULL. */
const char *list_json_refusal(void);

#endif
