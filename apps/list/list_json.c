/* apps/list/list_json.c: the list of cameras as JSON. */
#include "list_json.h"

#include <stdlib.h>

#include "file/common/utf8.h"
#include "list.h"

const char *list_json_refusal(void)
{
    return NULL;
}

int list_json_text(cJSON *object, const char *name, const char *text)
{
    char *copy = utf8_of(text);
    const int added = copy && cJSON_AddStringToObject(object, name, copy);
    free(copy);
    return added;
}

static int add_size(cJSON *sizes, const pupil_live_size *size)
{
    cJSON *object = cJSON_CreateObject(), *fps = NULL;
    if (!object || !cJSON_AddItemToArray(sizes, object))
        return 0;
    int added = cJSON_AddNumberToObject(object, "width", size->width) &&
                cJSON_AddNumberToObject(object, "height", size->height);
    if (added && (size->step_width || size->step_height))
        added = cJSON_AddNumberToObject(object, "max_width", size->max_width) &&
                cJSON_AddNumberToObject(object, "max_height", size->max_height) &&
                cJSON_AddNumberToObject(object, "step_width", size->step_width) &&
                cJSON_AddNumberToObject(object, "step_height", size->step_height);
    added = added && (fps = cJSON_AddArrayToObject(object, size->fps_between ? "fps_range" : "fps")) != NULL;
    for (uint32_t i = 0; added && i < size->rates; i++)
        added = cJSON_AddItemToArray(fps, cJSON_CreateNumber(size->fps[i]));
    return added;
}

static int add_mode(cJSON *formats, const pupil_live_mode *mode)
{
    cJSON *object = cJSON_CreateObject(), *sizes = NULL;
    if (!object || !cJSON_AddItemToArray(formats, object))
        return 0;
    int added =
        list_json_text(object, "fourcc", mode->name) && list_json_text(object, "description", mode->description) &&
        cJSON_AddBoolToObject(object, "read", mode->read) && (sizes = cJSON_AddArrayToObject(object, "sizes")) != NULL;
    for (uint32_t i = 0; added && i < mode->sizes; i++)
        added = add_size(sizes, &mode->size[i]);
    return added;
}

int list_json_camera(cJSON *object, const pupil_live_identity *is, const pupil_live_modes *modes)
{
    cJSON *formats = NULL;
    int added = list_json_text(object, "path", is->path) && list_json_text(object, "name", is->name) &&
                list_json_text(object, "driver", is->driver) && list_json_text(object, "bus", is->bus) &&
                (formats = cJSON_AddArrayToObject(object, "formats")) != NULL;
    for (uint32_t i = 0; added && i < modes->count; i++)
        added = add_mode(formats, &modes->mode[i]);
    return added;
}

static int add_camera(cJSON *list, const list_camera *camera)
{
    cJSON *object = cJSON_CreateObject();
    if (!object || !cJSON_AddItemToArray(list, object))
        return 0;
    return list_json_camera(object, &camera->is, &camera->modes);
}

char *list_json(const list_camera *cameras, size_t count)
{
    cJSON *list = cJSON_CreateArray();
    char *text = NULL;
    size_t i = 0;
    while (list && i < count && add_camera(list, &cameras[i]))
        i++;
    if (list && i == count)
        text = cJSON_Print(list);
    cJSON_Delete(list);
    return text;
}
