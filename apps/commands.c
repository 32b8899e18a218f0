#include "options/commands.h"

const option_command *const pupil_commands[] = {
    &run_command,    &replay_command, &record_command, &list_command, &probe_command,
    &render_command, &study_command,  &bench_command,  &sim_command,  NULL};
