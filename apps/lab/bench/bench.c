/* pupil bench: how long things take, each relative to its lower bound. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

#include "options/commands.h"

static const option_command *const parts[] = {&bench_kernels_command,
                                              &bench_gles_command,
                                              &bench_scene_command,
                                              &bench_ae_command,
                                              &bench_deferred_command,
                                              &bench_veil_command,
                                              NULL};
static int (*const runs[])(int argc, char **argv) = {bench_kernels_main, bench_gles_main,     bench_scene_main,
                                                     bench_ae_main,      bench_deferred_main, bench_veil_main};

const option_command bench_command = {
    .name = "bench",
    .summary = "measures speed, next to the physical limit",
    .parts = parts,
};

static void put_help(FILE *out)
{
    fputs("usage: pupil bench WHAT ...\n"
          "How long things take, next to the fastest that is possible, measured alternately in one run.\n",
          out);
    for (const option_command *const *c = parts; *c; c++)
        fprintf(out, "  %-8s %s\n", strchr((*c)->name, ' ') + 1, (*c)->summary);
    fputs("'pupil bench WHAT --help' has more.\n", out);
}

int bench_main(int argc, char **argv)
{
    char name[64];
    const char *what = argc > 1 ? argv[1] : "";
    snprintf(name, sizeof name, "bench %s", strcmp(what, "--ae") == 0 ? "ae" : what);
    const option_command *command = options_command(parts, name);
    for (size_t i = 0; command; i++)
        if (parts[i] == command)
            return runs[i](argc - 1, argv + 1);
    if (strcmp(what, "--help") == 0 || strcmp(what, "-h") == 0) {
        put_help(stdout);
        return 0;
    }
    if (*what)
        fprintf(stderr, "pupil bench: %s: nothing that can be measured; 'pupil bench --help' lists what can\n", what);
    else
        put_help(stderr);
    return 2;
}
