/* Natural order, folders and glob patterns. */
#include "natural_order.h"

#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "file/common/folder.h"

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Two numbers of any length, without their leading zeros: the longer is the larger. */
static int compare_numbers(const char **a, const char **b)
{
    const char *x = *a, *y = *b;
    size_t m = 0, n = 0;
    int order;
    while (*x == '0')
        x++;
    while (*y == '0')
        y++;
    while (is_digit(x[m]))
        m++;
    while (is_digit(y[n]))
        n++;
    order = m != n ? (m < n ? -1 : 1) : strncmp(x, y, m);
    *a = x + m;
    *b = y + n;
    return order;
}

int pupil_natural_compare(const char *a, const char *b)
{
    const char *whole_a = a, *whole_b = b;
    while (*a && *b) {
        if (is_digit(*a) && is_digit(*b)) {
            int order = compare_numbers(&a, &b);
            if (order)
                return order;
        } else if (*a != *b) {
            return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
        } else {
            a++;
            b++;
        }
    }
    if (*a || *b)
        return *a ? 1 : -1;
    return strcmp(whole_a, whole_b);
}

static int compare_paths(const void *a, const void *b)
{
    return pupil_natural_compare(*(char *const *)a, *(char *const *)b);
}

int pupil_paths_add(pupil_paths *paths, const char *path)
{
    if (paths->count == paths->capacity) {
        size_t capacity = paths->capacity ? 2 * paths->capacity : 16;
        char **larger = realloc(paths->path, capacity * sizeof *larger);
        if (!larger)
            return -1;
        paths->path = larger;
        paths->capacity = capacity;
    }
    paths->path[paths->count] = strdup(path);
    if (!paths->path[paths->count])
        return -1;
    paths->count++;
    return 0;
}

void pupil_paths_free(pupil_paths *paths)
{
    for (size_t i = 0; i < paths->count; i++)
        free(paths->path[i]);
    free(paths->path);
    memset(paths, 0, sizeof *paths);
}

static void sort_from(pupil_paths *paths, size_t first)
{
    if (paths->count > first)
        qsort(paths->path + first, paths->count - first, sizeof *paths->path, compare_paths);
}

/* 1 where the file is wanted. So is one that stat() fails on: its reader will say why. */
static int wanted(const char *path, int (*keep)(const char *path))
{
    struct stat status;
    if (keep && !keep(path))
        return 0;
    return stat(path, &status) == 0 ? !S_ISDIR(status.st_mode) : errno != ENOENT;
}

int pupil_paths_folder(pupil_paths *paths, const char *folder, int (*keep)(const char *path))
{
    size_t first = paths->count, length = strlen(folder);
    const struct dirent *entry;
    int result = 0;
    DIR *directory = opendir(folder);
    if (!directory)
        return -1;
    while (result == 0 && (entry = folder_next(directory))) {
        char *path = NULL;
        if (entry->d_name[0] == '.')
            continue;
        if (asprintf(&path, "%s%s%s", folder, length && folder[length - 1] == '/' ? "" : "/", entry->d_name) < 0) {
            path = NULL;
            result = -1;
        } else if (wanted(path, keep)) {
            result = pupil_paths_add(paths, path);
        }
        free(path);
    }
    const int error = errno; /* 0: the end of the folder */
    closedir(directory);
    errno = error;
    result = error ? -1 : result;
    sort_from(paths, first);
    return result;
}

int pupil_paths_glob(pupil_paths *paths, const char *pattern, int (*keep)(const char *path))
{
    size_t first = paths->count;
    glob_t matches;
    int result = glob(pattern, GLOB_NOSORT, NULL, &matches);
    if (result == GLOB_NOMATCH)
        return 0;
    if (result != 0) {
        errno = result == GLOB_NOSPACE ? ENOMEM : EIO;
        return -1;
    }
    for (size_t i = 0; i < matches.gl_pathc && result == 0; i++)
        if (wanted(matches.gl_pathv[i], keep))
            result = pupil_paths_add(paths, matches.gl_pathv[i]);
    globfree(&matches);
    sort_from(paths, first);
    return result;
}
