/* The `pupil` program: commands, each in a folder of its own. */
#include "options/commands.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>

#include "pupil/pupil.h"

static void put_help(FILE *out)
{
    fputs("usage: pupil COMMAND ...\nCamera-style auto-exposure for HDR frames.\n", out);
    for (const option_command *const *c = pupil_commands; *c; c++)
        fprintf(out, "  %-8s %s\n", (*c)->name, (*c)->summary);
    fputs("  help     this text, or 'pupil help COMMAND'\n"
          "  version  the version of the program and of the library\n"
          "  completion bash   what completes options in that shell\n"
          "'pupil COMMAND --help' fits a screen; 'man pupil' has everything.\n",
          out);
}

/* The number of a standard stream that is closed would go to the next file that is opened, and sentences for the user
 * into an output. What takes its place here refuses what the stream is used for, as the closed one would. */
static void fill_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0)
            (void)!open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY); /* the lowest free number: fd */
}

/* `pupil help ...`: of a command, the man page, or of all. */
static int help(const char *what)
{
    const option_command *command = options_command(pupil_commands, what);
    if (strcmp(what, "--man") == 0)
        options_manual(pupil_commands, stdout);
    else if (command && !command->groups) { /* it has more to say, or is not in this build */
        char name[32];
        snprintf(name, sizeof name, "%s", command->name);
        char *asked[] = {name, "--help", NULL};
        return pupil_command_run(command, 2, asked);
    } else if (command)
        options_help(command, stdout);
    else
        put_help(stdout);
    return 0;
}

int main(int argc, char **argv)
{
    fill_standard_streams();
    option_commands = pupil_commands;
    const char *name = argc > 1 ? argv[1] : "";
    const char *what = argc > 2 ? argv[2] : "";
    const option_command *command = strchr(name, ' ') ? NULL : options_command(pupil_commands, name);
    if (command)
        return pupil_command_run(command, argc - 1, argv + 1);
    if (strcmp(name, "version") == 0 || strcmp(name, "--version") == 0) {
        printf("pupil %d.%d.%d (library %s)\n", PUPIL_VERSION_MAJOR, PUPIL_VERSION_MINOR, PUPIL_VERSION_PATCH,
               pupil_version());
        return 0;
    }
    if (strcmp(name, "help") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return help(what);
    if (strcmp(name, "completion") == 0 && strcmp(what, "bash") == 0) {
        if (argc > 3)
            options_complete(pupil_commands, argc - 3, argv + 3, stdout);
        else
            options_completion(stdout);
        return 0;
    }
    if (strcmp(name, "completion") == 0)
        fputs("pupil completion: name a shell: bash is the only one that is known\n", stderr);
    else if (*name)
        fprintf(stderr, "pupil: %s: no such command; 'pupil help' lists them\n", name);
    else
        put_help(stderr);
    return 2;
}
