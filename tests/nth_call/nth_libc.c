/* tests/nth_call/nth_libc.c: the C library's functions that may fail. Both names of those with file offsets, and the
 * checked variants that the compiler calls instead. */
#include "nth_call.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

/* --- memory --- */
NTH_CALL(malloc, void *, NULL, ENOMEM, (size_t bytes), (bytes))
NTH_CALL(calloc, void *, NULL, ENOMEM, (size_t count, size_t bytes), (count, bytes))
NTH_CALL(realloc, void *, NULL, ENOMEM, (void *old, size_t bytes), (old, bytes))
NTH_CALL(aligned_alloc, void *, NULL, ENOMEM, (size_t alignment, size_t bytes), (alignment, bytes))
NTH_CALL(strdup, char *, NULL, ENOMEM, (const char *text), (text))
NTH_CALL(strndup, char *, NULL, ENOMEM, (const char *text, size_t most), (text, most))
NTH_CALL(vasprintf, int, -1, ENOMEM, (char **made, const char *format, va_list values), (made, format, values))
NTH_CALL(realpath, char *, NULL, ENOMEM, (const char *path, char *room), (path, room))
NTH_CALL(newlocale, locale_t, (locale_t)0, ENOMEM, (int mask, const char *name, locale_t base), (mask, name, base))
NTH_CALL(mmap, void *, MAP_FAILED, ENOMEM, (void *at, size_t n, int may, int flags, int fd, off_t offset),
         (at, n, may, flags, fd, offset))
NTH_CALL(mmap64, void *, MAP_FAILED, ENOMEM, (void *at, size_t n, int may, int flags, int fd, off_t offset),
         (at, n, may, flags, fd, offset))

int __wrap_asprintf(char **made, const char *format, ...) __attribute__((format(printf, 2, 3)));
int __wrap_asprintf(char **made, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = nth_fails("asprintf", ENOMEM) ? -1 : __real_vasprintf(made, format, values);
    va_end(values);
    return length;
}

int __wrap___asprintf_chk(char **made, int flags, const char *format, ...) __attribute__((format(printf, 3, 4)));
int __wrap___asprintf_chk(char **made, int flags, const char *format, ...)
{
    va_list values;
    (void)flags;
    va_start(values, format);
    const int length = nth_fails("asprintf", ENOMEM) ? -1 : __real_vasprintf(made, format, values);
    va_end(values);
    return length;
}

/* --- files --- */
int __real_open(const char *path, int flags, ...);
int __real_openat(int folder, const char *path, int flags, ...);

#define OPENS(name, real, parameters, arguments)                                                                       \
    int __wrap_##name parameters;                                                                                      \
    int __wrap_##name parameters                                                                                       \
    {                                                                                                                  \
        va_list more;                                                                                                  \
        va_start(more, flags);                                                                                         \
        const unsigned mode = flags & O_CREAT ? va_arg(more, unsigned) : 0;                                            \
        va_end(more);                                                                                                  \
        return nth_fails(#real, EIO) ? -1 : __real_##real arguments;                                                   \
    }
OPENS(open, open, (const char *path, int flags, ...), (path, flags, mode))
OPENS(open64, open, (const char *path, int flags, ...), (path, flags, mode))
OPENS(openat, openat, (int folder, const char *path, int flags, ...), (folder, path, flags, mode))
OPENS(openat64, openat, (int folder, const char *path, int flags, ...), (folder, path, flags, mode))

NTH_CALL(fopen, FILE *, NULL, EIO, (const char *path, const char *mode), (path, mode))
NTH_CALL(fopen64, FILE *, NULL, EIO, (const char *path, const char *mode), (path, mode))
NTH_CALL(fdopen, FILE *, NULL, ENOMEM, (int fd, const char *mode), (fd, mode))
NTH_CALL(opendir, DIR *, NULL, EIO, (const char *path), (path))
NTH_CALL(readdir, void *, NULL, EIO, (DIR * folder), (folder))
NTH_CALL(readdir64, void *, NULL, EIO, (DIR * folder), (folder))
NTH_CALL(fstat, int, -1, EIO, (int fd, void *is), (fd, is))
NTH_CALL(fstat64, int, -1, EIO, (int fd, void *is), (fd, is))
NTH_CALL(stat, int, -1, EIO, (const char *path, void *is), (path, is))
NTH_CALL(stat64, int, -1, EIO, (const char *path, void *is), (path, is))
NTH_CALL(lstat, int, -1, EIO, (const char *path, void *is), (path, is))
NTH_CALL(lstat64, int, -1, EIO, (const char *path, void *is), (path, is))
NTH_CALL(fstatat, int, -1, EIO, (int at, const char *path, void *is, int flags), (at, path, is, flags))
NTH_CALL(fstatat64, int, -1, EIO, (int at, const char *path, void *is, int flags), (at, path, is, flags))
NTH_CALL(lseek, off_t, -1, EIO, (int fd, off_t offset, int whence), (fd, offset, whence))
NTH_CALL(lseek64, off_t, -1, EIO, (int fd, off_t offset, int whence), (fd, offset, whence))
NTH_CALL(ftruncate, int, -1, EIO, (int fd, off_t bytes), (fd, bytes))
NTH_CALL(ftruncate64, int, -1, EIO, (int fd, off_t bytes), (fd, bytes))
NTH_CALL(fsync, int, -1, EIO, (int fd), (fd))
NTH_CALL(flock, int, -1, ENOLCK, (int fd, int operation), (fd, operation))
NTH_CALL(mkdir, int, -1, EIO, (const char *path, mode_t mode), (path, mode))
NTH_CALL(rename, int, -1, EIO, (const char *from, const char *to), (from, to))
NTH_CALL(renameat, int, -1, EIO, (int a, const char *from, int b, const char *to), (a, from, b, to))
NTH_CALL(link, int, -1, EIO, (const char *from, const char *to), (from, to))
NTH_CALL(unlink, int, -1, EIO, (const char *path), (path))
NTH_CALL(unlinkat, int, -1, EIO, (int folder, const char *name, int flags), (folder, name, flags))
NTH_CALL(rmdir, int, -1, EIO, (const char *path), (path))
NTH_CALL(readlink, ssize_t, -1, EIO, (const char *path, char *to, size_t bytes), (path, to, bytes))
NTH_CALL(pipe2, int, -1, EMFILE, (int fds[2], int flags), (fds, flags))
NTH_CALL(dup2, int, -1, EIO, (int from, int to), (from, to))
NTH_CALL(memfd_create, int, -1, ENOMEM, (const char *name, unsigned flags), (name, flags))
NTH_CALL(ferror, int, 1, EIO, (FILE * file), (file))

long __real_syscall(long number, long a, long b, long c, long d, long e, long f);
long __wrap_syscall(long number, long a, long b, long c, long d, long e, long f);
long __wrap_syscall(long number, long a, long b, long c, long d, long e, long f)
{
    return nth_fails("syscall", EIO) ? -1 : __real_syscall(number, a, b, c, d, e, f);
}

int __real_fcntl(int fd, int command, long argument);
int __wrap_fcntl(int fd, int command, long argument);
int __wrap_fcntl64(int fd, int command, long argument);
int __wrap_fcntl(int fd, int command, long argument)
{
    return nth_fails("fcntl", EMFILE) ? -1 : __real_fcntl(fd, command, argument);
}
int __wrap_fcntl64(int fd, int command, long argument)
{
    return __wrap_fcntl(fd, command, argument);
}

/* The stream's error flag is set, as by the real function; how to do that is specific to glibc. */
size_t __real_fwrite(const void *of, size_t bytes, size_t count, FILE *file);
size_t __wrap_fwrite(const void *of, size_t bytes, size_t count, FILE *file);
size_t __wrap_fwrite(const void *of, size_t bytes, size_t count, FILE *file)
{
    if (!nth_fails("fwrite", ENOSPC))
        return __real_fwrite(of, bytes, count, file);
    file->_flags |= _IO_ERR_SEEN;
    return 0;
}

int __real_fclose(FILE *file);
int __wrap_fclose(FILE *file);
int __wrap_fclose(FILE *file)
{
    const int result = __real_fclose(file);
    return nth_fails("fclose", EIO) ? EOF : result;
}

int __real_close(int fd);
int __wrap_close(int fd);
int __wrap_close(int fd)
{
    const int result = __real_close(fd);
    return nth_fails("close", EIO) ? -1 : result;
}

/* --- read and write --- */
#define MOVES(name, real, error, parameters, arguments)                                                                \
    ssize_t __wrap_##name parameters;                                                                                  \
    ssize_t __wrap_##name parameters                                                                                   \
    {                                                                                                                  \
        return nth_moves(#real, &bytes, error) ? -1 : __real_##real arguments;                                         \
    }
ssize_t __real_read(int fd, void *to, size_t bytes);
ssize_t __real_pread(int fd, void *to, size_t bytes, off_t offset);
ssize_t __real_write(int fd, const void *from, size_t bytes);
MOVES(read, read, EIO, (int fd, void *to, size_t bytes), (fd, to, bytes))
MOVES(__read_chk, read, EIO, (int fd, void *to, size_t bytes, size_t room), (fd, to, bytes + 0 * room))
MOVES(pread, pread, EIO, (int fd, void *to, size_t bytes, off_t offset), (fd, to, bytes, offset))
MOVES(pread64, pread, EIO, (int fd, void *to, size_t bytes, off_t offset), (fd, to, bytes, offset))
MOVES(write, write, ENOSPC, (int fd, const void *from, size_t bytes), (fd, from, bytes))

/* --- processes and threads --- */
NTH_CALL(fork, pid_t, -1, EAGAIN, (void), ())
NTH_CALL(pthread_create, int, EAGAIN, EAGAIN,
         (pthread_t * thread, const pthread_attr_t *with, void *(*run)(void *), void *given),
         (thread, with, run, given))
pid_t __real_waitpid(pid_t id, int *status, int options);
pid_t __wrap_waitpid(pid_t id, int *status, int options);
pid_t __wrap_waitpid(pid_t id, int *status, int options)
{
    return nth_waits("waitpid") ? -1 : __real_waitpid(id, status, options);
}
int __real_poll(struct pollfd *fds, nfds_t count, int timeout_ms);
int __wrap_poll(struct pollfd *fds, nfds_t count, int timeout_ms);
int __wrap_poll(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    return nth_fails("poll", EIO) || nth_waits("poll") ? -1 : __real_poll(fds, count, timeout_ms);
}
