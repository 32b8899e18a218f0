/* apps/options/commands.h: the commands of the program. Each takes its own arguments, its name first, and returns the
 * exit status. */
#ifndef PUPIL_APPS_OPTIONS_COMMANDS_H
#define PUPIL_APPS_OPTIONS_COMMANDS_H

#include "option_table.h"

/* The exit status, the same in all of them. */
enum {
    EXIT_DONE = 0,
    EXIT_FAILED = 1,
    EXIT_USAGE = 2,
    EXIT_INCOMPLETE = 3,   /* done, but frames were skipped or lost */
    EXIT_INTERRUPTED = 130 /* by Ctrl-C, where that is no usual end; as shells have it: 128 + SIGINT */
};

int run_main(int argc, char **argv);
int replay_main(int argc, char **argv);
int render_main(int argc, char **argv);
int study_main(int argc, char **argv);
int bench_main(int argc, char **argv);
int list_main(int argc, char **argv);
int probe_main(int argc, char **argv);
int record_main(int argc, char **argv);
int ctl_main(int argc, char **argv);
int sim_main(int argc, char **argv);
int meter_main(int argc, char **argv);
int adapt_main(int argc, char **argv);
int map_main(int argc, char **argv);

extern const option_command run_command, replay_command, record_command, render_command, study_command, bench_command,
    sim_command, list_command, probe_command, ctl_command, meter_command, adapt_command, map_command;

/* All of them in the order of the help, up to NULL. */
extern const option_command *const pupil_commands[];

/* Runs one of them: its own arguments, its name first; the exit status. */
int pupil_command_run(const option_command *command, int argc, char **argv);

#endif
