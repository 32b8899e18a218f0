/* In the place of OpenCV where it is not built in. */
#include <stdio.h>

#include "peers.h"

static void *refuse(const float *rgba, uint32_t width, uint32_t height, char *why, size_t why_bytes)
{
    (void)rgba;
    (void)width;
    (void)height;
    snprintf(why, why_bytes,
             "not in this build (-DPUPIL_BENCH_PEERS=ON, with libopencv-photo-dev and a C++ compiler, puts it in)");
    return NULL;
}

const bench_peer bench_peer_opencv = {.name = "opencv", .open = refuse};
