/* In the place of the benchmarks where they are not built in. */
#include <stdio.h>

#include "commands.h"

int bench_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    fputs("pupil bench: this build has no benchmarks (configured with PUPIL_BENCH=OFF)\n", stderr);
    return 1;
}
