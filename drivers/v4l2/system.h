/* drivers/v4l2/system.h: every system call that cameras and output nodes need, as one table, so that a fake device or
 * one whose n-th call fails can take the kernel's place. Errors as the kernel's: -1 (NULL) and errno. */
#ifndef PUPIL_DRIVERS_V4L2_SYSTEM_H
#define PUPIL_DRIVERS_V4L2_SYSTEM_H

#include <poll.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct pupil_v4l2_system {
    void *context;                                /* the first argument of each */
    int (*open)(void *context, const char *path); /* to read and write, without blocking, not for children */
    int (*close)(void *context, int fd);
    int (*ioctl)(void *context, int fd, unsigned long request, void *argument);
    void *(*mmap)(void *context, size_t bytes, int fd, off_t offset); /* shared, to read and write */
    int (*munmap)(void *context, void *memory, size_t bytes);
    int (*poll)(void *context, struct pollfd *fds, nfds_t count, int timeout_ms); /* count 0: sleeps */
    int64_t (*now_ns)(void *context); /* CLOCK_MONOTONIC, which buffers are stamped with; cannot fail */
    /* The names in a folder, in no order. */
    int (*list)(void *context, const char *folder, void (*found)(void *closure, const char *name), void *closure);
    int (*device_number)(void *context, int fd, uint32_t *major, uint32_t *minor);
    /* The name in /dev of the character device of a number. */
    int (*device_name)(void *context, uint32_t major, uint32_t minor, char *name, size_t name_bytes);
    ssize_t (*write)(void *context, int fd, const void *data, size_t bytes);
    /* Reads memory once, all of it, and returns how long that took; cannot fail. Multiples of 8 bytes, aligned so. */
    int64_t (*read_ns)(void *context, const void *memory, size_t bytes);
} pupil_v4l2_system;

extern const pupil_v4l2_system pupil_v4l2_kernel;

/* ioctl, again where a signal interrupted it, a hundred times at most. */
int pupil_v4l2_ioctl(const pupil_v4l2_system *system, int fd, unsigned long request, void *argument);

#endif
