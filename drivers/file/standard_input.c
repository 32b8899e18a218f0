#include "standard_input.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/common/write_all.h"
#include "refuse.h"

#define PEEK_BYTES 64 /* an MP4's first box has 16 to 48, and the next one 8 to begin with */
#define MOST_BYTES INT64_C(0x80000000)

/* Whether to retry a read or write: a signal interrupted it, and the program is not to stop. */
static int again(int (*stop)(void))
{
    return errno == EINTR && !(stop && stop());
}

/* Copies the first bytes of a pipe, which stay in it. Their number; -1: errno says why. */
static ssize_t peek_pipe(uint8_t bytes[PEEK_BYTES], int (*stop)(void))
{
    int copy[2];
    ssize_t size, got;
    if (pipe2(copy, O_CLOEXEC))
        return -1;
    do
        size = tee(STDIN_FILENO, copy[1], PEEK_BYTES, 0);
    while (size < 0 && again(stop));
    do
        got = size > 0 ? read(copy[0], bytes, (size_t)size) : size;
    while (size > 0 && got < 0 && again(stop));
    const int error = errno;
    close(copy[0]);
    close(copy[1]);
    errno = error;
    return got;
}

/* The first bytes of standard input, without consuming them. None of a terminal or a socket. */
static ssize_t peek(uint8_t bytes[PEEK_BYTES], int *is_file, int (*stop)(void))
{
    struct stat is;
    *is_file = 0;
    if (fstat(STDIN_FILENO, &is) != 0)
        return -1;
    *is_file = S_ISREG(is.st_mode);
    if (S_ISFIFO(is.st_mode))
        return peek_pipe(bytes, stop);
    return *is_file ? pread(STDIN_FILENO, bytes, PEEK_BYTES, lseek(STDIN_FILENO, 0, SEEK_CUR)) : 0;
}

static int begins(const uint8_t *bytes, size_t size, const char *with, size_t length)
{
    return size >= length && memcmp(bytes, with, length) == 0;
}

/* OpenEXR, PNG, Radiance, PFM, TIFF. Not JPEG: a stream of JPEGs begins like a single one, and libav reads both. */
static int is_still(const uint8_t *bytes, size_t size)
{
    return begins(bytes, size, "\x76\x2f\x31\x01", 4) || begins(bytes, size, "\x89PNG", 4) ||
           begins(bytes, size, "#?", 2) || begins(bytes, size, "PF", 2) || begins(bytes, size, "Pf", 2) ||
           begins(bytes, size, "II*\0", 4) || begins(bytes, size, "MM\0*", 4);
}

/* ISO/IEC 14496-12: boxes, each headed by its size and name. The index is "moov"; where it is not the second box, it
 * may come last. */
static int has_index_last(const uint8_t *bytes, size_t size)
{
    if (size < 8 || memcmp(bytes + 4, "ftyp", 4) != 0)
        return 0;
    const size_t first = (size_t)bytes[0] << 24 | (size_t)bytes[1] << 16 | (size_t)bytes[2] << 8 | bytes[3];
    return first > size - 8 || memcmp(bytes + first + 4, "moov", 4) != 0;
}

static int copy_all(int to, int (*stop)(void), pupil_why *why)
{
    static uint8_t block[1 << 16];
    int64_t total = 0;
    for (;;) {
        const ssize_t got = read(STDIN_FILENO, block, sizeof block);
        if (got < 0 && again(stop))
            continue;
        if (got < 0)
            return pupil_refuse(why, "standard input: cannot be read: %s", strerror(errno));
        if (got == 0)
            return 0;
        total += got;
        if (total > MOST_BYTES)
            return pupil_refuse(why,
                                "standard input: an MP4 whose index comes last, or a still, of over 2 GiB, which is "
                                "not read from a pipe; name the file");
        if (pupil_write_all(to, block, (size_t)got))
            return pupil_refuse(why, "standard input: no memory for its %lld bytes", (long long)total);
    }
}

/* Reads standard input into memory, which replaces it from now on. */
static int spool(int (*stop)(void), pupil_why *why)
{
    const int fd = memfd_create("standard input", MFD_CLOEXEC);
    int failed = fd < 0 ? pupil_refuse(why, "standard input: no memory for it") : copy_all(fd, stop, why);
    if (!failed && (lseek(fd, 0, SEEK_SET) != 0 || dup2(fd, STDIN_FILENO) < 0))
        failed = pupil_refuse(why, "standard input: %s", strerror(errno));
    if (fd >= 0)
        close(fd);
    return failed;
}

int pupil_standard_input_prepare(int (*stop)(void), pupil_why *why)
{
    uint8_t bytes[PEEK_BYTES];
    int is_file;
    const ssize_t size = peek(bytes, &is_file, stop);
    if (size < 0)
        return pupil_refuse(why, "standard input: cannot be read: %s", strerror(errno));
    const int still = is_still(bytes, (size_t)size);
    if (!is_file && (still || has_index_last(bytes, (size_t)size)) && spool(stop, why))
        return -1;
    return still;
}
