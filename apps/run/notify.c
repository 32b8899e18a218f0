#include "notify.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "refuse.h"

/* 1: the socket took the text. */
static int send_text(const run_notify *n, const char *text)
{
    return send(n->fd, text, strlen(text), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

/* "/path", or "@name" for a socket without a file. */
static int connect_to(const char *name, pupil_why *why)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    const size_t bytes = strlen(name);
    if ((*name != '/' && *name != '@') || bytes >= sizeof at.sun_path) {
        pupil_refuse(why,
                     "NOTIFY_SOCKET=%s: is neither a path nor an @name of up to %zu characters; nobody is notified",
                     name, sizeof at.sun_path - 1);
        return -1;
    }
    memcpy(at.sun_path, name, bytes);
    if (*name == '@')
        at.sun_path[0] = 0;
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const socklen_t length = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + bytes);
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&at, length) == 0)
        return fd;
    pupil_refuse(why, "NOTIFY_SOCKET=%s: %s; nobody is notified", name, strerror(errno));
    if (fd >= 0)
        close(fd);
    return -1;
}

/* Half of the service manager's timeout, if it watches this process. */
static int64_t watchdog_ns(void)
{
    const char *us = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
    char *end;
    if (!us || (pid && strtoll(pid, NULL, 10) != (long long)getpid()))
        return 0;
    errno = 0;
    const long long is_us = strtoll(us, &end, 10);
    return !errno && end != us && !*end && is_us > 0 && is_us < INT64_MAX / 500 ? is_us * 500 : 0;
}

void run_notify_open(run_notify *n, pupil_why *warning)
{
    const char *name = getenv("NOTIFY_SOCKET");
    warning->text[0] = 0;
    *n = (run_notify){.fd = -1};
    if (!name || !*name)
        return;
    n->fd = connect_to(name, warning);
    n->watchdog_ns = watchdog_ns();
}

/* "converged", "limited (exposure_max)" of the camera's controller, else of the picture's level. */
static void describe_state(const frame_log_entry *entry, char *text, size_t text_bytes)
{
    const char *reason = *entry->sensor ? entry->sensor_reason : entry->reason;
    snprintf(text, text_bytes, *reason ? "%s (%s)" : "%s", *entry->sensor ? entry->sensor : entry->state, reason);
}

void run_notify_frame(run_notify *n, int is_at_rest, const frame_log_entry *entry, int64_t now_ns)
{
    char state[sizeof n->status], text[sizeof n->status + 80];
    if (n->fd < 0)
        return;
    if (!n->is_ready && is_at_rest)
        n->is_ready = send_text(n, "READY=1");
    describe_state(entry, state, sizeof state);
    if (strcmp(state, n->status) != 0) {
        int bytes = snprintf(text, sizeof text, "STATUS=%s", state);
        if (isfinite(entry->exposure_s) && isfinite(entry->gain))
            snprintf(text + bytes, sizeof text - (size_t)bytes, ", %.3f ms, gain %.2f", entry->exposure_s * 1e3,
                     entry->gain);
        if (send_text(n, text))
            memcpy(n->status, state, sizeof state);
    }
    if (n->watchdog_ns && now_ns - n->alive_ns >= n->watchdog_ns && send_text(n, "WATCHDOG=1"))
        n->alive_ns = now_ns;
}

void run_notify_close(run_notify *n)
{
    if (n->fd < 0)
        return;
    send_text(n, "STOPPING=1");
    close(n->fd);
    n->fd = -1;
}
