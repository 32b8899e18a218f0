/* Replaces the lab's commands in a build without them. */
#include <stdio.h>

#include "options/commands.h"

static int absent(const char *command)
{
    fprintf(stderr, "pupil %s: this build has no such command (it was configured with PUPIL_LAB=OFF)\n", command);
    return 1;
}

#define ABSENT(command)                                                                                                \
    {                                                                                                                  \
        .name = command, .summary = "(not in this build)", .usage = "", .manual = ""                                   \
    }

const option_command render_command = ABSENT("render");
const option_command study_command = ABSENT("study");
const option_command sim_command = ABSENT("sim");
const option_command bench_command = ABSENT("bench");

int render_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    return absent("render");
}

int study_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    return absent("study");
}

int sim_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    return absent("sim");
}

int bench_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    return absent("bench");
}
