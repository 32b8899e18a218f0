/* drivers/file/still/natural_order.h: lists of paths, and the order in which people count: frame2 before frame10. */
#ifndef PUPIL_DRIVERS_FILE_STILL_NATURAL_ORDER_H
#define PUPIL_DRIVERS_FILE_STILL_NATURAL_ORDER_H

#include <stddef.h>

typedef struct pupil_paths {
    char **path;
    size_t count, capacity;
} pupil_paths;

/* As strcmp, but runs of digits compare as numbers (of any length); names that differ only in leading zeros compare as
 * bytes, so only identical names are equal. */
int pupil_natural_compare(const char *a, const char *b);

/* Each returns 0, or -1 if memory runs out (folder and glob: also where reading fails; errno says why). */
int pupil_paths_add(pupil_paths *paths, const char *path);

/* Appends the files of a folder (no subfolders, nothing hidden) or of a glob pattern that `keep` accepts (NULL: all),
 * in natural order. */
int pupil_paths_folder(pupil_paths *paths, const char *folder, int (*keep)(const char *path));
int pupil_paths_glob(pupil_paths *paths, const char *pattern, int (*keep)(const char *path));

void pupil_paths_free(pupil_paths *paths);

#endif
