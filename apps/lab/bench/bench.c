/* pupil bench: how long things take, each beside what it cannot be faster than. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

#include "commands.h"

enum { EXIT_DONE = 0, EXIT_USAGE = 2 };

static const char help[] =
    "usage: pupil bench WHAT ...\n"
    "How long things take, each beside what it cannot be faster than, in turns in one run.\n"
    "  kernels  metering and mapping at every level, format and number of threads; their errors\n"
    "  gles     the same on the GPU, beside the CPU and a plain copy; their errors\n"
    "  scene    rendering a scene's lights once, and its frames as their sums\n"
    "  ae       exposure loops on a simulated camera: pupil's beside published laws (also --ae)\n"
    "'pupil bench WHAT --help' tells more.\n";

int bench_main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } whats[] = {{"kernels", bench_kernels_main},
                 {"gles", bench_gles_main},
                 {"scene", bench_scene_main},
                 {"ae", bench_ae_main},
                 {"--ae", bench_ae_main}};
    const char *what = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < sizeof whats / sizeof whats[0]; i++)
        if (strcmp(what, whats[i].name) == 0)
            return whats[i].run(argc - 1, argv + 1);
    if (strcmp(what, "--help") == 0 || strcmp(what, "-h") == 0) {
        fputs(help, stdout);
        return EXIT_DONE;
    }
    if (*what)
        fprintf(stderr, "pupil bench: %s: nothing that can be measured; 'pupil bench --help' lists what can\n", what);
    else
        fputs(help, stderr);
    return EXIT_USAGE;
}
