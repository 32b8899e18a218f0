/* pupil/row_gain.h: row correction gains, which remove banding from frames of a rolling shutter.
 *
 * Lamps on the mains flicker, so rows exposed at different times are light or dark. A factor for each row corrects
 * that.
 *
 *     pupil_row_gain_config config;
 *     pupil_row_gain lamps;
 *     pupil_row_gain_config_default(&config);
 *     config.mains_hz = 50, config.readout_s = 0.025;
 *     pupil_row_gain_init(&lamps, &config);
 *     for each frame:
 *         pupil_row_gain_frame(&lamps, &in, &info);
 *         pupil_row_gain_of_rows(&lamps, &info, in.height, gain);
 *         pupil_map_rows_with_gains(&pupil, &curve, &in, gain, &out);
 *
 * When to use it: if the exposure must be shorter than a flicker period (10 ms, 8.3 ms), in bright light or for fast
 * motion. Exposures of whole periods have no banding (sensor.h: mains_hz), and are always better. A gain cannot correct
 * clipped light, nor areas where lamps and daylight mix.
 *
 * What it does: the picture is metered in 8 groups of columns and 64 bands of rows. Flicker is a change of these from
 * frame to frame (by timestamps) and from row to row at twice mains_hz, with up to four harmonics. Everything else is
 * the scene. Each row's gain is one over the flicker's wave.
 *
 * When it does nothing. If daylight or a monitor lights a part of the picture, or a part is clipped, the wave differs
 * there, and gains would add banding. The picture is compared in 64 tiles of 1/8 x 1/8. If one differs, the gains of
 * the whole frame fade to 1. An area is detected if it covers a tenth of any tile that it touches. A window that a pan
 * brings into view is detected after a few frames. There is also no gain while flicker and scene cannot be separated:
 *
 * - where the frame rate divides the flicker's (120 Hz at 30 frames a second; 29.97 differs enough);
 * - while too much else moves, and for a second after such a change began;
 * - for frames without timestamps, or more than half a second apart;
 * - for a picture of less than 64 x 64 pixels;
 * - for exposures of nine tenths of a flicker period or more.
 *
 * Light below 2^-10 is not used.
 *
 * Timestamps must be as in image.h, to about 0.1 ms. The formats must be linear in light, or have a coding (coding.h)
 * that describes their curve. Behind an unknown tone curve, areas of different brightness show different waves, and
 * there is no gain. OpenGL ES (gles.h) has no row correction gains.
 *
 * Memory, determinism, threads: as pupil_t in pupil.h. Nothing is allocated, the object has a fixed size and no
 * pointers, and the same frames give the same bits. pupil_row_gain_init chooses kernels for this CPU: on another
 * machine make the object again.
 */
#ifndef PUPIL_ROW_GAIN_H
#define PUPIL_ROW_GAIN_H

#include "pupil/error.h"
#include "pupil/image.h"
#include "pupil/pupil.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pupil_row_gain_config {
    uint32_t size_bytes; /* abi.h; filled in by pupil_row_gain_config_default */
    uint32_t mains_hz;   /* 50 or 60: the light flickers at twice that; 50 */
    double readout_s;    /* from the middle of the first row's exposure to the last row's; errors up to a tenth are
                          * corrected; 1/60; 1e-4..1 */
} pupil_row_gain_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_row_gain_config_default_sized(pupil_row_gain_config *config, size_t config_bytes);
static inline void pupil_row_gain_config_default(pupil_row_gain_config *config)
{
    pupil_row_gain_config_default_sized(config, sizeof *config);
}

/* PUPIL_OK or PUPIL_ERR_CONFIG. `why` may be NULL; else *why is a sentence (constant text) that names the first wrong
 * field and what would be right. */
PUPIL_API int pupil_row_gain_config_check(const pupil_row_gain_config *config, const char **why);

#define PUPIL_ROW_GAIN_OBJECT_BYTES 65536

/* The object. Its content is private; its size is part of the ABI. */
typedef union pupil_row_gain {
    uint64_t private_words[PUPIL_ROW_GAIN_OBJECT_BYTES / 8];
} pupil_row_gain;

/* Why there are no gains, or not all of them yet. */
typedef enum pupil_row_gain_reason {
    PUPIL_ROW_GAIN_ON = 0,     /* there are gains */
    PUPIL_ROW_GAIN_WAITING,    /* too few frames so far, no new timestamp, or too small a picture */
    PUPIL_ROW_GAIN_LONG,       /* the exposure is nine tenths of a flicker period, or more */
    PUPIL_ROW_GAIN_STATIONARY, /* the bands do not move in the picture: they cannot be distinguished from the scene */
    PUPIL_ROW_GAIN_NO_FLICKER, /* there is no flicker */
    PUPIL_ROW_GAIN_MIXED,      /* parts of the picture do not have the wave, or have another one */
    PUPIL_ROW_GAIN_DISTURBED,  /* this frame does not have the wave */
    PUPIL_ROW_GAIN_REASON_COUNT
} pupil_row_gain_reason;

typedef struct pupil_row_gain_result {
    uint32_t size_bytes; /* abi.h */
    uint32_t reason;     /* a pupil_row_gain_reason */
    double strength;     /* 0: all gains are 1; 1: the whole wave is removed */
    double flicker_ev;   /* amplitude of the wave's fundamental in the last frame, in stops: half the difference of the
                          * brightest row and the darkest */
    double disagreement; /* of the worst tile: the wave that would remain there, divided by the wave; 1 at most */
    double light_hz;     /* as measured; near twice mains_hz */
    double readout_s;    /* as measured; near config.readout_s */
} pupil_row_gain_result;

/* Makes an object out of any bytes. PUPIL_ERR_CONFIG: see pupil_row_gain_config_check. */
PUPIL_API int pupil_row_gain_init(pupil_row_gain *lamps, const pupil_row_gain_config *config);

/* Takes a frame: meters it (four rows of each band) and learns the wave. `info` has the timestamp, and the exposure if
 * it is known (0 counts as short). A refused frame, or one with the previous timestamp, changes nothing. A frame
 * without a timestamp, of another size or too small resets everything, as does a clock that goes back or forward by
 * more than half a second. */
PUPIL_API int pupil_row_gain_frame(pupil_row_gain *lamps, const pupil_image_const *image, const pupil_frame_info *info);

PUPIL_API int pupil_row_gain_get_sized(const pupil_row_gain *lamps, pupil_row_gain_result *result, size_t result_bytes);
static inline int pupil_row_gain_get(const pupil_row_gain *lamps, pupil_row_gain_result *result)
{
    return pupil_row_gain_get_sized(lamps, result, sizeof *result);
}

/* The gains of the `height` rows of a frame, gain[0] being the top row's. The timestamp of `info` says whether it is
 * the last frame or, to map a frame in the pass that meters it, the next one. Gains are 1/16 to 16. All are 1 if there
 * is nothing to correct, for a time before the last frame, and for more than half a second after it. PUPIL_ERR_SIZE: a
 * height of 0 or above PUPIL_MAX_SIDE_PX.
 */
PUPIL_API int pupil_row_gain_of_rows(const pupil_row_gain *lamps, const pupil_frame_info *info, uint32_t height,
                                     float *gain);

/* pupil_map_rows with the curve's scale times gain[i] in row i of `rows`. Rows that are mapped together have the mean
 * of their gains: pairs of NV12 (in or out) and of mosaics, fours of a mosaic to NV12 of half its size. Gains are above
 * 0 and finite (PUPIL_ERR_VALUE); no scale becomes larger than 2^60. The same can be done with pupil_fused_rows, a row
 * or pair at a time. */
PUPIL_API int pupil_map_rows_with_gains(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                                        const float *gain, const pupil_image *out);

#ifdef __cplusplus
}
#endif

#endif
