/* One still in memory: the file's bytes, and the reader that its first bytes select. */
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
#include "tiff_tags.h"

#define MAX_FILE_BYTES INT64_C(0x80000000)

void pupil_still_free(pupil_still *still)
{
    free(still->pixels);
    free(still->file);
    memset(still, 0, sizeof *still);
}

/* Reads to the end of the file, even if its size changes meanwhile. */
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
        result = pupil_still_fail(why, "is not a regular file; an image file is needed here");
    else if (status.st_size == 0)
        result = pupil_still_fail(why, "the file is empty");
    else if (status.st_size > MAX_FILE_BYTES)
        result = pupil_still_fail(why, "the file has %lld bytes; at most 2 GiB are read", (long long)status.st_size);
    else
        result = read_bytes(still, fd, (size_t)status.st_size, size, why);
    close(fd);
    return result;
}

/* A TIFF 6.0 whose first directory says that it is a DNG (1.7, DNGVersion), or that other directories belong to a
 * camera's picture (SubIFDs and Make). */
static int is_raw_tiff(const uint8_t *bytes, size_t size)
{
    enum { MAKE = 271, SUB_IFDS = 330, DNG_VERSION = 50706 };
    uint32_t value;
    return pupil_tiff_find(bytes, size, DNG_VERSION, &value) ||
           (pupil_tiff_find(bytes, size, MAKE, &value) && pupil_tiff_find(bytes, size, SUB_IFDS, &value));
}

static int is_raw(const uint8_t *bytes, size_t size)
{
    static const char *const magics[] = {"FUJIFILMCCD-RAW", "IIRO", "IIRS", "MMOR", "IIU"};
    for (size_t i = 0; i < sizeof magics / sizeof *magics; i++)
        if (size >= 64 && memcmp(bytes, magics[i], strlen(magics[i])) == 0)
            return 1;
    return is_raw_tiff(bytes, size) || (size >= 64 && memcmp(bytes + 4, "ftypcrx ", 8) == 0) ||
           (size >= 64 && memcmp(bytes, "II*\0\x10\0\0\0CR", 10) == 0);
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

static void set_most(pupil_still *still, size_t size)
{
    const uint64_t by_size = (uint64_t)size * PUPIL_STILL_PIXELS_FOR_BYTE;
    still->most = still->max_pixels                    ? still->max_pixels
                  : by_size > PUPIL_STILL_MAX_PIXELS   ? PUPIL_STILL_MAX_PIXELS
                  : by_size < PUPIL_STILL_SMALL_PIXELS ? PUPIL_STILL_SMALL_PIXELS
                                                       : by_size;
}

static int load(pupil_still *still, const char *path, pupil_why *why)
{
    size_t size = 0;
    if (read_file(still, path, &size, why))
        return -1;
    set_most(still, size);
    if (is_raw(still->file, size)) {
        const int failed = pupil_read_raw(still, still->file, size, why);
        if (failed != PUPIL_STILL_NOT_RAW)
            return failed;
    }
    return reader_for(still->file, size)(still, still->file, size, why);
}

int pupil_still_load(pupil_still *still, const char *path, pupil_why *why)
{
    pupil_why reason;
    if (load(still, path, &reason))
        return pupil_refuse(why, "%s: %s", path, reason.text);
    reason = still->notice;
    if (reason.text[0])
        pupil_refuse(&still->notice, "%s: %s", path, reason.text);
    return 0;
}
