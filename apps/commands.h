/* apps/commands.h: the subcommands. Each takes its own arguments, its name first, and returns the exit status. */
#ifndef PUPIL_APPS_COMMANDS_H
#define PUPIL_APPS_COMMANDS_H

int run_main(int argc, char **argv);
int replay_main(int argc, char **argv);
int render_main(int argc, char **argv);
int study_main(int argc, char **argv);
int bench_main(int argc, char **argv);
int list_main(int argc, char **argv);
int probe_main(int argc, char **argv);
int record_main(int argc, char **argv);
int sim_main(int argc, char **argv);

#endif
