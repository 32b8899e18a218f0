/* The plain loop, with the flags of everything else. */
#include "plain_loop.h"

float bench_plain_usual(const float *rgba, size_t pixels, float white, uint8_t *out)
{
    return plain(rgba, pixels, white, out);
}
