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
    BLOOM_BEHIND = PUPIL_BLOOM_ROWS / 2 + 1, /* rows that light is ahead of what takes its place */
    BLOOM_UNIT = 16,                         /* pixels that are skipped where there is no light for them */
    BLOOM_FIT_FAR = 13,                      /* pixels */
    /* Pixels of a row that are worked at a time, with what filters at full size reach: small enough that all rows that
     * they reach stay in the L1 cache. */
    BLOOM_SIDE = PUPIL_BLOOM_SIDE,
    BLOOM_LINE = PUPIL_BLOOM_LINE,
    BLOOM_PART = BLOOM_LINE - 2 * BLOOM_SIDE
};

/* Its planes begin at these floats of `memory`: rows of `stride` floats, BLOOM_MARGIN rows before the first. With all
 * light, blurred rows take the place of light that no other one needs: so there is less memory to go through. `lit` are
 * bytes of `memory`: for each row, where in its planes of light there is some, by `units` of BLOOM_UNIT pixels from the
 * margin's first on. `reached` are the same of the blurred planes. All other units are 0. */
typedef struct bloom_octave {
    uint32_t width, height, stride, rows, units;
    size_t light, blurred, lit, reached;
} bloom_octave;

typedef struct bloom_object {
    uint64_t magic;
    pupil_bloom_config config;
    uint32_t octaves;                     /* with the full size */
    uint32_t lit;                         /* there is light in the octaves, since solve */
    pupil_bloom_taps taps[BLOOM_OCTAVES]; /* at full size less what all lobes take from a pixel */
    bloom_octave octave[BLOOM_OCTAVES];   /* the first has no planes */
    size_t nothing, room;                 /* a row of zeros; filters' room for solve */
    size_t need;                          /* bytes of memory: three for a unit, for solve */
    size_t lamps;                         /* words of memory: rows of bloom_lamps.c, with a bright pass */
    _Alignas(double) float memory[];      /* at init a bloom_fit */
} bloom_object;

#define BLOOM_MAGIC (UINT64_C(0x626c6f6d00000000) + sizeof(bloom_object))

static inline int pupil_bloom_check(const pupil_bloom *bloom)
{
    if (!bloom)
        return PUPIL_ERR_NULL;
    return ((const bloom_object *)(const void *)bloom)->magic == BLOOM_MAGIC ? PUPIL_OK : PUPIL_ERR_OBJECT;
}

/* Where an octave may have light: not in the margin's last rows. */
static inline int pupil_bloom_has_row(const bloom_octave *at, int32_t y)
{
    return y > -BLOOM_MARGIN && y < (int32_t)at->height + BLOOM_MARGIN - 1;
}

/* Row y of a plane of an octave, from BLOOM_LEFT before the first pixel on. */
static inline size_t pupil_bloom_row(const bloom_object *o, uint32_t octave, size_t planes, int channel, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    if (!pupil_bloom_has_row(at, y))
        return o->nothing;
    return planes + ((size_t)channel * at->rows + (size_t)(y + BLOOM_MARGIN)) * at->stride;
}

/* The bytes of row y, which is one of the octave's. */
static inline uint8_t *pupil_bloom_flags(const bloom_object *o, uint32_t octave, size_t flags, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    return (uint8_t *)(uintptr_t)o->memory + flags + (size_t)(y + BLOOM_MARGIN) * at->units;
}

/* Whether one of units first to end is set in one of rows y to y + rows. */
static inline int pupil_bloom_any(const bloom_object *o, uint32_t octave, size_t flags, int32_t y, int32_t rows,
                                  uint32_t first, uint32_t end)
{
    const bloom_octave *at = &o->octave[octave];
    const int32_t from = y > -BLOOM_MARGIN ? y : -BLOOM_MARGIN, below = (int32_t)at->height + BLOOM_MARGIN;
    const int32_t to = y + rows < below ? y + rows : below;
    end = end < at->units ? end : at->units;
    for (int32_t i = from; i < to; i++) {
        const uint8_t *row = pupil_bloom_flags(o, octave, flags, i);
        for (uint32_t u = first; u < end; u++)
            if (row[u])
                return 1;
    }
    return 0;
}

/* A frame whose light is read by blocks. */
typedef struct bloom_frame {
    const pupil_kernels *kernels;
    veil_rows rows;
    float threshold;
    int32_t ahead; /* how many rows further down are fetched into the cache */
    pupil_planes planes;
} bloom_frame;

typedef float bloom_line[3][BLOOM_LINE];

/* What vectors read is at multiples of 64 bytes, which they then read at once. */
#define BLOOM_ALIGNED __attribute__((aligned(64)))

static inline void *pupil_bloom_aligned(pupil_bloom_scratch *scratch)
{
    return (unsigned char *)scratch + (64 - (uintptr_t)scratch % 64) % 64;
}

/* bloom_lamps.c: where a row of the frame has lamps, pixels above the threshold: a bit for each 8 pixels, in words
 * between two that are 0. */
enum { BLOOM_EIGHT = 8, BLOOM_WORD = 32 * BLOOM_EIGHT, BLOOM_MOST_WORDS = PUPIL_MAX_SIDE_PX / BLOOM_WORD + 2 };
static inline uint32_t pupil_bloom_words(uint32_t width)
{
    return (width + BLOOM_WORD - 1) / BLOOM_WORD + 2;
}
void pupil_bloom_find_lamps(bloom_frame *frame, int32_t y, uint32_t *words);
/* Where those of row y of the frame are kept: from which float on, and there. */
static inline size_t pupil_bloom_lamps_row(const bloom_object *o, int32_t y)
{
    return o->lamps + (size_t)y * pupil_bloom_words(o->config.width);
}
static inline uint32_t *pupil_bloom_lamps_of(bloom_object *o, int32_t y)
{
    return (uint32_t *)(void *)(o->memory + pupil_bloom_lamps_row(o, y));
}
/* `count` of the bits, 32 at most, from that of pixel 8 * first on; first is -32 or more. Behind the frame there are
 * none. */
static inline uint32_t pupil_bloom_bits(const uint32_t *words, uint32_t width, int32_t first, uint32_t count)
{
    const uint32_t at = (uint32_t)(first + 32), word = at / 32, last = pupil_bloom_words(width) - 1;
    const uint64_t low = word < last ? words[word] : 0, high = word < last ? words[word + 1] : 0;
    return (uint32_t)((low | high << 32) >> at % 32) & (uint32_t)((UINT64_C(1) << count) - 1);
}

/* bloom_light.c: the light of row y, n pixels from x on, BLOOM_LINE at most; 0 outside the frame. Returns whether its
 * pixels are known to be whole (kernels.h: pupil_bloom_pixels_kernel). */
int pupil_bloom_light(bloom_frame *frame, int32_t y, int32_t x, uint32_t n, bloom_line line);
/* Of some lines: light that is not read yet; none, but anything in it; light, read; zeros. */
enum { BLOOM_UNREAD, BLOOM_DARK, BLOOM_LIT, BLOOM_BLACK };
/* The four rows of an octave's blurred planes, from PUPIL_BLOOM_SIDE before pixel x on, that give row y of the octave
 * above: of its first channel, and how far it is to the next channel's. */
typedef struct bloom_four {
    const float *row[4];
    size_t next[4];
    int32_t y;
} bloom_four;
void pupil_bloom_find_four(const bloom_object *o, uint32_t octave, int32_t y, int32_t x, bloom_four *four);
/* 2 n pixels of that row, of the channel at hand, which is then the next one; with `add` they get more. */
void pupil_bloom_take(const pupil_kernels *kernels, bloom_four *four, uint32_t n, pupil_bloom_room room, float *to,
                      int add);

/* bloom_octaves.c: units first to end of row y of planes and their flags become 0, if they are not. */
void pupil_bloom_clear(bloom_object *o, uint32_t octave, size_t planes, size_t flags, int32_t y, uint32_t first,
                       uint32_t end);

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

/* bloom_window.c: full size, block by block, down its rows. */
typedef struct bloom_window {
    BLOOM_ALIGNED bloom_line ring[PUPIL_BLOOM_ROWS];
    BLOOM_ALIGNED pupil_bloom_room room;
    uint8_t state[PUPIL_BLOOM_ROWS], whole[PUPIL_BLOOM_ROWS];
    uint32_t lamps[PUPIL_BLOOM_ROWS]; /* of 8 pixels each, from 8 before the block on */
    uint32_t x, n;                    /* the block */
    uint32_t units;                   /* of the row at hand, within reach of the kernel at full size: a bit each */
    int octaves;                      /* they give that row something */
    bloom_frame frame;
} bloom_window;

/* Whether light reaches one of rows y to end_row of a block: with a bright pass. */
int pupil_bloom_reaches(const bloom_object *o, uint32_t y, uint32_t end_row, uint32_t x, uint32_t n);

/* Before row y of the block at x, n pixels wide, BLOOM_PART at most. */
void pupil_bloom_window_begin(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n);
/* The next row of it, y: whether light reaches it. */
int pupil_bloom_window_step(const bloom_object *o, bloom_window *w, uint32_t y);
/* Reads the light that it needs: whether all pixels of row y are whole, so that planes need not be loaded. */
int pupil_bloom_window_read(bloom_window *w, uint32_t y);
/* Adds to planes, or to a row of whole pixels, what is scattered to it. */
void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, int whole, pupil_planes *planes);

#endif
