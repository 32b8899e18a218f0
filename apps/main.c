/* The `pupil` program: subcommands, each in a file of its own. */
#include "commands.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>

#include "pupil/pupil.h"

static const char help[] = "usage: pupil COMMAND ...\n"
                           "Camera-style auto-exposure for HDR frames.\n"
                           "  run      live frames of a camera, with its exposure under control\n"
                           "  replay   recorded HDR frames in; a display video and what the exposure did out\n"
                           "  record   a camera's raw frames, kept as they come\n"
                           "  render   the frames of a scene: linear pictures, or mapped for a display\n"
                           "  study    the study of adaptation made again: tables, videos, acceptance\n"
                           "  bench    how long things take, beside what they cannot be faster than\n"
                           "  sim      an exposure loop around a simulated camera\n"
                           "  list     the cameras that are there, and what they offer\n"
                           "  probe    what a camera is, and, measured in its picture, what it does\n"
                           "  help     this text, or 'pupil help COMMAND'\n"
                           "  version  the version of the program and of the library\n"
                           "'pupil COMMAND --help' fits a screen; 'man pupil' tells all.\n";

/* The number of a standard stream that is closed would go to the next file that is opened, and sentences for the user
 * into an output. What takes its place here refuses what the stream is used for, as the closed one would. */
static void fill_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0)
            (void)!open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY); /* the lowest free number: fd */
}

typedef int command_main(int argc, char **argv);

static command_main *find(const char *name)
{
    static const struct {
        const char *name;
        command_main *run;
    } commands[] = {{"run", run_main},       {"replay", replay_main}, {"render", render_main},
                    {"study", study_main},   {"bench", bench_main},   {"list", list_main},
                    {"record", record_main}, {"probe", probe_main},   {"sim", sim_main}};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        if (strcmp(name, commands[i].name) == 0)
            return commands[i].run;
    return NULL;
}

int main(int argc, char **argv)
{
    fill_standard_streams();
    const char *command = argc > 1 ? argv[1] : "";
    command_main *run = find(command);
    if (run)
        return run(argc - 1, argv + 1);
    if (strcmp(command, "version") == 0 || strcmp(command, "--version") == 0) {
        printf("pupil %d.%d.%d (library %s)\n", PUPIL_VERSION_MAJOR, PUPIL_VERSION_MINOR, PUPIL_VERSION_PATCH,
               pupil_version());
        return 0;
    }
    run = strcmp(command, "help") == 0 && argc > 2 ? find(argv[2]) : NULL;
    if (run) {
        char *asked[] = {argv[2], "--help", NULL};
        return run(2, asked);
    }
    if (strcmp(command, "help") == 0 || strcmp(command, "--help") == 0 || strcmp(command, "-h") == 0) {
        fputs(help, stdout);
        return 0;
    }
    if (*command)
        fprintf(stderr, "pupil: %s: no such command; 'pupil help' lists them\n", command);
    else
        fputs(help, stderr);
    return 2;
}
