/* apps/lab/bench/peers.h: what a user could use instead of pupil, for the benchmark only: each maps linear RGBA float
 * to 8 bits on one thread, as its users do. None does quite what pupil does; `does` says what. */
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
    /* Converts the frame to the peer's own layout; not timed. NULL and a sentence: not in this build, or it does not
     * work here. */
    void *(*open)(const float *rgba, uint32_t width, uint32_t height, pupil_why *why);
    void (*run)(void *state);          /* one frame, until its last 8-bit sample is in memory */
    double (*mean)(const void *state); /* of the green codes of the last frame, to prove that there is a picture; -1:
                                        * none */
    void (*close)(void *state);
} bench_peer;

extern const bench_peer bench_peer_opencv, bench_peer_ffmpeg, bench_peer_ffmpeg_least, bench_peer_libplacebo;

#ifdef __cplusplus
}
#endif

#endif
