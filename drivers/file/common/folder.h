/* drivers/file/common/folder.h: folders walked without allocating, so that they can be removed where memory is short,
 * too.
 */
#ifndef PUPIL_DRIVERS_FILE_COMMON_FOLDER_H
#define PUPIL_DRIVERS_FILE_COMMON_FOLDER_H

#include <dirent.h>

/* The folder that `path` is in, to be freed. NULL: no memory. */
char *folder_of(const char *path);

/* The next entry but "." and "..". NULL: there is none (errno is 0), or the folder cannot be read (errno). */
struct dirent *folder_next(DIR *folder);

/* Removes the folder and its entries. 0 or an errno; an entry that is gone already is no error. */
int folder_remove(const char *path);

/* The same for a file or folder in an open folder. */
int folder_remove_entry(int folder, const char *name);

/* Flushes to the disk: a file, or a folder and the files in it (not in its subfolders). 0 or an errno. */
int folder_flush_file(int fd);
int folder_flush(int folder);

#endif
