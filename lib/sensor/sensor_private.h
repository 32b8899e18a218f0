/* lib/sensor/sensor_private.h: what is inside a pupil_sensor, and how a frame goes through it, once:
 *
 *     evidence.c   what a frame says, and whether it says anything        pupil_stats -> sensor_evidence
 *     estimate.c   what was in force in it, and what the camera made of it  -> sensor_estimate
 *     plan.c       what the picture is to become: one step, or the filter  -> sensor_plan
 *     in_force.c, answer.c  what the last step did, once it is in force
 *     search.c     where the camera answers otherwise than it should: between settings that were seen -> sensor_search
 *     follow.c     which setting is asked for; path.c, exchange.c: and how it is reached
 *     split.c      a total as an exposure time and a gain that the camera has
 *     report.c     state and reason
 *     day_night.c  whether it is day
 *
 * All levels are log2. "Effect" is what the controls do to the picture, in stops of the picture, from any zero: for a
 * linear camera that is log2 of exposure time x gain. */
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
    int is_dead;   /* no weight, or no number */
    int is_number; /* the mean is one: neither clipped nor black to a great part */
    double mean;   /* without the flicker of lamps */
    double middle; /* the mean without the darkest and the brightest */
    double clipped_share, black_share;
    double full_share;         /* that may be clipped */
    double white;              /* the level at which the picture is full */
    double top, spike;         /* the highest level that has weight; the share of it there */
    double highlight;          /* the brightest that is to stay below white */
    uint32_t has_highlight;    /* it is known */
    double rank[SENSOR_RANKS]; /* some quantiles, as they are in the frame: black_level.c */
    double low[SENSOR_ORDERS]; /* some quantiles are from low to high */
    double high[SENSOR_ORDERS];
} sensor_evidence;

/* Where the picture is full, if that is below what the configuration says. */
typedef struct sensor_white {
    double level;   /* found; 0 or above: not */
    double top;     /* of a flat top when the last large step was asked for; SENSOR_FAR_AWAY: none */
    double highest; /* top of any frame since the camera was doubted */
    uint32_t is_found;
    uint32_t reserved;
} sensor_white;

/* What is added to all pixels. */
typedef struct sensor_black {
    double value;                /* 0: nothing was found */
    double candidate;            /* what the last step says it is */
    double darkest;              /* 2 % of a frame were once as dark as this; 0: no frame yet */
    double before[SENSOR_RANKS]; /* the ranks of the frame in which a large step was asked for */
} sensor_black;

/* --- estimate --- */

/* A frame of the past: by how much the picture's level had moved, and what the controls are taken to have done. */
typedef struct sensor_past {
    double least, most, done;
    double wrong_ev; /* by how much that may be wrong */
    double said;     /* by how much the metadata had moved */
    double reported[SENSOR_CONTROLS];
    uint32_t gap; /* since the frame before; 0: it was lost */
    uint32_t reserved;
} sensor_past;

typedef struct sensor_estimate {
    sensor_past past[SENSOR_RING];
    double asked[SENSOR_RING][SENSOR_CONTROLS];                 /* after frame i */
    double requested[SENSOR_CONTROLS];                          /* asked for last */
    double said[SENSOR_CONTROLS], said_before[SENSOR_CONTROLS]; /* by the metadata */
    double reported[SENSOR_CONTROLS];                           /* which of the asked settings the metadata say */
    double reported_before[SENSOR_CONTROLS];
    double unit[SENSOR_CONTROLS];     /* the metadata are so much above what was asked for */
    uint32_t still[SENSOR_CONTROLS];  /* frames in which nothing was on its way, at most SENSOR_STILL_FRAMES */
    double in_force[SENSOR_CONTROLS]; /* in this frame, by the best guess */
    double low_before[SENSOR_ORDERS], high_before[SENSOR_ORDERS];
    double noise_ev;                        /* of the scene, from frame to frame */
    double response[SENSOR_CONTROLS];       /* stops of the picture for a stop of the control */
    double effect;                          /* of what is in force */
    double scene_moved[SENSOR_RAMP_FRAMES]; /* by itself, as far as that is known; the latest first */
    double stepped;                         /* stops of the controls that came into force in this frame */
    double answered;                        /* ... and by how much the picture's level moved, where that is known */
    double unexplained;                     /* of a change of the setting, in this frame */
    uint64_t sequence;
    uint32_t frame; /* index into asked, of the next frame */
    uint32_t gap;   /* frames since the one before */
    uint32_t has_level, has_frame;
    uint32_t alive[SENSOR_CONTROLS]; /* masks of guesses */
    uint32_t best[SENSOR_CONTROLS], best_before[SENSOR_CONTROLS];
    uint32_t delay[SENSOR_CONTROLS]; /* found; 0: not yet */
    uint32_t said_frames;            /* since the metadata moved */
    uint32_t reports;                /* this frame's metadata have both */
    uint32_t is_borne_out;           /* the picture has moved as the metadata did */
    uint32_t seen;                   /* mask of controls whose answer was seen */
    uint32_t is_searching;           /* the camera did not do what was expected */
    uint32_t learned;                /* an answer was seen */
    float cost[SENSOR_GUESSES][SENSOR_GUESSES];
} sensor_estimate;

/* --- plan --- */

/* A change of light that the caller has announced. */
typedef struct sensor_announced {
    double without, with; /* the effect that is wanted until it comes, and from then on */
    double filter_ev;     /* so much of it is a filter's */
    uint32_t frames;      /* that it may still take; 0: none is awaited */
    uint32_t seen;        /* frames in a row that have it */
} sensor_announced;

typedef struct sensor_plan {
    double wanted;        /* effect that is wanted: what is shown is the picture times 2^(wanted - effect) */
    double goal;          /* ... that this frame asks for */
    double beyond;        /* goal, less what the camera can reach of it */
    double aim;           /* what the frame's mean is to be */
    double light;         /* by which the key was chosen */
    double held_back_ev;  /* by the highlights */
    double moved;         /* `wanted`, for the highlights in this frame */
    double far_ev;        /* the least that the last far frames were off by */
    double blind_ev;      /* of the last step from a frame that was no number, and to which side; 0: one since was */
    uint32_t far_frames;  /* in a row that are far off on one side */
    uint32_t near_frames; /* since the last step from far, at most a little over SENSOR_HIGHLIGHT_FRAMES */
    uint32_t is_looking;  /* what is known is a guess: the next frame counts at once */
    uint32_t is_guess;
    uint32_t slow; /* a pupil_sensor_reason for not moving */
} sensor_plan;

/* --- follow --- */

typedef struct sensor_point {
    double total; /* asked for, log2 */
    double setting[SENSOR_CONTROLS];
    double effect;
    uint32_t is_used;
    uint32_t reserved;
} sensor_point;

/* What became of the exposures that were asked for: told.c. */
typedef struct sensor_told_range {
    double told_s, low_s, high_s; /* what it is, and the shortest and the longest that was asked for */
} sensor_told_range;

typedef struct sensor_told {
    double said_before[SENSOR_CONTROLS]; /* the metadata, when the last large step was asked for */
    double unit_ev; /* the metadata are so much above what was asked for where nothing is rounded */
    uint32_t is_trusted, count, next, reserved;
    sensor_told_range range[SENSOR_TOLD_RANGES];
} sensor_told;

typedef struct sensor_search {
    double total;                   /* wanted, on the path of settings, log2 of s */
    double set;                     /* ... when the setting was chosen */
    double from[SENSOR_CONTROLS];   /* the setting before the last large step */
    double effect_from;             /* its effect */
    double pinned[SENSOR_CONTROLS]; /* a control that does not do small steps; the other one does them */
    uint32_t is_pinned[SENSOR_CONTROLS];
    uint32_t mover; /* the control that is not */
    uint32_t swaps; /* of it, in this search */
    uint32_t pinned_frames;
    double rest_wanted;  /* the effect that was wanted when the search ended, or a control was pinned */
    double step_ev;      /* between the two settings of which a search ended at one, if none is between; else 0 */
    double rest_ev;      /* what the best setting of a search that ended lacks */
    double wrong_ev;     /* the error when it was last seen to shrink */
    double wrong_wanted; /* the effect that was wanted then */
    uint32_t wrong_frames, wrong_times;
    uint32_t since;                 /* frames since the last large step, at most SENSOR_RING */
    uint32_t looks;                 /* ... and those of them that came */
    uint32_t is_large;              /* that step is not evaluated yet */
    uint32_t is_blunt;              /* what the setting did was not what was expected, in this light */
    double blunt_wanted;            /* the effect that was wanted then */
    double agreed[SENSOR_CONTROLS]; /* the last setting that did what it should */
    double agreed_effect;           /* its effect */
    double jumped_ev;               /* in the last frame in which a small step went with a large one of the picture */
    double jump_ev;                 /* the camera jumps by so much near this total */
    double jump_total;
    uint32_t is_searching, is_resting;
    uint32_t unanswered;    /* large steps in a row that did nothing */
    uint32_t deaf;          /* ... whatever was doubted since; at most 2 */
    uint32_t weak;          /* ... or less than expected */
    uint32_t next;          /* of point */
    uint32_t is_exchanging; /* one control for the other, in parts */
    sensor_point point[SENSOR_POINTS];
} sensor_search;

/* --- day and night --- */

typedef struct sensor_day_night {
    double filter_ev; /* that filters were announced to pass, more than at first */
    double beyond_s;  /* for so long it has been on the other side ... */
    uint32_t side;    /* ... which is this one; 0: on none */
    uint32_t reserved;
} sensor_day_night;

typedef struct pupil_sensor_object {
    uint64_t magic;
    pupil_sensor_config config;      /* mains_hz: that in use */
    double held_exposure, held_gain; /* of controls that are not auto */
    int64_t last_timestamp_ns;
    uint64_t last_sequence;
    uint32_t has_time;
    double rewrite_s; /* since the setting was written last to a camera that does not take it */
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

/* The caller's configuration as one of this version: NULL, or a sentence. */
const char *pupil_sensor_config_read(pupil_sensor_config *ours, const pupil_sensor_config *theirs);

/* evidence.c: from statistics, which are whole; or from a level that another program has metered. */
int pupil_sensor_evidence(const pupil_sensor_object *object, const pupil_stats *stats, sensor_evidence *evidence);
void pupil_sensor_evidence_of_level(const pupil_sensor_object *object, double mean, double clipped_share,
                                    sensor_evidence *evidence);
/* What each frame says against the white that was found; and the white that the frame after a large step shows. */
void pupil_sensor_white_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_find_white(pupil_sensor_object *object, const sensor_evidence *evidence);

/* black_level.c: what each frame says against it; before and after a step of `ev` stops. */
void pupil_sensor_black_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_black_before(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_find_black(pupil_sensor_object *object, const sensor_evidence *evidence, double ev);
/* log2 of a level without what is added to it. */
double pupil_sensor_above_black(const pupil_sensor_object *object, double level);

/* clipped_scene.c: the mean and the highlights of a frame that is partly clipped, as far as that can be guessed; and by
 * how much clipping lowers the mean of such a scene where that is `wanted`. */
void pupil_sensor_guess(const pupil_sensor_config *config, const sensor_evidence *evidence, double wanted, double *mean,
                        double *highlight, double *lost);

/* estimate.c */
void pupil_sensor_forget(pupil_sensor_object *object); /* what was learned of the camera */
void pupil_sensor_doubt(pupil_sensor_object *object);  /* half of it */
void pupil_sensor_estimate_frame(pupil_sensor_object *object, const sensor_evidence *evidence,
                                 const pupil_frame_info *info);
/* The effect of one setting beyond another's. */
double pupil_sensor_effect(const sensor_estimate *estimate, const double from[SENSOR_CONTROLS],
                           const double to[SENSOR_CONTROLS]);
/* The most that the scene moved by itself in one of the last frames. */
double pupil_sensor_unrest(const sensor_estimate *estimate);
/* A step went too far: no control does less than it should. */
void pupil_sensor_overshot(sensor_estimate *estimate);
/* Its delay counts: not that of a control that stayed for longer than any, where the other one's is known. */
int pupil_sensor_is_waited_for(const sensor_estimate *estimate, int control);
/* The longest delay that is not ruled out, of controls that are waited for. */
uint32_t pupil_sensor_longest_delay(const pupil_sensor_object *object);
/* What a step of the setting did: `expected` and `seen`, stops. */
void pupil_sensor_learn(pupil_sensor_object *object, const double from[SENSOR_CONTROLS], double expected, double seen);

/* told.c: what the camera makes of an exposure; one to ask for in its place; one to try between it and the next longer
 * one that is known. */
double pupil_sensor_told(const pupil_sensor_object *object, double exposure_s);
double pupil_sensor_told_ask(const pupil_sensor_object *object, double exposure_s);
double pupil_sensor_told_probe(const pupil_sensor_object *object, double exposure_s);
/* A large step is in force: its stops as they were asked for, by the metadata, and as seen in the picture. */
void pupil_sensor_weigh_told(pupil_sensor_object *object, double asked, double told, double seen);
/* What was asked for is in force. */
void pupil_sensor_learn_told(pupil_sensor_object *object);
void pupil_sensor_forget_told(pupil_sensor_object *object);

/* plan.c */
void pupil_sensor_plan_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
/* What a change of the light by so many stops makes of the effect that is wanted: stops more. */
double pupil_sensor_plan_for(const pupil_sensor_object *object, double ev);

/* in_force.c: the setting that was asked for last may not be in force yet; a large step of it is waited for. */
int pupil_sensor_is_on_its_way(const pupil_sensor_object *object);
int pupil_sensor_is_pending(const pupil_sensor_object *object);
/* Frames after which it is taken to be in force, with any delay. */
uint32_t pupil_sensor_wait_frames(const pupil_sensor_object *object);
/* The effect of the setting that was asked for last, once it is in force. */
double pupil_sensor_effect_asked(const pupil_sensor_object *object);

/* path.c: the ends of the path of settings, as totals and as effects. */
void pupil_sensor_path_ends(const pupil_sensor_object *object, double *least, double *most);
void pupil_sensor_reach(const pupil_sensor_object *object, double *least, double *most);
/* The effect of a total beyond that of the requested setting; and its setting. What the setting lacks of the total is
 * the digital factor's. */
double pupil_sensor_effect_of(const pupil_sensor_object *object, double total, double setting[SENSOR_CONTROLS]);
double pupil_sensor_left_of(double total, const double setting[SENSOR_CONTROLS]);
/* The total whose effect is so much beyond that of the requested setting, by what the controls are known to do. */
double pupil_sensor_total_for(const pupil_sensor_object *object, double need);

/* answer.c: what a step did, once it is in force; and whether the error shrinks. */
void pupil_sensor_answer_frame(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_watch_error(pupil_sensor_object *object);

/* search.c: the requested setting becomes a point. `need`: what it lacks. */
void pupil_sensor_remember(pupil_sensor_object *object);
void pupil_sensor_forget_points(sensor_search *search);
/* By how much a level may be wrong that highlights hold: they are known from bins. */
double pupil_sensor_doubt_ev(const pupil_sensor_object *object);
void pupil_sensor_begin_search(pupil_sensor_object *object, double need);
/* Whether it goes on, and with which control. */
void pupil_sensor_search_on(pupil_sensor_object *object, double need);
/* The total that a search asks for, where all that is known says `total`. */
double pupil_sensor_search_at(pupil_sensor_object *object, double total, double need);

/* exchange.c: whether the way to a setting goes in parts; then this part takes its place. */
int pupil_sensor_is_part_of_exchange(const pupil_sensor_object *object, double total, double setting[SENSOR_CONTROLS],
                                     double *exposure_s, double *gain);

/* follow.c */
void pupil_sensor_count_frame(pupil_sensor_object *object); /* before all else that asks whether a step is in force */
void pupil_sensor_follow(pupil_sensor_object *object, const sensor_evidence *evidence);
void pupil_sensor_begin(pupil_sensor_object *object, double total);
/* Asks for the setting with this effect, which is not judged: there is no frame that says so. */
void pupil_sensor_move_to(pupil_sensor_object *object, double effect);

/* sensor_config.c: at this frame rate, or at any where that has no priority. */
double pupil_sensor_longest_exposure(const pupil_sensor_config *config);

/* split.c: the exposure and gain that the camera has for a total of at most so much. */
void pupil_sensor_split(const pupil_sensor_object *object, double total, double *exposure_s, double *gain);
/* The darkest and the brightest setting, log2, regardless of what a search has pinned. */
void pupil_sensor_ends(const pupil_sensor_object *object, double darkest[SENSOR_CONTROLS],
                       double brightest[SENSOR_CONTROLS]);
double pupil_sensor_exposure_of(const pupil_sensor_config *config, double exposure_s);
/* ... of one that is manual or held: in half periods of the mains only where they are known. */
double pupil_sensor_held_exposure_of(const pupil_sensor_config *config, double exposure_s);
double pupil_sensor_gain_of(const pupil_sensor_config *config, double gain);
/* The limits that the setting is at, and the one that keeps it from going on. */
uint32_t pupil_sensor_limits(const pupil_sensor_object *object);
uint32_t pupil_sensor_limit(const pupil_sensor_object *object, int is_dark);

/* report.c */
void pupil_sensor_report(pupil_sensor_object *object, const sensor_evidence *evidence);

/* day_night.c */
void pupil_sensor_day_night_frame(pupil_sensor_object *object);

#endif
