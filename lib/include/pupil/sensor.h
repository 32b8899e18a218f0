/* pupil/sensor.h: a camera's exposure time and gain, from the statistics of its frames.
 *
 *     pupil_sensor_config config;
 *     pupil_sensor sensor;
 *     pupil_sensor_setting setting;
 *     pupil_sensor_config_default(&config);
 *     config.exposure_step_s = line_s, config.gain_max = 16;
 *     pupil_sensor_init(&sensor, &config);
 *     pupil_sensor_get(&sensor, &setting), write setting.exposure_s and setting.gain to the camera;
 *     for each frame:
 *         pupil_stats_clear(&stats), pupil_meter_rows(&pupil, &image, 0, height, &stats);
 *         pupil_sensor_frame(&sensor, &stats, &info);
 *         pupil_sensor_get(&sensor, &setting);
 *         if (setting.changed) write setting.exposure_s and setting.gain to the camera;
 *         show the frame times setting.frame_digital; (that is what "shown" means below)
 *
 * The promise: once light and configuration have not changed for max(60, 12 x delay_frames) delivered frames, the shown
 * picture is within 0.1 stops of the aim (`key`, `key_at`, `ev_compensation`, or where highlights hold it back), and
 * the sensor is within 0.25 stops of its best setting, or within half a step of the camera's coarser control there.
 * This holds whatever happened before, on every camera on which more exposure or gain never makes the picture darker.
 * If a wrong black level is found, the picture without it is meant; the frames' mean is then above the key. Where the
 * aim is out of reach, `reason` or `limits` names the limit. docs/sensor.md says how this is reached and tested, how
 * often it is missed, and what to do in each state (States).
 *
 * Statistics: those of pupil_meter_rows (or any other metering, stats.h) of the frame as the camera delivered it,
 * before frame_digital. Highlights and clipped light need a histogram (pupil_config.histogram). White is set once,
 * where the frame is metered: pupil_coding.white for codes, pupil_config.clip for floats. A sensor that clips at a
 * lower code is detected from its frames. config.clip below is white in the unit of the statistics.
 *
 * Metadata: info.exposure_s and info.gain are the values that the camera reports for this very frame; 0 where it
 * reports none. Wrong units, delays and rounding are detected. Do not fill in the values requested last: that would
 * look like a camera without delay. info.sequence says whether a frame is new and how many were lost; it may restart.
 * It is 0 where the source has none: then no frame counts as lost. Timestamps may be equal, stop or jump.
 *
 * Settings: exposure_s and gain are already rounded to values that the camera has (exposure_step_s or exposure_table,
 * gain_law): down, or to the nearest where rounding down would lose more than 0.125 stops. If the camera needs codes,
 * convert to the nearest code. `digital` is the rest, so that total_s = exposure_s * gain * digital always holds; it is
 * for information. Multiply the picture by frame_digital only: it is the factor for the frame that was just given, and
 * hides the steps of the sensor.
 *
 * Speed: an error above 4.5 x far_ev that lasts for more than flash_frames frames is corrected in one step. An error
 * above far_ev is corrected at 0.05 stops a frame, a smaller one by a first-order filter (tau_s). Light that clearly
 * moves one way is followed at its own speed. Highlights move the level by at most 0.05 stops a frame in the 60 frames
 * after a step, and by at most 0.025 later.
 *
 * Cameras: the delays of both controls are learned from the frames. So are tone curves; gains and exposures that do
 * more, less or nothing; lost writes; and a white below the top code. All of it is checked again while the error
 * persists. While a camera ignores its settings, or the aim is more than 0.25 stops out of reach, the setting is
 * written again once a second: `changed` is then 1 with the same values. Where true metadata do not show a step of over
 * a stop, it is written again at once, three times at most. See to it that the driver does not skip equal values.
 * docs/camera-answers.md says what an integrator configures and what is detected.
 *
 * Known changes: announce a filter that is about to be switched, or a flash that is about to fire, by
 * pupil_sensor_announce. The setting for it is requested at once, and its frames are not taken as evidence about the
 * camera.
 *
 * Lamps: flicker of the whole frame is removed from the level, and from each shown frame by frame_digital (flicker_ev).
 * Flicker within a frame (bands) needs exposures in multiples of half a mains period. With PUPIL_SENSOR_MAINS_AUTO the
 * mains frequency is found from the bands. Until then, exposures of 10 ms and more are multiples of 10 ms where the
 * light allows it. docs/mains.md has the limits of both.
 *
 * Threads: one thread at a time may use an object; different objects do not share anything.
 * Memory and determinism: as pupil.h says of pupil_t. Nothing is allocated, the object has a fixed size and no
 * pointers, the same frames give the same bits. A call takes bounded time: all loops are over histogram bins and over
 * tables of fixed or configured length.
 */
#ifndef PUPIL_SENSOR_H
#define PUPIL_SENSOR_H

#include "pupil/config.h"
#include "pupil/error.h"
#include "pupil/image.h"
#include "pupil/stats.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Which gains the camera has. gain_min is always available, whatever the law. */
typedef enum pupil_gain_law {
    PUPIL_GAIN_ANY = 0,    /* default: any value */
    PUPIL_GAIN_LINEAR,     /* n * gain_step */
    PUPIL_GAIN_DB,         /* 10^(n * gain_step / 20) */
    PUPIL_GAIN_RECIPROCAL, /* gain_step / (gain_step - n): 256 / (256 - n), 512 / (512 - n), ... */
    PUPIL_GAIN_TABLE,      /* gain_table */
    PUPIL_GAIN_LAW_COUNT
} pupil_gain_law;

/* Who decides about one control. */
typedef enum pupil_sensor_mode {
    PUPIL_SENSOR_AUTO = 0, /* default */
    PUPIL_SENSOR_MANUAL,   /* uses manual_exposure_s or manual_gain; the other control still adapts */
    PUPIL_SENSOR_HELD,     /* keeps its present value */
    PUPIL_SENSOR_MODE_COUNT
} pupil_sensor_mode;

/* config.mains_hz: found from the frames. */
#define PUPIL_SENSOR_MAINS_AUTO 1

#define PUPIL_SENSOR_STAGES         8
#define PUPIL_SENSOR_GAIN_TABLE     64
#define PUPIL_SENSOR_EXPOSURE_TABLE 64

/* Frozen: elements of an array in pupil_sensor_config. */
typedef struct pupil_sensor_stage {
    double exposure_s, gain;
} pupil_sensor_stage;

typedef struct pupil_sensor_config {
    uint32_t size_bytes;   /* abi.h; filled in by pupil_sensor_config_default */
    uint32_t delay_frames; /* the camera's longest possible delay, in frames of the camera: from the measured frame to
                            * the first one that was taken with the new setting. Frames that wait in a program's queue
                            * need not be added. Too large a value only costs time until the real delay is found; 4;
                            * 1..16 */

    /* the aim */
    double key; /* the wanted log-average, as a share of `clip`; 0.18; 2^-10..1 */
    /* A key that depends on the light, so that night looks like night; replaces `key`. Between two points log2 of the
     * key is linear in scene_ev; beyond the ends it is constant. From one point to the next the key may rise by at most
     * one stop per two stops of light, so that a wrong scene_ev cannot make the loop swing. */
    uint32_t key_points; /* in use; 0 (key)..PUPIL_KEY_POINTS */
    uint32_t reserved;   /* 0 */
    pupil_key_point key_at[PUPIL_KEY_POINTS];
    double ev_compensation; /* stops, positive is brighter; with key_at, too; 0; -16..16 */
    double clip;            /* the value at which a channel is full, in the unit of the statistics; 1, which is right
                             * for integer formats (their pupil_coding.white says at which code); 2^-16..2^16 */
    double trim_low;        /* share of the weight left out of the mean at the dark end; 0; 0..1 */
    double trim_high;       /* share of the weight at which the bright end begins to be left out; above trim_low; 1.
                             * Read only where there is a histogram */
    double highlight_share; /* at most this share of the frame may lie above clip; needs a histogram; 0.05; 0.001..1.
                             * This quantile is held a fifth of a stop below clip, which is about a bin of the
                             * histogram, so a smooth scene clips less and may be up to a fifth of a stop darker */
    double highlight_ev;    /* how many stops highlight_share may lower the level at most; 1; 0 (never)..8 */

    /* how fast */
    double far_ev;  /* a larger error is not CONVERGED, and is corrected faster (Speed, above); stops; 0.10; 0.02..2 */
    double tau_s;   /* the filter's time constant, seconds; 0.8, a weight of 0.04 a frame at 30 a second; 0..1e6. The
                     * weight of a frame is at most 0.35 where the delays are known. Until then it is at most
                     * 0.39 / delay_frames: no delay up to that makes it overshoot. (An error x that is reduced by k
                     * times its value D - 1 frames earlier overshoots if k is above (D-1)^(D-1) / D^D.) */
    double hold_ev; /* the setting is kept while the wanted total is within so many stops of it; frame_digital does
                     * the rest; 0.05; 0..0.5. Once 32 frames have passed since the last request, and 60 since the
                     * last large step, at least 0.125 is used */
    double digital_ev; /* frame_digital stays within +- this many stops, without its flicker correction; 1.5; 0..8 */

    /* exposure time */
    double frame_s;               /* a frame's period; dt of unstamped frames; 1/30; 1e-6..1e6 */
    double exposure_min_s;        /* 1e-4; 1e-9..exposure_max_s; with frame_rate_priority at most frame_s */
    double exposure_max_s;        /* 1/30; 1e-9..1e4 */
    double exposure_step_s;       /* exposures are multiples of this, the line time; 0: any; 0..1. exposure_min_s is not
                                   * rounded, so make it a multiple */
    uint32_t frame_rate_priority; /* 1: automatic exposures stay within frame_s; 0: in the dark, once the gain is at its
                                   * maximum, they may grow up to exposure_max_s; 1 */
    uint32_t mains_hz;        /* 50, 60, 0 (no lamps), or PUPIL_SENSOR_MAINS_AUTO, the default: found from the frames,
                               * taken as 50 until then. Exposures of half a mains period and more are multiples of half
                               * a period (rounded down to a multiple of exposure_step_s), unless that would cost more
                               * than half a stop. With 50 or 60 they are so at the largest gain, too, whatever it
                               * costs. Manual and held ones are so only where it is 50 or 60, or found. Of an
                               * exposure_table the entries within 5 % of such a multiple are used, or all if there is
                               * none */
    uint32_t exposure_mode;   /* a pupil_sensor_mode */
    uint32_t gain_mode;       /* a pupil_sensor_mode */
    double manual_exposure_s; /* for PUPIL_SENSOR_MANUAL: 1e-9..1e4; clamped to the limits, rounded to the steps */
    double manual_gain;       /* the same: 2^-10..2^16 */

    /* gain */
    double gain_min;     /* 1; 2^-10..gain_max */
    double gain_max;     /* 16; 2^-10..2^16 */
    double gain_step;    /* for LINEAR (1e-6..64) and DB (dB, 1e-6..64); for RECIPROCAL 2..65536, to be set with the
                          * law, because the default is 1/16 */
    uint32_t gain_law;   /* a pupil_gain_law */
    uint32_t gain_count; /* entries of gain_table in use, 1..PUPIL_SENSOR_GAIN_TABLE */
    double gain_table[PUPIL_SENSOR_GAIN_TABLE]; /* 2^-10..2^16, never falling; equal entries are allowed */

    /* The profile: how exposure and gain share a rising total. It begins with the shortest exposure at gain_min, rises
     * to stage 0's exposure, then to its gain, then to stage 1's exposure, and so on; none of them may fall. After the
     * last stage come frame_s, gain_max and exposure_max_s. So without stages exposure rises first, and gain only in
     * the dark. 1e-9..1e4 s, 2^-10..2^16. */
    uint32_t stages; /* 0..PUPIL_SENSOR_STAGES; 0 */
    uint32_t lock;   /* 1: the setting is kept while measuring goes on; 0 */
    pupil_sensor_stage stage[PUPIL_SENSOR_STAGES];

    /* what is known of the camera and the light */
    uint32_t flash_frames; /* an error above 4.5 x far_ev must last for more than this many frames before anything
                            * moves, because strobes and lightning are shorter; 2; 0..8. Not during the first search */
    uint32_t linear;       /* 1: values are proportional to light, as of raw sensors. Set 0 for a tone curve, companding
                            * or gamma: then no wrong black level is looked for, and steps go half the way until the
                            * first one has shown how strongly the picture responds. The frames overrule both; 1 */

    /* exposures of a camera that has no fixed step */
    uint32_t exposure_count; /* entries of exposure_table in use; 0 (exposure_step_s)..PUPIL_SENSOR_EXPOSURE_TABLE */
    uint32_t reserved_too;   /* 0 */
    double exposure_table[PUPIL_SENSOR_EXPOSURE_TABLE]; /* seconds, never falling; 1e-9..1e4. Those from exposure_min_s
                                                         * to exposure_max_s are used, and exposure_min_s itself;
                                                         * exposure_step_s is not read */

    /* Day and night (setting.day_night): night begins after day_night_s seconds with scene_ev below night_ev, day after
     * as many above day_ev; at first the middle of both decides. Announced filters do not count as light. Keep the two
     * a stop or two apart. */
    double night_ev;    /* 0; -256..day_ev */
    double day_ev;      /* 0; -256..256 */
    double day_night_s; /* 0: not looked for; 0..1e6 */
} pupil_sensor_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_sensor_config_default_sized(pupil_sensor_config *config, size_t config_bytes);
static inline void pupil_sensor_config_default(pupil_sensor_config *config)
{
    pupil_sensor_config_default_sized(config, sizeof *config);
}

/* PUPIL_OK, or PUPIL_ERR_CONFIG and, where `why` is not NULL, a sentence in *why (constant text) that names the first
 * wrong field and what would be right. */
PUPIL_API int pupil_sensor_config_check(const pupil_sensor_config *config, const char **why);

#define PUPIL_SENSOR_OBJECT_BYTES 12288

/* The object. Its content is private; its size is part of the ABI. */
typedef union pupil_sensor {
    uint64_t private_words[PUPIL_SENSOR_OBJECT_BYTES / 8];
} pupil_sensor;

typedef enum pupil_sensor_state {
    PUPIL_SENSOR_EMPTY = 0, /* no frame with light yet */
    PUPIL_SENSOR_SEARCHING, /* a step is due or in flight */
    PUPIL_SENSOR_CONVERGED, /* what is shown is within far_ev of the aim, and the last step is in force */
    PUPIL_SENSOR_LIMITED,   /* the camera can do no more, and reason names the limit; or it ignores its settings:
                             * IGNORED */
    PUPIL_SENSOR_CLIPPED,   /* more than half of the frame is clipped: its light is estimated, and the search goes on */
    PUPIL_SENSOR_FLICKER,   /* converged, but on an exposure below half a mains period: lamps may show bands. Not while
                             * the frequency is undetermined */
    PUPIL_SENSOR_LOCKED     /* config.lock, or both controls manual or held */
} pupil_sensor_state;

typedef enum pupil_sensor_reason {
    PUPIL_SENSOR_NO_REASON = 0,
    PUPIL_SENSOR_WAITING,         /* the last step may not be in force yet */
    PUPIL_SENSOR_AT_EXPOSURE_MIN, /* limits: this one keeps the aim out of reach */
    PUPIL_SENSOR_AT_EXPOSURE_MAX,
    PUPIL_SENSOR_AT_FRAME_PERIOD, /* exposure_max_s, had frame_rate_priority not been set */
    PUPIL_SENSOR_AT_GAIN_MIN,
    PUPIL_SENSOR_AT_GAIN_MAX,
    PUPIL_SENSOR_HIGHLIGHTS,     /* the total is lower than the key asks for, by highlight_share */
    PUPIL_SENSOR_BELOW_MAINS,    /* the exposure is shorter than half a mains period */
    PUPIL_SENSOR_LOCK,           /* config.lock */
    PUPIL_SENSOR_ALL_MANUAL,     /* both controls are manual or held */
    PUPIL_SENSOR_INVALID_FRAME,  /* this frame has no weight, or values that are not finite: nothing moved */
    PUPIL_SENSOR_REPEATED_FRAME, /* this frame has the last one's sequence and timestamp, neither 0: nothing moved */
    PUPIL_SENSOR_CLOCK_BACK,     /* this frame's timestamp is before the last one's: dt is taken from the sequence, or
                                  * is 0 */
    PUPIL_SENSOR_FLASH, /* an error above 4.5 x far_ev that has lasted for flash_frames at most so far: nothing moved */
    PUPIL_SENSOR_IGNORED,   /* at least two large steps of exposure or gain had no visible effect: dead controls, or the
                             * camera's own automatic. They are tried again; each second `changed` is 1 */
    PUPIL_SENSOR_NONLINEAR, /* a picture that should be linear does not respond as light does (slope): a tone curve, or
                             * a wrong black level */
    PUPIL_SENSOR_HUNTING,   /* not reported any more; older programs may name it */
    PUPIL_SENSOR_ANNOUNCED  /* an announced change of light is awaited: nothing else moves */
} pupil_sensor_reason;

/* What pupil_sensor_announce is about. */
typedef enum pupil_sensor_change {
    PUPIL_SENSOR_CHANGE_LIGHT = 0, /* the scene's light: lamps, a flash */
    PUPIL_SENSOR_CHANGE_FILTER, /* how much of it reaches the sensor: an infrared-cut filter, a grey filter, an iris */
    PUPIL_SENSOR_CHANGE_COUNT
} pupil_sensor_change;

/* Where config.day_night_s is not 0. */
typedef enum pupil_sensor_day_night {
    PUPIL_SENSOR_DAY_NIGHT_UNKNOWN = 0, /* undecided so far */
    PUPIL_SENSOR_DAY,
    PUPIL_SENSOR_NIGHT
} pupil_sensor_day_night;

/* Where a setting's mains_hz is from. */
typedef enum pupil_sensor_mains {
    PUPIL_SENSOR_MAINS_UNDETERMINED = 0, /* no frame has shown it yet, and many cannot: mains_hz is 0 */
    PUPIL_SENSOR_MAINS_FOUND,            /* flicker of lamps was seen, and none of another frequency since */
    PUPIL_SENSOR_MAINS_CONFIGURED        /* config.mains_hz */
} pupil_sensor_mains;

/* All EV are log2. scene_ev, wanted_ev, error_ev: of the last frame with light; 0 where `frames` is 0. */
typedef struct pupil_sensor_setting {
    uint32_t size_bytes; /* abi.h */
    uint32_t reserved;
    double exposure_s;    /* to be written to the camera; a value that it has */
    double gain;          /* to be written to the camera; a value that it has */
    double digital;       /* total_s / (exposure_s * gain); for information: apply frame_digital instead */
    double total_s;       /* wanted exposure time x gain */
    double frame_digital; /* the factor for the frame that was given last */
    double flicker_ev;    /* how much brighter lamps were in that frame than on average; frame_digital corrects it */
    double scene_ev;      /* log2 of the light of the scene: value / (exposure_s * gain), without flicker */
    double wanted_ev;     /* log2 of the wanted mean of that frame: clip times key, or times key_at's at its light, with
                           * ev_compensation */
    double error_ev; /* by how much the total has to rise from the one that was wanted before this frame, within the
                      * limits; positive: too dark. It is not the error of what is shown: state says whether that is
                      * within far_ev */
    double dt_s;
    uint64_t frames;  /* frames with light since init */
    uint32_t state;   /* a pupil_sensor_state */
    uint32_t reason;  /* a pupil_sensor_reason */
    uint32_t limits;  /* bit mask, 1 << PUPIL_SENSOR_AT_...: every limit that an automatic control has reached, in any
                       * state; in daylight the gain is at its minimum */
    uint32_t changed; /* 1: write exposure_s and gain: they changed in the last call other than a get, or have to be
                       * written again. Check it after each of these calls. After init write both in any case */
    double slope;     /* stops of the picture for one of light, as learned from the frames; 1 at first */
    uint32_t exposure_delay, gain_delay; /* frames from the one after which a setting was requested to the first that
                                          * was taken with it, as learned; 0: not known yet */
    uint32_t mains_hz;                   /* in use: 50, 60 or 0 */
    uint32_t mains;                      /* a pupil_sensor_mains */
    double mains_modulation;             /* depth of the bands in the rows, at the frames' exposure, 0..1, when they
                                          * were last seen; 0: never */
    uint32_t day_night;                  /* a pupil_sensor_day_night */
    uint32_t reserved_too;
    double filter_ev; /* stops that announced filters have added to scene_ev since the first frame */
} pupil_sensor_setting;

/* "converged", "exposure_min": names for logs and for people; of a number that is none, "unknown". Constant text. */
PUPIL_API const char *pupil_sensor_state_name(uint32_t state);
PUPIL_API const char *pupil_sensor_reason_name(uint32_t reason);
PUPIL_API const char *pupil_sensor_day_night_name(uint32_t day_night);

/* --- life --- */

/* Makes an object out of any bytes. The first setting is the total of 1/100 s at gain 1, within the limits. */
PUPIL_API int pupil_sensor_init(pupil_sensor *sensor, const pupil_sensor_config *config);

/* Changes the configuration, at any time. The wanted total is kept where the new limits allow it, so that setting a
 * control to manual or back, a lock, another profile or another gain law does not move the level. Another delay_frames
 * or `linear` discards what was learned of the camera. */
PUPIL_API int pupil_sensor_retune(pupil_sensor *sensor, const pupil_sensor_config *config);

/* Warm start, or resumption after a pause: begins with exposure_s x gain, clamped to the limits. Pass a total_s that
 * was saved before, with gain 1, or what the camera has now. Write the first setting afterwards, as after init.
 * PUPIL_ERR_VALUE: not positive numbers from 2^-64 to 2^64. */
PUPIL_API int pupil_sensor_start(pupil_sensor *sensor, double exposure_s, double gain);

/* Announces that the light will be `ev` stops brighter than in the last frame, from one of the next `within_frames`
 * frames on; `change`: a pupil_sensor_change. The setting for it is requested at once (`changed`). Until the frames
 * show the change, the shown picture stays as it was, as far as digital_ev allows, and nothing else moves. This ends at
 * the latest when the setting is in force and within_frames more have come. A change that did not come is then
 * corrected like any change of light. The frames in between are no evidence of delays or of what the controls do. So
 * the best time for the call is the controls' delay before the change.
 *
 * A second call while a change is awaited adds to it. Before the first frame with light, and while the setting is
 * locked, the call has no effect. PUPIL_ERR_VALUE: ev outside -32..32, within_frames outside 1..1000, or no such
 * change. */
PUPIL_API int pupil_sensor_announce(pupil_sensor *sensor, double ev, uint32_t within_frames, uint32_t change);

/* --- a frame --- */

/* The statistics of a frame and its metadata (see above). info may be NULL, and its fields may be 0, in some or all
 * frames. PUPIL_ERR_STATS, and nothing moves: statistics that no metering of a frame with weight can produce. */
PUPIL_API int pupil_sensor_frame(pupil_sensor *sensor, const pupil_stats *stats, const pupil_frame_info *info);

/* The same with the metering of somebody else, an ISP for example: log2 of the light of the scene
 * (pupil_exposure.metered_ev of frames that bring exposure and gain, with a calibration of 1) and the share of it that
 * was clipped, 0..1. highlight_share has no effect here. An EV that is NaN or outside -256..256, or a share outside
 * 0..1, makes an invalid frame. */
PUPIL_API int pupil_sensor_scene(pupil_sensor *sensor, double scene_ev, double clipped_share,
                                 const pupil_frame_info *info);

/* --- results --- */

PUPIL_API int pupil_sensor_get_sized(const pupil_sensor *sensor, pupil_sensor_setting *setting, size_t setting_bytes);
static inline int pupil_sensor_get(const pupil_sensor *sensor, pupil_sensor_setting *setting)
{
    return pupil_sensor_get_sized(sensor, setting, sizeof *setting);
}

#ifdef __cplusplus
}
#endif

#endif
