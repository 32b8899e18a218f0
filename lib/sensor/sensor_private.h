/* lib/sensor/sensor_private.h: what is inside a pupil_sensor, and how a frame goes through it, once:
 *
 *     evidence.c   what a frame shows of the light, if anything            pupil_stats -> sensor_evidence
 *     estimate.c   which setting it was taken with, and what the controls did  -> sensor_estimate
 *     plan.c       how bright the picture should become: one step, or the filter  -> sensor_plan
 *     in_force.c, answer.c  what the last step did, once it is in force
 *     search.c     if the camera responds otherwise than it should: between settings that were seen -> sensor_search
 *     follow.c     which setting is asked for; path.c, exchange.c: how it is reached
 *     split.c      a total as an exposure time and a gain that the camera has
 *     report.c     state and reason
 *     day_night.c  whether it is day
 *
 * All levels are log2. "Effect" is what the controls do to the picture, in stops of the picture, relative to an
 * arbitrary zero: on a linear camera log2 of exposure time x gain. */
#ifndef PUPIL_SENSOR_SENSOR_PRIVATE_H
#define PUPIL_SENSOR_SENSOR_PRIVATE_H

#include "constants_private.h"
#include "flicker/mains.h"
#include "flicker/temporal.h"
#include "pupil/sensor.h"

enum { SENSOR_EXPOSURE, SENSOR_GAIN, SENSOR_CONTROLS };

/* --- evidence --- */

/* A frame's level. */
typedef struct sensor_evidence {
    int is_dead;   /* no weight, or not finite */
    int is_number; /* the mean is usable: neither mostly clipped nor black */
    double mean;   /* without the flicker of lamps */
    double middle; /* without the darkest and the brightest, to find flicker */
    double clipped_share, black_share;
    double full_share;         /* ... that is clipped, or may be: a flat top far above the key */
    double white;              /* the level at which the sensor saturates */
    double top, spike;         /* the highest level with weight; the share there, 0 if it is no spike */
    double highlight;          /* the quantile that should stay below white */
    uint32_t has_highlight;    /* highlight is known */
    double rank[SENSOR_RANKS]; /* some quantiles, before black is subtracted: black_level.c */
    double low[SENSOR_ORDERS]; /* bounds of more quantiles; equal unless clipped or black */
    double high[SENSOR_ORDERS];
} sensor_evidence;

/* The level at which the sensor saturates, if it is below the configured one. */
typedef struct sensor_white {
    double level;   /* log2; valid where is_found */
    double top;     /* flat top when the last step was asked for; SENSOR_FAR_AWAY: none */
    double highest; /* highest top since the camera was last doubted */
    uint32_t is_found;
    uint32_t reserved;
} sensor_white;

/* A wrong black level: a value that is added to all pixels. */
typedef struct sensor_black {
    double value;                /* in force; 0: none was found */
    double candidate;            /* by the last step; another one has to confirm it */
    double darkest;              /* lowest 2 % quantile of the frames so far; 0: no frame yet */
    double before[SENSOR_RANKS]; /* ranks of the frame in which the last step was asked for */
} sensor_black;

/* --- estimate --- */

/* An earlier frame: by how much the picture's level had moved (least to most), and the controls' part of that. */
typedef struct sensor_past {
    double least, most, done;
    double wrong_ev; /* possible error of least and most */
    double said;     /* movement by the metadata, of both controls together */
    double reported[SENSOR_CONTROLS];
    uint32_t gap; /* frames since the one before; 0: this frame was lost */
    uint32_t reserved;
} sensor_past;

typedef struct sensor_estimate {
    sensor_past past[SENSOR_RING];
    double asked[SENSOR_RING][SENSOR_CONTROLS];                 /* asked for after frame i, log2 */
    double requested[SENSOR_CONTROLS];                          /* asked for last */
    double said[SENSOR_CONTROLS], said_before[SENSOR_CONTROLS]; /* by the metadata, log2 */
    double reported[SENSOR_CONTROLS];                           /* the request that the metadata match */
    double reported_before[SENSOR_CONTROLS];
    double unit[SENSOR_CONTROLS];     /* stops by which the metadata exceed the request: another unit */
    uint32_t still[SENSOR_CONTROLS];  /* frames in a row without a request in flight, at most SENSOR_STILL_FRAMES */
    double in_force[SENSOR_CONTROLS]; /* the setting of this frame, by the best guess */
    double low_before[SENSOR_ORDERS], high_before[SENSOR_ORDERS];
    double noise_ev;                        /* noise of the scene from frame to frame */
    double response[SENSOR_CONTROLS];       /* stops of the picture for one stop of the control */
    double effect;                          /* of the setting in force, as seen so far */
    double scene_moved[SENSOR_RAMP_FRAMES]; /* stops a frame, without the controls' part; 0: unknown; latest first */
    double stepped;                         /* stops of the controls that came into force in this frame */
    double answered;                        /* movement of the picture in this frame; 0: unknown */
    double unexplained;                     /* stops that a change of the setting leaves unexplained */
    uint64_t sequence;
    uint32_t frame;  /* index of this frame in past and asked */
    uint32_t gap;    /* frames since the one before, as they are counted; above 1: some were lost */
    uint32_t losses; /* frames in a row before which some were lost, at most SENSOR_SLOW_FRAMES */
    uint32_t has_level, has_frame;
    uint32_t alive[SENSOR_CONTROLS]; /* bit masks of the guesses that are not ruled out */
    uint32_t best[SENSOR_CONTROLS], best_before[SENSOR_CONTROLS];
    uint32_t delay[SENSOR_CONTROLS]; /* frames; 0: not found yet */
    uint32_t said_frames;            /* frames since the metadata moved */
    uint32_t reports;                /* this frame has metadata of both controls, not stuck */
    uint32_t reports_before;         /* the frame before had them */
    uint32_t has_reported;           /* some frame had metadata */
    uint32_t is_borne_out;           /* the picture has moved as the metadata say */
    uint32_t seen;                   /* bit mask of controls whose own response was learned */
    uint32_t is_searching;           /* copy of sensor_search's */
    uint32_t learned;                /* a response was learned */
    uint32_t reserved;
    float cost[SENSOR_GUESSES][SENSOR_GUESSES];
} sensor_estimate;

/* --- plan --- */

/* A change of light that the caller has announced. */
typedef struct sensor_announced {
    double without, with; /* wanted effect until the change comes, and from then on */
    double filter_ev;     /* the part of the change that is a filter's */
    uint32_t frames;      /* how long it is still awaited; 0: none is awaited */
    uint32_t seen;        /* frames in a row that show it */
} sensor_announced;

typedef struct sensor_plan {
    double wanted;        /* effect; what is shown is the picture times 2^(wanted - effect) */
    double goal;          /* the effect that this frame asks for; `wanted` moves towards it */
    double beyond;        /* the part of the goal that is out of the camera's reach */
    double aim;           /* what the frame's mean should be */
    double light;         /* scene light by which the key was chosen */
    double held_back_ev;  /* stops by which highlights lower the level */
    double moved;         /* change of `wanted` by the highlights in this frame */
    double far_ev;        /* smallest error of these far_frames, signed */
    double blind_ev;      /* last step from a frame without a usable mean, signed; 0: one with a mean came since */
    uint32_t far_frames;  /* frames in a row that are off by more than config.far_ev on one side */
    uint32_t near_frames; /* frames since the last step from far off, at most a little over SENSOR_HIGHLIGHT_FRAMES */
    uint32_t is_looking;  /* the first setting is looked for, or the light is only a guess: no flash is waited for */
    uint32_t is_guess;
    uint32_t slow; /* a pupil_sensor_reason for not moving */
} sensor_plan;

/* --- follow --- */

/* A setting that was seen. */
typedef struct sensor_seen {
    double total; /* asked for, log2 */
    double setting[SENSOR_CONTROLS];
    double effect;
    uint32_t is_seen;
    uint32_t reserved;
} sensor_seen;

/* A range of requested exposures that the camera rounds to the same one: told.c. */
typedef struct sensor_told_range {
    double told_s, low_s, high_s; /* what the camera takes; the shortest and longest such request */
} sensor_told_range;

typedef struct sensor_told {
    double said_before[SENSOR_CONTROLS]; /* the metadata when the last large step was asked for */
    double unit_ev;                      /* stops by which the metadata exceed an unrounded request: another unit */
    uint32_t is_trusted, count, next, reserved;
    sensor_told_range range[SENSOR_TOLD_RANGES];
} sensor_told;

typedef struct sensor_search {
    double total;                   /* wanted, on the path of settings, log2 of s */
    double set;                     /* the total for which the setting was chosen */
    double from[SENSOR_CONTROLS];   /* the setting before the last large step */
    double effect_from;             /* its effect */
    double pinned[SENSOR_CONTROLS]; /* value of a control that is fixed while the other one moves */
    uint32_t is_pinned[SENSOR_CONTROLS];
    uint32_t mover;      /* the control that moves while the other one is pinned */
    uint32_t swaps;      /* changes of the mover in this search */
    double rest_wanted;  /* wanted effect when the search ended or a control was pinned */
    double step_ev;      /* stops between the two neighbouring settings at one of which a search ended; else 0 */
    double rest_ev;      /* error of the setting at which a search ended */
    double wrong_ev;     /* the error when it last shrank */
    double wrong_wanted; /* the effect that was wanted then */
    uint32_t wrong_frames, wrong_times; /* since then; doubts so far */
    uint32_t since;                     /* frames since the setting was last changed, at most SENSOR_NOISY_FRAMES */
    uint32_t looks;                     /* the same without lost frames */
    uint32_t is_large;                  /* the last change was large, and is not evaluated yet */
    uint32_t is_blunt;   /* small steps did not do what was expected in this light: the digital factor does them */
    double blunt_wanted; /* the effect that was wanted then */
    double agreed[SENSOR_CONTROLS]; /* the last setting that did what it should */
    double agreed_effect;           /* its effect */
    uint32_t is_searching, is_resting;
    uint32_t unanswered;            /* large steps in a row that did nothing */
    uint32_t deaf;                  /* the same, not reset by a doubt; at most 2 */
    uint32_t weak;                  /* the same that did less than expected; at most 2 */
    uint32_t is_restored;           /* the profile was tried again in this light */
    uint32_t pair_mover;            /* the control that moved between `pair` */
    uint32_t lost[SENSOR_CONTROLS]; /* large steps in a row after which the metadata did not move */
    uint32_t is_exchanging;         /* one control is exchanged for the other in parts */
    uint32_t is_half;               /* the next step between the ends goes to their middle */
    sensor_seen low, high;          /* the ends: the brightest that was too dark, the darkest that was not */
    sensor_seen pair[2];            /* the ends between which the other control took over */
} sensor_search;

/* --- day and night --- */

typedef struct sensor_day_night {
    double filter_ev; /* stops by announced filters since the first frame */
    double beyond_s;  /* how long the light has been on the other side */
    uint32_t side;    /* that side, a pupil_sensor_day_night; 0: none */
    uint32_t reserved;
} sensor_day_night;

typedef struct pupil_sensor_object {
    uint64_t magic;
    pupil_sensor_config config;      /* mains_hz: the one in use */
    double held_exposure, held_gain; /* values of controls that are manual or held */
    int64_t last_timestamp_ns;
    uint64_t last_sequence;
    uint32_t has_time;
    double rewrite_s; /* since the last write to a camera that does not respond, or is at a limit */
    sensor_white white;
    sensor_black black;
    sensor_estimate estimate;
    sensor_plan plan;
    sensor_announced announced;
    sensor_day_night day_night;
    sensor_search search;
    sensor_told told;
    pupil_mains mains;
    pupil_flicker flicker;
    pupil_sensor_setting setting;
} pupil_sensor_object;

_Static_assert(sizeof(pupil_sensor_object) <= sizeof(pupil_sensor), "PUPIL_SENSOR_OBJECT_BYTES is too small");

static inline double size_of(double x)
{
    return x < 0.0 ? -x : x;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* Copies the caller's configuration into one of this version. NULL, or what is wrong. */
const char *pupil_sensor_config_read(pupil_sensor_config *ours, const pupil_sensor_config *theirs);

/* evidence.c: from complete statistics, or from a level that another program has metered. */
int pupil_sensor_evidence(const pupil_sensor_object *object, const pupil_stats *stats, sensor_evidence *evidence);
void pupil_sensor_evidence_of_level(const pupil_sensor_object *object, double mean, double clipped_share,
                                    sensor_evidence *evidence);
/* Drops the white that was found if a frame contradicts it; finds white in the frame after a large step. */
void pupil_sensor_white_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_find_white(pupil_sensor_object *object, const sensor_evidence *evidence);

/* black_level.c: drops the level that was found if a frame contradicts it; before, and after, a step of `ev` stops. */
void pupil_sensor_black_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_black_before(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_find_black(pupil_sensor_object *object, const sensor_evidence *evidence, double ev);
/* A level, log2, without the wrong black level. */
double pupil_sensor_above_black(const pupil_sensor_object *object, double level);

/* clipped_scene.c: estimates the mean and the highlights of a partly clipped frame; and by how much clipping will lower
 * the mean of such a scene when the mean is `wanted`. */
void pupil_sensor_guess(const pupil_sensor_config *config, const sensor_evidence *evidence, double wanted, double *mean,
                        double *highlight, double *lost);

/* estimate.c */
void pupil_sensor_forget(pupil_sensor_object *object); /* all that was learned of the camera */
void pupil_sensor_doubt(pupil_sensor_object *object);  /* half of that */
void pupil_sensor_estimate_frame(pupil_sensor_object *object, const sensor_evidence *evidence,
                                 const pupil_frame_info *info);
/* The effect of `to`, less that of `from`. */
double pupil_sensor_effect(const sensor_estimate *estimate, const double from[SENSOR_CONTROLS],
                           const double to[SENSOR_CONTROLS]);
/* The most that the scene moved by itself in one of the last frames. */
double pupil_sensor_unrest(const sensor_estimate *estimate);
/* A step went too far: no control is taken to do less than it should. */
void pupil_sensor_overshot(sensor_estimate *estimate);
/* Whether a control's delay is waited for: not if it was constant for longer than any delay, and the other
 * one's is known. */
int pupil_sensor_is_waited_for(const sensor_estimate *estimate, int control);
/* The longest delay that is not ruled out, of controls that are waited for. */
uint32_t pupil_sensor_longest_delay(const pupil_sensor_object *object);
/* Learns the responses from a step: its effect as `expected` and as `seen`, stops. */
void pupil_sensor_learn(pupil_sensor_object *object, const double from[SENSOR_CONTROLS], double expected, double seen);

/* told.c: the exposure that the camera takes for a request; the request to send in its place; one to try between it and
 * the next longer one that is known. */
double pupil_sensor_told(const pupil_sensor_object *object, double exposure_s);
double pupil_sensor_told_ask(const pupil_sensor_object *object, double exposure_s);
double pupil_sensor_told_probe(const pupil_sensor_object *object, double exposure_s);
/* A large step is in force: compares its stops by the request, the metadata and the picture. */
void pupil_sensor_weigh_told(pupil_sensor_object *object, double asked, double told, double seen);
/* The requested exposure is in force: remembers what became of it. */
void pupil_sensor_learn_told(pupil_sensor_object *object);
void pupil_sensor_forget_told(pupil_sensor_object *object);

/* plan.c */
void pupil_sensor_plan_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
/* Stops by which the wanted effect changes if the light changes by `ev`. */
double pupil_sensor_plan_for(const pupil_sensor_object *object, double ev);

/* in_force.c: whether the last request may not be in force yet; whether it is a large step, which is waited for. */
int pupil_sensor_is_on_its_way(const pupil_sensor_object *object);
int pupil_sensor_is_pending(const pupil_sensor_object *object);
/* Frames after which it is taken to be in force, with any delay. */
uint32_t pupil_sensor_wait_frames(const pupil_sensor_object *object);
/* The effect of the setting that was asked for last, once it is in force. */
double pupil_sensor_effect_asked(const pupil_sensor_object *object);

/* path.c: the ends of the path of settings, as totals and as effects. */
void pupil_sensor_path_ends(const pupil_sensor_object *object, double *least, double *most);
void pupil_sensor_reach(const pupil_sensor_object *object, double *least, double *most);
/* The effect of a total, less that of the requested setting; and the setting for it. What that setting lacks of the
 * total is left to the digital factor. */
double pupil_sensor_effect_of(const pupil_sensor_object *object, double total, double setting[SENSOR_CONTROLS]);
double pupil_sensor_left_of(double total, const double setting[SENSOR_CONTROLS]);
/* The total whose effect is `need` more than that of the requested setting, by the learned responses. */
double pupil_sensor_total_for(const pupil_sensor_object *object, double need);

/* answer.c: what a step did, once it is in force; and whether the error shrinks. */
void pupil_sensor_answer_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_watch_error(pupil_sensor_object *object);

/* search.c: remembers the requested setting as an end, once it is in force. `need`: the effect that it lacks. */
void pupil_sensor_remember(pupil_sensor_object *object);
void pupil_sensor_forget_ends(sensor_search *search);
/* By how much a level that highlights hold may be wrong: highlights are known from bins. */
double pupil_sensor_doubt_ev(const pupil_sensor_object *object);
void pupil_sensor_begin_search(pupil_sensor_object *object, double need);
/* Decides whether a search continues, and with which control. */
void pupil_sensor_search_on(pupil_sensor_object *object, double need);
/* The total that a search asks for in place of `total`, which the learned responses give. */
double pupil_sensor_search_at(pupil_sensor_object *object, double total, double need);

/* exchange.c: whether the controls are exchanged in parts; the next part then replaces the setting. */
int pupil_sensor_is_part_of_exchange(const pupil_sensor_object *object, double total, double setting[SENSOR_CONTROLS],
                                     double *exposure_s, double *gain);

/* follow.c */
void pupil_sensor_count_frame(pupil_sensor_object *object); /* before anything asks whether a step is in force */
void pupil_sensor_follow(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_begin(pupil_sensor_object *object, double total);
/* Asks for the setting with this effect. The step is not evaluated: no frame asked for it. */
void pupil_sensor_move_to(pupil_sensor_object *object, double effect);

/* sensor_config.c: within the frame period if the frame rate has priority. */
double pupil_sensor_longest_exposure(const pupil_sensor_config *config);

/* split.c: an exposure and a gain that the camera has, for a total. */
void pupil_sensor_split(const pupil_sensor_object *object, double total, double *exposure_s, double *gain);
/* ... regardless of what a search has pinned. */
void pupil_sensor_split_freely(const pupil_sensor_object *object, double total, double *exposure_s, double *gain);
/* The darkest and the brightest setting, log2, regardless of what a search has pinned. */
void pupil_sensor_ends(const pupil_sensor_object *object, double darkest[SENSOR_CONTROLS],
                       double brightest[SENSOR_CONTROLS]);
double pupil_sensor_exposure_of(const pupil_sensor_config *config, double exposure_s);
/* ... if it is manual or held: in half mains periods only where the frequency is known. */
double pupil_sensor_held_exposure_of(const pupil_sensor_config *config, double exposure_s);
double pupil_sensor_gain_of(const pupil_sensor_config *config, double gain);
/* The limits that the setting is at; and the one that keeps the aim out of reach. */
uint32_t pupil_sensor_limits(const pupil_sensor_object *object);
uint32_t pupil_sensor_limit(const pupil_sensor_object *object, int is_dark);

/* report.c */
void pupil_sensor_report(pupil_sensor_object *object, const sensor_evidence *evidence);

/* day_night.c */
void pupil_sensor_day_night_frame(pupil_sensor_object *object);

#endif
