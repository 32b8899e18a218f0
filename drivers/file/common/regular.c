#include "regular.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "refuse.h"

FILE *pupil_regular_open(const char *path, pupil_why *why)
{
    struct stat s;
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    int error = fd < 0 || fstat(fd, &s) != 0 ? errno : 0;
    const int is_other = !error && !S_ISREG(s.st_mode);
    FILE *file = !error && !is_other ? fdopen(fd, "r") : NULL;
    if (file)
        return file;
    if (is_other)
        pupil_refuse(why, "%s: is not a regular file", path);
    else
        pupil_refuse(why, "%s: cannot be read: %s", path, strerror(error ? error : errno));
    error = is_other ? EINVAL : error ? error : errno;
    if (fd >= 0)
        close(fd);
    errno = error;
    return NULL;
}
