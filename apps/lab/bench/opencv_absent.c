/* Replaces OpenCV where it is not built in. */
#include <stdio.h>

#include "peers.h"
#include "refuse.h"

static void *refuse(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
{
    (void)rgba;
    (void)width;
    (void)height;
    pupil_refuse(why,
                 "not in this build (-DPUPIL_BENCH_PEERS=ON, with libopencv-photo-dev and a C++ compiler, puts it in)");
    return NULL;
}

const bench_peer bench_peer_opencv = {.name = "opencv", .open = refuse};
