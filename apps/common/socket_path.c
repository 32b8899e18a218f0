#include "socket_path.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "refuse.h"

#define MOST_NAME 80 /* with "/proc/self/fd/2147483647/" in front */

int socket_path_open(socket_path *at, const char *path, pupil_why *why)
{
    const char *slash = strrchr(path, '/');
    char folder[PATH_MAX];
    *at = (socket_path){.address = {.sun_family = AF_UNIX}};
    if (strlen(path) < sizeof at->address.sun_path) {
        strcpy(at->address.sun_path, path);
        return 0;
    }
    if (!slash || strlen(slash + 1) > MOST_NAME || slash - path >= PATH_MAX)
        return pupil_refuse(why, "%s: must be a path of at most %zu bytes, or a name of at most %d in a folder", path,
                            sizeof at->address.sun_path - 1, MOST_NAME);
    snprintf(folder, sizeof folder, "%.*s/", (int)(slash - path), path);
    const int fd = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return pupil_refuse(why, "%s: its folder: %s", path, strerror(errno));
    at->folder = fd + 1;
    snprintf(at->address.sun_path, sizeof at->address.sun_path, "/proc/self/fd/%d/%.*s", fd, MOST_NAME, slash + 1);
    return 0;
}

void socket_path_close(socket_path *at)
{
    if (at->folder)
        close(at->folder - 1);
    at->folder = 0;
}
