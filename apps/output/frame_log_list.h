/* apps/output/frame_log_list.h: the records of a run that may never end, for its plot, in memory that is taken once. */
#ifndef PUPIL_APPS_OUTPUT_FRAME_LOG_LIST_H
#define PUPIL_APPS_OUTPUT_FRAME_LOG_LIST_H

#include "frame_log.h"

typedef struct record_list {
    pupil_record *records; /* without their names */
    size_t count;
    uint64_t every, seen; /* one of each `every` is kept */
} record_list;

/* 0; -1: not enough memory. */
int record_list_open(record_list *list);
/* Where there is no more room, every second one of all goes. */
void record_list_add(record_list *list, const pupil_record *record);
void record_list_close(record_list *list);

#endif
