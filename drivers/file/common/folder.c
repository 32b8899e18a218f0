#include "folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return !slash ? strdup(".") : strndup(path, slash == path ? 1 : (size_t)(slash - path));
}

struct dirent *folder_next(DIR *folder)
{
    struct dirent *entry;
    do {
        errno = 0;
        entry = readdir(folder);
    } while (entry && (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0));
    return entry;
}

/* getdents64(2): glibc's readdir allocates memory, and musl has no other name for this. */
typedef struct directory_entry {
    uint64_t inode;
    int64_t offset;
    uint16_t bytes;
    uint8_t type;
    char name[];
} directory_entry;

#define DEPTH_MOST 16 /* nested folders; outputs have one level */

typedef int act_on(int folder, const char *name, int depth); /* 0 or an errno */

/* Calls `act` for each entry; `acted` counts the successes. */
static int for_each(int folder, act_on *act, int depth, unsigned long *acted)
{
    _Alignas(directory_entry) char block[4096];
    long bytes;
    int error = 0;
    *acted = 0;
    if (lseek(folder, 0, SEEK_SET) != 0)
        return errno;
    while ((bytes = syscall(SYS_getdents64, folder, block, sizeof block)) > 0)
        for (long at = 0; at < bytes;) {
            const directory_entry *entry = (const void *)(block + at);
            at += entry->bytes;
            if (strcmp(entry->name, ".") == 0 || strcmp(entry->name, "..") == 0)
                continue;
            const int failed = act(folder, entry->name, depth);
            error = error ? error : failed;
            *acted += !failed;
        }
    return bytes < 0 && !error ? errno : error;
}

static int removed(int folder, const char *name, int flags)
{
    return unlinkat(folder, name, flags) != 0 && errno != ENOENT ? errno : 0;
}

static int remove_entry(int folder, const char *name, int depth)
{
    const int inner = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    unsigned long gone = 1;
    int error = depth == DEPTH_MOST ? ELOOP : 0;
    if (inner < 0)
        return errno == ENOTDIR || errno == ELOOP ? removed(folder, name, 0) : errno == ENOENT ? 0 : errno;
    while (!error && gone) /* again: removing entries may make a listing skip others */
        error = for_each(inner, remove_entry, depth + 1, &gone);
    close(inner);
    return error ? error : removed(folder, name, AT_REMOVEDIR);
}

int folder_remove_entry(int folder, const char *name)
{
    return remove_entry(folder, name, 0);
}

int folder_remove(const char *path)
{
    return folder_remove_entry(AT_FDCWD, path);
}

int folder_flush_file(int fd)
{
    return fsync(fd) != 0 && errno != EINVAL && errno != EROFS ? errno : 0; /* these two: it cannot sync */
}

static int flush_entry(int folder, const char *name, int depth)
{
    (void)depth;
    const int fd = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const int error = fd < 0 ? errno : folder_flush_file(fd);
    if (fd >= 0)
        close(fd);
    return error;
}

int folder_flush(int folder)
{
    unsigned long flushed;
    const int error = for_each(folder, flush_entry, 0, &flushed);
    return error ? error : folder_flush_file(folder);
}
