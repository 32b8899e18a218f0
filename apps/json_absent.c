/* apps/json_absent.c: replaces stats_json.c, list_json.c and probe/json.c in a build without cJSON. */
#include <stdlib.h>

#include "file/sink/sink_common.h"
#include "list/list.h"
#include "output/stats_json.h"
#include "probe/probe.h"
#include "refuse.h"

int pupil_stats_json_check(const char *path, pupil_why *why)
{
    return pupil_refuse(
        why, "%s: this program was built without cJSON (PUPIL_MEDIA=OFF); statistics can be a .csv file", path);
}

int pupil_stats_json_object(FILE *file, const frame_log_entry *record)
{
    (void)file, (void)record;
    abort(); /* the check does not let callers come here */
}

const char *list_json_refusal(void)
{
    return "this program was built without cJSON (PUPIL_MEDIA=OFF); without --json it is text";
}

char *list_json(const list_camera *cameras, size_t count)
{
    (void)cameras, (void)count;
    abort(); /* nor here */
}

char *probe_json(const probe_report *report)
{
    (void)report;
    abort();
}
