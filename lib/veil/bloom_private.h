/* lib/veil/bloom_private.h: what is inside a pupil_bloom, and its parts. */
#ifndef PUPIL_VEIL_BLOOM_PRIVATE_H
#define PUPIL_VEIL_BLOOM_PRIVATE_H

#include "pupil/bloom.h"

#include "core/object.h"
#include "veil_rows.h"

enum {
    BLOOM_OCTAVES = 11, /* full size, and those of half the one before */
    BLOOM_MARGIN = 4,   /* pixels of an octave beyond the picture's edges, where filters leave light, and take it
                         * back */
    BLOOM_LEFT = 16,    /* floats before the first pixel: those that are not margin are 0 */
    BLOOM_STEP = 32,    /* kernels round widths up to this */
    BLOOM_BEHIND = PUPIL_BLOOM_ROWS / 2 + 1, /* rows by which light is ahead of what overwrites it */
    BLOOM_UNIT = 16,                         /* pixels that are skipped together if no light reaches them */
    BLOOM_FIT_FAR = 13,                      /* pixels */
    /* Pixels of a row that are processed at a time, with the reach of the full-size filters: few enough that all rows
     * within reach stay in the L1 cache. */
    BLOOM_SIDE = PUPIL_BLOOM_SIDE,
    BLOOM_LINE = PUPIL_BLOOM_LINE,
    BLOOM_PART = BLOOM_LINE - 2 * BLOOM_SIDE
};

/* Its planes begin at these floats of `memory`: rows of `stride` floats, BLOOM_MARGIN rows before the first. Without a
 * bright pass, blurred rows overwrite rows of light that are no longer needed, so less memory is touched. `lit` are
 * bytes of `memory`: for each row, which of its `units` (BLOOM_UNIT pixels, from the margin's first on) have light.
 * `reached` are the same for the blurred planes. All other units are 0. */
typedef struct bloom_octave {
    uint32_t width, height, stride, rows, units;
    size_t light, blurred, lit, reached;
} bloom_octave;

typedef struct bloom_object {
    uint64_t magic;
    pupil_bloom_config config;
    uint32_t octaves;                     /* with the full size */
    uint32_t lit;                         /* the octaves have light, by the last solve */
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

/* The flags of row y, which is one of the octave's. */
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

/* For data that vectors read: at multiples of 64 bytes they read it at once. */
#define BLOOM_ALIGNED __attribute__((aligned(64)))

static inline void *pupil_bloom_aligned(pupil_bloom_scratch *scratch)
{
    return (unsigned char *)scratch + (64 - (uintptr_t)scratch % 64) % 64;
}

/* bloom_lamps.c: where a row of the frame has lamps, pixels above the threshold: a bit for each 8 pixels, in words with
 * a 0 before and behind them. */
enum { BLOOM_EIGHT = 8, BLOOM_WORD = 32 * BLOOM_EIGHT, BLOOM_MOST_WORDS = PUPIL_MAX_SIDE_PX / BLOOM_WORD + 2 };
static inline uint32_t pupil_bloom_words(uint32_t width)
{
    return (width + BLOOM_WORD - 1) / BLOOM_WORD + 2;
}
void pupil_bloom_find_lamps(bloom_frame *frame, int32_t y, uint32_t *words);
/* The lamps of row y of the frame: the index of their first float, and a pointer to it. */
static inline size_t pupil_bloom_lamps_row(const bloom_object *o, int32_t y)
{
    return o->lamps + (size_t)y * pupil_bloom_words(o->config.width);
}
static inline uint32_t *pupil_bloom_lamps_of(bloom_object *o, int32_t y)
{
    return (uint32_t *)(void *)(o->memory + pupil_bloom_lamps_row(o, y));
}
/* `count` of the bits, 32 at most, from that of pixel 8 * first on; first is -32 or more. Beyond the frame they are
 * 0. */
static inline uint32_t pupil_bloom_bits(const uint32_t *words, uint32_t width, int32_t first, uint32_t count)
{
    const uint32_t at = (uint32_t)(first + 32), word = at / 32, last = pupil_bloom_words(width) - 1;
    const uint64_t low = word < last ? words[word] : 0, high = word < last ? words[word + 1] : 0;
    return (uint32_t)((low | high << 32) >> at % 32) & (uint32_t)((UINT64_C(1) << count) - 1);
}

/* bloom_light.c: the light of row y, n pixels from x on, BLOOM_LINE at most; 0 outside the frame. Returns whether its
 * pixels are known to be whole (kernels.h: pupil_bloom_pixels_kernel). */
int pupil_bloom_light(bloom_frame *frame, int32_t y, int32_t x, uint32_t n, bloom_line line);
/* States of a line: its light is not read yet; it has no light, but stale content; its light is read; it is zeros. */
enum { BLOOM_UNREAD, BLOOM_DARK, BLOOM_LIT, BLOOM_BLACK };
/* The four rows of an octave's blurred planes, from PUPIL_BLOOM_SIDE before pixel x on, that give row y of the finer
 * octave: those of the first channel, and the distance to the next channel's. */
typedef struct bloom_four {
    const float *row[4];
    size_t next[4];
    int32_t y;
} bloom_four;
void pupil_bloom_find_four(const bloom_object *o, uint32_t octave, int32_t y, int32_t x, bloom_four *four);
/* Writes 2 n pixels of that row and the current channel, or with `add` adds to them. The next channel is then
 * current. */
void pupil_bloom_take(const pupil_kernels *kernels, bloom_four *four, uint32_t n, pupil_bloom_room room, float *to,
                      int add);

/* bloom_octaves.c: clears units first to end of row y of planes, and their flags, where these are set. */
void pupil_bloom_clear(bloom_object *o, uint32_t octave, size_t planes, size_t flags, int32_t y, uint32_t first,
                       uint32_t end);

/* bloom_fit.c: its scratch, for each octave in turn: the lobes that are left; the light that the narrow ones and that
 * all of them scatter, from the middle outwards; and the fitted taps. */
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
    uint32_t lamps[PUPIL_BLOOM_ROWS]; /* a bit for each 8 pixels, from 8 before the block on */
    uint32_t x, n;                    /* the block */
    uint32_t units;                   /* of the current row, with light within the full-size kernel's reach: a bit
                                       * each */
    int octaves;                      /* they add light to that row */
    bloom_frame frame;
} bloom_window;

/* With a bright pass: whether light reaches one of rows y to end_row of a block. */
int pupil_bloom_reaches(const bloom_object *o, uint32_t y, uint32_t end_row, uint32_t x, uint32_t n);

/* To be called before row y of the block at x, n pixels wide, BLOOM_PART at most. */
void pupil_bloom_window_begin(const bloom_object *o, bloom_window *w, uint32_t y, uint32_t x, uint32_t n);
/* Goes to its next row, y. Returns whether light reaches it. */
int pupil_bloom_window_step(const bloom_object *o, bloom_window *w, uint32_t y);
/* Reads the light that row y needs. Returns whether all its pixels are whole, so that planes need not be loaded. */
int pupil_bloom_window_read(bloom_window *w, uint32_t y);
/* Adds the light that is scattered to row y, to planes or to a row of whole pixels. */
void pupil_bloom_window_add(const bloom_object *o, bloom_window *w, uint32_t y, int whole, pupil_planes *planes);

#endif
