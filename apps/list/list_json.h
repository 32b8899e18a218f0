/* apps/list/list_json.h: the parts of a list that are also in other JSON of this program. Each: 0 if memory is
 * short. */
#ifndef PUPIL_APPS_LIST_LIST_JSON_H
#define PUPIL_APPS_LIST_LIST_JSON_H

#include <cjson/cJSON.h>

#include "live_source.h"

int list_json_text(cJSON *object, const char *name, const char *text);
/* "path", "name", "driver", "bus" and "formats". */
int list_json_camera(cJSON *object, const pupil_live_identity *is, const pupil_live_modes *modes);

#endif
