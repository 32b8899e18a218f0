/* One still in memory: the file's bytes, and the reader by the first of them. */
#include "still.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "refuse.h"
#include "still_private.h"

#define MAX_FILE_BYTES INT64_C(0x80000000)

void pupil_still_free(pupil_still *still)
{
    free(still->pixels);
    free(still->file);
    memset(still, 0, sizeof *still);
}

/* Reads to the end of the file, however it changes meanwhile. */
static int read_bytes(pupil_still *still, int fd, size_t size, size_t *got, pupil_why *why)
{
    *got = 0;
    if (size > still->file_capacity_bytes) {
        free(still->file);
        still->file = malloc(size);
        still->file_capacity_bytes = still->file ? size : 0;
        if (!still->file)
            return pupil_still_fail(why, "no memory for its %zu bytes", size);
    }
    while (*got < size) {
        ssize_t n = read(fd, still->file + *got, size - *got);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return pupil_still_fail(why, "cannot be read: %s", strerror(errno));
        if (n == 0)
            break;
        *got += (size_t)n;
    }
    return 0;
}

static int read_file(pupil_still *still, const char *path, size_t *size, pupil_why *why)
{
    struct stat status;
    int result, fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return pupil_still_fail(why, "cannot be opened: %s", strerror(errno));
    if (fstat(fd, &status) != 0)
        result = pupil_still_fail(why, "cannot be read: %s", strerror(errno));
    else if (S_ISDIR(status.st_mode))
        result = pupil_still_fail(why, "is a folder; an image file is needed here");
    else if (!S_ISREG(status.st_mode))
        result = pupil_still_fail(why, "is no regular file; an image file is needed here");
    else if (status.st_size == 0)
        result = pupil_still_fail(why, "the file is empty");
    else if (status.st_size > MAX_FILE_BYTES)
        result = pupil_still_fail(why, "the file has %lld bytes; at most 2 GiB are read", (long long)status.st_size);
    else
        result = read_bytes(still, fd, (size_t)status.st_size, size, why);
    close(fd);
    return result;
}

static pupil_still_reader *reader_for(const uint8_t *bytes, size_t size)
{
    static const struct {
        const char *magic;
        size_t length;
        pupil_still_reader *reader;
    } kinds[] = {
        {"\x76\x2f\x31\x01", 4, pupil_read_exr},
        {"\x89PNG", 4, pupil_read_png},
        {"#?", 2, pupil_read_radiance},
        {"PF", 2, pupil_read_pfm},
        {"Pf", 2, pupil_read_pfm},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (size >= kinds[i].length && memcmp(bytes, kinds[i].magic, kinds[i].length) == 0)
            return kinds[i].reader;
    return pupil_read_libav;
}

static int load(pupil_still *still, const char *path, pupil_why *why)
{
    size_t size = 0;
    if (read_file(still, path, &size, why))
        return -1;
    return reader_for(still->file, size)(still, still->file, size, why);
}

int pupil_still_load(pupil_still *still, const char *path, pupil_why *why)
{
    pupil_why reason;
    if (load(still, path, &reason) == 0)
        return 0;
    return pupil_refuse(why, "%s: %s", path, reason.text);
}
