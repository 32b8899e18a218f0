#include "frame_log_list.h"

#include <stdlib.h>

#include "plot_series.h"

enum { ROOM = 8 * PLOT_MOST_POINTS }; /* a plot that was thinned out is still finer than what is drawn */

int record_list_open(record_list *list)
{
    *list = (record_list){.records = calloc(ROOM, sizeof(pupil_record)), .every = 1};
    return list->records ? 0 : -1;
}

void record_list_add(record_list *list, const pupil_record *record)
{
    if (!list->records || list->seen++ % list->every)
        return;
    if (list->count == ROOM) {
        for (size_t i = 0; i < ROOM / 2; i++)
            list->records[i] = list->records[2 * i];
        list->count = ROOM / 2;
        list->every *= 2; /* ROOM is even: this one is kept */
    }
    list->records[list->count] = *record;
    list->records[list->count++].name = "";
}

void record_list_close(record_list *list)
{
    free(list->records);
    *list = (record_list){0};
}
