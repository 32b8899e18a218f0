#include "frame_log.h"

#include <stdlib.h>
#include <string.h>

enum { FIRST_ROOM = 1024 };

static int make_room(frame_log *log, size_t capacity)
{
    frame_log_entry *more = realloc(log->entry, capacity * sizeof *more);
    if (!more)
        return -1;
    log->entry = more;
    log->capacity = capacity;
    return 0;
}

int frame_log_open(frame_log *log, int bounded)
{
    *log = (frame_log){.is_bounded = bounded, .every = 1};
    return make_room(log, bounded ? FRAME_LOG_BOUND : FIRST_ROOM);
}

/* The bound is even, so the next entry is one to keep. */
static void thin_out(frame_log *log)
{
    for (size_t i = 0; i < FRAME_LOG_BOUND / 2; i++)
        log->entry[i] = log->entry[2 * i];
    log->count = FRAME_LOG_BOUND / 2;
    log->every *= 2;
}

int frame_log_add(frame_log *log, const frame_log_entry *entry)
{
    if (!log->capacity || log->seen++ % log->every)
        return 0;
    if (log->count == log->capacity && log->is_bounded)
        thin_out(log);
    if (log->count == log->capacity && make_room(log, 2 * log->capacity))
        return -1;
    frame_log_entry *kept = &log->entry[log->count];
    *kept = *entry;
    kept->name = log->is_bounded ? "" : strdup(entry->name); /* the source's name lives only as long as the frame */
    log->count += kept->name != NULL;
    return kept->name ? 0 : -1;
}

void frame_log_close(frame_log *log)
{
    for (size_t i = 0; i < log->count && !log->is_bounded; i++)
        free((char *)(uintptr_t)log->entry[i].name);
    free(log->entry);
    *log = (frame_log){0};
}
