#include "write_all.h"

#include <errno.h>
#include <unistd.h>

int pupil_write_all(int fd, const void *bytes, size_t count)
{
    for (const char *from = bytes, *const end = from + count; from < end;) {
        const ssize_t wrote = write(fd, from, (size_t)(end - from));
        if (wrote > 0) {
            from += wrote;
        } else if (wrote == 0 || errno != EINTR) {
            errno = wrote ? errno : ENOSPC;
            return -1;
        }
    }
    return 0;
}
