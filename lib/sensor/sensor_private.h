/* lib/sensor/sensor_private.h: what is inside a pupil_sensor. */
#ifndef PUPIL_SENSOR_SENSOR_PRIVATE_H
#define PUPIL_SENSOR_SENSOR_PRIVATE_H

#include "flicker/mains.h"
#include "flicker/temporal.h"
#include "pupil/sensor.h"

/* Guesses at one control: what info says; what was asked for 1..16 frames before; that it does not obey. */
#define PUPIL_SENSOR_DELAYS  16
#define PUPIL_SENSOR_GUESSES (PUPIL_SENSOR_DELAYS + 2)
#define PUPIL_SENSOR_RING    32 /* twice the delays, so that frames may be missing */
#define PUPIL_SENSOR_ORDERS  10
#define PUPIL_SENSOR_SLOPES  5

/* How the camera answers (sensor_answer.c). All log2; [2]: exposure, gain. */
typedef struct pupil_sensor_answer {
    uint64_t frame;    /* counts frames, with those that were dropped; 0 before the first */
    uint64_t sequence; /* of the frame before */
    uint32_t gap;      /* frames since then */
    double asked[PUPIL_SENSOR_RING][2];
    double standing[2]; /* asked for now */
    double told[2], told_before[2];
    double unit[2];                   /* what info says is so much more than what was asked for */
    double taken[2];                  /* what the frame was taken with, by the best guess */
    double anchor[2];                 /* what stays in force if the camera does not obey */
    double low, high;                 /* total in force, by all that is not ruled out */
    double noise;                     /* of the scene, stops from frame to frame */
    double left;                      /* stops that the scene moved by itself in the frame before */
    double slope;                     /* of the picture's log2 over the light's */
    double steepest;                  /* of late: what may lie on the way, where the picture is bent unevenly */
    double seen[PUPIL_SENSOR_SLOPES]; /* slopes, the latest first */
    double gains[3];                  /* what steps of gain alone have done of what they should */
    double gain_does;                 /* ... where these agree; 1 */
    double jump, place[2];            /* what the camera does more from a gain on, which lies from there to there */
    double brighter; /* the scene, at most, since that was 0, by the quantiles that are not clipped; stops */
    double low_of[PUPIL_SENSOR_ORDERS], high_of[PUPIL_SENSOR_ORDERS]; /* of the frame before */
    uint32_t slopes;                                                  /* seen; at most 3 */
    uint32_t jumps;                                                   /* at that place, that were alike; at most 2 */
    uint32_t short_steps; /* in a row, that were as if a line were missing of each exposure; at most 2 */
    uint32_t strange;     /* steps that the picture did not follow; at most 4 */
    uint32_t alive[2];    /* masks of guesses */
    uint32_t best[2];     /* guesses */
    uint32_t delay[2];    /* found; 0: not yet */
    uint32_t in_flight;   /* the last setting may not be in force yet */
    uint32_t has_level;
    uint32_t unheard[2]; /* info says of the control what was not asked for: is_unheard */
    uint32_t dead[2];    /* the control does nothing: is_dead */
    uint32_t disobeys;   /* what is asked for is not seen, and it is not known why */
    uint32_t info_tells; /* this frame's info has both */
    uint32_t is_told;    /* and the picture has borne it out */
    float price[PUPIL_SENSOR_GUESSES][PUPIL_SENSOR_GUESSES];
} pupil_sensor_answer;

typedef struct pupil_sensor_object {
    uint64_t magic;
    pupil_sensor_config config;      /* mains_hz: that in use */
    double total_log2;               /* what is wanted */
    double set_log2;                 /* ... when the sensor's setting was last chosen */
    double least_log2, most_log2;    /* what the camera can */
    double held_exposure, held_gain; /* of controls that are not auto */
    int64_t last_timestamp_ns;
    uint32_t stamped;
    uint32_t waited;     /* frames since the last large step, at most PUPIL_SENSOR_DELAYS */
    double stride;       /* share of the way that a large step goes: halved where it turns back */
    int32_t direction;   /* of the last large step, 1 or -1; 0: at rest since, or it was a guess */
    uint32_t looking;    /* what is known is a guess: the next frame counts at once */
    uint32_t odd_frames; /* in a row that are far off on one side, before anything is done about it */
    uint32_t turns;      /* large steps that turned back, with little rest between */
    uint32_t same;       /* large steps in a row to one side, after the first */
    int32_t nudged;      /* frames since the filter moved the setting, downwards, with its sign: it may be on its way */
    int32_t jumped;      /* the same since the light seemed to jump just when that came into force */
    double mean_log2, taken_log2;            /* of the last frame: what was metered, and what it was taken with */
    double noise_ev;                         /* of the light, from frame to frame */
    uint32_t coarse;                         /* frames since the highlights had a say, downwards */
    uint32_t calm;                           /* frames of rest since the last large step */
    int32_t last_direction;                  /* of the last large step, guessed or not; 0 after some rest */
    double known_ev, known_log2, known_over; /* of the last frame not far too bright: mean, total, highlights over it */
    double odd_ev;                           /* the least that these were off by */
    double last_size, last_total_log2;       /* of the last large step: stops it was for, and where it began */
    double stood_s, patience_s;              /* seconds since the search was given up, and until it starts again */
    double band_ev; /* this far off is taken for what the camera cannot do better; 0 at first */
    pupil_mains mains;
    pupil_flicker flicker;
    pupil_sensor_answer answer;
    pupil_sensor_setting setting;
} pupil_sensor_object;

_Static_assert(sizeof(pupil_sensor_object) <= sizeof(pupil_sensor), "PUPIL_SENSOR_OBJECT_BYTES is too small");

static inline int is_near(double x, double y)
{
    return x - y < 0.05 && x - y > -0.05;
}

/* What is known of a frame's light, log2 of frame values. */
typedef struct pupil_sensor_light {
    double mean, clipped_share, black_share;
    double middle;    /* the mean without the darkest and the brightest */
    double highlight; /* the brightest that is to stay below clip; where has_highlight */
    uint32_t has_highlight, dead;
    double low[PUPIL_SENSOR_ORDERS], high[PUPIL_SENSOR_ORDERS]; /* the values of some ranks are from, to */
} pupil_sensor_light;

/* The caller's configuration as one of this version: NULL, or a sentence. */
const char *pupil_sensor_config_read(pupil_sensor_config *ours, const pupil_sensor_config *theirs);

/* The exposure and gain that the camera has for a total of at most so much; the nearest total that it can. */
void pupil_sensor_split(const pupil_sensor_object *object, double total_log2, double *exposure_s, double *gain);
double pupil_sensor_reachable(const pupil_sensor_object *object, double wanted);
double pupil_sensor_exposure_of(const pupil_sensor_config *config, double exposure_s);
double pupil_sensor_gain_of(const pupil_sensor_config *config, double gain);
/* log2 of what is left of an exposure, in log2, of which a line is missing. */
double pupil_sensor_shorter(const pupil_sensor_object *object, double exposure_log2);
/* log2 of what the camera does more for a gain's step, by what has been seen; off: stops that it is a part of, or 0. */
double pupil_sensor_jump(const pupil_sensor_answer *answer, double from, double to, double off);
/* How far the wanted total has to go so that the camera goes so far, by what it has been seen to do; half to double. */
double pupil_sensor_way(const pupil_sensor_object *object, double off);
/* The limits that the setting stands at, and the one that keeps it from going on. */
uint32_t pupil_sensor_limits(const pupil_sensor_object *object);
uint32_t pupil_sensor_limit(const pupil_sensor_object *object, int dark);

/* The mean and the highlight quantile of a frame that is partly clipped, as far as that can be guessed; and by how much
 * clip lowers the mean of such a scene where that is as wanted. */
void pupil_sensor_guess(const pupil_sensor_config *config, const pupil_sensor_light *light, double wanted, double *mean,
                        double *highlight, double *lost);

void pupil_sensor_choose(pupil_sensor_object *object, int anew);
void pupil_sensor_advance(pupil_sensor_object *object, pupil_sensor_light *light, const pupil_frame_info *info);

/* A step of the controls that was clear; [2]: log2 of exposure and gain, in force before it and after. */
typedef struct pupil_sensor_step {
    double then[2], now[2];
    double all, answer; /* stops: of both controls, in what they are known to do; of the picture */
    double left;        /* of the answer, without either */
    int is_real;        /* two frames in a row of still light, neither dark */
} pupil_sensor_step;

void pupil_sensor_learn(pupil_sensor_object *object, const pupil_sensor_step *step);

/* How the camera answers, which frames tell. */
void pupil_sensor_orders(const pupil_sensor_config *config, const pupil_stats *stats, pupil_sensor_light *light);
void pupil_sensor_answer_reset(pupil_sensor_object *object);
void pupil_sensor_answer_frame(pupil_sensor_object *object, const pupil_sensor_light *light, uint64_t sequence);
uint32_t pupil_sensor_longest_delay(const pupil_sensor_object *object);
uint32_t pupil_sensor_longest_wait(const pupil_sensor_object *object);

#endif
