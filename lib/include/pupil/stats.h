/* pupil/stats.h: the statistics of a frame, the interface between metering and adaptation.
 *
 * Statistics are integers, so merging is exact and does not depend on the order. Groups of whole rows can be metered
 * anywhere (threads, another machine, a GPU). Their sum has the same bits as the whole frame metered at once.
 *
 * What a pixel counts as. L = wr R + wg G + wb B in binary32, without fused multiply-add, in that order. Negative
 * components count as they are. A 16-bit sample of RGB is code * (1 / 65535) there, an 8-bit one the nearest binary32
 * on the sRGB curve. coding.h has the formats of cameras.
 *
 *   ordinary: L between floor and 2^30 counts as L
 *   black: L <= floor (zero, negative and denormal L among them) counts as floor
 *   clipped: a channel at or above the clip value; L counts as L, at most 2^30. By default the clip value is the
 *       largest code of an integer format, 65504 for half, 2^30 for float. For Y'CbCr and grey it is 1, which is
 *       white; for mosaics it is the value that the coding limits each channel to
 *   bad: L is NaN or infinite. NaN and -Inf count as floor, +Inf as 2^30; such pixels are not black or clipped
 * Pixels whose metering weight is 0 count nowhere.
 *
 * Threads: plain values; two threads must not write the same one.
 */
#ifndef PUPIL_STATS_H
#define PUPIL_STATS_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Histogram: 8 bins a stop over 64 stops. Bin b holds luminances from 2^(b/8 - 32), b % 8 = 0, upward. Within a stop
 * the eight bins are equally wide in luminance: they are the top three bits of the float's fraction. */
#define PUPIL_HISTOGRAM_BINS_PER_STOP 8
#define PUPIL_HISTOGRAM_MIN_EV        (-32)
#define PUPIL_HISTOGRAM_BINS          512

/* config.histogram_step says which pixels are counted. Each counts with the weight of all pixels that it represents, so
 * a whole frame's bins sum to its weight. For some of its rows the sum may be more or less than theirs, or 0. */

/* A second, coarser histogram, of each pixel's brightest channel: 4 bins a stop over the same 64 stops. The channel is
 * clamped as L is, and counts as the floor where L is NaN. A white point must leave room for the brightest channel,
 * which in a saturated colour is far above L. */
#define PUPIL_PEAK_BINS_PER_STOP 4
#define PUPIL_PEAK_BINS          256

/* Row bands: the frame's rows in this many equal groups, top to bottom, for detecting mains flicker. Row y of a frame
 * of h rows is in band y * 64 / h; of a mosaic, rows of quads count. With config.meter_rows bands may be empty. */
#define PUPIL_BANDS 64

/* Widths: 2^28 pixels (16384 x 16384) x weight 255 x 32 stops < 2^41, so log2_sum and each bin have room for eight
 * million of the largest frames. A band holds at most 2^22 pixels x 32 stops x 2^24 = 2^51. */
typedef struct pupil_stats {
    uint32_t size_bytes;    /* abi.h; filled in by pupil_stats_clear; or 0 */
    float code_light;       /* light of the first code above black, as exact as a binary32; 0: no codes (float, half).
                             * 2^-12, set before pupil_adapt, says that floats are decoded codes of 8-bit sRGB */
    uint64_t pixels;        /* metered pixels (weight above 0) */
    uint64_t weight;        /* sum of their weights */
    uint64_t black;         /* pixels, unweighted; see above */
    uint64_t clipped;       /* pixels */
    uint64_t bad;           /* pixels */
    int64_t log2_sum;       /* sum of weight x log2 L, whole stops, rounded down ... */
    uint64_t log2_frac;     /* ... and the rest in 2^-40 stops, below 2^40 */
    uint32_t rows;          /* rows so far, including those that config.meter_rows left out */
    uint32_t frame_height;  /* rows of the whole frame; 0 while empty */
    uint32_t has_histogram; /* 1 if bins were gathered */
    float peak;             /* the brightest channel of any counted pixel; 0 without one */
    uint64_t bin[PUPIL_HISTOGRAM_BINS]; /* weights, by luminance */
    uint64_t peak_bin[PUPIL_PEAK_BINS]; /* weights, by brightest channel (of which primaries: pupil_output_primaries) */
    int64_t channel_sum[3]; /* mosaics, with config.grey_world: sums for red, green and blue of four times the samples
                             * less black (rounded to a quarter of a code), over ... */
    uint64_t channel_quads; /* ... the quads of a weight above 0 whose channels are all below the coding's white;
                             * unweighted, regardless of config.clip and the balance */
    int64_t band_log2_sum[PUPIL_BANDS]; /* sum of log2 L of the metered pixels, unweighted, in 2^-24 stops */
    uint32_t band_pixels[PUPIL_BANDS];  /* their number */
    uint64_t black_weight; /* sum of the weights of the black pixels, which pupil_adapt leaves out of the level of
                            * floats and halves (config.h, floor); 0: black counts */
} pupil_stats;

/* Makes the statistics of no pixels at all. */
PUPIL_API void pupil_stats_clear_sized(pupil_stats *stats, size_t stats_bytes);
static inline void pupil_stats_clear(pupil_stats *stats)
{
    pupil_stats_clear_sized(stats, sizeof *stats);
}

/* Adds `more` to `sum`. PUPIL_ERR_STATS if their frames differ in height, if only one of them has a histogram, or if
 * there would be more rows than the frame has. */
PUPIL_API int pupil_stats_add(pupil_stats *sum, const pupil_stats *more);

/* Weighted mean of log2 luminance in stops, frame units, of all pixels, black ones too. It is trimmed to the weight
 * between the shares low and high; (0, 1) is untrimmed, and exact to about 1e-11 stops on natural frames. The trimmed
 * mean uses the histogram; its error is below 1.5e-3 stops if half of the weight or more is kept, and vanishes with the
 * trim. PUPIL_ERR_NO_LIGHT without any weight, PUPIL_ERR_NO_HISTOGRAM where trimming lacks one. */
PUPIL_API int pupil_stats_mean(const pupil_stats *stats, double low, double high, double *log2_luminance);

/* The luminance (log2, frame units) below which the share q (0..1) of the weight is, interpolated within a bin. */
PUPIL_API int pupil_stats_quantile(const pupil_stats *stats, double q, double *log2_luminance);

/* The same for the brightest channel; never above `peak`. */
PUPIL_API int pupil_stats_peak_quantile(const pupil_stats *stats, double q, double *log2_peak);

/* The factors that make the average of a mosaic's channels grey, the least being 1: for pupil_coding.balance. They do
 * not depend on the balance that the frame was metered with. PUPIL_ERR_NO_LIGHT if nothing was summed or a channel has
 * no light. (Buchsbaum: A spatial processor model for object colour perception, 1980.) */
PUPIL_API int pupil_stats_grey_world(const pupil_stats *stats, float balance[3]);

#ifdef __cplusplus
}
#endif

#endif
