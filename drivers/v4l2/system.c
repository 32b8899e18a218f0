/* drivers/v4l2/system.c: the table of system calls, filled with the kernel's. */
#include "v4l2/system.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <time.h>
#include <unistd.h>

static int kernel_open(void *context, const char *path)
{
    (void)context;
    return open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

static int kernel_close(void *context, int fd)
{
    (void)context;
    return close(fd);
}

static int kernel_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    (void)context;
    return (int)syscall(SYS_ioctl, fd, request, argument); /* the type of ioctl's request differs among C libraries */
}

static void *kernel_mmap(void *context, size_t bytes, int fd, off_t offset)
{
    (void)context;
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return memory == MAP_FAILED ? NULL : memory;
}

static int kernel_munmap(void *context, void *memory, size_t bytes)
{
    (void)context;
    return munmap(memory, bytes);
}

static int kernel_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    (void)context;
    return poll(fds, count, timeout_ms);
}

static int64_t kernel_now_ns(void *context)
{
    struct timespec now = {0};
    (void)context;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int kernel_list(void *context, const char *folder, void (*found)(void *closure, const char *name), void *closure)
{
    (void)context;
    DIR *open_folder = opendir(folder);
    if (!open_folder)
        return -1;
    errno = 0;
    for (struct dirent *entry; (entry = readdir(open_folder)); errno = 0)
        found(closure, entry->d_name);
    const int error = errno;
    closedir(open_folder);
    errno = error;
    return error ? -1 : 0;
}

static int kernel_device_number(void *context, int fd, uint32_t *major_number, uint32_t *minor_number)
{
    struct stat status;
    (void)context;
    if (fstat(fd, &status) != 0)
        return -1;
    *major_number = major(status.st_rdev);
    *minor_number = minor(status.st_rdev);
    return 0;
}

static int kernel_device_name(void *context, uint32_t major_number, uint32_t minor_number, char *name,
                              size_t name_bytes)
{
    char path[64], target[512];
    (void)context;
    snprintf(path, sizeof path, "/sys/dev/char/%u:%u", major_number, minor_number);
    const ssize_t length = readlink(path, target, sizeof target - 1);
    if (length < 0)
        return -1;
    target[length] = 0;
    const char *slash = strrchr(target, '/');
    snprintf(name, name_bytes, "%s", slash ? slash + 1 : target);
    return 0;
}

static ssize_t kernel_write(void *context, int fd, const void *data, size_t bytes)
{
    (void)context;
    return write(fd, data, bytes);
}

static int64_t kernel_read_ns(void *context, const void *memory, size_t bytes)
{
    const volatile uint64_t *words = memory; /* volatile: every one of them is read */
    uint64_t sum = 0;
    const int64_t began_ns = kernel_now_ns(context);
    for (size_t i = 0; i < bytes / sizeof *words; i++)
        sum += words[i];
    (void)sum;
    return kernel_now_ns(context) - began_ns;
}

const pupil_v4l2_system pupil_v4l2_kernel = {
    NULL,          kernel_open, kernel_close,         kernel_ioctl,       kernel_mmap,  kernel_munmap,  kernel_poll,
    kernel_now_ns, kernel_list, kernel_device_number, kernel_device_name, kernel_write, kernel_read_ns,
};

int pupil_v4l2_ioctl(const pupil_v4l2_system *system, int fd, unsigned long request, void *argument)
{
    for (int i = 0; i < 100; i++) {
        const int result = system->ioctl(system->context, fd, request, argument);
        if (result >= 0 || errno != EINTR)
            return result;
    }
    return -1;
}
