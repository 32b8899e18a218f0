#include "control.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "common/socket_path.h"
#include "refuse.h"

enum {
    WAITING = 64,      /* connections not yet accepted */
    MOST_SKIPPED = 256 /* parts of a too long line, between two frames: 128 KiB */
};

typedef struct client {
    int fd;          /* -1: none */
    int is_skipping; /* the rest of a line that is too long */
    int has_ended;   /* it sends no more; closed once its answers are gone */
    size_t in_bytes, out_bytes;
    char in[CONTROL_LINE_BYTES], out[2 * CONTROL_ANSWER_BYTES];
} client;

struct run_control {
    int fd;
    const char *path; /* as the user wrote it */
    socket_path at;
    struct stat is; /* the socket's file, so that no other one is removed */
    run_control_answer *answer;
    void *context;
    client client[CONTROL_CLIENTS];
};

/* --- answers --- */

void run_control_text(const char *text, char *json, size_t json_bytes)
{
    size_t n = 0;
    for (; *text && n + 3 < json_bytes; text++) {
        if (*text == '"' || *text == '\\')
            json[n++] = '\\';
        json[n++] = *text < ' ' || *text > '~' ? '?' : *text;
    }
    json[n] = 0;
}

void run_control_refuse(const char *sentence, char *answer, size_t answer_bytes)
{
    char text[CONTROL_ANSWER_BYTES - 64];
    run_control_text(sentence, text, sizeof text);
    snprintf(answer, answer_bytes, "{\"ok\":false,\"error\":\"%s\"}", text);
}

static void put(client *c, const char *answer)
{
    c->out_bytes += (size_t)snprintf(c->out + c->out_bytes, sizeof c->out - c->out_bytes, "%s\n", answer);
}

static int has_room(const client *c)
{
    return sizeof c->out - c->out_bytes > CONTROL_ANSWER_BYTES + 1;
}

static void refuse_line(client *c, const char *sentence)
{
    char answer[CONTROL_ANSWER_BYTES];
    run_control_refuse(sentence, answer, sizeof answer);
    put(c, answer);
}

static void drop(client *c)
{
    close(c->fd);
    *c = (client){.fd = -1};
}

/* --- a client --- */

static void send_answers(client *c)
{
    const ssize_t sent = c->out_bytes ? send(c->fd, c->out, c->out_bytes, MSG_DONTWAIT | MSG_NOSIGNAL) : 0;
    if (sent < 0 && errno != EAGAIN && errno != EINTR) {
        drop(c);
        return;
    }
    if (sent > 0) {
        c->out_bytes -= (size_t)sent;
        memmove(c->out, c->out + sent, c->out_bytes);
    }
    if (c->has_ended && !c->out_bytes)
        drop(c);
}

static void receive(client *c)
{
    const size_t room = sizeof c->in - c->in_bytes;
    const ssize_t got = room && !c->has_ended ? recv(c->fd, c->in + c->in_bytes, room, MSG_DONTWAIT) : -1;
    if (got > 0)
        c->in_bytes += (size_t)got;
    else if (room && !c->has_ended && (got == 0 || (errno != EAGAIN && errno != EINTR)))
        c->has_ended = 1; /* an unfinished line is ignored */
}

/* The next received line; NULL: none is complete. It is valid until the next call of receive. */
static char *next_line(client *c, char line[CONTROL_LINE_BYTES])
{
    char *end = memchr(c->in, '\n', c->in_bytes);
    if (!end && c->in_bytes == sizeof c->in) {
        if (!c->is_skipping)
            refuse_line(c, "a line of over 511 bytes");
        c->is_skipping = 1;
        c->in_bytes = 0;
    }
    if (!end)
        return NULL;
    const size_t length = (size_t)(end - c->in), skipping = (size_t)c->is_skipping;
    memcpy(line, c->in, length);
    line[length] = 0;
    const int has_zero = memchr(line, 0, length) != NULL;
    if (length && line[length - 1] == '\r')
        line[length - 1] = 0;
    c->in_bytes -= length + 1;
    memmove(c->in, end + 1, c->in_bytes);
    c->is_skipping = 0;
    if (!skipping && has_zero)
        refuse_line(c, "a line with a byte of 0");
    if (skipping || has_zero)
        *line = 0;
    return line;
}

/* Answers up to `most` lines; returns how many. */
static int serve(run_control *s, client *c, int most)
{
    char line[CONTROL_LINE_BYTES], answer[CONTROL_ANSWER_BYTES];
    int served = 0, skipped = 0;
    while (served < most && has_room(c)) {
        if (!memchr(c->in, '\n', c->in_bytes))
            receive(c);
        const size_t before = c->in_bytes;
        if (!next_line(c, line)) {
            if (c->in_bytes == before || ++skipped > MOST_SKIPPED) /* otherwise a part of a long line was skipped */
                break;
            continue;
        }
        served++;
        if (!*line)
            continue;
        s->answer(s->context, line, answer, sizeof answer);
        put(c, answer);
    }
    send_answers(c);
    return served;
}

/* --- the socket --- */

/* The same user, or root. */
static int is_allowed(int fd)
{
    struct ucred peer;
    socklen_t bytes = sizeof peer;
    return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) == 0 && (peer.uid == geteuid() || peer.uid == 0);
}

static void turn_away(int fd, const char *sentence)
{
    char answer[CONTROL_ANSWER_BYTES];
    run_control_refuse(sentence, answer, sizeof answer - 1);
    strcat(answer, "\n");
    (void)!send(fd, answer, strlen(answer), MSG_DONTWAIT | MSG_NOSIGNAL);
    close(fd);
}

/* 0: nobody waits. */
static int accept_next(run_control *s)
{
    const int fd = accept4(s->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0)
        return 0;
    if (!is_allowed(fd)) {
        turn_away(fd, "this run is another user's");
        return 1;
    }
    for (size_t i = 0; i < CONTROL_CLIENTS; i++)
        if (s->client[i].fd < 0) {
            s->client[i].fd = fd;
            return 1;
        }
    turn_away(fd, "8 clients are there already");
    return 1;
}

void run_control_serve(run_control *s)
{
    int left = CONTROL_LINES;
    if (!s)
        return;
    for (int i = 0; i < WAITING && accept_next(s); i++)
        ;
    for (size_t i = 0; i < CONTROL_CLIENTS; i++)
        if (s->client[i].fd >= 0) /* a client that floods does not delay the others */
            left -= serve(s, &s->client[i],
                          left < CONTROL_LINES / CONTROL_CLIENTS ? left : CONTROL_LINES / CONTROL_CLIENTS);
}

/* Removes the socket of a killed run. */
static int remove_stale(const char *path, const struct sockaddr_un *at, pupil_why *why)
{
    struct stat is;
    if (lstat(at->sun_path, &is) != 0)
        return 0; /* bind reports any other error */
    if (!S_ISSOCK(is.st_mode))
        return pupil_refuse(why, "--control %s: is there already, and no socket; name another path", path);
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const int gone = fd >= 0 && connect(fd, (const struct sockaddr *)at, sizeof *at) != 0 && errno == ECONNREFUSED;
    if (fd >= 0)
        close(fd);
    if (!gone)
        return pupil_refuse(why, "--control %s: another run is listening there; name another path", path);
    return unlink(at->sun_path) == 0 ? 0
                                     : pupil_refuse(why, "--control %s: cannot be replaced: %s", path, strerror(errno));
}

static int listen_at(run_control *s, pupil_why *why)
{
    s->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const mode_t before = umask(0177); /* from the beginning no other user may connect */
    const int failed = s->fd < 0 || bind(s->fd, (const struct sockaddr *)&s->at.address, sizeof s->at.address) != 0;
    const int error = errno;
    umask(before);
    if (failed)
        return pupil_refuse(why, "--control %s: no socket can be made there: %s", s->path, strerror(error));
    if (lstat(s->at.address.sun_path, &s->is) != 0 || listen(s->fd, WAITING) != 0)
        return pupil_refuse(why, "--control %s: cannot be listened to: %s", s->path, strerror(errno));
    return 0;
}

int run_control_open(run_control **control, const char *path, run_control_answer *answer, void *context, pupil_why *why)
{
    run_control *s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "not enough memory");
    s->fd = -1;
    s->answer = answer;
    s->context = context;
    s->path = path;
    for (size_t i = 0; i < CONTROL_CLIENTS; i++)
        s->client[i].fd = -1;
    pupil_why words = {""};
    int failed = socket_path_open(&s->at, path, &words);
    if (failed)
        pupil_refuse(why, "--control %s", words.text);
    failed = failed || remove_stale(path, &s->at.address, why) || listen_at(s, why);
    if (failed) {
        run_control_close(s);
        return -1;
    }
    *control = s;
    return 0;
}

void run_control_close(run_control *s)
{
    struct stat now;
    if (!s)
        return;
    for (size_t i = 0; i < CONTROL_CLIENTS; i++)
        if (s->client[i].fd >= 0) {
            send_answers(&s->client[i]);
            if (s->client[i].fd >= 0)
                close(s->client[i].fd);
        }
    if (s->is.st_ino && lstat(s->at.address.sun_path, &now) == 0 && now.st_ino == s->is.st_ino &&
        now.st_dev == s->is.st_dev)
        unlink(s->at.address.sun_path);
    socket_path_close(&s->at);
    if (s->fd >= 0)
        close(s->fd);
    free(s);
}
