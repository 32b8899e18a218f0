/* In the place of the renderer and the study where they are not built in. */
#include <stdio.h>

#include "bench.h"
#include "commands.h"

static int absent(const char *command)
{
    fprintf(stderr, "pupil %s: this build has no scene renderer (configured with PUPIL_SCENES=OFF)\n", command);
    return 1;
}

int render_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return absent("render");
}

int study_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return absent("study");
}

int sim_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return absent("sim");
}

int bench_ae_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return absent("bench ae");
}

int bench_scene_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return absent("bench scene");
}
