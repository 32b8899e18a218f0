/* Names of outputs with a time or a number in them, so that a service never finds its old file in the way. */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "file/common/pending.h"
#include "frame_options.h"
#include "refuse.h"

#define MOST_NUMBER 999999

/* Reserved numbers, kept until their outputs have begun, so that runs that begin together get different ones. */
static pupil_pending *kept;
static size_t kept_count;

void frame_options_release_paths(void)
{
    while (kept_count)
        pupil_pending_discard(&kept[--kept_count]);
    free(kept);
    kept = NULL;
}

/* A run that is killed later leaves nothing of these. */
void frame_options_release_begun(void)
{
    size_t still = 0;
    for (size_t i = 0; i < kept_count; i++) {
        if (pupil_pending_is_begun(&kept[i]))
            pupil_pending_discard(&kept[i]);
        else
            kept[still++] = kept[i];
    }
    kept_count = still;
}

/* 0; 1: another process has the name; -1 and a sentence. */
static int keep(const char *path, pupil_why *why)
{
    pupil_pending *more = realloc(kept, (kept_count + 1) * sizeof *kept);
    if (!more)
        return pupil_refuse(why, "not enough memory");
    if (!kept)
        atexit(frame_options_release_paths);
    kept = more;
    const int taken = pupil_pending_reserve(&kept[kept_count], path);
    kept_count += !taken;
    return taken;
}

enum { MOST_NAME = 4096 };

/* The place and length of a %d with a width (%04d); NULL: none. */
static const char *numbered(const char *path, size_t *length)
{
    for (const char *at = strchr(path, '%'); at; at = strchr(at + (at[1] ? 2 : 1), '%')) {
        const size_t digits = strspn(at + 1, "0123456789");
        if (digits && digits <= 2 && at[1 + digits] == 'd') {
            *length = digits + 2;
            return at;
        }
    }
    return NULL;
}

/* A %d that is the only pattern is a number, too. With other patterns it is strftime's day. */
static const char *alone(const char *path, size_t *length)
{
    const char *first = strchr(path, '%');
    if (!first || first[1] != 'd' || strchr(first + 1, '%'))
        return NULL;
    *length = 2;
    return first;
}

static int put_time(const char *path, time_t now, char *text, pupil_why *why)
{
    struct tm local;
    char longer[MOST_NAME];
    if (!strchr(path, '%')) {
        snprintf(text, MOST_NAME, "%s", path);
        return 0;
    }
    for (const char *at = strchr(path, '%'); at; at = strchr(at + 2, '%'))
        if (!isalpha((unsigned char)at[1]) && at[1] != '%')
            return pupil_refuse(why,
                                "%s: a %% is followed by a letter of date(1), or by digits and d for a number; %%%% "
                                "is the sign itself",
                                path);
    /* A letter first, so that an empty result means that it did not fit. */
    snprintf(longer, sizeof longer, "x%s", path);
    char filled[MOST_NAME];
    if (!localtime_r(&now, &local) || !strftime(filled, sizeof filled, longer, &local))
        return pupil_refuse(why, "%s: its pattern of time cannot be filled in", path);
    snprintf(text, MOST_NAME, "%s", filled + 1);
    return 0;
}

/* The first number whose name neither exists nor is reserved. */
static int put_number(const char *path, const char *at, size_t length, time_t now, char *text, pupil_why *why)
{
    const int width = length > 2 ? atoi(at + 1) : 0;
    struct stat is;
    for (int n = 0; n <= MOST_NUMBER; n++) {
        char name[MOST_NAME];
        snprintf(name, sizeof name, "%.*s%0*d%s", (int)(at - path), path, width, n, at + length);
        if (put_time(name, now, text, why))
            return -1;
        if (lstat(text, &is) == 0)
            continue;
        if (errno != ENOENT)
            return pupil_refuse(why, "%s: %s", text, strerror(errno));
        const int taken = keep(text, why);
        if (taken <= 0)
            return taken;
    }
    return pupil_refuse(why, "%s: all of its %d numbers are there already", path, MOST_NUMBER + 1);
}

static int expand(const char **path, time_t now, pupil_why *why)
{
    char text[MOST_NAME];
    size_t length = 0;
    if (!*path || !strchr(*path, '%'))
        return 0;
    if (strlen(*path) >= MOST_NAME / 2)
        return pupil_refuse(why, "%s: a path of over %d bytes", *path, MOST_NAME / 2);
    const char *at = numbered(*path, &length);
    if (!at)
        at = alone(*path, &length);
    if (at ? put_number(*path, at, length, now, text, why) : put_time(*path, now, text, why))
        return -1;
    *path = strdup(text);
    return *path ? 0 : pupil_refuse(why, "not enough memory");
}

int frame_options_expand_paths(frame_options *o, time_t now, pupil_why *why)
{
    const char **others[] = {&o->stats, &o->plot, &o->record};
    for (size_t i = 0; i < o->out_count; i++)
        if (expand(&o->out[i], now, why))
            return OPTIONS_USAGE;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (expand(others[i], now, why))
            return OPTIONS_USAGE;
    return OPTIONS_RUN;
}
