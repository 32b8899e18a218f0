/* apps/list/list_json.h: the parts of a list that other JSON of this program has, too. Each: 0 where memory is short.
 */
#ifndef PUPIL_APPS_LIST_LIST_JSON_H
#define PUPIL_APPS_LIST_LIST_JSON_H

#include <cjson/cJSON.h>

#include "v4l2/modes.h"

int list_json_text(cJSON *object, const char *name, const char *text);
/* "path", "name", "driver", "bus" and "formats". */
int list_json_camera(cJSON *object, const pupil_v4l2_device *device, const pupil_v4l2_modes *modes);

#endif
