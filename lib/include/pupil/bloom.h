/* pupil/bloom.h: bloom, the light that scatters to a few degrees around what is bright.
 *
 * When not to use it: as of veil.h. A picture of a camera has the bloom of its lens.
 *
 *     pupil_veil_get(&veil, &psf);                          the narrow lobes of an eye: veil.h
 *     pupil_bloom_config_default(&config);
 *     config.width = 1920, config.height = 1080, config.lobes = psf.lobes;
 *     memcpy(config.lobe, psf.lobe, sizeof config.lobe);
 *     bloom = malloc(pupil_bloom_bytes(&config));
 *     pupil_bloom_init(bloom, pupil_bloom_bytes(&config), &config);
 *     for each frame:
 *         pupil_bloom_gather_rows(bloom, &pupil, &frame, 0, frame.height, &scratch);
 *         pupil_bloom_solve(bloom, &pupil);
 *         pupil_bloom_map_rows(bloom, &veil, &pupil, &curve, &frame, &out, &scratch);
 *
 * The picture that is mapped is, in linear light and with b the light above config.threshold,
 *     direct * v + veil + sum over the lobes of weight * (Gaussian * b - b)
 * so veil and bloom together are the whole point spread function, and light is moved and not made. `direct` and veil
 * are those of the veil that is given; without one they are 1 and 0. What is scattered beyond the picture's edges is
 * lost, and nothing comes from there.
 *
 * How: the picture is halved again and again, into octaves, by filters of eight taps. All lobes together are one kernel
 * of 7 x 7 taps in each octave. A lobe is in the last octave that is fine enough for it, filters' variances taken off:
 * at full size below 2.5 pixels, at half the size below 5.4, and so on. What it scatters beyond 7 x 7 there is fitted
 * by the taps of the octave below, at init. A pixel far from a lamp may lose up to 0.2 % of what a lobe gives at most,
 * where no other lobe gives it more. Errors against the formulas: docs/look.md. With a threshold gather_rows
 * notes where lamps are: what no lobe of them reaches is mapped as without bloom.
 *
 * Units: pixels; light in the frame's unit (image.h: White). Channels below 0 and NaN scatter nothing, one above 2^30
 * scatters as 2^30.
 *
 * Memory: the caller owns every byte. A pupil_bloom is pupil_bloom_bytes of the caller's, without pointers; nothing is
 * allocated. Each thread has a pupil_bloom_scratch of its own.
 *
 * Determinism: a pixel's operations do not depend on how rows are grouped. The same frames give the same bits on every
 * CPU.
 *
 * Threads: gather_rows of different rows may run at the same time on one object, and so may map_rows. solve runs alone.
 */
#ifndef PUPIL_BLOOM_H
#define PUPIL_BLOOM_H

#include "pupil/veil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* At least pupil_bloom_bytes bytes, aligned for a double. */
typedef struct pupil_bloom pupil_bloom;

typedef struct pupil_bloom_config {
    uint32_t size_bytes;    /* abi.h; filled in by pupil_bloom_config_default */
    uint32_t width, height; /* of every frame, pixels, 1..PUPIL_MAX_SIDE_PX; to be chosen */
    uint32_t lobes;         /* how many of `lobe`; 0 */
    double threshold; /* bright pass: of a pixel whose largest channel is m, a share of (m - threshold) / m scatters, if
                       * that is above 0; 0: all light; 0..2^30 */
    pupil_veil_gaussian lobe[PUPIL_VEIL_MOST_LOBES]; /* sigma 0.1..1024 pixels, weight 0..1, together 1 at most */
} pupil_bloom_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_bloom_config_default_sized(pupil_bloom_config *config, size_t config_bytes);
static inline void pupil_bloom_config_default(pupil_bloom_config *config)
{
    pupil_bloom_config_default_sized(config, sizeof *config);
}

/* PUPIL_OK or PUPIL_ERR_CONFIG. `why` may be NULL; else *why is a sentence (constant text) that names the first wrong
 * field and what would be right. */
PUPIL_API int pupil_bloom_config_check(const pupil_bloom_config *config, const char **why);

/* What an object for it takes: about 5 bytes a pixel, 10 with a threshold. 0: pupil_bloom_config_check refuses it. */
PUPIL_API size_t pupil_bloom_bytes(const pupil_bloom_config *config);

/* Makes an object out of any `bytes` bytes. PUPIL_ERR_CONFIG: see pupil_bloom_config_check. PUPIL_ERR_VALUE: fewer
 * bytes than pupil_bloom_bytes. PUPIL_ERR_ALIGNMENT: not aligned for a double. */
PUPIL_API int pupil_bloom_init(pupil_bloom *bloom, size_t bytes, const pupil_bloom_config *config);

#define PUPIL_BLOOM_SCRATCH_BYTES 131072

/* Room for gather_rows and map_rows; any bytes. */
typedef union pupil_bloom_scratch {
    uint64_t private_words[PUPIL_BLOOM_SCRATCH_BYTES / 8];
} pupil_bloom_scratch;

/* The light of rows first_row to first_row + count of a frame, which is there as a whole: the rows next to them are
 * read, too. first_row is even, count is even or reaches the last row. All rows come once before solve.
 * PUPIL_ERR_PIXEL: a mosaic. PUPIL_ERR_SIZE: another size than config's. PUPIL_ERR_ROWS: other rows. */
PUPIL_API int pupil_bloom_gather_rows(pupil_bloom *bloom, const pupil_t *pupil, const pupil_image_const *frame,
                                      uint32_t first_row, uint32_t count, pupil_bloom_scratch *scratch);

/* The octaves' blurs, from what was gathered. */
PUPIL_API int pupil_bloom_solve(pupil_bloom *bloom, const pupil_t *pupil);

/* pupil_map_rows of the rows of `frame` from curve->first_row on, out->height of them, with their bloom and, unless
 * `veil` is NULL, with the veil that it was solved for. Errors as of gather_rows and pupil_map_rows; PUPIL_ERR_SIZE:
 * the veil is of another size. */
PUPIL_API int pupil_bloom_map_rows(const pupil_bloom *bloom, const pupil_veil *veil, const pupil_t *pupil,
                                   const pupil_curve *curve, const pupil_image_const *frame, const pupil_image *out,
                                   pupil_bloom_scratch *scratch);

#ifdef __cplusplus
}
#endif

#endif
