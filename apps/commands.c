/* The commands of the program, in the order of the help: what each takes, and what it runs. */
#include "options/commands.h"

const option_command *const pupil_commands[] = {
    &run_command,   &replay_command, &record_command, &list_command,  &probe_command, &ctl_command, &meter_command,
    &adapt_command, &map_command,    &render_command, &study_command, &bench_command, &sim_command, NULL};

static int (*const runs[])(int argc, char **argv) = {run_main,   replay_main, record_main, list_main, probe_main,
                                                     ctl_main,   meter_main,  adapt_main,  map_main,  render_main,
                                                     study_main, bench_main,  sim_main};
_Static_assert(sizeof runs / sizeof runs[0] + 1 == sizeof pupil_commands / sizeof pupil_commands[0],
               "each command runs something");

int pupil_command_run(const option_command *command, int argc, char **argv)
{
    size_t n = 0;
    while (pupil_commands[n] != command)
        n++;
    return runs[n](argc, argv);
}
