/* tests/stream/digest.h: the cases of the digest program and how one is run. */
#ifndef PUPIL_TESTS_DIGEST_H
#define PUPIL_TESTS_DIGEST_H

#include "pupil/pupil.h"

enum {
    DIGEST_UPSIDE_DOWN = 1, /* negative strides */
    DIGEST_PLAIN = 2,       /* no odd samples */
    DIGEST_STAMPED = 4,     /* frames bring timestamps, some of them odd */
    DIGEST_EXPOSED = 8,     /* frames bring exposure and gain */
    DIGEST_ROWS = 16,       /* by pupil_frame_rows instead of pupil_process */
    DIGEST_SEAM = 32,       /* by pupil_meter_rows, pupil_adapt, pupil_map_rows */
    DIGEST_HALVED = 64,     /* mosaics: out is half the size */
    DIGEST_PALE = 128       /* Cb and Cr are near grey */
};

typedef struct digest_case {
    pupil_config config;
    uint32_t in, out; /* pixel formats */
    uint32_t width, height;
    unsigned frames;
    unsigned flags;
    pupil_coding coding; /* of camera formats, in and out */
} digest_case;

uint64_t digest_run(const digest_case *c);

/* Veiling glare: two eyes, a list of lights, their nodes, series and pictures. */
uint64_t digest_veil(void);
uint64_t digest_bloom(void);

/* Gains of rows under lamps. */
uint64_t digest_lamps(void);

/* Lamps in the bands of a sensor's frames; lamps in the light of whole frames. */
uint64_t digest_mains(void);
uint64_t digest_flicker(void);

#endif
