/* apps/lab/bench/peers.h: what a user would take in pupil's place, for the benchmark alone: each makes 8 bits of linear
 * RGBA float, as its users do, on one thread. None does quite what pupil does; `does` says what. */
#ifndef PUPIL_APPS_LAB_BENCH_PEERS_H
#define PUPIL_APPS_LAB_BENCH_PEERS_H

#include "pupil/error.h"
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_peer {
    const char *name, *out, *does; /* out: what its samples are, rgba8 or the like */
    /* Takes the frame into the peer's own layout, which is not timed. NULL and a sentence: not in this build, or it
     * does not work here. */
    void *(*open)(const float *rgba, uint32_t width, uint32_t height, pupil_why *why);
    void (*run)(void *state);          /* one frame, to its last 8-bit sample in memory */
    double (*mean)(const void *state); /* of the green codes of the last frame: that there is a picture; -1: none */
    void (*close)(void *state);
} bench_peer;

extern const bench_peer bench_peer_opencv, bench_peer_ffmpeg, bench_peer_ffmpeg_least, bench_peer_libplacebo;

#ifdef __cplusplus
}
#endif

#endif
