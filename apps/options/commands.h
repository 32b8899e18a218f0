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
    EXIT_INTERRUPTED = 130 /* by Ctrl-C, if that is not the usual end; as in shells: 128 + SIGINT */
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

/* All commands in the order of the help, ended by NULL. */
extern const option_command *const pupil_commands[];

/* Runs a command with its own arguments, its name first; returns the exit status. */
int pupil_command_run(const option_command *command, int argc, char **argv);

#endif
