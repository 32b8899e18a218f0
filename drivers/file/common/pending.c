#include "file/common/pending.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "beside.h"
#include "folder.h"
#include "refuse.h"

/* Links followed in a chain, as many as Linux follows. */
#define LINKS 40

static int is_frame_name(const char *name)
{
    size_t digits;
    if (strncmp(name, "frame_", 6) != 0)
        return 0;
    digits = strspn(name + 6, "0123456789");
    return digits >= 6 && (strcmp(name + 6 + digits, ".png") == 0 || strcmp(name + 6 + digits, ".exr") == 0);
}

/* Counts a folder's entries, and finds the first that is no file named frame_NNNNNN.png or .exr (first_other).
 */
static int look_through(const char *path, size_t *entries, char first_other[NAME_MAX + 1])
{
    DIR *folder = opendir(path);
    struct dirent *entry;
    *entries = 0;
    first_other[0] = 0;
    if (!folder)
        return -1;
    while ((entry = folder_next(folder)) != NULL) {
        struct stat s;
        ++*entries;
        if (!first_other[0] &&
            (!is_frame_name(entry->d_name) || fstatat(dirfd(folder), entry->d_name, &s, AT_SYMLINK_NOFOLLOW) != 0 ||
             !S_ISREG(s.st_mode)))
            snprintf(first_other, NAME_MAX + 1, "%s", entry->d_name);
    }
    const int error = errno;
    closedir(folder);
    errno = error;
    return error ? -1 : 0;
}

static int may_replace(const char *path, const char *shown, int overwrite, pupil_why *why)
{
    char other[NAME_MAX + 1];
    size_t entries;
    if (look_through(path, &entries, other))
        return pupil_refuse(why, "%s: the folder cannot be read: %s", shown, strerror(errno));
    if (entries && !overwrite)
        return pupil_refuse(
            why, "%s: is there already and not empty; name another folder, or overwrite it (-y, --overwrite)", shown);
    if (other[0])
        return pupil_refuse(
            why,
            "%s: is not overwritten, for it holds %s, which is not a frame_NNNNNN.png or .exr; name another folder",
            shown, other);
    return 0;
}

/* Where a link leads, whether or not anything is there. NULL: it is no link. */
static char *led_to(const char *path)
{
    char target[PATH_MAX], *folder = folder_of(path), *joined = NULL;
    const ssize_t length = readlink(path, target, sizeof target - 1);
    if (folder && length > 0) {
        target[length] = 0;
        if (asprintf(&joined, "%s%s%s", *target == '/' ? "" : folder, *target == '/' ? "" : "/", target) < 0)
            joined = NULL;
    }
    free(folder);
    return joined;
}

/* Where the output will be: without slashes at the end, and where a link leads, so that the link stays. */
static char *final_path(const char *path)
{
    char *at = strdup(path), *next;
    size_t length = strlen(path);
    while (at && length > 1 && at[length - 1] == '/')
        at[--length] = 0;
    for (int i = 0; at && i < LINKS && (next = led_to(at)) != NULL; i++) {
        free(at);
        at = next;
    }
    char *real = at ? realpath(at, NULL) : NULL;
    if (!real || strcmp(at, path) == 0) {
        free(real);
        return at;
    }
    free(at);
    return real;
}

/* Its stat. */
static int check_parent(const char *path, struct stat *parent, pupil_why *why)
{
    char *folder = folder_of(path);
    int failed = 0;
    if (!folder)
        return pupil_refuse(why, "%s: out of memory", path);
    if (stat(folder, parent) != 0)
        failed = errno == ENOENT
                     ? pupil_refuse(why, "%s: there is no folder %s; make it first", path, folder)
                     : pupil_refuse(why, "%s: the folder %s cannot be used: %s", path, folder, strerror(errno));
    else if (!S_ISDIR(parent->st_mode))
        failed = pupil_refuse(why, "%s: %s is a file, not a folder", path, folder);
    free(folder);
    return failed;
}

/* "a.mp4" becomes "a-1.mp4", or the first such name that is free. NULL: none is found. */
static char *free_name(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    const char *end = dot && dot != name ? dot : name + strlen(name);
    for (int i = 1; i <= BESIDE_ATTEMPTS; i++) {
        char *made;
        struct stat s;
        if (asprintf(&made, "%.*s-%d%s", (int)(end - path), path, i, end) < 0)
            return NULL;
        if (lstat(made, &s) != 0 && errno == ENOENT)
            return made;
        free(made);
    }
    return NULL;
}

int pupil_pending_keep(const char *path, pupil_why *why)
{
    char *other = free_name(path);
    pupil_refuse(why, "%s: is there already; -y replaces it, and %s is free", path, other ? other : "another name");
    free(other);
    return -1;
}

/* The old file may be readable by its owner only, and so must be the new one, from its first byte on. */
static void keep_mode(const pupil_pending *p, mode_t more)
{
    if (p->mode)
        (void)!fchmod(p->fd, (mode_t)p->mode | more); /* a file system may have no modes */
}

static int check_there(pupil_pending *p, const struct stat *parent, pupil_why *why)
{
    struct stat s;
    if (stat(p->path, &s) != 0) {
        if (errno == ENOENT)
            return 0;
        return pupil_refuse(why, "%s: cannot be written: %s", p->path, strerror(errno));
    }
    p->mode = s.st_mode & 0777;
    if (!p->is_folder) {
        if (S_ISDIR(s.st_mode))
            return pupil_refuse(why, "%s: is a folder; name a file", p->path);
        return p->overwrite ? 0 : pupil_pending_keep(p->path, why);
    }
    if (!S_ISDIR(s.st_mode))
        return pupil_refuse(why, "%s: is a file; name a folder", p->path);
    if (s.st_dev != parent->st_dev) /* rename cannot replace it */
        return pupil_refuse(why, "%s: is a mount point; name a folder inside it", p->path);
    return p->is_merged ? 0 : may_replace(p->path, p->path, p->overwrite, why);
}

static int prepare(pupil_pending *p, const char *path, pupil_why *why)
{
    struct stat parent, is;
    const char *slash, *name;
    if (!*path)
        return pupil_refuse(why, "\"\": an output needs a name");
    if (!p->is_folder && path[strlen(path) - 1] == '/')
        return pupil_refuse(why, "%s: is a folder; name a file", path);
    /* A rename would put a file in its place. The link of a process's own pipe leads nowhere. */
    if (stat(path, &is) == 0 && !S_ISREG(is.st_mode) && !S_ISDIR(is.st_mode))
        return pupil_refuse(why, "%s: is a device or a pipe; name a %s", path, p->is_folder ? "folder" : "file");
    p->path = final_path(path);
    if (!p->path)
        return pupil_refuse(why, "%s: out of memory", path);
    slash = strrchr(p->path, '/');
    name = slash ? slash + 1 : p->path;
    if (!*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return pupil_refuse(why, "%s: cannot be replaced; name a %s", path, p->is_folder ? "folder inside it" : "file");
    if (check_parent(p->path, &parent, why) || check_there(p, &parent, why))
        return -1;
    beside_sweep(p->path);
    p->temporary = beside_make(p->path, p->is_folder, "part", &p->fd);
    if (!p->temporary)
        return pupil_refuse(why, "%s: cannot be written there: %s", p->path, strerror(errno));
    keep_mode(p, p->is_folder ? S_IRWXU : S_IRUSR | S_IWUSR);
    return 0;
}

static int begin(pupil_pending *pending, const char *path, int is_folder, int is_merged, int overwrite, pupil_why *why)
{
    *pending = (pupil_pending){.is_folder = is_folder, .is_merged = is_merged, .overwrite = overwrite, .fd = -1};
    if (prepare(pending, path, why) == 0)
        return 0;
    pupil_pending_discard(pending);
    return -1;
}

int pupil_pending_file(pupil_pending *pending, const char *path, int overwrite, pupil_why *why)
{
    return begin(pending, path, 0, 0, overwrite, why);
}

int pupil_pending_folder(pupil_pending *pending, const char *path, int overwrite, pupil_why *why)
{
    return begin(pending, path, 1, 0, overwrite, why);
}

int pupil_pending_into(pupil_pending *pending, const char *path, int overwrite, pupil_why *why)
{
    return begin(pending, path, 1, 1, overwrite, why);
}

/* The output is looked for last, for it may just have lost its temporary name. */
int pupil_pending_is_begun(const pupil_pending *kept)
{
    struct stat is;
    return (kept->temporary && beside_is_held(kept->path, kept->temporary)) || lstat(kept->path, &is) == 0;
}

/* The own name is made before others are looked for, so that of two processes one sees the other's. */
int pupil_pending_reserve(pupil_pending *pending, const char *path)
{
    *pending = (pupil_pending){.fd = -1, .path = final_path(path)};
    if (!pending->path)
        return 0;
    pending->temporary = beside_make(pending->path, 0, "part", &pending->fd);
    const int taken = pupil_pending_is_begun(pending);
    if (taken)
        pupil_pending_discard(pending);
    return taken;
}

/* Moves the old folder aside and the new one into its place, and only then removes the old one. The old one is checked
 * again once it is aside, where no other program puts anything into it. */
static int swap_folders(pupil_pending *p, pupil_why *why)
{
    int failed = 0, fd = -1;
    char *aside = beside_make(p->path, 1, "old", &fd);
    if (!aside || rename(p->path, aside) != 0) {
        failed = pupil_refuse(why, "%s: the old folder cannot be moved aside: %s", p->path, strerror(errno));
        if (aside)
            rmdir(aside);
    } else if (may_replace(aside, p->path, 1, why)) {
        failed = -1;
        rename(aside, p->path);
    } else if (rename(p->temporary, p->path) != 0) {
        failed = pupil_refuse(why, "%s: cannot be put in place: %s", p->path, strerror(errno));
        rename(aside, p->path);
    } else {
        free(p->temporary); /* in place; nothing to take back */
        p->temporary = NULL;
        if (folder_remove(aside) != 0)
            failed =
                pupil_refuse(why, "%s: is in place, but the old folder, now %s, cannot be removed", p->path, aside);
    }
    if (fd >= 0)
        close(fd);
    free(aside);
    return failed;
}

/* The renames survive a power cut once the parent folder's entries are on the disk. Without one, a failure here loses
 * nothing. */
static void flush_parent(const char *path)
{
    char *folder = folder_of(path);
    const int fd = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (fd >= 0) {
        fsync(fd);
        close(fd);
    }
    free(folder);
}

FILE *pupil_pending_stream(const pupil_pending *pending)
{
    const int fd = fcntl(pending->fd, F_DUPFD_CLOEXEC, 0);
    FILE *file = fd >= 0 ? fdopen(fd, "w") : NULL;
    if (!file && fd >= 0)
        close(fd);
    return file;
}

/* Whether the temporary name is still that of the file that was made. */
static int check_ours(const pupil_pending *p, pupil_why *why)
{
    struct stat made, now;
    if (fstat(p->fd, &made) != 0 || lstat(p->temporary, &now) != 0)
        return pupil_refuse(why, "%s: cannot be put in place: %s: %s", p->path, p->temporary, strerror(errno));
    if (made.st_dev != now.st_dev || made.st_ino != now.st_ino)
        return pupil_refuse(why, "%s: cannot be put in place: %s was replaced by another file", p->path, p->temporary);
    return 0;
}

enum { NO_REPLACE = 1 }; /* RENAME_NOREPLACE: musl 1.2.3 has neither this nor a function for the call */

/* Renames without replacing a file: atomically in the kernel, where the file system can. */
static int move_to(const pupil_pending *p, const char *path)
{
    if (syscall(SYS_renameat2, AT_FDCWD, p->temporary, AT_FDCWD, path, NO_REPLACE) == 0)
        return 0;
    if (errno != EINVAL && errno != ENOSYS)
        return -1;
    if (!p->is_folder && link(p->temporary, path) == 0)
        return unlink(p->temporary);
    return errno == EEXIST ? -1 : rename(p->temporary, path); /* a file system without links */
}

static int move(const pupil_pending *p)
{
    keep_mode(p, 0);
    return p->is_folder || p->overwrite ? rename(p->temporary, p->path) : move_to(p, p->path);
}

/* Another program has made something of this name since the output was begun: it stays, and the output gets a free
 * name. Returns -1. */
static int put_beside(pupil_pending *p, pupil_why *why)
{
    char *other = free_name(p->path);
    if (!other || move_to(p, other) != 0) {
        free(other);
        return p->is_folder
                   ? pupil_refuse(why, "%s: files were put there in the meantime; name another folder", p->path)
                   : pupil_pending_keep(p->path, why);
    }
    pupil_refuse(why, "%s: was made by another program in the meantime; this output is complete, as %s", p->path,
                 other);
    free(other);
    free(p->temporary);
    p->temporary = NULL;
    return -1;
}

int pupil_pending_show(pupil_pending *pending, pupil_why *why)
{
    if (check_ours(pending, why))
        return -1;
    if (move(pending) != 0)
        return errno == EEXIST ? pupil_pending_keep(pending->path, why)
                               : pupil_refuse(why, "%s: cannot be put in place: %s", pending->path, strerror(errno));
    free(pending->temporary);
    pending->temporary = NULL;
    return 0;
}

/* Moves each file of the folder into the existing one; `look`: only checks whether that is possible. */
static int merge(const pupil_pending *p, int look, pupil_why *why)
{
    DIR *folder = opendir(p->temporary);
    const int to = open(p->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    struct dirent *entry;
    struct stat is;
    int failed = folder && to >= 0 ? 0 : pupil_refuse(why, "%s: cannot be opened: %s", p->path, strerror(errno));
    while (!failed && (entry = folder_next(folder)) != NULL) {
        const char *name = entry->d_name;
        const int there = fstatat(to, name, &is, AT_SYMLINK_NOFOLLOW) == 0;
        if (there && (!p->overwrite || !S_ISREG(is.st_mode)))
            failed = pupil_refuse(why, "%s/%s: is there already%s", p->path, name, p->overwrite ? ", and no file" : "");
        else if (!look && renameat(dirfd(folder), name, to, name) != 0)
            failed = pupil_refuse(why, "%s/%s: cannot be put in place: %s", p->path, name, strerror(errno));
    }
    if (!failed && errno) /* else files would be left out, and go with the temporary folder */
        failed = pupil_refuse(why, "%s: cannot be read: %s", p->temporary, strerror(errno));
    if (folder)
        closedir(folder);
    if (to >= 0)
        close(to);
    return failed;
}

static int put_in_place(pupil_pending *pending, pupil_why *why)
{
    if (check_ours(pending, why))
        return -1;
    if (move(pending) != 0) {
        const int there = errno == ENOTEMPTY || errno == EEXIST;
        if (!pending->is_folder && there)
            return put_beside(pending, why);
        if (!there)
            return pupil_refuse(why, "%s: cannot be put in place: %s", pending->path, strerror(errno));
        if (pending->is_merged) {
            if (merge(pending, 1, why) || merge(pending, 0, why))
                return -1;
            folder_remove(pending->temporary);
        } else if (!pending->overwrite)
            return put_beside(pending, why);
        else if (swap_folders(pending, why))
            return -1;
    }
    free(pending->temporary);
    pending->temporary = NULL;
    return 0;
}

int pupil_pending_commit(pupil_pending *pending, pupil_why *why)
{
    const int error = pending->is_folder ? folder_flush(pending->fd) : folder_flush_file(pending->fd);
    if (error)
        return pupil_refuse(why, "%s: cannot be written: %s", pending->path, strerror(error));
    if (pending->temporary && put_in_place(pending, why))
        return -1;
    flush_parent(pending->path);
    pupil_pending_discard(pending);
    return 0;
}

void pupil_pending_discard(pupil_pending *pending)
{
    if (pending->temporary && pending->is_folder)
        folder_remove(pending->temporary);
    else if (pending->temporary)
        unlink(pending->temporary);
    if (pending->path && pending->fd >= 0) /* all 0: never begun */
        close(pending->fd);
    free(pending->temporary);
    free(pending->path);
    memset(pending, 0, sizeof *pending);
    pending->fd = -1;
}
