/* pupil/bloom.h: bloom, light that scatters to a few degrees around bright areas.
 *
 * When not to use it: on pictures of a camera (veil.h has the reason). They have the bloom of its lens already.
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
 * Veil and bloom together are the whole point spread function. They move light and add none. `direct` and veil are
 * those of the given veil, or 1 and 0 without one. Light scattered beyond the picture's edges is lost, and no light
 * comes from there.
 *
 * How: the picture is halved again and again, into octaves, by filters of eight taps. All lobes together are one kernel
 * of 7 x 7 taps in each octave. A lobe is in the coarsest octave that is fine enough for it: at full size below a sigma
 * of 2.5 pixels, at half the size below 5.4, and so on; the variance of the filters is subtracted from the lobe's. Its
 * light beyond 7 x 7 taps is fitted by the taps of the next coarser octave, at init. Far from a lamp, a lobe may darken
 * a pixel by up to 0.2 % of the lobe's peak, if no other lobe adds more. Errors against the formulas: docs/look.md.
 * With a threshold, gather_rows records where lamps are: pixels that no lobe reaches are mapped as without bloom.
 *
 * Units: pixels; light in the frame's unit (image.h: White). Channels below 0 and NaN scatter nothing, one above 2^30
 * scatters as 2^30.
 *
 * Memory: the caller owns every byte. A pupil_bloom is pupil_bloom_bytes of memory without pointers; nothing is
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
    double threshold; /* bright pass: of a pixel whose largest channel is m, the share (m - threshold) / m scatters, if
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

/* The size of its object: about 5 bytes a pixel, 10 with a threshold. 0 if pupil_bloom_config_check refuses
 * `config`. */
PUPIL_API size_t pupil_bloom_bytes(const pupil_bloom_config *config);

/* Makes an object out of any `bytes` bytes. PUPIL_ERR_CONFIG: see pupil_bloom_config_check. PUPIL_ERR_VALUE: fewer
 * bytes than pupil_bloom_bytes. PUPIL_ERR_ALIGNMENT: not aligned for a double. */
PUPIL_API int pupil_bloom_init(pupil_bloom *bloom, size_t bytes, const pupil_bloom_config *config);

#define PUPIL_BLOOM_SCRATCH_BYTES 131072

/* Room for gather_rows and map_rows; any bytes. */
typedef union pupil_bloom_scratch {
    uint64_t private_words[PUPIL_BLOOM_SCRATCH_BYTES / 8];
} pupil_bloom_scratch;

/* Gathers the light of `count` rows from first_row on. `frame` is the whole frame, because the rows next to them are
 * read, too. first_row is even, count is even or reaches the last row. Each row is gathered once before solve.
 * PUPIL_ERR_PIXEL: a mosaic. PUPIL_ERR_SIZE: another size than config's. PUPIL_ERR_ROWS: other rows. */
PUPIL_API int pupil_bloom_gather_rows(pupil_bloom *bloom, const pupil_t *pupil, const pupil_image_const *frame,
                                      uint32_t first_row, uint32_t count, pupil_bloom_scratch *scratch);

/* Blurs the octaves, once all rows are gathered. */
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
