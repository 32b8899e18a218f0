/* Replaces libavfilter's filters where they are not built in. */
#include <stdio.h>

#include "peers.h"
#include "refuse.h"

static void *refuse(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
{
    (void)rgba;
    (void)width;
    (void)height;
    pupil_refuse(why, "not in this build (-DPUPIL_BENCH_PEERS=ON, with libavfilter-dev, puts it in)");
    return NULL;
}

const bench_peer bench_peer_ffmpeg = {.name = "ffmpeg", .open = refuse};
const bench_peer bench_peer_ffmpeg_least = {.name = "ffmpeg-min", .open = refuse};
const bench_peer bench_peer_libplacebo = {.name = "libplacebo", .open = refuse};
