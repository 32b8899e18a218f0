/* drivers/file/common/folder.h: folders walked without taking memory, so that they are removed where memory is short,
 * too.
 */
#ifndef PUPIL_DRIVERS_FILE_COMMON_FOLDER_H
#define PUPIL_DRIVERS_FILE_COMMON_FOLDER_H

#include <dirent.h>

/* The folder that `path` is in, to be freed. NULL: no memory. */
char *folder_of(const char *path);

/* The next entry but "." and "..". NULL: there is none (errno is 0), or the folder cannot be read (errno). */
struct dirent *folder_next(DIR *folder);

/* Removes the folder and what is in it. 0 or an errno; what is gone already is no error. */
int folder_remove(const char *path);

/* The same of a file or a folder in a folder that is open. */
int folder_remove_entry(int folder, const char *name);

/* To the disk: a file, or a folder and the files in it (not in folders within). 0 or an errno. */
int folder_flush_file(int fd);
int folder_flush(int folder);

#endif
