/* apps/common/socket_path.h: the address of a Unix socket, which has room for a path of 107 bytes. A longer path is
 * reached through its folder, which is held open: /proc/self/fd/N/NAME. */
#ifndef PUPIL_APPS_COMMON_SOCKET_PATH_H
#define PUPIL_APPS_COMMON_SOCKET_PATH_H

#include <sys/socket.h>
#include <sys/un.h>

#include "pupil/error.h"

typedef struct socket_path {
    struct sockaddr_un address; /* good as long as the folder is open */
    int folder;                 /* 1 more than its file descriptor; 0: none */
} socket_path;

/* 0, or -1 and a sentence. */
int socket_path_open(socket_path *at, const char *path, pupil_why *why);
void socket_path_close(socket_path *at);

#endif
