/* pupil/config.h: everything that can be chosen, its default, its range and its check.
 *
 * Start from pupil_config_default and change what you need; nothing has to be changed for live video to look right.
 *
 * Threads: a config is a plain value. No function here touches anything but its arguments.
 */
#ifndef PUPIL_CONFIG_H
#define PUPIL_CONFIG_H

#include "pupil/error.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Which primaries the input's red, green and blue have. They set the weights of luminance. The picture has the same
 * primaries unless output_primaries names others. */
typedef enum pupil_primaries {
    PUPIL_PRIMARIES_BT709 = 0, /* also sRGB: Y = 0.2126 R + 0.7152 G + 0.0722 B (Rec. ITU-R BT.709-6, item 3.2) */
    PUPIL_PRIMARIES_BT2020, /* Y = 0.262631 R + 0.678056 G + 0.059313 B: that of BT.709 for the same light, within 7e-5
                             * of Rec. ITU-R BT.2020-2, table 4 */
    PUPIL_PRIMARIES_MATRIX  /* config.rgb_to_xyz; its second row, scaled to a sum of 1, gives the weights */
} pupil_primaries;

/* Which primaries the picture has: those of the display, or of the file that it is written to. If they differ from the
 * input's, a 3x3 matrix is applied after metering and before the curve, which then uses the luminance of the picture's
 * primaries. The matrix goes by way of CIE XYZ (SMPTE RP 177-1993, from the chromaticities of BT.709-6 item 1.3 and
 * BT.2020-2 table 3, white D65); rgb_to_xyz is used as it is, scaled, without adaptation to another white. The
 * statistics' brightest channel, which a white point follows, is also that after the matrix, except for mosaics.
 *
 * Before the matrix a component is clamped to -2^31..2^31, so +Inf stays bright.
 *
 * Colours that the new primaries cannot show have negative components after the matrix: these are set to 0. So such a
 * colour becomes a little brighter and less saturated, and its hue may turn. Rep. ITU-R BT.2407 describes better ways,
 * which look up perceptual hues; they are not done here. */
typedef enum pupil_output_primaries {
    PUPIL_OUTPUT_AS_INPUT = 0,
    PUPIL_OUTPUT_BT709, /* also sRGB */
    PUPIL_OUTPUT_BT2020,
    PUPIL_OUTPUT_COUNT
} pupil_output_primaries;

/* How the adapted level follows the metered one. The four formulas are numbered as in the study that pupil grew from
 * (docs/study.md). Their w is the weight of each new frame, at any frame rate. */
typedef enum pupil_law {
    PUPIL_LAW_SECONDS = 0,      /* default: log2 luminance, first order in seconds, one tau for more and one for less
                                 * light */
    PUPIL_LAW_ARITHMETIC_SCALE, /* formula 1: arithmetic average of key / L */
    PUPIL_LAW_ARITHMETIC_LUMINANCE, /* formula 2: arithmetic average of L */
    PUPIL_LAW_GEOMETRIC_SCALE,      /* formula 3: geometric average of key / L */
    PUPIL_LAW_GEOMETRIC_LUMINANCE,  /* formula 4: geometric average of L; the same numbers as formula 3 */
    PUPIL_LAW_EYE,                  /* as an eye sees: see eye_unit_cd_m2 */
    PUPIL_LAW_COUNT
} pupil_law;

/* Where the white point W of extended Reinhard comes from, in units of scaled luminance (key is mid-grey, 1 is about
 * 2.5 stops above it). */
typedef enum pupil_white {
    PUPIL_WHITE_FOLLOW = 0, /* default: the upper quantile (config.white_quantile) of the brightest channel, adapted as
                             * the level is. Never below 1, so a frame of little contrast is not stretched */
    PUPIL_WHITE_FIXED,      /* config.white */
    PUPIL_WHITE_NONE,       /* Reinhard's global operator, L / (1 + L): nothing ever reaches white */
    PUPIL_WHITE_COUNT
} pupil_white;

/* Which curve maps luminance to the display. All but the first are tables of knots, made from each frame's histogram
 * and smoothed in time by `law`, with the level's weight: so no single frame can make them flicker. They act on G, the
 * root of display light, 0..1, of the picture that Reinhard's curve would give (about its 8-bit code over 255).
 * docs/numerics.md has the formulas. */
typedef enum pupil_curve_kind {
    PUPIL_CURVE_REINHARD = 0, /* default: pupil.h, pupil_curve; no table */
    PUPIL_CURVE_NORMALISE,    /* the quantiles curve_share and 1 - curve_share of G become 0 and 1, and values between
                               * are stretched, by at most 4 */
    PUPIL_CURVE_QUANTISE,     /* curve_levels evenly spaced levels of G, from 0 to 1 */
    PUPIL_CURVE_EQUALISE, /* code over 255 is the share of the weight that is darker: all codes are equally frequent. It
                           * turns noise in a large even area into contrast; ADJUST does not */
    PUPIL_CURVE_ADJUST,   /* histogram adjustment with a ceiling: the frame's range is compressed into the display's
                           * where light is rare, and contrast is nowhere above curve_ceiling times the scene's. A frame
                           * that fits is mapped at the key, and not stretched. (Ward Larson, Rushmeier, Piatko: A
                           * visibility matching tone reproduction operator for high dynamic range scenes, 1997, section
                           * 4) */
    PUPIL_CURVE_COUNT
} pupil_curve_kind;

/* How linear display light becomes 8-bit codes. */
typedef enum pupil_transfer {
    PUPIL_TRANSFER_SRGB = 0, /* IEC 61966-2-1 */
    PUPIL_TRANSFER_GAMMA22,  /* code = light^(1/2.2) */
    PUPIL_TRANSFER_LINEAR,   /* code = light */
    PUPIL_TRANSFER_COUNT
} pupil_transfer;

/* How exactly frames of 8-bit Y'CbCr are processed (YUYV, UYVY, NV12, NV21, NV16, I420); all others are processed
 * exactly. Both ways give the same bits on every CPU, and with any split into pairs of rows that begin at an even
 * one. */
typedef enum pupil_accuracy {
    PUPIL_ACCURACY_EXACT = 0, /* every pixel, as light */
    PUPIL_ACCURACY_LUMA, /* For cameras on small boards. One of each n rows, and in it one of each n pairs of pixels, is
                          * metered exactly, with n of 1, 2, 4, 8 so that 16 000 pixels or more are metered: the
                          * statistics are of these pixels alone. Mapping uses a table of luma, and Cb and Cr keep their
                          * ratio to it, where the output is NV12 or I420 of the same matrix and range, RGBA8 or BGRX8,
                          * without dither, in the input's primaries and in codes of sRGB or gamma 2.2. Grey has the
                          * exact bits. Colours near the gamut's surface or far from grey are mapped exactly, so a frame
                          * of only such colours takes longer than with EXACT. YUYV, UYVY and NV16 become 4:2:0 by the
                          * mean of two rows' Cb and Cr. docs/numerics.md has the errors. Each call builds the tables,
                          * which takes as long as 256 exact pixels: map many rows a call */
    PUPIL_ACCURACY_COUNT
} pupil_accuracy;

/* Which state maps a frame. */
typedef enum pupil_order {
    PUPIL_ORDER_EXACT = 0, /* meter, adapt, map: two passes over the frame, no lag */
    PUPIL_ORDER_FUSED,     /* map with the state before this frame while metering it: one pass, one frame of lag. The
                            * first frame after init or reset is done exactly */
    PUPIL_ORDER_COUNT
} pupil_order;

/* Kernels for the instructions of one kind of CPU. */
typedef enum pupil_level {
    PUPIL_LEVEL_SCALAR = 0, /* plain C: the reference */
    PUPIL_LEVEL_NEON,       /* AArch64 */
    PUPIL_LEVEL_AVX2,       /* x86-64 with AVX2 and F16C */
    PUPIL_LEVEL_AVX512,     /* x86-64 with AVX-512 F, BW, DQ and VL */
    PUPIL_LEVEL_WASM128,    /* WebAssembly with 128-bit SIMD */
    PUPIL_LEVEL_COUNT
} pupil_level;

#define PUPIL_KEY_POINTS 8

/* A point of a key that depends on the light. Frozen: elements of arrays in pupil_config and pupil_sensor_config. */
typedef struct pupil_key_point {
    double scene_ev; /* log2 of scene luminance; -256..256, rising */
    double key;      /* 2^-10..1; never falls */
} pupil_key_point;

/* Side of the metering grid: the frame is cut into this many columns and rows of cells. */
#define PUPIL_GRID_SIDE 16

typedef struct pupil_config {
    uint32_t size_bytes; /* abi.h; filled in by pupil_config_default */

    /* metering */
    uint32_t primaries;  /* a pupil_primaries; BT.709 */
    float rgb_to_xyz[9]; /* row by row, -1e6..1e6, the second row 0..1e6; read only with PUPIL_PRIMARIES_MATRIX. If
                          * output_primaries is as the input, only the second row is read; else the determinant must not
                          * be 0 */
    float floor;         /* luminance that everything darker, and NaN, counts as; frame units; 2^-14; 2^-30..1. Of
                          * floats or halves, pixels at or below it do not count for the level while 1/64 of the frame
                          * is above it, because a rendered background is exactly 0; of decoded codes they do
                          * (pupil_stats.code_light). If the brightest 5 % of the light
                          * are below 2^-6 or above 2^16, multiply the frame and its gain (pupil_frame_info) by the same
                          * power of two, with exposure_s 1 if it is unknown. The level is then still that of the
                          * original light. PUPIL_REASON_RANGE reports such frames */
    float clip;          /* a channel at or above it counts as clipped; frame units; 0: the format's largest value
                          * (stats.h) */
    float trim_low;      /* share of the weight left out of the mean at the dark end, 0..1; 0 */
    float trim_high;     /* where the kept share ends, above trim_low; 1. (0.05, 0.95) is the usual trimmed mean */
    uint32_t histogram;  /* 0: gathered only if trimming, a white point that follows or a curve needs it; 1: always; 0.
                          * histogram_step says which pixels it counts */
    uint32_t meter_rows; /* n of 1, 2, 4, 8: one of each n rows (of a mosaic: rows of quads) is metered, a different one
                          * in each frame. Mapping does not change. For slow boards: docs/numerics.md has the error. If
                          * few rows have a weight, a frame may meter none of them; it then counts as a frame without
                          * light. The number of frames that pupil_adapt has taken selects the rows, so workers use the
                          * object that adapts, or a copy made since the last frame; 0: as 1 */
    uint32_t grey_world; /* 1: sum up the channels of mosaics (pupil_stats_grey_world); same for all workers; 0 */
    uint8_t weight[PUPIL_GRID_SIDE][PUPIL_GRID_SIDE]; /* [row][column] of the metering grid, 0..255, at least one
                                                       * above 0; all 1. A pixel belongs to the cell that contains its
                                                       * centre: (2x+1)*16 / (2*width). */

    /* adaptation */
    uint32_t law;     /* a pupil_law; seconds */
    uint32_t lock;    /* 1: the adapted level and white are held while metering continues (the first valid frame still
                       * sets them); 0 */
    uint32_t flicker; /* 1: temporal flicker of lamps at 50 or 60 Hz is removed from the level and from each frame's
                       * curve. It is detected if frames have timestamps, and if it is periodic and little else changes;
                       * 1 */
    uint32_t key_points;    /* how many of key_at are used; 0 (key)..PUPIL_KEY_POINTS */
    double frame_weight;    /* w of formulas 1..4, above 0, up to 1; 0.05 */
    double tau_light_s;     /* time constant toward more light, seconds, 0 (at once) ..1e6; 0.3 */
    double tau_dark_s;      /* time constant toward less light, seconds, 0 (at once) ..1e6; 0.9 */
    double nominal_frame_s; /* dt of frames that bring no timestamps, seconds, above 0, up to 1e6; 1/30 */
    double ev_min;          /* lowest adapted level, log2 of scene luminance; -32; -64..ev_max */
    double ev_max;          /* highest adapted level; 32; ev_min..64 */
    double calibration;     /* scene luminance = value / (exposure_s * gain) * calibration, if a frame has both;
                             * 2^-64..2^64; 1 */
    double key;             /* what the log-average is mapped to, 2^-10..1; 0.18 */
    /* Night that looks like night: key_at in place of key. Between two points log2 of the key is linear in scene_ev,
     * beyond the ends it is constant. From one point to the next the key may rise by at most one stop for two stops of
     * light. scene_ev is the adapted level, so it is absolute where frames bring exposure and gain. */
    pupil_key_point key_at[PUPIL_KEY_POINTS];
    double ev_compensation; /* stops, positive is brighter; with key_at, too; 0; -16..16 */

    /* Highlights: if more than `highlight_share` of the weight is more than `highlight_room_ev` above the log-average,
     * the level rises by the excess, at most by `highlight_ev`, and the picture is darker. So a lamp in a dark room, or
     * a lit meadow behind a tree, keeps its colours. The excess is a mean over the shares from 0.8 to 1.6 times
     * `highlight_share`, so that it begins slowly. A second excess is that of the shares from 0.5 to 1 % over 10.275
     * stops, which the curve shows as white; the larger one counts. Where black is left out (floor), shares are of the
     * rest, of at least an eighth of the frame; that of white_quantile, too. This needs a histogram, and there is none
     * if the white point does not follow, nothing is trimmed and `histogram` is 0. docs/pictures.md shows what it does.
     */
    double highlight_share;   /* 0.05; 0.001..0.5 */
    double highlight_room_ev; /* stops; 4; 0..32 */
    double highlight_ev;      /* stops; 2; 0 (never)..8 */

    /* Noise stays dark: the level of frames of codes (8 to 16 bits) is at least 0.18 * 2^-amplification_ev in frame
     * units, so a frame behind a lens cap is black, and its state is PUPIL_STATE_LIMITED. If the light of the first
     * code is below 2^-12, the limit is lower by as many stops. Float and half frames count as noiseless, and have no
     * such limit, unless pupil_stats.code_light says that they are decoded codes. With the default, 8-bit video that is
     * 4 stops too dark looks as bright as any, and the noise of a camera in the dark is nearly black: docs/pictures.md
     * has the measurements. */
    double amplification_ev; /* stops; 4; 0..32 (in effect never) */

    /* mapping */
    uint32_t order;            /* a pupil_order; exact */
    uint32_t white_mode;       /* a pupil_white; follow */
    double white;              /* W for PUPIL_WHITE_FIXED, 2^-8..2^30; 1 */
    double white_quantile;     /* for PUPIL_WHITE_FOLLOW, 0.5..1; 0.995 */
    uint32_t transfer;         /* a pupil_transfer; sRGB */
    uint32_t output_primaries; /* a pupil_output_primaries; as the input */

    uint32_t levels; /* mask of the levels of kernels that may be used, 1 << pupil_level; 0: all. The best one that the
                      * CPU has is used, or scalar if it has none of them; all give the same bits; 0 */
    uint32_t dither; /* 1: 8-bit pictures get ordered dither, by pixel position, so smooth ramps have no bands. Values
                      * that are sRGB or linear codes already do not change. Any split into rows has the same bits; for
                      * video and windows, not for measuring; 0 */

    /* curves from the histogram (pupil_curve_kind) */
    uint32_t curve;        /* a pupil_curve_kind; Reinhard's */
    uint32_t curve_levels; /* of PUPIL_CURVE_QUANTISE; 8; 2..256 */
    double curve_share;    /* of NORMALISE and ADJUST: share of the weight that is left out at each end; 0.005;
                            * 0..0.25 */
    double curve_ceiling;  /* of ADJUST: the largest slope of log2 of display light over log2 of luminance; 1; 1..4 */
    double curve_range_ev; /* of ADJUST: stops used, from the display's darkest light to its brightest; 8; 2..16 */

    /* PUPIL_LAW_EYE: cones and rods, each with a neural filter (0.08 and 0.15 s) and a pigment that light bleaches and
     * the dark restores (110 and 400 s), after Pattanaik et al. 2000. So the picture is too bright for a moment when
     * the light comes on, and too dark for minutes after it is out. adapted_ev is the light at which a fully adapted
     * eye is as sensitive. Where rods see, colours fade toward blue-grey (pupil_curve.rods). This shows what an eye
     * would see; for video that should look right, the default law is better. docs/numerics.md has the formulas. The
     * four filters are exact exponentials of the time between frames. The eye needs absolute light: */
    double eye_unit_cd_m2; /* cd/m2 of scene luminance 1; read only with PUPIL_LAW_EYE; 100, as PQ; 1e-6..1e9 */

    uint32_t histogram_step; /* n of 2, 4, 8: the histogram counts one of each n rows (of a mosaic: of quads), and in it
                              * one of each 2n pixels, with the weight of all of them. 1: every pixel. They are chosen
                              * by position alone, pseudo-randomly: the same frame has the same statistics, in any
                              * split. The log-average does not change; docs/numerics.md has the errors of the other
                              * statistics. 0, the default: the largest n that counts 25 000 pixels or more: 1 up to
                              * 640x312, 2 for 640x480, 4 for 1280x720 and 1920x1080, 8 for 3840x2160. With meter_rows
                              * above 1 each metered row is counted */
    uint32_t accuracy;       /* a pupil_accuracy; exact */
} pupil_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_config_default_sized(pupil_config *config, size_t config_bytes);
static inline void pupil_config_default(pupil_config *config)
{
    pupil_config_default_sized(config, sizeof *config);
}

/* PUPIL_OK or PUPIL_ERR_CONFIG. `why` may be NULL; else *why is a sentence (constant text) that names the first wrong
 * field and what would be right. */
PUPIL_API int pupil_config_check(const pupil_config *config, const char **why);

/* The usual metering patterns, written into config->weight. A caller's own mask is written there directly.
 *
 * - centre: a bell over the frame, 255 in the middle, 16 at the corners.
 * - spot: a disc over the central 5 % of the area.
 * - roi: x, y, width and height as fractions of the frame (0..1, not empty); cells count by the share that is covered.
 *
 * The first three refuse only NULL; roi refuses values outside the frame with PUPIL_ERR_VALUE. */
PUPIL_API int pupil_metering_uniform(pupil_config *config);
PUPIL_API int pupil_metering_centre(pupil_config *config);
PUPIL_API int pupil_metering_spot(pupil_config *config);
PUPIL_API int pupil_metering_roi(pupil_config *config, double x, double y, double width, double height);

#ifdef __cplusplus
}
#endif

#endif
