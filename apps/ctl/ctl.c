/* pupil ctl: queries and changes a running `pupil run --control PATH`. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include "common/report_error.h"
#include "common/socket_path.h"
#include "options/commands.h"
#include "refuse.h"

#define WAIT_S 10

enum { LINE_BYTES = 1024 }; /* more than a run takes, so that it refuses longer lines */

typedef struct ctl_options {
    int unused;
} ctl_options;

/* No options but --help, which every command has. */
static const option_group groups[] = {{0}};

const option_command ctl_command = {
    .name = "ctl",
    .summary = "queries and changes a running 'pupil run --control PATH'",
    .usage = "PATH COMMAND [VALUE]\nPATH < COMMANDS",
    .about = "Sends lines to the socket of a run, and prints the answers, lines of JSON.\n"
             "  status                     the latest frame, and the settings\n"
             "  lock on|off                hold the level, exposure time and gain\n"
             "  ev STOPS, key K, key-at EV:KEY,...|off\n"
             "  metering uniform|centre|spot, roi X,Y,W,H|off, trim LOW,HIGH|off\n"
             "  highlights STOPS, amplification STOPS, tau-light S, tau-dark S\n"
             "  gain-max FACTOR|off, shutter-max TIME|off, day-night EV,EV,S|off\n"
             "  light STOPS[,FRAMES]       it gets so much brighter, within so many frames (30)\n"
             "  filter STOPS[,FRAMES]      the same, by a filter of the camera",
    .exits = "0 done, 1 refused or not reached, 2 usage",
    .manual = "Sends a command to a run that was started with --control PATH, or each line of standard input, and "
              "prints the answers: a JSON object a line, with \"ok\". Values are those of the options of pupil run; "
              "off takes them away. A change acts from the frame that the answer names. lock holds the level of the "
              "picture, the exposure time and the gain. The socket is of its user alone.\n\n"
              "light and filter announce a change of light that is known to come: a flash, a lamp, an infrared-cut or "
              "grey filter. The exposure for it is set at once, in one step. What does not come within FRAMES frames "
              "is taken back. The best time is some frames before (the camera's control delay). With filter, the "
              "picture and day-night are those of the light without the filter; with light the picture adapts to it, "
              "so use --mode sensor for a flash.",
    .groups = groups,
};

static int reach(const char *path, pupil_why *why)
{
    socket_path at;
    const struct timeval wait = {.tv_sec = WAIT_S};
    struct stat is;
    if (stat(path, &is) == 0 && !S_ISSOCK(is.st_mode))
        return pupil_refuse(why, "%s: is not a socket; 'pupil run --control PATH' makes one", path);
    if (socket_path_open(&at, path, why))
        return -1;
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait) != 0 ||
        setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &wait, sizeof wait) != 0 ||
        connect(fd, (const struct sockaddr *)&at.address, sizeof at.address) != 0) {
        if (errno == EAGAIN) /* its queue of waiting connections is full */
            pupil_refuse(why, "%s: the run there takes nobody for %d s; it hangs, or no frames come", path, WAIT_S);
        else
            pupil_refuse(why, "%s: no run is reached there: %s; 'pupil run --control %s' makes the socket", path,
                         strerror(errno), path);
        socket_path_close(&at);
        if (fd >= 0)
            close(fd);
        return -1;
    }
    socket_path_close(&at);
    return fd;
}

/* One line with its line feed, and its answer: EXIT_DONE if that is ok. */
static int ask(int fd, FILE *answers, const char *line, size_t length, pupil_why *why)
{
    char answer[4096];
    if (send(fd, line, length, MSG_NOSIGNAL) != (ssize_t)length)
        return pupil_refuse(why, "the run has ended, or takes no more"), EXIT_FAILED;
    if (!fgets(answer, sizeof answer, answers))
        return pupil_refuse(why, "no answer came; the run has ended, or no frames come"), EXIT_FAILED;
    fputs(answer, stdout);
    fflush(stdout);
    return strncmp(answer, "{\"ok\":true", 10) == 0 ? EXIT_DONE : EXIT_FAILED;
}

static int is_blank(const char *line, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (line[i] != ' ' && line[i] != '\t' && line[i] != '\r')
            return 0;
    return 1;
}

/* The next line that is not blank, with its line feed, without a carriage return. A line that is too long is cut, so
 * that the run refuses it, and the rest is skipped. 0: no more lines. */
static size_t next_line(char line[LINE_BYTES])
{
    for (int c = 0; c != EOF;) {
        size_t length = 0;
        while ((c = getchar()) != EOF && c != '\n')
            if (length < LINE_BYTES - 1)
                line[length++] = (char)c;
        const int whole = length < LINE_BYTES - 1;
        if (whole && is_blank(line, length))
            continue;
        length -= whole && line[length - 1] == '\r';
        line[length] = '\n';
        return length + 1;
    }
    return 0;
}

static int ask_all(int fd, FILE *answers, pupil_why *why)
{
    char line[LINE_BYTES];
    int status = EXIT_DONE;
    for (size_t length; !*why->text && (length = next_line(line)) > 0;)
        if (ask(fd, answers, line, length, why))
            status = EXIT_FAILED;
    return status;
}

/* The words, separated by spaces, and a line feed; -1: too long, several lines, or blank. */
static int join(char *line, size_t bytes, int count, char **words, pupil_why *why)
{
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        const int n = snprintf(line + used, bytes - used, "%s%s", i ? " " : "", words[i]);
        if (n < 0 || (size_t)n >= bytes - used || strchr(words[i], '\n'))
            return pupil_refuse(why, "a command of over 511 bytes or of several lines");
        used += (size_t)n;
    }
    if (is_blank(line, used))
        return pupil_refuse(why, "an empty command; 'pupil ctl --help' has those that there are");
    strcpy(line + used, "\n");
    return 0;
}

static int is_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
}

int ctl_main(int argc, char **argv)
{
    ctl_options o = {0};
    pupil_why why = {""};
    option_words words;
    char line[512 + 1];
    /* Options come before PATH; after it come values, which may be negative. */
    const int options = argc == 3 && is_help(argv[2]) ? argc : argc > 2 ? 2 : argc;
    const int parsed = options_read(&ctl_command, &o, options, argv, &words);
    if (parsed >= 0)
        return parsed;
    if (!words.count || !*words.word[0])
        pupil_refuse(&why, "name the socket of a run, and a command; 'pupil ctl --help' has more");
    if (*why.text || (argc > 2 && join(line, sizeof line - 1, argc - 2, argv + 2, &why))) {
        report_error("pupil ctl", &why, "");
        return EXIT_USAGE;
    }
    const int fd = reach(words.word[0], &why);
    FILE *answers = fd >= 0 ? fdopen(fd, "r") : NULL;
    int status = EXIT_FAILED;
    if (answers)
        status = argc > 2 ? ask(fd, answers, line, strlen(line), &why) : ask_all(fd, answers, &why);
    if (answers)
        fclose(answers);
    if (*why.text)
        report_error("pupil ctl", &why, "");
    return *why.text ? EXIT_FAILED : status;
}
