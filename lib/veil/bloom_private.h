/* lib/veil/bloom_private.h: what is inside a pupil_bloom, and its parts. */
#ifndef PUPIL_VEIL_BLOOM_PRIVATE_H
#define PUPIL_VEIL_BLOOM_PRIVATE_H

#include "pupil/bloom.h"

#include "core/object.h"
#include "veil_rows.h"

enum {
    BLOOM_OCTAVES = 11, /* full size, and those of half the one before */
    BLOOM_MARGIN = 4,   /* octaves go on beyond the picture's edges: filters leave light there, and take it back */
    BLOOM_LEFT = 16,    /* floats before the first pixel, of which the rest are 0 */
    BLOOM_STEP = 32,    /* what kernels round up to */
    BLOOM_FIT_FAR = 13, /* pixels */
    /* Pixels of a row that are worked at a time, with what filters at full size reach: small enough that all rows that
     * they reach stay in the L1 cache. */
    BLOOM_SIDE = PUPIL_BLOOM_SIDE,
    BLOOM_LINE = PUPIL_BLOOM_LINE,
    BLOOM_PART = BLOOM_LINE - 2 * BLOOM_SIDE
};

/* Its planes begin at these floats of `memory`: rows of `stride` floats, BLOOM_MARGIN rows before the first. `lit` are
 * bytes of `memory`: for each row, where in its planes of light there is some, by `units` of BLOOM_STEP pixels from the
 * margin's first on. The others are 0. */
typedef struct bloom_octave {
    uint32_t width, height, stride, rows, units;
    size_t light, blurred, lit;
} bloom_octave;

typedef struct bloom_object {
    uint64_t magic;
    pupil_bloom_config config;
    uint32_t octaves;                     /* with the full size */
    uint32_t lit;                         /* there is light in the octaves, since solve */
    pupil_bloom_taps taps[BLOOM_OCTAVES]; /* at full size less what all lobes take from a pixel */
    bloom_octave octave[BLOOM_OCTAVES];   /* the first has no planes */
    size_t nothing, line, sums;           /* a row of zeros; a row and columns' sums for solve */
    size_t need;                          /* bytes of memory: a unit each, for solve */
    _Alignas(double) float memory[];      /* at init a bloom_fit */
} bloom_object;

#define BLOOM_MAGIC (UINT64_C(0x626c6f6d00000000) + sizeof(bloom_object))

static inline int pupil_bloom_check(const pupil_bloom *bloom)
{
    if (!bloom)
        return PUPIL_ERR_NULL;
    return ((const bloom_object *)(const void *)bloom)->magic == BLOOM_MAGIC ? PUPIL_OK : PUPIL_ERR_OBJECT;
}

/* Row y of a plane of an octave, from BLOOM_LEFT before the first pixel on; beyond the margin there is no light. */
static inline size_t pupil_bloom_row(const bloom_object *o, uint32_t octave, size_t planes, int channel, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    if (y < -BLOOM_MARGIN || y >= (int32_t)at->height + BLOOM_MARGIN)
        return o->nothing;
    return planes + ((size_t)channel * at->rows + (size_t)(y + BLOOM_MARGIN)) * at->stride;
}

static inline uint8_t *pupil_bloom_lit(bloom_object *o, uint32_t octave, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    return (uint8_t *)o->memory + at->lit + (size_t)(y + BLOOM_MARGIN) * at->units;
}

/* A frame whose light is read by blocks. */
typedef struct bloom_frame {
    const pupil_kernels *kernels;
    veil_rows rows;
    float threshold;
    pupil_planes planes;
} bloom_frame;

typedef float bloom_line[3][BLOOM_LINE];

/* What vectors read is at multiples of 64 bytes, which they then read at once. */
#define BLOOM_ALIGNED __attribute__((aligned(64)))

static inline void *pupil_bloom_aligned(pupil_bloom_scratch *scratch)
{
    return (unsigned char *)scratch + (64 - (uintptr_t)scratch % 64) % 64;
}

/* bloom_light.c: the light of row y, n pixels from x on, BLOOM_LINE at most; 0 outside the frame. Returns in which
 * units of BLOOM_UNIT pixels of the line there is some: bit k, in the k-th. 0: what is in the line is not said. */
enum { BLOOM_UNIT = 16, BLOOM_UNITS = BLOOM_LINE / BLOOM_UNIT, BLOOM_ALL_UNITS = (1 << BLOOM_UNITS) - 1 };
uint32_t pupil_bloom_light(bloom_frame *frame, int32_t y, int32_t x, uint32_t n, bloom_line line);
/* Of some lines: no light, but anything in it; light; zeros. */
enum { BLOOM_DARK, BLOOM_LIT, BLOOM_BLACK };
/* Whether one of them is lit. Then those that are dark are made black. */
int pupil_bloom_any(bloom_line *lines, uint8_t *state, uint32_t count);
/* Row y of the octave above from four rows of `blurred` of `octave`, still of its width, from float `from` on. */
void pupil_bloom_between(const bloom_object *o, const pupil_kernels *kernels, uint32_t octave, int channel, int32_t y,
                         uint32_t from, uint32_t n, float *to);

/* bloom_fit.c: what it works with: of each octave in turn the lobes that are left; what the narrow ones of them scatter
 * and what all do, from the middle outwards; and its taps that are fitted. */
typedef struct bloom_fit {
    uint32_t lobes;
    double variance[PUPIL_VEIL_MOST_LOBES], share[PUPIL_VEIL_MOST_LOBES];
    double narrow, least;
    double target[BLOOM_FIT_FAR + 1][BLOOM_FIT_FAR + 1], all[BLOOM_FIT_FAR + 1][BLOOM_FIT_FAR + 1];
    double reply[PUPIL_BLOOM_ROWS / 2 + 1][2 * BLOOM_FIT_FAR + 1];
    double sums[PUPIL_BLOOM_TAPS][PUPIL_BLOOM_TAPS + 1], below[PUPIL_BLOOM_TAPS];
    float weight[(2 * BLOOM_FIT_FAR + 1) * (2 * BLOOM_FIT_FAR + 1)];
} bloom_fit;

/* How many octaves the lobes need, with the full size. And their kernels. */
uint32_t pupil_bloom_octaves(const pupil_bloom_config *config);
void pupil_bloom_fit(const pupil_bloom_config *config, bloom_fit *fit, uint32_t octaves, pupil_bloom_taps taps[]);

/* bloom_window.c: full size, block by block. */
typedef struct bloom_window {
    BLOOM_ALIGNED bloom_line ring[PUPIL_BLOOM_ROWS];
    BLOOM_ALIGNED pupil_bloom_sums sums;
    BLOOM_ALIGNED float line[BLOOM_LINE];
    uint8_t state[PUPIL_BLOOM_ROWS];
    uint32_t units[PUPIL_BLOOM_ROWS]; /* pupil_bloom_light's */
    bloom_frame frame;
} bloom_window;

/* Before the first row y of the block at x, n pixels wide, BLOOM_PART at most. */
void pupil_bloom_window_begin(bloom_window *w, uint32_t y, uint32_t x, uint32_t n);
/* Adds to planes what is scattered to row y, n pixels from x on: the rows come one after the other. */
void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n,
                            pupil_planes *planes);

#endif
