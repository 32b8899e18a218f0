#include "beside.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "folder.h"

/* How much of the name goes into the temporary one, so that ".", ".PID-NN.part" still fit in NAME_MAX (255). */
#define NAME_PART 200

/* The name in its folder. */
static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Its descriptor, with a lock that ends with this process: a temporary without a lock was left by a killed process. -1,
 * with errno EEXIST: a run that sweeps has just taken this name, and another one is to be tried. */
static int make_locked(const char *made, int is_folder)
{
    struct stat s;
    int fd;
    if (is_folder && mkdir(made, 0777) != 0)
        return -1;
    fd = open(made, is_folder ? O_RDONLY | O_DIRECTORY | O_CLOEXEC : O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) {
        const int error = errno;
        if (is_folder)
            rmdir(made);
        errno = error;
        return -1;
    }
    const int is_swept = flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    const int error = fstat(fd, &s) != 0 ? errno : is_swept || s.st_nlink == 0 ? EEXIST : 0;
    if (error) {
        if (error != EEXIST)
            (is_folder ? rmdir : unlink)(made);
        close(fd);
        errno = error;
        return -1;
    }
    return fd; /* on a file system without locks, too: no process sweeps there */
}

char *beside_make(const char *path, int is_folder, const char *ending, int *fd)
{
    const char *name = name_of(path);
    for (int i = 0; i < BESIDE_ATTEMPTS; i++) {
        char number[16] = "", *made;
        if (i > 0)
            snprintf(number, sizeof number, "-%d", i);
        if (asprintf(&made, "%.*s.%.*s.%ld%s.%s", (int)(name - path), path, NAME_PART, name, (long)getpid(), number,
                     ending) < 0)
            return NULL;
        *fd = make_locked(made, is_folder);
        if (*fd >= 0)
            return made;
        free(made);
        if (errno != EEXIST)
            return NULL;
    }
    return NULL;
}

/* The ending of an entry called ".name.PID.ending" or ".name.PID-N.ending"; NULL: it has another form. */
static const char *ending_of(const char *entry, const char *name)
{
    const int length = (int)strnlen(name, NAME_PART);
    if (entry[0] != '.' || strncmp(entry + 1, name, (size_t)length) != 0 || entry[1 + length] != '.')
        return NULL;
    const char *number = entry + 2 + length, *end = number + strspn(number, "0123456789");
    if (end == number)
        return NULL;
    if (*end == '-')
        end += 1 + strspn(end + 1, "0123456789");
    return *end == '.' ? end + 1 : NULL;
}

void beside_sweep(const char *path)
{
    const char *name = name_of(path);
    char *parent = folder_of(path);
    DIR *folder = parent ? opendir(parent) : NULL;
    struct dirent *entry;
    while (folder && (entry = readdir(folder)) != NULL) {
        const char *ending = ending_of(entry->d_name, name);
        if (!ending || (strcmp(ending, "part") != 0 && (strcmp(ending, "old") != 0 || access(path, F_OK) != 0)))
            continue;
        const int fd = openat(dirfd(folder), entry->d_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0)
            folder_remove_entry(dirfd(folder), entry->d_name);
        if (fd >= 0)
            close(fd);
    }
    if (folder)
        closedir(folder);
    free(parent);
}

int beside_is_held(const char *path, const char *own)
{
    const char *name = name_of(path), *own_name = name_of(own);
    char *parent = folder_of(path);
    DIR *folder = parent ? opendir(parent) : NULL;
    struct dirent *entry;
    int held = 0;
    while (folder && !held && (entry = readdir(folder)) != NULL) {
        const char *ending = ending_of(entry->d_name, name);
        if (!ending || strcmp(ending, "part") != 0 || strcmp(entry->d_name, own_name) == 0)
            continue;
        const int fd = openat(dirfd(folder), entry->d_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        held = fd < 0 ? errno != ENOENT : flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
        if (fd >= 0)
            close(fd);
    }
    if (folder)
        closedir(folder);
    free(parent);
    return held;
}
