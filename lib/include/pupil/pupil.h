/* pupil/pupil.h: camera-style auto-exposure for streaming HDR frames.
 *
 *     frame --meter--> stats --adapt(dt)--> curve --map--> display frame
 *
 * meter: reduces a frame to a few integers (stats.h).
 *
 * adapt: the only place where time passes, and the only owner of state.
 *
 * curve: a few numbers, all that a mapper (a CPU kernel, a shader) needs.
 *
 * The shortest use:
 *
 *     pupil_config config;
 *     pupil_t pupil;
 *     pupil_config_default(&config);
 *     pupil_init(&pupil, &config);
 *     for each frame: pupil_process(&pupil, &in, &info, &out);
 *
 * Memory: the caller owns every byte. pupil_t has a fixed size and holds no pointer. memcpy saves it, forks it, and
 * moves it between threads or processes of the same build. A fork replays the same bits. Nothing is ever allocated.
 *
 * Determinism: the same frames give the same bits on every CPU, with any split into rows and any number of threads.
 *
 * Threads: calls that take a `const pupil_t *` may run at the same time on one object. A call that takes a `pupil_t *`
 * must be the only one on its object. Different objects are independent. There is no global state.
 */
#ifndef PUPIL_PUPIL_H
#define PUPIL_PUPIL_H

#include "pupil/config.h"
#include "pupil/error.h"
#include "pupil/image.h"
#include "pupil/stats.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PUPIL_OBJECT_BYTES 12288

/* The object. Its content is private; its size is part of the ABI. */
typedef union pupil {
    uint64_t private_words[PUPIL_OBJECT_BYTES / 8];
} pupil_t;

/* --- life --- */

/* Makes an object out of any bytes, and chooses the kernels for this CPU. An object that is saved and taken to another
 * machine needs a pupil_retune there. PUPIL_ERR_CONFIG: see pupil_config_check. */
PUPIL_API int pupil_init(pupil_t *pupil, const pupil_config *config);

/* New settings from the next frame on. The adaptation is kept, also the level when the law changes. Only between
 * frames: PUPIL_ERR_ORDER between pupil_frame_begin and pupil_frame_end. */
PUPIL_API int pupil_retune(pupil_t *pupil, const pupil_config *config);

/* The pupil_level that was chosen. */
PUPIL_API int pupil_get_level(const pupil_t *pupil, uint32_t *level);

/* Forgets every frame; the configuration is kept. The next valid frame sets the state at once. */
PUPIL_API int pupil_reset(pupil_t *pupil);

/* --- a frame at once --- */

/* Meters, adapts and maps one frame in the configured order. `in` and `out` have the same size and do not overlap (of a
 * mosaic, `out` may have half the width and height). `info` may be NULL (nothing known). A frame without any weight
 * leaves the level as it is; before the first valid frame, such a frame is mapped at the key itself (scale 1).
 */
PUPIL_API int pupil_process(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info,
                            const pupil_image *out);

/* pupil_process without a picture: meters the whole frame and adapts to it. The state is then the same to the bit, so
 * pupil_get_exposure, pupil_get_stats and pupil_get_curve answer as after pupil_process. Use it to control the exposure
 * of a camera, to display only a level, or where something else maps the picture. Metering alone, without adaptation,
 * is pupil_meter_rows with all rows. PUPIL_ERR_ORDER between pupil_frame_begin and pupil_frame_end. */
PUPIL_API int pupil_meter(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info);

/* --- a frame as its rows arrive --- */

/* Call begin; then rows, with each row exactly once, in groups of any size and order (NV12 and mosaics in pairs:
 * image.h); then end, which adapts. If `out` is given, the rows are mapped in the same pass with the state before this
 * frame (fused): PUPIL_ERR_NO_EXPOSURE if there is none yet. If the number of rows is too small, pupil_frame_end
 * refuses the frame (PUPIL_ERR_ROWS) and drops it. pupil_frame_cancel drops it too.
 */
PUPIL_API int pupil_frame_begin(pupil_t *pupil, uint32_t width, uint32_t height, const pupil_frame_info *info);
PUPIL_API int pupil_frame_rows(pupil_t *pupil, const pupil_image_const *rows, uint32_t first_row,
                               const pupil_image *out);
PUPIL_API int pupil_frame_end(pupil_t *pupil);
PUPIL_API int pupil_frame_cancel(pupil_t *pupil);

/* --- in parts: any worker meters, one place adapts, any worker maps --- */

/* What a mapper needs. With v the frame's value and Lv its luminance:
 *     u = scale * Lv,   display RGB = v * scale * (1 + u * inverse_white_squared) / (1 + u)
 * (Reinhard, Stark, Shirley, Ferwerda: Photographic Tone Reproduction for Digital Images, 2002, equations 3 and 4.)
 * Here Lv is clamped to 0..2^30 and a component of v to 0..2^31; where Lv is NaN the pixel is black.
 *
 * A colour beyond the display's gamut becomes darker and paler until it fits; its hue stays. D is its luminance, m its
 * largest component, x = (m - D) / (1 - D) its distance from the grey of D (1: the gamut's surface). Where x > k its
 * largest component becomes
 *     M = min(1, D + (1 - D) * (k + (x - k) / (1 + gamut * (m / (1 - D) - k)))),   k = PUPIL_GAMUT_KNEE
 * Where gamut is 0, M is 1 if m > 1, and colours inside the gamut do not change. To reach M, the cube roots of the
 * responses of Oklab's cones (Ottosson 2020; 1 for white; BT.709's where config.rgb_to_xyz has none) move toward that
 * of the second cone, of middle wavelengths, by min(1, D^3 * (m - M) / (M * (m - D))) of the way. Then all components
 * are scaled so that the largest is M. Components below 0 become 0. From D = 1 on the pixel is white. */
#define PUPIL_GAMUT_KNEE 0.85f

/* A curve as a table (config.h, pupil_curve_kind): knot k is at the luminance (1 + (k % 8) / 8) * 2^(k / 8) /
 * knot_scale (k / 8 being whole stops), and holds the root of display luminance there. There are eight knots a stop, as
 * the bins of the histogram, over 16 stops; the adapted level is within 1.5 stops of their middle. With g interpolated
 * between the two knots around t = knot_scale * Lv, linearly in t, display RGB = v * knot_scale * g^2 / max(t, 1).
 * Below the first knot and above the last g is constant, so darker light goes to black in proportion. With levels, g is
 * then min(floor(g * levels), levels - 1) / (levels - 1). The gamut is then as above. */
#define PUPIL_CURVE_KNOTS 128
typedef struct pupil_curve {
    uint32_t size_bytes;           /* abi.h; or 0 */
    float scale;                   /* X: from frame values to scaled luminance; 0..2^60 */
    float inverse_white_squared;   /* 1 / W^2; 0: no white point; 0..2^16 */
    float gamut;                   /* 1 / (1 - k) - 1 / (W - k): a component of W at D = 0 becomes 1; 0 where W <= 1;
                                    * 0..16 */
    uint32_t dither;               /* config.dither */
    uint32_t first_row;            /* for pupil_map_rows: the frame's row that `rows` begins with, so that dither is the
                                    * same in parts as in the whole (pupil_fused_rows has its own). Rows of the input
                                    * count, also where a mosaic is mapped to half its size; 0..PUPIL_MAX_SIDE_PX - 1 */
    float rods;                    /* the share of the rods' light in the picture, 0..1; above 0 only with
                                    * PUPIL_LAW_EYE. v is then (1 - rods) * v + rods * (v's light for rods) * blue, in
                                    * the picture's primaries. An object of another law ignores it */
    uint32_t knots;                /* 0: Reinhard's curve, as above; PUPIL_CURVE_KNOTS: by knot[] */
    uint32_t levels;               /* 0: no levels; or with knots, how many: 2..256 */
    float knot_scale;              /* 1 / the luminance of knot[0], in the frame's units; 0..2^60 */
    float knot[PUPIL_CURVE_KNOTS]; /* 0..1; read only where knots is not 0 */
} pupil_curve;

/* Meters a group of whole rows, which begins at row `first_row` of a frame of `frame_height` rows, and adds them to
 * `stats`, which pupil_stats_clear began. Workers have their own stats and merge them with pupil_stats_add. */
PUPIL_API int pupil_meter_rows(const pupil_t *pupil, const pupil_image_const *rows, uint32_t first_row,
                               uint32_t frame_height, pupil_stats *stats);

/* The only place where time passes: takes a frame's statistics, from any meter, and moves the adapted level. */
PUPIL_API int pupil_adapt(pupil_t *pupil, const pupil_stats *stats, const pupil_frame_info *info);

/* Maps rows, each independently, so any part of a frame is mapped as the whole would be. */
PUPIL_API int pupil_map_rows(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                             const pupil_image *out);

/* Both in one pass over the rows: metered into `stats`, mapped with `curve`. */
PUPIL_API int pupil_fused_rows(const pupil_t *pupil, const pupil_curve *curve, const pupil_image_const *rows,
                               uint32_t first_row, uint32_t frame_height, const pupil_image *out, pupil_stats *stats);

/* --- results --- */

typedef enum pupil_state {
    PUPIL_STATE_EMPTY = 0, /* no valid frame yet */
    PUPIL_STATE_ADAPTING,  /* on the way */
    PUPIL_STATE_SETTLED,   /* within 0.05 stop of its target */
    PUPIL_STATE_LIMITED,   /* settled at ev_min, ev_max or the limit of amplification_ev, with the light beyond it */
    PUPIL_STATE_LOCKED     /* held by config.lock */
} pupil_state;

typedef enum pupil_reason {
    PUPIL_REASON_NONE = 0,
    PUPIL_REASON_EV_MIN,        /* the light is below ev_min */
    PUPIL_REASON_EV_MAX,        /* the light is above ev_max */
    PUPIL_REASON_NO_LIGHT,      /* this frame's statistics carry no weight: the level was held */
    PUPIL_REASON_CLOCK_BACK,    /* this frame's timestamp is before the last one's: dt was taken as 0 */
    PUPIL_REASON_LOCK,          /* config.lock */
    PUPIL_REASON_CLOCK_UNIT,    /* this frame's timestamp is less than 0.1 ms after the last one's: seconds, ms or us in
                                 * the place of ns? The level hardly moves */
    PUPIL_REASON_HIGHLIGHTS,    /* the highlights hold the level up (config.highlight_ev): held_back_ev */
    PUPIL_REASON_NO_HISTOGRAM,  /* the highlights are not known, because the statistics have no histogram */
    PUPIL_REASON_AMPLIFICATION, /* the frame is so dark that its codes are mostly noise: it remains dark
                                 * (config.amplification_ev) */
    PUPIL_REASON_RANGE /* more than half of the frame's pixels are at or below config.floor, or about half at the
                        * largest luminance (stats.h): the level is that of the others */
} pupil_reason;

/* The state after the last pupil_adapt. All EV are log2 of scene luminance (relative unless frames bring exposure, gain
 * and the config a calibration). */
typedef struct pupil_exposure {
    uint32_t size_bytes; /* abi.h */
    uint32_t reserved;
    double metered_ev;   /* the last frame's (trimmed) log-average; of floats and halves without black (config.floor) */
    double flicker_ev;   /* how much of it is temporal flicker (config.flicker); 0: none known */
    double held_back_ev; /* by how much the last frame's highlights hold the level above its log-average, and the
                          * picture darker (config.highlight_ev); 0..8 */
    double adapted_ev;   /* the adapted level */
    double white_ev;     /* the adapted upper quantile of the brightest channel; 0 unless the white point follows */
    double scale;        /* from scene luminance to scaled luminance: key * 2^(ev_compensation - adapted_ev) */
    double dt_s;         /* the time step of the last frame */
    uint64_t frames;     /* frames adapted to since init or reset */
    uint32_t state;      /* a pupil_state */
    uint32_t reason;     /* a pupil_reason */
    /* PUPIL_LAW_EYE; else 0 */
    double cone_cd_m2, rod_cd_m2;     /* the light to which their neural filters have adapted cones and rods */
    double cone_pigment, rod_pigment; /* the share of each pigment that is not bleached, 0..1 */
    double rods;                      /* the share of the rods in the response to the last frame's light, 0..1 */
} pupil_exposure;

PUPIL_API int pupil_get_exposure_sized(const pupil_t *pupil, pupil_exposure *exposure, size_t exposure_bytes);
static inline int pupil_get_exposure(const pupil_t *pupil, pupil_exposure *exposure)
{
    return pupil_get_exposure_sized(pupil, exposure, sizeof *exposure);
}

/* The curve for a frame. If `info` or an earlier frame has exposure and gain, these were divided out of the light
 * before adapting, and are put back here. Temporal flicker (config.flicker) is that of the frame with info's timestamp,
 * which may be the last frame or a future one. `info` may be NULL: the last frame's. PUPIL_ERR_NO_EXPOSURE before the
 * first valid frame. */
PUPIL_API int pupil_get_curve_sized(const pupil_t *pupil, const pupil_frame_info *info, pupil_curve *curve,
                                    size_t curve_bytes);
static inline int pupil_get_curve(const pupil_t *pupil, const pupil_frame_info *info, pupil_curve *curve)
{
    return pupil_get_curve_sized(pupil, info, curve, sizeof *curve);
}

/* The curve with which pupil_process maps frames before the first valid one. The scale is 1. The white point is
 * config.white, or 1 where it follows the light. */
PUPIL_API int pupil_curve_before_light_sized(const pupil_t *pupil, pupil_curve *curve, size_t curve_bytes);
static inline int pupil_curve_before_light(const pupil_t *pupil, pupil_curve *curve)
{
    return pupil_curve_before_light_sized(pupil, curve, sizeof *curve);
}

/* The statistics of the last frame that pupil_process, pupil_meter or pupil_frame_end metered; of no pixels if that
 * frame was dropped. Between pupil_frame_begin and pupil_frame_end: of the rows so far. */
PUPIL_API int pupil_get_stats_sized(const pupil_t *pupil, pupil_stats *stats, size_t stats_bytes);
static inline int pupil_get_stats(const pupil_t *pupil, pupil_stats *stats)
{
    return pupil_get_stats_sized(pupil, stats, sizeof *stats);
}

#ifdef __cplusplus
}
#endif

#endif
