/* apps/common/reader.h: the program that reads standard output. */
#ifndef PUPIL_APPS_COMMON_READER_H
#define PUPIL_APPS_COMMON_READER_H

#include <poll.h>
#include <unistd.h>

/* 1: the pipe's other end is closed. */
static inline int reader_gone(void)
{
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    return poll(&out, 1, 0) == 1 && out.revents & (POLLERR | POLLHUP);
}

#endif
