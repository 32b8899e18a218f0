/* A small camera to close the loop with: linear, 12 bits, a log-normal scene, quantised controls that come late. */
#ifndef PUPIL_TESTS_SENSOR_PLANT_H
#define PUPIL_TESTS_SENSOR_PLANT_H

#include <math.h>

#include "check.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { PLANT_WIDTH = 64, PLANT_HEIGHT = 16, PLANT_PIXELS = PLANT_WIDTH * PLANT_HEIGHT, PLANT_RING = 32 };

#define PLANT_LINE_S 18.9e-6
#define PLANT_SIGMA  1.3 /* stops, of the scene */

/* What info says of a frame. */
enum {
    PLANT_TRUTH,
    PLANT_ASKED /* what was asked for last */,
    PLANT_NOTHING,
    PLANT_FIRST /* what was at first */,
    PLANT_IN_FORCE /* of a control that ignores requests, too */
};

typedef struct plant {
    double light_ev;          /* log-average of the scene: value of a frame of 1 s and gain 1 */
    double noise_ev;          /* standard deviation of the metered light */
    uint32_t delay[2];        /* frames from the measured one to the first that shows the reaction: exposure, gain */
    int lies;                 /* a plant_info */
    double slope;             /* slope of the picture's log2 against the light's; 1: linear */
    int shoulder;             /* the picture's curve has a shoulder, too, up to white */
    int ignored[2];           /* the control ignores requests */
    int off_by_one;           /* exposures are this many lines longer than asked for, at least one line */
    double shortens;          /* exposures are shorter by this share of the gain's stops */
    double moving;            /* exposures are this many times as long where the gain is 2 or more; 0: off */
    double wrap;              /* gains from here on begin at 1 again; 0: off */
    double jitter;            /* share of the settings that come a frame later */
    uint8_t late[PLANT_RING]; /* whether the setting of frame i % PLANT_RING does */
    int pixels;               /* of the scene, whole rows */
    uint64_t busy;            /* a setting written within so many frames of the last one is lost; 0: off */
    uint64_t written;         /* the frame after which the last one was */
    double drops;             /* share of the frames that are lost on their way */
    double frame_s;
    uint64_t frame;
    double asked[PLANT_RING][2]; /* after frame i % PLANT_RING: exposure, gain */
    double at_first[2];
    double scene[PLANT_PIXELS]; /* log2, mean 0; the caller's until the first frame */
    float light[PLANT_PIXELS];  /* 2^(light_slope x scene): the scene as it is metered */
    double light_slope;         /* 0: not made yet */
    pupil_t meter;
} plant;

static inline double plant_normal(void)
{
    double u = 1.0 - check_uniform(), v = check_uniform();
    return sqrt(-2.0 * log(u)) * cos(2.0 * 3.14159265358979323846 * v);
}

/* x below which a share p of a normal distribution is, by Newton's method. */
static inline double plant_quantile(double p)
{
    double x = 0.0;
    for (int i = 0; i < 50; i++) {
        const double off = (0.5 * erfc(-x / sqrt(2.0)) - p) / (exp(-0.5 * x * x) / sqrt(2.0 * 3.14159265358979323846));
        x -= fmax(-0.5, fmin(0.5, off)); /* in the tails, where the density is small, a step would diverge */
    }
    return x;
}

static inline void plant_open(plant *p, const pupil_sensor *sensor, double light_ev, uint32_t delay)
{
    pupil_config config;
    pupil_sensor_setting s;
    memset(p, 0, sizeof *p);
    p->light_ev = light_ev;
    p->delay[0] = p->delay[1] = delay;
    p->frame_s = 1.0 / 30.0;
    p->slope = 1.0;
    p->pixels = PLANT_PIXELS;
    static double quantile[PLANT_PIXELS]; /* the same for all plants */
    if (quantile[0] == 0.0)
        for (int i = 0; i < PLANT_PIXELS; i++)
            quantile[i] = PLANT_SIGMA * plant_quantile((i + 0.5) / PLANT_PIXELS);
    for (int i = 0; i < PLANT_PIXELS; i++) { /* every quantile once, in any order */
        const int j = (int)(check_random() % (uint64_t)(i + 1));
        p->scene[i] = p->scene[j];
        p->scene[j] = quantile[i];
    }
    CHECK(pupil_sensor_get(sensor, &s) == PUPIL_OK);
    for (int i = 0; i < PLANT_RING; i++)
        p->asked[i][0] = p->at_first[0] = s.exposure_s, p->asked[i][1] = p->at_first[1] = s.gain;
    pupil_config_default(&config);
    config.histogram = 1;
    CHECK(pupil_init(&p->meter, &config) == PUPIL_OK);
}

/* The value of the camera's register for the next frame. */
static inline double plant_register(const plant *p, int control)
{
    const uint64_t newest = p->frame + PLANT_RING - p->delay[control];
    return p->asked[(newest - (p->late[newest % PLANT_RING] != 0)) % PLANT_RING][control];
}

/* The value in force in the next frame. */
static inline double plant_in_force(const plant *p, int control)
{
    double gain = p->ignored[1] ? p->at_first[1] : plant_register(p, 1);
    double exposure = p->ignored[0] ? p->at_first[0] : plant_register(p, 0);
    gain = p->wrap > 0.0 && gain >= p->wrap ? gain / p->wrap : gain;
    exposure = p->off_by_one ? fmax(exposure + p->off_by_one * PLANT_LINE_S, PLANT_LINE_S) : exposure;
    exposure *= p->shortens > 0.0 ? exp2(-p->shortens * log2(gain)) : 1.0;
    exposure *= p->moving > 0.0 && gain >= 2.0 ? p->moving : 1.0;
    return control ? gain : exposure;
}

/* The picture's log2 (of its range) where the light's is x. */
static inline double plant_bent(const plant *p, double x)
{
    x *= p->slope;
    return p->shoulder ? x - log2(0.82 + exp2(x)) : x; /* grey, 0.18, stays */
}

static inline double plant_tells(const plant *p, int control)
{
    switch (p->lies) {
    case PLANT_ASKED:
        return p->asked[(p->frame + PLANT_RING - 1) % PLANT_RING][control];
    case PLANT_NOTHING:
        return 0.0;
    case PLANT_FIRST:
        return p->at_first[control];
    case PLANT_IN_FORCE:
        return plant_in_force(p, control);
    default:
        return plant_register(p, control);
    }
}

/* The next frame's statistics. */
static inline pupil_frame_info plant_next(plant *p, pupil_stats *stats)
{
    static uint16_t codes[PLANT_PIXELS];
    const double ev = p->light_ev + log2(plant_in_force(p, 0) * plant_in_force(p, 1)) + p->noise_ev * plant_normal();
    const uint32_t rows = (uint32_t)(p->pixels / PLANT_WIDTH);
    pupil_image_const image = {.data = codes,
                               .stride_bytes = PLANT_WIDTH * 2,
                               .width = PLANT_WIDTH,
                               .height = rows,
                               .pixel = PUPIL_PIXEL_GREY12};
    pupil_frame_info info = {.timestamp_ns = 1000000000 + (int64_t)((double)p->frame * p->frame_s * 1e9),
                             .sequence = p->frame,
                             .exposure_s = plant_tells(p, 0),
                             .gain = plant_tells(p, 1)};
    for (int i = 0; i < PLANT_PIXELS && p->light_slope != p->slope; i++)
        p->light[i] = (float)exp2(p->slope * p->scene[i]);
    p->light_slope = p->slope;
    const float all = (float)exp2(p->slope * ev);
    for (int i = 0; i < p->pixels; i++) { /* plant_bent without its logarithms */
        const float x = all * p->light[i], code = 4095.0f * (p->shoulder ? x / (0.82f + x) : x) + 0.5f;
        codes[i] = (uint16_t)(code < 4095.0f ? code : 4095.0f);
    }
    pupil_stats_clear(stats);
    CHECK(pupil_meter_rows(&p->meter, &image, 0, rows, stats) == PUPIL_OK);
    return info;
}

/* After the frame has been measured: asks the camera for the controller's setting. */
static inline void plant_ask(plant *p, const pupil_sensor_setting *s)
{
    const int is_kept = p->busy && (!s->changed || p->frame < p->written + p->busy);
    const double *last = p->asked[(p->frame + PLANT_RING - 1) % PLANT_RING];
    p->written = s->changed && !is_kept ? p->frame : p->written;
    p->asked[p->frame % PLANT_RING][0] = is_kept ? last[0] : s->exposure_s;
    p->asked[p->frame % PLANT_RING][1] = is_kept ? last[1] : s->gain;
    p->late[p->frame % PLANT_RING] = p->jitter > 0.0 && check_uniform() < p->jitter;
    p->frame++;
}

/* One frame of the loop. Returns how many stops too bright the sensor took it; *shown: the same with the digital
 * factor. */
static inline double plant_turn(plant *p, pupil_sensor *sensor, pupil_sensor_setting *s, double *shown)
{
    static pupil_stats stats;
    const double light = p->light_ev + log2(plant_in_force(p, 0) * plant_in_force(p, 1));
    const double off = light - log2(0.18);
    const double drawn = p->drops > 0.0 ? check_uniform() : 1.0;
    const pupil_frame_info info = plant_next(p, &stats);
    if (drawn >= p->drops)
        CHECK(pupil_sensor_frame(sensor, &stats, &info) == PUPIL_OK);
    CHECK(pupil_sensor_get(sensor, s) == PUPIL_OK);
    if (shown)
        *shown = plant_bent(p, light) - log2(0.18) + log2(s->frame_digital);
    plant_ask(p, s);
    return off;
}

enum { LAW_FINE, LAW_DB, LAW_SIXTEENTH, LAW_THIRD, LAWS };
static const char *const law_name[LAWS] = {"256/(256-n)", "0.3 dB", "n/16", "1/3 stop"};

/* A camera of 30 frames a second with one of four gain laws, up to 22 times; in daylight, so that the profile is the
 * plain one: exposure first, in lines, then gain. */
static inline pupil_sensor_config plant_config(int law)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.mains_hz = 0;
    c.exposure_min_s = PLANT_LINE_S;
    c.exposure_step_s = PLANT_LINE_S;
    c.gain_max = 22.0;
    c.gain_law = law == LAW_FINE        ? PUPIL_GAIN_RECIPROCAL
                 : law == LAW_DB        ? PUPIL_GAIN_DB
                 : law == LAW_SIXTEENTH ? PUPIL_GAIN_LINEAR
                                        : PUPIL_GAIN_TABLE;
    c.gain_step = law == LAW_FINE ? 256.0 : law == LAW_DB ? 0.3 : 1.0 / 16.0;
    c.gain_count = 14;
    for (int i = 0; i < 14; i++)
        c.gain_table[i] = exp2(i / 3.0);
    return c;
}

#endif
