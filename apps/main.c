/* The `pupil` program: commands, each in a folder of its own. */
#include "options/commands.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/report_error.h"
#include "pupil/pupil.h"
#include "refuse.h"

static void put_help(FILE *out)
{
    fputs("usage: pupil COMMAND ...\nCamera-style auto-exposure for HDR frames.\n", out);
    for (const option_command *const *c = pupil_commands; *c; c++)
        fprintf(out, "  %-8s %s\n", (*c)->name, (*c)->summary);
    fputs("  help     this text, or 'pupil help COMMAND'\n"
          "  version  the version of the program and of the library\n"
          "  completion bash   what completes options in that shell\n"
          "'pupil COMMAND --help' lists its options; docs/pupil.1, as 'man pupil' once installed, has everything.\n",
          out);
}

/* If a standard stream is closed, the next opened file would get its number, and messages would be written into an
 * output. /dev/null, opened for the opposite direction, takes the number: uses fail, as those of the closed stream
 * would. */
static void fill_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0)
            (void)!open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY); /* the lowest free number: fd */
}

/* What the program itself does, besides the commands. */
static const char *const own[] = {"help", "version", "completion"};
enum { OWN = sizeof own / sizeof own[0] };

/* Refuses an unknown command. */
static int refuse(const char *name)
{
    option_near near;
    option_near_begin(&near, name);
    for (const option_command *const *c = pupil_commands; *c; c++)
        option_near_try(&near, (*c)->name);
    for (int n = 0; n < OWN; n++)
        option_near_try(&near, own[n]);
    pupil_why why;
    pupil_refuse(&why, "%s: no such command%s%s; 'pupil help' lists them", name, near.name ? "; perhaps " : "",
                 near.name ? near.name : "");
    if (access(name, R_OK) == 0)
        pupil_refuse_add(&why, "; pupil replay %s -o OUT adapts a file", name);
    report_error("pupil", &why, "");
    return EXIT_USAGE;
}

/* `pupil help ...`: for a command, for a part of it, for all, or the man page. */
static int help(int argc, char **argv)
{
    char what[64] = "";
    for (int n = 0; n < argc; n++)
        snprintf(what + strlen(what), sizeof what - strlen(what), "%s%s", n ? " " : "", argv[n]);
    const option_command *command = options_command(pupil_commands, what);
    int all = !argc;
    for (int n = 0; n < OWN; n++)
        all |= strcmp(what, own[n]) == 0;
    if (all)
        put_help(stdout);
    else if (strcmp(what, "--man") == 0)
        options_manual(pupil_commands, stdout);
    else if (!command)
        return refuse(what);
    else if (!command->groups) { /* it has more help, or is not in this build */
        char name[32];
        snprintf(name, sizeof name, "%s", command->name);
        char *asked[] = {name, "--help", NULL};
        return pupil_command_run(command, 2, asked);
    } else
        options_help(command, stdout);
    return EXIT_DONE;
}

static int completion(int argc, char **argv)
{
    if (!argc || strcmp(argv[0], "bash") != 0) {
        fputs("pupil completion: name a shell: bash is the only one that is known\n", stderr);
        return EXIT_USAGE;
    }
    if (argc > 1)
        options_complete(pupil_commands, argc - 1, argv + 1, stdout);
    else
        options_completion(stdout);
    return EXIT_DONE;
}

static int run(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    const option_command *command = strchr(name, ' ') ? NULL : options_command(pupil_commands, name);
    if (command)
        return pupil_command_run(command, argc - 1, argv + 1);
    if (strcmp(name, "version") == 0 || strcmp(name, "--version") == 0) {
        printf("pupil %d.%d.%d (library %s)\n", PUPIL_VERSION_MAJOR, PUPIL_VERSION_MINOR, PUPIL_VERSION_PATCH,
               pupil_version());
        return EXIT_DONE;
    }
    if (strcmp(name, "help") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return help(argc - 2, argv + 2);
    if (strcmp(name, "completion") == 0)
        return completion(argc - 2, argv + 2);
    if (*name)
        return refuse(name);
    put_help(stderr);
    return EXIT_USAGE;
}

int main(int argc, char **argv)
{
    fill_standard_streams();
    option_commands = pupil_commands;
    const int status = run(argc, argv);
    const int failed = fflush(stdout) != 0 || ferror(stdout);
    if (status == EXIT_DONE && failed) {
        fputs("pupil: standard output cannot be written\n", stderr);
        return EXIT_FAILED;
    }
    return status;
}
