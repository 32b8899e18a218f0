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
 * What it is built and tested for: in constant light, from max(60, 12 x delay_frames) delivered frames after the last
 * change of light or configuration on, the shown picture is within 0.1 stops of the aim (`key`, `key_at`,
 * `ev_compensation`, or where highlights hold it back), and the sensor within 0.25 stops of its best setting, or half
 * the camera's own step there. That is so whatever happened before, on each camera on which more exposure or gain never
 * makes the picture darker. Where the aim is out of reach, `reason` or `limits` names the limit. docs/sensor.md says
 * how, what was tested, and how often it is missed; and what to do in each state (States).
 *
 * Statistics: those of pupil_meter_rows (or any other metering, stats.h) of the frame as the camera delivered it,
 * before frame_digital. A histogram (pupil_config.histogram) is needed for the highlights and to see clipped light.
 * White is set once, where the frame is metered: pupil_coding.white for codes, pupil_config.clip for floats. What is
 * clipped at a lower code is found in the picture. `clip` here only tells the object which value white has in the
 * statistics.
 *
 * Metadata: info.exposure_s and info.gain are those that this very frame was taken with, as far as the camera reports
 * them, as it reports them: wrong units, delays, rounding and missing metadata are detected. Do not put there what was
 * asked for last: that would look like a camera without delay. info.sequence says whether a frame is new and how many
 * were lost; it may restart. Timestamps may be equal, stop or jump.
 *
 * Settings: exposure_s and gain are already rounded to values that the camera has, by exposure_step_s or exposure_table
 * and by gain_law: down, or to the nearest where that leaves more than 0.125 stops. If the camera needs codes, convert
 * to the nearest code. What is left is `digital`, so that total_s = exposure_s * gain * digital always; it is for
 * information. The picture is multiplied by frame_digital only, the factor for the frame that was just given: shown
 * with it, a step of the sensor cannot be seen.
 *
 * Speed: light that is off by more than 4.5 x far_ev for more than flash_frames frames is followed in one step. From
 * far_ev on it is followed at 0.05 stops a frame, below that by a first-order filter (tau_s), and light that clearly
 * moves to one side by its own speed. Highlights move the level by at most 0.05 stops a frame in the 60 frames after a
 * step, and by 0.025 later.
 *
 * Cameras: delays of both controls are found from the frames, and so are tone curves, gains and exposures that do more
 * or less than they should or nothing, lost writes and white below the top code. All of it is examined again while the
 * error stays. To a camera that ignores its settings, or whose aim is more than 0.25 stops out of reach, the
 * setting is written again each second: `changed` is then 1 with the same values. docs/camera-answers.md has what an
 * integrator configures, and what is found.
 *
 * Known changes: a filter that is switched or a flash that fires is announced by pupil_sensor_announce. The setting for
 * it is asked for at once, and its frames are no evidence against the camera.
 *
 * Lamps: flicker of all light from frame to frame is taken out of the level and, by frame_digital, of each frame
 * (flicker_ev). Rows need exposures in multiples of half a mains period. With PUPIL_SENSOR_MAINS_AUTO their frequency
 * is found from the bands. Until it is known, exposures of 10 ms and more are multiples of 10 ms where the light allows
 * it. docs/mains.md has the limits of both.
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

/* Which gains the camera has. Beside those of the law, gain_min is always one. */
typedef enum pupil_gain_law {
    PUPIL_GAIN_ANY = 0,    /* default: every one */
    PUPIL_GAIN_LINEAR,     /* n * gain_step */
    PUPIL_GAIN_DB,         /* 10^(n * gain_step / 20) */
    PUPIL_GAIN_RECIPROCAL, /* gain_step / (gain_step - n): 256 / (256 - n), 512 / (512 - n), ... */
    PUPIL_GAIN_TABLE,      /* gain_table, rising */
    PUPIL_GAIN_LAW_COUNT
} pupil_gain_law;

/* Who decides about one control. */
typedef enum pupil_sensor_mode {
    PUPIL_SENSOR_AUTO = 0, /* default */
    PUPIL_SENSOR_MANUAL,   /* manual_exposure_s, manual_gain; the other control goes on making up for it */
    PUPIL_SENSOR_HELD,     /* stays what it is at this moment */
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
    uint32_t delay_frames; /* the longest delay that the camera may have: frames from the one that was measured to the
                            * first that was taken with the new setting. Too long costs time only until it is found;
                            * 4; 1..16 */

    /* what is wanted */
    double key; /* what the log-average is to be, of the sensor's range: of `clip`; 0.18; 2^-10..1 */
    /* Night that looks like night: key_at in place of key. Between two points log2 of the key is linear in scene_ev,
     * beyond the ends it stays. From one point to the next the key may rise by at most a stop for two of light, so that
     * a wrong scene_ev cannot make the loop swing. */
    uint32_t key_points; /* in use; 0 (key)..PUPIL_KEY_POINTS */
    uint32_t reserved;   /* 0 */
    pupil_key_point key_at[PUPIL_KEY_POINTS];
    double ev_compensation; /* stops, positive is brighter; with key_at, too; 0; -16..16 */
    double clip;            /* the value of a frame at which a channel is full; 2^-16..2^16; 1, as integer formats have
                             * it, of which pupil_coding.white says at which code they are full */
    double trim_low;        /* share of the weight left out of the mean at the dark end; 0; 0..1 */
    double trim_high;       /* where the kept share ends, above trim_low; 1. Read only where there is a histogram */
    double highlight_share; /* at most this share may lie above clip, where there is a histogram; 0.05; 0.001..1. Where
                             * it starts is aimed at a fifth of a stop below clip, for a bin of the histogram may be as
                             * wide, so less of a smooth scene is clipped, and the total up to as much lower */
    double highlight_ev;    /* ... at the price of at most so many stops; 1; 0 (never)..8 */

    /* how fast */
    double far_ev;     /* further off than this is not converged (see Speed above); stops; 0.10; 0.02..2 */
    double tau_s;      /* the filter's time constant, seconds; 0.8, a weight of 0.04 a frame at 30 a second; 0..1e6. The
                        * weight of a frame is at most 0.35 where the delays are known. Until then it is at most
                        * 0.39 / delay_frames: no delay up to that makes it overshoot (largest k without overshoot of
                        * x' = x - k * (x of D - 1 frames before): (D-1)^(D-1) / D^D) */
    double hold_ev;    /* the setting is kept while the wanted total is within so many stops of it; frame_digital does
                        * the rest. At rest, that is 32 frames after the last request and 60 after the last large step,
                        * it is at least 0.125; 0.05; 0..0.5 */
    double digital_ev; /* frame_digital stays within +- so many stops, the beat of lamps apart; 1.5; 0..8 */

    /* exposure time */
    double frame_s;               /* a frame's period; dt of unstamped frames; 1/30; 1e-6..1e6 */
    double exposure_min_s;        /* 1e-4; 1e-9..exposure_max_s; with frame_rate_priority at most frame_s */
    double exposure_max_s;        /* 1/30; 1e-9..1e4 */
    double exposure_step_s;       /* exposures are multiples of it: a line; 0: any; 0..1. exposure_min_s is used as it
                                   * is, so make it a multiple */
    uint32_t frame_rate_priority; /* 1: exposures stay within frame_s, but for manual or held ones; 0: in the dark,
                                   * after the gain, they may go on up to exposure_max_s; 1 */
    uint32_t mains_hz;      /* 50, 60, 0 (no lamps), or PUPIL_SENSOR_MAINS_AUTO, which is the default: found, and taken
                             * to be 50 until then. From half a mains period on, exposures are multiples of half a
                             * period (rounded down to a multiple of exposure_step_s), unless that would cost more than
                             * half a stop; manual or held ones only where it is 50 or 60, or found. Of an
                             * exposure_table the entries within 5 % of such a multiple are used, or all if none is */
    uint32_t exposure_mode; /* a pupil_sensor_mode */
    uint32_t gain_mode;     /* a pupil_sensor_mode */
    double manual_exposure_s; /* read with PUPIL_SENSOR_MANUAL: 1e-9..1e4; brought into the limits and steps */
    double manual_gain;       /* the same: 2^-10..2^16 */

    /* gain */
    double gain_min;     /* 1; 2^-10..gain_max */
    double gain_max;     /* 16; 2^-10..2^16 */
    double gain_step;    /* of LINEAR (1e-6..64) and DB (dB, 1e-6..64); of RECIPROCAL its step, 2..65536, which has to
                          * be set with the law, for the default is 1/16 */
    uint32_t gain_law;   /* a pupil_gain_law */
    uint32_t gain_count; /* entries of gain_table in use, 1..PUPIL_SENSOR_GAIN_TABLE */
    double gain_table[PUPIL_SENSOR_GAIN_TABLE]; /* 2^-10..2^16, never falling; equal entries are allowed */

    /* the profile: from the shortest exposure at gain_min, up to stage 0's exposure, then to its gain, then to stage
     * 1's exposure, ... none of which falls; after the last stage, up to frame_s, then gain_max, then exposure_max_s.
     * So without stages it is exposure first and gain only in the dark. 1e-9..1e4 s, 2^-10..2^16. */
    uint32_t stages; /* 0..PUPIL_SENSOR_STAGES; 0 */
    uint32_t lock;   /* 1: the setting stands still while measuring goes on; 0 */
    pupil_sensor_stage stage[PUPIL_SENSOR_STAGES];

    /* what is known of the camera and the light */
    uint32_t flash_frames; /* light that is off by more than 4.5 x far_ev must be so for more than this many frames
                            * before anything moves: strobes and lightning are shorter; 2; 0..8. Not while the first
                            * setting is looked for */
    uint32_t linear;       /* 1: values are proportional to light, as of raw sensors. Set 0 for a tone curve, companding
                            * or gamma: then nothing is taken for a wrong black level, and until the first step has
                            * shown how strongly the picture answers, steps go half the way. Frames overrule both; 1 */

    /* exposures that the camera has, where they are no multiples of a step */
    uint32_t exposure_count; /* entries of exposure_table in use; 0 (exposure_step_s)..PUPIL_SENSOR_EXPOSURE_TABLE */
    uint32_t reserved_too;   /* 0 */
    double exposure_table[PUPIL_SENSOR_EXPOSURE_TABLE]; /* seconds, never falling; 1e-9..1e4. Exposures are the ones in
                                                         * it from exposure_min_s to exposure_max_s, and exposure_min_s
                                                         * itself; exposure_step_s is not read */

    /* Day and night (setting.day_night): night from day_night_s seconds of scene_ev below night_ev on, day from as many
     * above day_ev on; at first the middle of both decides. What filters were announced to pass is left out. Put both
     * well apart: a stop or two. */
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
    PUPIL_SENSOR_SEARCHING, /* a step is due or on its way */
    PUPIL_SENSOR_CONVERGED, /* what is shown is within far_ev of the aim, and the last step is in force */
    PUPIL_SENSOR_LIMITED,   /* at the end of what the camera can: reason has the limit; or the camera does not do what
                             * is asked of it: IGNORED */
    PUPIL_SENSOR_CLIPPED,   /* more than half of the frame is clipped: the light is a guess, searching goes on */
    PUPIL_SENSOR_FLICKER,   /* converged, but on an exposure below half a mains period: lamps may show bands. Not while
                             * the frequency is undetermined */
    PUPIL_SENSOR_LOCKED     /* config.lock, or both controls manual or held */
} pupil_sensor_state;

typedef enum pupil_sensor_reason {
    PUPIL_SENSOR_NO_REASON = 0,
    PUPIL_SENSOR_WAITING,         /* the last step has not had its time yet */
    PUPIL_SENSOR_AT_EXPOSURE_MIN, /* limits: the light is beyond what this one allows */
    PUPIL_SENSOR_AT_EXPOSURE_MAX,
    PUPIL_SENSOR_AT_FRAME_PERIOD, /* exposure_max_s, had frame_rate_priority not been set */
    PUPIL_SENSOR_AT_GAIN_MIN,
    PUPIL_SENSOR_AT_GAIN_MAX,
    PUPIL_SENSOR_HIGHLIGHTS,     /* the total is lower than the key asks for, by highlight_share */
    PUPIL_SENSOR_BELOW_MAINS,    /* the exposure is shorter than half a mains period */
    PUPIL_SENSOR_LOCK,           /* config.lock */
    PUPIL_SENSOR_ALL_MANUAL,     /* both controls are manual or held */
    PUPIL_SENSOR_INVALID_FRAME,  /* this frame has no weight, or its numbers are none: nothing moved */
    PUPIL_SENSOR_REPEATED_FRAME, /* this frame has the last one's sequence and timestamp, neither 0: nothing moved */
    PUPIL_SENSOR_CLOCK_BACK,     /* this frame's timestamp is before the last one's: dt is that of the sequence, or 0 */
    PUPIL_SENSOR_FLASH,   /* off by more than 4.5 x far_ev, for no more than flash_frames so far: nothing moved */
    PUPIL_SENSOR_IGNORED, /* two large steps or more of exposure or gain were not seen in the frames: dead controls, or
                           * the camera's own automatic. They are asked again; each second `changed` is 1 */
    PUPIL_SENSOR_NONLINEAR, /* a picture that should be linear does not answer as light does (slope): a tone curve, or a
                             * wrong black level */
    PUPIL_SENSOR_HUNTING,   /* not reported any more */
    PUPIL_SENSOR_ANNOUNCED  /* a change of light that was announced is awaited: nothing else moves */
} pupil_sensor_reason;

/* What pupil_sensor_announce is about. */
typedef enum pupil_sensor_change {
    PUPIL_SENSOR_CHANGE_LIGHT = 0, /* the scene's light: lamps, a flash */
    PUPIL_SENSOR_CHANGE_FILTER,    /* what the camera passes of it: an infrared-cut filter, a grey filter, an iris */
    PUPIL_SENSOR_CHANGE_COUNT
} pupil_sensor_change;

/* Where config.day_night_s is not 0. */
typedef enum pupil_sensor_day_night {
    PUPIL_SENSOR_DAY_NIGHT_UNKNOWN = 0, /* not for long enough yet */
    PUPIL_SENSOR_DAY,
    PUPIL_SENSOR_NIGHT
} pupil_sensor_day_night;

/* Where a setting's mains_hz is from. */
typedef enum pupil_sensor_mains {
    PUPIL_SENSOR_MAINS_UNDETERMINED = 0, /* no frame has shown it yet, and many cannot: mains_hz is 0 */
    PUPIL_SENSOR_MAINS_FOUND,            /* lamps' waves were seen, and none of another frequency since */
    PUPIL_SENSOR_MAINS_CONFIGURED        /* config.mains_hz */
} pupil_sensor_mains;

/* All EV are log2. scene_ev, wanted_ev, error_ev: of the last frame with light; 0 where `frames` is 0. */
typedef struct pupil_sensor_setting {
    uint32_t size_bytes; /* abi.h */
    uint32_t reserved;
    double exposure_s;    /* to be written to the camera, as it has it */
    double gain;          /* to be written to the camera, as it has it */
    double digital;       /* total_s / (exposure_s * gain): not to be applied, frame_digital is */
    double total_s;       /* what is wanted: exposure time x gain */
    double frame_digital; /* for the frame given last, which was taken with what its info says */
    double flicker_ev; /* how much brighter lamps were in that frame than on average; frame_digital makes up for it */
    double scene_ev;   /* log2 of the light of the scene: value / (exposure_s * gain), without the beat */
    double wanted_ev;  /* log2 of what that frame's mean was to be: key, or key_at's at its light, of clip, with
                        * ev_compensation */
    double error_ev;   /* the aim minus the total wanted before this frame; positive: too dark; as far as the limits
                        * allow. Not the error of what is shown: state says whether that is within far_ev */
    double dt_s;
    uint64_t frames; /* frames with light since init */
    uint32_t state;  /* a pupil_sensor_state */
    uint32_t reason; /* a pupil_sensor_reason */
    uint32_t limits; /* mask, 1 << PUPIL_SENSOR_AT_...: every limit that an automatic control is at, whatever the state:
                      * gain is at its minimum in daylight */
    uint32_t changed; /* 1: exposure_s and gain are to be written: they changed in the last call that was not a get, or
                       * are to be written again. To be looked at after each of these calls. After init both are to be
                       * written, whatever the camera had */
    double slope;     /* of the picture's log2 over the light's, as the frames show it; 1 at first */
    uint32_t exposure_delay, gain_delay; /* frames from the one after which a setting was asked for to the first that
                                          * was taken with it, as the frames show it; 0: not known yet */
    uint32_t mains_hz;                   /* in use: 50, 60 or 0 */
    uint32_t mains;                      /* a pupil_sensor_mains */
    double mains_modulation;             /* of the rows, as the frames' exposure leaves it, 0..1, when it was last seen
                                          * in a frame; 0: never */
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

/* New settings, at any time. The wanted total stays what it is wherever the new limits allow it, so that turning a
 * control from auto to manual or back, a lock, another profile or another gain law does not move the level. Another
 * delay_frames or `linear` forgets what was learned of the camera. */
PUPIL_API int pupil_sensor_retune(pupil_sensor *sensor, const pupil_sensor_config *config);

/* Warm start, or after a pause: begins with the product of both, brought into the limits: total_s of a
 * pupil_sensor_setting saved before, with gain 1; or what the camera has now. Write the first setting after it, too.
 * PUPIL_ERR_VALUE: not positive numbers from 2^-64 to 2^64. */
PUPIL_API int pupil_sensor_start(pupil_sensor *sensor, double exposure_s, double gain);

/* The caller knows that the light of the coming frames will be `ev` stops brighter than in the last one, from one of
 * the next `within_frames` frames on; `change`: a pupil_sensor_change. The setting for that is asked for at once
 * (`changed`). Until the frames show the change, what is shown stays as it was, as far as digital_ev allows, and
 * nothing else is done; that lasts at most until the setting is in force and within_frames more have come. What did not
 * come true is taken back then, as any step of the light is. The frames in between do not count as evidence of delays
 * or of what the controls do. So the best time for the call is as many frames before the change as the controls' delay.
 *
 * A second call while a change is awaited adds to it. Before the first frame with light, and while the setting is
 * locked, there is nothing to be done. PUPIL_ERR_VALUE: ev outside -32..32, within_frames outside 1..1000, or no such
 * change. */
PUPIL_API int pupil_sensor_announce(pupil_sensor *sensor, double ev, uint32_t within_frames, uint32_t change);

/* --- a frame --- */

/* The statistics of a frame and its metadata (see above). info may be NULL, and fields of it 0, in all frames or in
 * some. Refused and nothing moved: PUPIL_ERR_STATS for what no metering can have produced of a frame with weight. */
PUPIL_API int pupil_sensor_frame(pupil_sensor *sensor, const pupil_stats *stats, const pupil_frame_info *info);

/* The same where somebody else has metered: log2 of the light of the scene (pupil_exposure.metered_ev of frames that
 * bring exposure and gain, with a calibration of 1) and the share of it that was clipped, 0..1. No highlight_share
 * here. An EV that is NaN or outside -256..256, or a share outside 0..1, makes a dead frame. */
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
