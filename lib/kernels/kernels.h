/* lib/kernels/kernels.h: all functions that touch pixels, as one table for each level (scalar, NEON, AVX2, AVX-512,
 * WebAssembly's 128 bits).
 *
 * A row is processed in blocks of up to PUPIL_BLOCK pixels, so that the data between two functions, or pieces, stays in
 * the L1 cache. A level that has a piece for a format reads the frame's samples directly:
 *
 *     meter                          (metering alone: nothing is stored)
 *     scale (meters too) -> store    (mapping: planar floats in between)
 *
 * The pixels that the histogram counts are then loaded a second time. Any other format takes one step more, through
 * planar floats; so does a frame whose histogram counts every pixel, or whose picture has other primaries:
 *
 *     load -> histogram -> meter of planes
 *     load -> histogram -> scale of planes (meters too) -> store
 *
 * Three pieces load a mosaic: unpack (by format) makes 16-bit samples, row by row; then binned makes a pixel of each
 * quad, or bilinear one of each sample. A row for NV12 or I420 is stored as RGBA first, and these codes become Y', Cb
 * and Cr.
 *
 * Each function type is declared once, here. All levels give the same bits (no fused multiply-add, 16 fixed lanes). The
 * scalar level is the reference and has every piece; the others have only faster ones.
 */
#ifndef PUPIL_KERNELS_KERNELS_H
#define PUPIL_KERNELS_KERNELS_H

#include <stdint.h>

#include "pupil/pupil.h"

#define PUPIL_BLOCK   256 /* pixels; a multiple of 64, so that lanes and exponent moves line up from block to block */
#define PUPIL_LANES   16
#define PUPIL_SAMPLES (2 * PUPIL_BLOCK) /* of a mosaic's row, for a block of quads */
#define PUPIL_CEILING 0x1p30f /* the largest luminance; a product of 4, as of 4 times 2^-30, is in a float's range */
/* A channel's bound before it is mapped: above PUPIL_CEILING, so that the largest channel is never below Ld. */
#define PUPIL_BRIGHTEST 0x1p31f

/* --- constants of gamut.h and vector_scale.h --- */

/* x^(-1/3). The first guess y is a constant less a third of the float's bits, so that x y^3 is in 0.66..0.79. For
 * these, a polynomial of degree 2 (minimax by weighted least squares) leaves an error of 2.7e-5. */
#define ROOT_BITS  0x548e0000u
#define ROOT_THIRD 0.333333343f
#define ROOT_0     1.73338342f
#define ROOT_1     1.19775796f
#define ROOT_2     0.472088337f
/* Lower bound of the largest component's distance from grey, which is a divisor. */
#define LEAST_DIVISOR 0x1p-24f
/* Lower bounds of a component, and of grey, in a pixel beyond the limit: smaller values would not change the sums, and
 * their cubes would be denormals, which are slow. */
#define LEAST_VISIBLE 0x1p-60f
#define LEAST_GREY    0x1p-40f

/* --- a curve's knots (pupil.h): a float's bits are the knot below it, and the part of the way to the next --- */

#define KNOT_BITS 20                         /* the bits above are the knot: eight a stop */
#define KNOT_PART ((1u << KNOT_BITS) - 1)    /* the part of the way to the next one ... */
#define KNOT_UNIT 0x1p-20f                   /* ... in this unit */
#define KNOT_ZERO (0x3f800000u >> KNOT_BITS) /* the first one is at 1.0 */
#define KNOT_LAST 0x1.dffffep15f             /* just below the last one */

/* The result of metering a run of pixels. Pixel i of the run is in lane i % 16; log2 of a lane is exponent + log2
 * product. */
typedef struct pupil_run {
    float product[PUPIL_LANES]; /* in [1, 2) between calls */
    int32_t exponent[PUPIL_LANES];
    uint32_t black, clipped, bad;
} pupil_run;

/* 8-bit encoding, exact by construction. A float's cell is its exponent and the upper 7 bits of its fraction, from
 * base_bits on; a cell holds at most one boundary of codes. Its word is (code at its start) * 65536 + (65536 - the
 * boundary's lower 16 bits), or without a boundary code * 65536. Adding the sample's lower 16 bits then carries into
 * the code exactly when the boundary is reached. */
typedef struct pupil_encoder {
    const uint32_t *cell; /* by (bits - base_bits) >> 16, up to that of 1.0 */
    uint32_t base_bits;   /* of a power of two; everything below it is code 0 */
    uint32_t transfer;    /* a pupil_transfer */
} pupil_encoder;

/* The light of companded codes from `from` on: light + (code - from) * slope. */
typedef struct pupil_line {
    float from, light, slope;
} pupil_line;

/* A pupil_coding (coding.h) as factors. */
typedef struct pupil_coder {
    /* Y'CbCr, to 0..top: y = (Y - y_zero) * y_unit; R = y + red_v * v, G = y + green_u * u + green_v * v,
     * B = y + blue_u * u with u = Cb - 128, v = Cr - 128 (512 of 10, 32768 of 16 bits) */
    float y_zero, y_unit, red_v, green_u, green_v, blue_u;
    float y_coarse, y_fine;      /* y_unit, to 32 bits, as a sum; a code times y_coarse is exact */
    const float (*light)[2];     /* light of codes 0..top, and the step to the next code's; NULL: linear */
    float top, brightest;        /* the last code of `light` (NULL: 255), and its light */
    float zero, unit;            /* grey: (code - zero) * unit; RGB10A2: unit, to 0..top */
    float zero4, unit4[3], most; /* mosaics: of four times a sample, for R, G, B; upper bound of light */
    int32_t ordinary4[3];        /* four times a sample, up to this, is neither clamped nor clipped; negative: none */
    uint32_t close_to_1;         /* no ordinary luminance is below 2^-15 or above 2^14; and zero4 is an integer */
    float full4;                 /* mosaics: four times the code of the largest light ... */
    int32_t black4;              /* ... and of no light, rounded */
    float matrix[9];
    uint32_t lines; /* grey and mosaics: those between knees; zero, unit are then 0, 1, unit4 the balance; 0: linear */
    pupil_line line[PUPIL_KNEES + 1];
    uint32_t has_matrix, shift, red_x, red_y; /* which pixel of a quad is red */
} pupil_coder;

/* R'G'B' codes to Y'CbCr: integers, in 2^-16. */
typedef struct pupil_chroma_coder {
    int32_t y_zero, y[3], cb[3], cr[3];
} pupil_chroma_coder;

/* What kernels read of a frame: one row, or both rows of a mosaic's quads. */
typedef struct pupil_row {
    const uint8_t *data;
    const uint8_t *chroma, *cr;   /* Y'CbCr in planes */
    const uint8_t *above, *below; /* mosaics: the rows next to it; at the frame's edges the picture is mirrored */
    uint32_t width;               /* of the frame, pixels */
    uint32_t y;                   /* the picture's row that it becomes */
    uint32_t odd;                 /* mosaics: the second row of a quad */
    uint32_t bins_rows;           /* how many rows it represents in the histogram; 0: it is not counted */
    uint32_t bins_first;          /* which one of each job->histogram pixels is counted */
} pupil_row;

/* A pupil_curve (pupil.h) that has been checked; its knots stay the caller's. */
typedef struct pupil_tone {
    float scale, inverse_white_squared, gamut, knot_scale;
    uint32_t dither, first_row, levels;
    float rods;        /* the rods' share in the matrix to the picture */
    const float *knot; /* NULL: Reinhard's */
} pupil_tone;

/* How pixels get into planes. */
typedef enum pupil_way {
    PUPIL_WAY_PIXELS = 0, /* each by itself */
    PUPIL_WAY_BINNED,     /* mosaics: one for each quad, of this row and the one below */
    PUPIL_WAY_BILINEAR    /* mosaics: one for each sample */
} pupil_way;

/* Linear RGB to the responses of Oklab's cones, which are 1 for white, and back; row by row. */
typedef struct pupil_cones {
    float from_rgb[9], to_rgb[9];
} pupil_cones;

/* All that processing a row needs; constant over the frame. */
typedef struct pupil_row_job {
    const struct pupil_kernels *kernels;
    const pupil_encoder *encoder;
    const pupil_coder *coder;
    const pupil_tone *curve;             /* NULL: meter only */
    const pupil_cones *cones;            /* of the picture */
    const struct pupil_row_job *picture; /* if the picture has other primaries, maps it: this job with their luma ... */
    const float *to_picture;             /* ... after this matrix; NULL, NULL: the input's primaries */
    const float *to_peak; /* for the histogram of the brightest channel: as to_picture, but without mapping too */
    float luma[3];
    float floor, clip;
    uint32_t in_pixel, out_pixel;
    uint32_t way;        /* a pupil_way */
    uint32_t histogram;  /* gather bins from one of so many pixels; 0: none */
    uint32_t grey_world; /* mosaics: gather the sums of the channels */
    uint32_t sample;     /* Y'CbCr of 8 bits: one of so many pairs of pixels is metered; 0: all */
} pupil_row_job;

/* What to prefetch: every second cache line of the pixels that are read next, from `first` on. */
typedef struct pupil_lines {
    uintptr_t first;
    size_t pixel_bytes; /* 16; 0: nothing, and `first` is in the cache */
} pupil_lines;

/* A block as planar linear floats; grey is scratch space of scale. On x86, scale then overwrites it with the cache
 * lines that store is to prefetch while it makes codes. */
typedef struct pupil_planes {
    float r[PUPIL_BLOCK], g[PUPIL_BLOCK], b[PUPIL_BLOCK];
    union {
        float grey[PUPIL_BLOCK];
        pupil_lines next;
    };
} pupil_planes;

/* For the fastest access by vectors: none crosses a cache line. Not part of the type, for planes are in callers'
 * memory, too. */
#define PUPIL_PLANES_ALIGNED __attribute__((aligned(64)))

/* For loops of look-ups or counts: gcc would assemble vectors from single numbers, which is slower. */
#if defined(__clang__)
#define PUPIL_ONE_BY_ONE (void)0
#else
#define PUPIL_ONE_BY_ONE __asm__ volatile("")
#endif

/* n is at most PUPIL_BLOCK, and a multiple of 64 in all calls of a run except the last. source NULL: the planes
 * themselves. */
/* Pixels x to x + n of a row. Returns 1 if every pixel is known to be opaque. */
typedef int pupil_load_kernel(const pupil_coder *coder, const pupil_row *row, uint32_t x, uint32_t n,
                              pupil_planes *planes);
/* Samples x to x + n of a mosaic's row; n is at most PUPIL_SAMPLES. */
typedef void pupil_unpack_kernel(const uint8_t *row, uint32_t shift, uint32_t x, uint32_t n, uint16_t *samples);
/* n quads, from both of their rows. */
typedef void pupil_binned_kernel(const pupil_coder *coder, const uint16_t *upper, const uint16_t *lower, uint32_t n,
                                 pupil_planes *planes);
/* n pixels, from three rows of n + 2 samples that begin left of the first pixel. `red_x`: whether the first pixel's
 * column has red samples; `red_y`: whether its row has. */
typedef void pupil_bilinear_kernel(const pupil_coder *coder, const uint16_t *const rows[3], int red_x, int red_y,
                                   uint32_t n, pupil_planes *planes);
/* The same of companded samples, after expand has made them light. expand: n samples, written up to the next multiple
 * of PUPIL_LANES. binned_light: n quads, PUPIL_BLOCK at most, to planes from pixel `at` on. */
typedef void pupil_expand_kernel(const pupil_coder *coder, const uint16_t *samples, uint32_t n, float *light);
typedef void pupil_binned_light_kernel(const pupil_coder *coder, const float *upper, const float *lower, uint32_t at,
                                       uint32_t n, pupil_planes *planes);
typedef void pupil_bilinear_light_kernel(const pupil_coder *coder, const float *const rows[3], int red_x, int red_y,
                                         uint32_t n, pupil_planes *planes);
/* matrix: camera RGB to that of the primaries. to_picture: from primaries to primaries. Components are clamped to -2^31
 * .. 2^31 before it, so that no number becomes NaN; negative ones and NaN become 0 after it. */
typedef void pupil_matrix_kernel(const float matrix[9], uint32_t n, pupil_planes *planes);
typedef void pupil_meter_kernel(const pupil_row_job *job, const void *source, const pupil_planes *planes, uint32_t n,
                                pupil_run *run);
/* n quads of a mosaic from quad x on; n has no limit. Returns 0 if it did nothing: the usual pieces are needed. */
typedef int pupil_quads_kernel(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, pupil_run *run);
/* Meters into run unless it is NULL; maps into planes, to 0..1 or, by rounding, the float above 1. Returns as load. */
typedef int pupil_scale_kernel(const pupil_row_job *job, const void *source, uint32_t n, pupil_planes *planes,
                               pupil_run *run);
/* Adds `light` to the bins, and the brightest channel of `picture` (often the same) to the peak bins and the peak. */
typedef struct pupil_channels {
    const float *r, *g, *b;
} pupil_channels;
typedef void pupil_histogram_kernel(const pupil_row_job *job, const pupil_channels *light,
                                    const pupil_channels *picture, uint32_t n, uint32_t weight, pupil_stats *stats);
/* Runs between scale and store; the first pixel is the picture's at x, y. */
typedef void pupil_dither_kernel(uint32_t transfer, uint32_t x, uint32_t y, uint32_t n, pupil_planes *planes);
/* Takes what scale left: nothing negative, no NaN. */
typedef void pupil_store_kernel(const pupil_planes *planes, uint32_t n, const pupil_encoder *encoder, void *target);
/* Writes the fourth byte of RGBA8 pixels. */
typedef void pupil_alpha_kernel(const void *source, uint32_t n, uint8_t *rgba);
/* Alpha from 0 to 1; and its store to the pixels of a format with float or half alpha. */
typedef void pupil_alpha_light_kernel(const void *source, uint32_t n, float *alpha);
typedef void pupil_store_alpha_kernel(const float *alpha, uint32_t n, void *target);

/* Y' of n RGBA codes. */
typedef void pupil_luma_kernel(const pupil_chroma_coder *coder, const uint8_t *rgba, uint32_t n, uint8_t *luma);
/* Mapping by luma (config.h: pupil_accuracy), in integers: light depends on the code of Y' alone. "Scaled" Cb and Cr
 * are the codes less 128, times a ratio, in 1/16 of a code. A quad is two pixels of each row, with their common Cb and
 * Cr. */
typedef struct pupil_luma_tables {
    uint8_t luma[256];       /* what a code of Y' becomes: a code of Y', or of grey R'G'B' */
    uint8_t luma_steps[256]; /* for avx2_luma.h: each 16 entries exclusive-ored with the 16 before */
    /* The factors of Cb and Cr, in 1/2048, indexed by the mean of a quad's codes in steps of two. */
    uint8_t ratio_low[128], ratio_high[128];
    int16_t red_v, blue_u, green_u, green_v; /* scaled to R'G'B' in quarters of a code, in 2^-15 */
    /* A quad is mapped exactly if a component is further above grey, in quarters of a code, than one of two limits:
     * surface - slope * the largest new code of luma; and far + slope * the smallest one, or PUPIL_LUMA_NOISE if that
     * is larger. Slopes are in 2^-8. */
    int16_t surface, surface_slope, far, far_slope;
} pupil_luma_tables;
#define PUPIL_LUMA_QUADS 256
#define PUPIL_LUMA_PART  64
#define PUPIL_LUMA_NOISE 32
/* Rows from a quad on. lower NULL: there is one row. chroma: Cb, then Cr, of each quad. */
typedef struct pupil_luma_quads {
    const uint8_t *upper, *lower, *chroma;
} pupil_luma_quads;
typedef struct pupil_luma_target {
    uint8_t *upper, *lower, *chroma; /* chroma NULL: rows of RGBA8, or with blue_first of BGRX8 */
    int blue_first;
} pupil_luma_target;
/* n quads, PUPIL_LUMA_QUADS at most. exact: not 0 for each quad that is to be mapped exactly. Bit p of the result: one
 * of these is among the PUPIL_LUMA_PART quads from p * PUPIL_LUMA_PART on. */
typedef uint32_t pupil_by_luma_kernel(const pupil_luma_tables *tables, const pupil_luma_quads *in, uint32_t n,
                                      const pupil_luma_target *out, uint16_t *exact);

/* Cb and Cr of two rows (or twice the same) of n pixels: n + n % 2 bytes. */
typedef void pupil_chroma_kernel(const pupil_chroma_coder *coder, const uint8_t *upper, const uint8_t *lower,
                                 uint32_t n, uint8_t *chroma);

/* The veil (pupil/veil.h): sums over the pixels of a row that are in one of its cells: their light, and light times
 * index. */
typedef struct pupil_veil_sums {
    float sum[3], moment[3];
} pupil_veil_sums;
/* `count` runs of pixels that follow each other in planes, PUPIL_BLOCK at most: sums[c] is of the next n[c]. Up to
 * seven pixels after the last are read, but not summed. */
typedef void pupil_veil_gather_kernel(const pupil_planes *planes, const uint32_t *n, uint32_t count,
                                      pupil_veil_sums *sums);
/* The same from a row of RGBA32F; none after the last is read. Prefetches the next row, `next_row` bytes on. */
typedef void pupil_veil_pixels_kernel(const void *source, ptrdiff_t next_row, const uint32_t *n, uint32_t count,
                                      pupil_veil_sums *sums);
/* What is added to a block: channel c of pixel i gets from[c][i] + part * more[c][i]. */
typedef struct pupil_scattered {
    float from[3][PUPIL_BLOCK], more[3][PUPIL_BLOCK];
} pupil_scattered;
/* Multiplies n pixels by `direct`, and adds the light that is scattered to them. Works up to the last vector's end. */
typedef void pupil_scatter_kernel(pupil_planes *planes, uint32_t n, float direct, const pupil_scattered *scattered,
                                  float part);

/* Bloom (pupil/bloom.h): a kernel of 7 x 7 taps without the corners, with the symmetry of a square. */
enum { PUPIL_BLOOM_ROWS = 7, PUPIL_BLOOM_TAPS = 9 };
typedef struct pupil_bloom_taps {
    float tap[PUPIL_BLOOM_TAPS]; /* at (0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2) */
} pupil_bloom_taps;
/* Its filters read rows from PUPIL_BLOOM_SIDE before the first pixel on, and prefetch the last rows `ahead` floats
 * further on, unless `ahead` is 0. `room` is scratch space. */
enum { PUPIL_BLOOM_SIDE = 8, PUPIL_BLOOM_LINE = 208 };
typedef float pupil_bloom_room[4][PUPIL_BLOOM_LINE];
/* The light that a row gets from seven rows, plus `with` unless it is NULL; n is rounded up to a multiple of 16. */
typedef void pupil_bloom_scatter_kernel(const float *const *row, size_t ahead, const pupil_bloom_taps *taps, uint32_t n,
                                        pupil_bloom_room room, const float *with, float *to);
/* n pixels at half the size from eight rows; n is rounded up to a multiple of 16. */
typedef void pupil_bloom_halve_kernel(const float *const *row, size_t ahead, uint32_t n, pupil_bloom_room room,
                                      float *to);
/* 2 n pixels at twice the size from four rows, by a tap each, stored or, with `add`, added; n is rounded up to a
 * multiple of 8. */
typedef void pupil_bloom_widen_kernel(const float *const *row, const float tap[4], uint32_t n, pupil_bloom_room room,
                                      float *to, int add);
/* The light of n pixels that scatters: above a threshold, and within 0..PUPIL_CEILING. */
typedef void pupil_bloom_bright_kernel(const pupil_planes *planes, uint32_t n, float threshold, float *const to[3]);
/* All of the light of n pixels of RGBA32F. Prefetches the next row, `next_row` bytes on. Returns whether the pixels are
 * whole: opaque, with no value out of bounds. */
typedef int pupil_bloom_pixels_kernel(const void *source, ptrdiff_t next_row, uint32_t n, float *const to[3]);
/* Which of n pixels, PUPIL_BLOCK at most, have a channel above a threshold: bit k is for pixels 8 k to 8 k + 7. From
 * RGBA32F, and from planes. */
typedef uint32_t pupil_bloom_lamps_of_pixels_kernel(const void *source, uint32_t n, float threshold);
typedef uint32_t pupil_bloom_lamps_kernel(const pupil_planes *planes, uint32_t n, float threshold);

/* Index 0 of meter and scale, which is no format, is the piece for planes. NULL: this level has no such piece. In the
 * scalar level NULL means that the format has no such use, except for meter and scale, which it has for planes alone.
 */
typedef struct pupil_kernels {
    pupil_load_kernel *load[PUPIL_PIXEL_COUNT];         /* by input format */
    pupil_meter_kernel *meter[PUPIL_PIXEL_COUNT];       /* by input format */
    pupil_scale_kernel *scale[PUPIL_PIXEL_COUNT];       /* by input format */
    pupil_scale_kernel *scale_by_knots;                 /* of planes, where the curve has knots */
    pupil_unpack_kernel *unpack[PUPIL_PIXEL_COUNT];     /* by input format; scalar NULL: not a mosaic */
    pupil_quads_kernel *meter_quads[PUPIL_PIXEL_COUNT]; /* by input format; only where it is faster than its pieces */
    pupil_binned_kernel *binned;
    pupil_bilinear_kernel *bilinear;
    pupil_expand_kernel *expand;
    pupil_binned_light_kernel *binned_light;
    pupil_bilinear_light_kernel *bilinear_light;
    pupil_matrix_kernel *matrix, *to_picture;
    pupil_luma_kernel *luma_of_codes;
    pupil_chroma_kernel *chroma_of_codes;
    pupil_by_luma_kernel *yuv_by_luma, *rgb_by_luma;
    pupil_histogram_kernel *histogram;
    pupil_dither_kernel *dither;
    pupil_store_kernel *store[PUPIL_PIXEL_COUNT];             /* by output format */
    pupil_alpha_kernel *alpha[PUPIL_PIXEL_COUNT];             /* by input format; scalar NULL: opaque */
    pupil_alpha_light_kernel *alpha_light[PUPIL_PIXEL_COUNT]; /* the same formats */
    pupil_store_alpha_kernel *store_alpha[PUPIL_PIXEL_COUNT]; /* by output format */
    pupil_veil_gather_kernel *veil_gather;
    pupil_veil_pixels_kernel *veil_gather_rgba32f;
    pupil_scatter_kernel *scatter;
    pupil_bloom_scatter_kernel *bloom_scatter;
    pupil_bloom_halve_kernel *bloom_halve;
    pupil_bloom_widen_kernel *bloom_widen;
    pupil_bloom_bright_kernel *bloom_bright;
    pupil_bloom_pixels_kernel *bloom_light_rgba32f; /* only where it is faster than its pieces */
    pupil_bloom_lamps_of_pixels_kernel *bloom_lamps_rgba32f;
    pupil_bloom_lamps_kernel *bloom_lamps;
} pupil_kernels;

#define PUPIL_PLANES PUPIL_PIXEL_NONE

/* A piece of a level, or the scalar level's where it has none of its own. */
#define PUPIL_PIECE(KERNELS, MEMBER) ((KERNELS)->MEMBER ? (KERNELS)->MEMBER : pupil_kernels_scalar.MEMBER)

extern const pupil_kernels pupil_kernels_scalar;
#if defined(__x86_64__)
extern const pupil_kernels pupil_kernels_avx2, pupil_kernels_avx512;
#elif defined(__aarch64__)
extern const pupil_kernels pupil_kernels_neon;
#endif
#if defined(PUPIL_WASM128) /* cmake/wasm32.cmake; not all of WebAssembly has it */
extern const pupil_kernels pupil_kernels_wasm128;
#endif

/* The best level that this CPU has and the mask (of 1 << pupil_level; 0: all) allows. */
uint32_t pupil_level_choose(uint32_t mask);
/* NULL: this build has no such level. */
const pupil_kernels *pupil_level_kernels(uint32_t level);

/* The step of light from code to code, at light x: scale * x^power, and at least `least`: the derivative of the
 * transfer's inverse. The power is computed on the float's bits, as bits * power + offset, to 3 %: offset = (1 - power)
 * (127 - 0.045) 2^23. */
typedef struct pupil_code_width {
    float power, scale, least;
    uint32_t offset;
} pupil_code_width;
extern const pupil_code_width pupil_code_widths[PUPIL_TRANSFER_COUNT];

extern const pupil_encoder pupil_encoders[PUPIL_TRANSFER_COUNT];
/* Light of the codes 0 to 255, each with the difference to the next one's (0 at the end), rounded. x86_yuv.h also needs
 * PUPIL_BEYOND entries before and after, with the light of 0 and of 255: Y'CbCr has codes from -293 to 551 (coding.c).
 */
#if defined(__x86_64__)
#define PUPIL_BEYOND 304
#else
#define PUPIL_BEYOND 0
#endif
extern const float pupil_srgb_codes[256 + 2 * PUPIL_BEYOND][2], pupil_bt709_codes[256 + 2 * PUPIL_BEYOND][2];
#define pupil_srgb_light  (pupil_srgb_codes + PUPIL_BEYOND)
#define pupil_bt709_light (pupil_bt709_codes + PUPIL_BEYOND)
/* The same of PQ and HLG, at multiples of a quarter and of half a 10-bit code. The difference ends a little below the
 * next one's light, so that the mean error is 0 (make_tables.py). */
#define PUPIL_PQ_TOP  4092
#define PUPIL_HLG_TOP 2046
extern const float pupil_pq_light[PUPIL_PQ_TOP + 1][2], pupil_hlg_light[PUPIL_HLG_TOP + 1][2];
/* The light of pupil_srgb_codes alone, for use without interpolation: a smaller table whose entries are faster to
 * reach. */
extern const float pupil_srgb8_to_linear[256];

/* Pixels (quads, where job->way is binned) x to x + n of a row, that all have the metering weight `weight`; 0 or stats
 * NULL: not metered. target NULL: not mapped. */
void pupil_work_run(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint8_t *target,
                    uint32_t weight, uint32_t band, pupil_stats *stats);

/* Maps n pixels, PUPIL_BLOCK at most, that are in planes already, as light of the job's input; x and y are the
 * picture's. `source`: their pixels, for alpha; NULL: opaque. */
void pupil_map_planes(const pupil_row_job *job, uint32_t x, uint32_t y, uint32_t n, pupil_planes *planes,
                      const void *source, uint8_t *target);

/* Where a pair of rows of NV12 or I420 goes. */
typedef struct pupil_yuv_rows {
    uint8_t *upper, *lower; /* lower NULL: there is none */
    uint8_t *chroma, *cr;   /* cr NULL: Cb and Cr are both in chroma */
} pupil_yuv_rows;

/* Pixels x to end, x being even, of two rows (or one) to Y' and their common Cb and Cr; not metered. */
void pupil_map_yuv(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_row *upper,
                   const pupil_row *lower, uint32_t x, uint32_t end, const pupil_yuv_rows *to);

/* By luma, in this order: meters the pixels of a run that job->sample selects; makes the tables (coder NULL: for
 * R'G'B'); maps two rows of n pixels to 4:2:0 of the same coding; maps two rows or one (lower NULL) to RGBA8 or BGRX8.
 */
void pupil_meter_sampled(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, uint32_t weight,
                         uint32_t band, pupil_stats *stats);
void pupil_luma_tables_make(const pupil_row_job *job, const pupil_chroma_coder *coder, pupil_luma_tables *tables);
void pupil_map_luma(const pupil_row_job *job, const pupil_chroma_coder *coder, const pupil_luma_tables *tables,
                    const pupil_row *upper, const pupil_row *lower, uint32_t n, const pupil_yuv_rows *to);
void pupil_map_luma_rgb(const pupil_row_job *job, const pupil_luma_tables *tables, const pupil_row *upper,
                        const pupil_row *lower, uint32_t n, uint8_t *upper_to, uint8_t *lower_to);
/* As pupil_map_yuv, of n pixels, PUPIL_BLOCK at most, that are RGBA codes already. lower NULL: there is none. */
void pupil_yuv_of_codes(const pupil_kernels *kernels, const pupil_chroma_coder *coder, const uint8_t *upper,
                        const uint8_t *lower, uint32_t n, const pupil_yuv_rows *to);

#endif
