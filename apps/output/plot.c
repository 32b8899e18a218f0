#include "plot.h"

#include <ctype.h>
#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "file/common/pending.h"
#include "file/sink/sink_common.h"
#include "plot_script.h"
#include "refuse.h"

extern char **environ;

typedef struct run {
    const frame_log_entry *records;
    size_t count;
    const char *title;
} run;

static void script_of_run(FILE *out, int is_png, const void *context)
{
    const run *r = context;
    plot_script(out, is_png, r->records, r->count, r->title);
}

/* --- the program --- */

/* The line of gnuplot's output that says what is wrong: the last non-empty one (above it are the script's line and a
 * mark). */
static void complaint(FILE *errors, char *line, size_t bytes)
{
    char next[256];
    snprintf(line, bytes, "it said nothing");
    rewind(errors);
    while (fgets(next, sizeof next, errors)) {
        size_t length = strlen(next);
        while (length && isspace((unsigned char)next[length - 1]))
            next[--length] = 0;
        if (length)
            snprintf(line, bytes, "%s", next + strspn(next, " "));
    }
}

/* Runs gnuplot with the script at its standard input and the picture from its standard output; without a shell, a file
 * name in the script, or the user's settings. 0, an errno, or -1: it failed, and `errors` says why. */
static int gnuplot(FILE *input, int output, FILE *errors)
{
    char *arguments[] = {(char[]){"gnuplot"}, (char[]){"--default-settings"}, (char[]){"-"}, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status, failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawn_file_actions_adddup2(&actions, fileno(input), 0);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, output, 1);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, fileno(errors), 2);
    if (!failed)
        failed = posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return failed;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return errno;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -1;
}

/* The errno that gnuplot() returned, as a sentence. */
static int not_started(const char *path, int error, pupil_why *why)
{
    if (error == ENOENT)
        return pupil_refuse(why, "--plot needs gnuplot; on Debian: apt-get install gnuplot-nox");
    return pupil_refuse(why, "%s: gnuplot cannot be started: %s", path, strerror(error));
}

static int draw(const char *path, FILE *input, FILE *errors, int output, pupil_why *why)
{
    char line[256];
    int failed = gnuplot(input, output, errors);
    if (failed > 0)
        return not_started(path, failed, why);
    if (!failed && lseek(output, 0, SEEK_END) > 0)
        return 0;
    complaint(errors, line, sizeof line);
    return pupil_refuse(why, "%s: gnuplot cannot draw it: %s", path, line);
}

int pupil_plot_kind(const char *path, pupil_why *why)
{
    const char *ending = strrchr(path, '.');
    if (ending && strcasecmp(ending, ".png") == 0)
        return 1;
    if (ending && strcasecmp(ending, ".svg") == 0)
        return 0;
    return pupil_refuse(why, "%s: a plot is an .svg or a .png file", path);
}

int pupil_plot_check(const char *path, int overwrite, pupil_why *why)
{
    pupil_pending pending;
    if (pupil_plot_kind(path, why) < 0 || pupil_pending_file(&pending, path, overwrite, why))
        return -1;
    pupil_pending_discard(&pending);
    FILE *nothing = fopen("/dev/null", "r+e");
    int failed = nothing ? gnuplot(nothing, fileno(nothing), nothing) : errno;
    if (nothing)
        fclose(nothing);
    if (failed < 0)
        return pupil_refuse(why, "%s: the gnuplot that is installed fails even with nothing to draw", path);
    return failed ? not_started(path, failed, why) : 0;
}

/* A file in memory: boards may have no other writable folder than the plot's. */
static FILE *in_memory(void)
{
    const int fd = memfd_create("plot", MFD_CLOEXEC);
    FILE *file = fd >= 0 ? fdopen(fd, "w+") : NULL;
    if (!file && fd >= 0)
        close(fd);
    return file;
}

/* This program writes gnuplot's picture, because gnuplot does not report a full disk. */
static int save(FILE *picture, const pupil_pending *pending, pupil_why *why)
{
    char block[65536];
    size_t bytes;
    FILE *file = pupil_pending_stream(pending);
    int failed = !file || fseek(picture, 0, SEEK_SET) != 0;
    while (!failed && (bytes = fread(block, 1, sizeof block, picture)) > 0)
        failed = fwrite(block, 1, bytes, file) != bytes;
    failed |= ferror(picture) != 0;
    if (file && fclose(file) != 0)
        failed = 1;
    return failed ? pupil_refuse(why, "%s: the plot cannot be written: %s", pending->path, strerror(errno)) : 0;
}

int pupil_plot_draw(const char *path, int overwrite, pupil_plot_script *write_script, const void *context,
                    pupil_why *why)
{
    pupil_pending pending;
    int is_png = pupil_plot_kind(path, why);
    if (is_png < 0 || pupil_pending_file(&pending, path, overwrite, why))
        return -1;

    int failed = -1;
    FILE *input = in_memory(), *errors = in_memory(), *picture = in_memory();
    if (!input || !errors || !picture) {
        pupil_refuse(why, "%s: the plot cannot be drawn: %s", path, strerror(errno));
    } else {
        write_script(input, is_png, context);
        failed = fflush(input) != 0 || fseek(input, 0, SEEK_SET) != 0
                     ? pupil_refuse(why, "%s: the plot cannot be drawn: %s", path, strerror(errno))
                     : draw(path, input, errors, fileno(picture), why);
        failed = failed ? failed : save(picture, &pending, why);
    }
    FILE *const files[] = {input, errors, picture};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (files[i])
            fclose(files[i]);
    if (!failed)
        failed = pupil_pending_commit(&pending, why);
    pupil_pending_discard(&pending);
    return failed;
}

int pupil_plot_write(const char *path, int overwrite, const frame_log_entry *records, size_t count, const char *title,
                     pupil_why *why)
{
    const run r = {records, count, title};
    if (pupil_plot_kind(path, why) < 0)
        return -1;
    if (!count)
        return pupil_refuse(why, "%s: there is no frame to plot", path);
    return pupil_plot_draw(path, overwrite, script_of_run, &r, why);
}
