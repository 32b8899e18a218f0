/* apps/lab/bench/gles_absent.c: replaces gles*.c in a build without OpenGL ES. */
#include <stdio.h>

#include "bench.h"

int bench_gles_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    fputs("pupil bench gles: this program was built without OpenGL ES (PUPIL_GPU=OFF)\n", stderr);
    return 1;
}

const option_command bench_gles_command = {
    .name = "bench gles", .summary = "(not in this build)", .usage = "", .manual = ""};
