/* One still in memory: room for pixels, the file's bytes, and the reader by the file's first bytes. */
#include "still.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "refuse.h"
#include "still_private.h"

#define MAX_FILE_BYTES INT64_C(0x80000000)

int pupil_still_fail(pupil_why *why, const char *format, ...)
{
    va_list arguments;
    if (!why)
        return -1;
    va_start(arguments, format);
    vsnprintf(why->text, sizeof why->text, format, arguments);
    va_end(arguments);
    for (char *c = why->text; *c; c++)
        if (*c < 0x20 || *c > 0x7e)
            *c = '?';
    return -1;
}

double pupil_parse_double(const char *text, char **end)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    double value;
    if (!c)
        return strtod(text, end);
    value = strtod_l(text, end, c);
    freelocale(c);
    return value;
}

void pupil_still_free(pupil_still *still)
{
    free(still->pixels);
    free(still->file);
    memset(still, 0, sizeof *still);
}

int pupil_still_size_ok(uint64_t width, uint64_t height, pupil_why *why)
{
    if (!width || !height)
        return pupil_still_fail(why, "the header promises %llu x %llu pixels; at least 1 x 1 are needed",
                                (unsigned long long)width, (unsigned long long)height);
    if (width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return pupil_still_fail(why, "the header promises %llu x %llu pixels; at most %u a side are read",
                                (unsigned long long)width, (unsigned long long)height, PUPIL_MAX_SIDE_PX);
    if (width * height > PUPIL_STILL_MAX_PIXELS)
        return pupil_still_fail(
            why, "the header promises %llu x %llu pixels; at most %llu in all (8192 x 8192) are read",
            (unsigned long long)width, (unsigned long long)height, (unsigned long long)PUPIL_STILL_MAX_PIXELS);
    return 0;
}

int pupil_still_reserve(pupil_still *still, uint64_t width, uint64_t height, uint32_t pixel, pupil_why *why)
{
    size_t need;
    if (pupil_still_size_ok(width, height, why))
        return -1;
    need = (size_t)(width * height) * pupil_pixel_bytes(pixel);
    if (need > still->capacity_bytes) {
        free(still->pixels);
        still->pixels = malloc(need);
        still->capacity_bytes = still->pixels ? need : 0;
        if (!still->pixels)
            return pupil_still_fail(why, "no memory for %llu x %llu pixels", (unsigned long long)width,
                                    (unsigned long long)height);
    }
    still->width = (uint32_t)width;
    still->height = (uint32_t)height;
    still->pixel = pixel;
    still->exposure_s = 0;
    return 0;
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
    return NULL;
}

static int load(pupil_still *still, const char *path, pupil_why *why)
{
    pupil_still_reader *reader;
    size_t size = 0;
    if (read_file(still, path, &size, why))
        return -1;
    reader = reader_for(still->file, size);
    if (!reader)
        return pupil_still_fail(why, "is no OpenEXR, Radiance, PFM or PNG file, by its first bytes");
    return reader(still, still->file, size, why);
}

int pupil_still_load(pupil_still *still, const char *path, pupil_why *why)
{
    pupil_why reason;
    if (load(still, path, &reason) == 0)
        return 0;
    pupil_refuse(why, "%s: %s", path, reason.text);
    return -1;
}
