/* The plain loop with -O3 -ffast-math (apps/CMakeLists.txt). */
#include "plain_loop.h"

float bench_plain_fast(const float *rgba, size_t pixels, float white, uint8_t *out)
{
    return plain(rgba, pixels, white, out);
}
