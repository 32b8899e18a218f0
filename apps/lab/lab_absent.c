/* In place of the lab's commands in a build without them. */
#include <stdio.h>

#include "options/commands.h"

static int absent(int argc, char **argv)
{
    fprintf(stderr, "pupil %s: this build has no such command (it was configured with PUPIL_LAB=OFF)\n",
            argc > 0 ? argv[0] : "");
    return 1;
}

#define ABSENT(command)                                                                                                \
    {                                                                                                                  \
        .name = command, .summary = "(not in this build)", .usage = "", .manual = "", .run = absent                    \
    }

const option_command render_command = ABSENT("render");
const option_command study_command = ABSENT("study");
const option_command sim_command = ABSENT("sim");
const option_command bench_command = ABSENT("bench");
