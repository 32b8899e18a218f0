#include "bench.h"
int bench_ae_main(int argc, char **argv)
{
    (void)argc, (void)argv;
    return 1;
}
