/* drivers/file/recording/recording_folder.c: the folder that a recording is written into, and its recording.json. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/common/folder.h"
#include "recording_format.h"
#include "refuse.h"

static const char *const names[] = {PUPIL_RECORDING_ABOUT, PUPIL_RECORDING_PART, PUPIL_RECORDING_LINES,
                                    PUPIL_RECORDING_FRAMES};
#define NAMES (sizeof names / sizeof names[0])

void pupil_recording_remove_files(const char *folder)
{
    char path[PATH_MAX];
    for (size_t i = 0; i < NAMES; i++) /* recording.json first: without it the rest is no recording */
        if (pupil_recording_path(path, folder, names[i]) == 0)
            unlink(path);
}

static int is_ours(const char *name)
{
    for (size_t i = 0; i < NAMES; i++)
        if (strcmp(name, names[i]) == 0)
            return 1;
    return 0;
}

/* An existing folder may be empty, or hold a recording and nothing else if it is to be overwritten. */
static int look_through(const char *path, int overwrite, pupil_why *why)
{
    DIR *folder = opendir(path);
    struct dirent *entry;
    int failed = 0;
    if (!folder)
        return pupil_refuse(why, "%s: is not a folder that can be used: %s", path, strerror(errno));
    while (!failed && (entry = folder_next(folder)) != NULL) {
        if (!is_ours(entry->d_name))
            failed = pupil_refuse(why,
                                  "%s: is not used, for it holds %s, which is not part of a recording; name another "
                                  "folder",
                                  path, entry->d_name);
        else if (!overwrite)
            failed = pupil_refuse(
                why, "%s: is a recording already; name another folder, or overwrite it (-y, --overwrite)", path);
    }
    if (!failed && errno)
        failed = pupil_refuse(why, "%s: the folder cannot be read: %s", path, strerror(errno));
    closedir(folder);
    return failed;
}

int pupil_recording_make_folder(const char *folder, int overwrite, pupil_why *why)
{
    if (!*folder)
        return pupil_refuse(why, "\"\": a recording needs a name, of a folder");
    if (mkdir(folder, 0777) == 0)
        return 1;
    if (errno == ENOENT)
        return pupil_refuse(why, "%s: the folder that it is to be in is not there; make it first", folder);
    if (errno != EEXIST)
        return pupil_refuse(why, "%s: the folder cannot be made: %s", folder, strerror(errno));
    if (look_through(folder, overwrite, why))
        return -1;
    pupil_recording_remove_files(folder);
    return 0;
}

int pupil_recording_create(const char *folder, const char *name, pupil_why *why)
{
    char path[PATH_MAX];
    if (pupil_recording_path(path, folder, name))
        return pupil_refuse(why, "%s: the name is too long", folder);
    const int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return pupil_refuse(why, "%s: cannot be made: %s", path, strerror(errno));
    return fd;
}

/* recording.json takes its place complete. */
int pupil_recording_about_write(const char *folder, const pupil_recording_about *about, const char *camera,
                                pupil_why *why)
{
    char part[PATH_MAX], path[PATH_MAX], *text = pupil_recording_about_text(about, camera);
    const int fd = text ? pupil_recording_create(folder, PUPIL_RECORDING_PART, why) : -1;
    if (fd < 0) {
        free(text);
        return text ? -1 : pupil_refuse(why, "%s: not enough memory", folder);
    }
    FILE *file = fdopen(fd, "w");
    int failed = !file || fprintf(file, "%s\n", text) < 0;
    failed |= (file ? fclose(file) : close(fd)) != 0;
    free(text);
    if (!failed)
        failed = pupil_recording_path(part, folder, PUPIL_RECORDING_PART) ||
                 pupil_recording_path(path, folder, PUPIL_RECORDING_ABOUT) || rename(part, path);
    return failed ? pupil_refuse(why, "%s/" PUPIL_RECORDING_ABOUT ": cannot be written: %s", folder, strerror(errno))
                  : 0;
}
