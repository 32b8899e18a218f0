/* lib/core/sensor_object.h: what is inside a pupil_sensor. */
#ifndef PUPIL_CORE_SENSOR_OBJECT_H
#define PUPIL_CORE_SENSOR_OBJECT_H

#include "pupil/sensor.h"

typedef struct pupil_sensor_object {
    uint64_t magic;
    pupil_sensor_config config;
    double total_log2;               /* what is wanted */
    double set_log2;                 /* ... when the sensor's setting was last chosen */
    double least_log2, most_log2;    /* what the camera can */
    double held_exposure, held_gain; /* of controls that are not auto */
    int64_t last_timestamp_ns;
    uint32_t stamped;
    uint32_t waited;   /* frames since the last large step, at most delay_frames */
    double stride;     /* share of the way that a large step goes: halved where it turns back */
    int32_t direction; /* of the last large step, 1 or -1; 0: at rest since, or it was a guess */
    uint32_t reserved;
    pupil_sensor_setting setting;
} pupil_sensor_object;

_Static_assert(sizeof(pupil_sensor_object) <= sizeof(pupil_sensor), "PUPIL_SENSOR_OBJECT_BYTES is too small");

/* What is known of a frame's light, log2 of frame values. */
typedef struct pupil_sensor_light {
    double mean, clipped_share, black_share;
    double highlight; /* the brightest that is to stay below clip; where has_highlight */
    uint32_t has_highlight, dead;
} pupil_sensor_light;

/* The exposure and gain that the camera has for a total of at most so much, where it can. */
void pupil_sensor_split(const pupil_sensor_object *object, double total_log2, double *exposure_s, double *gain);
double pupil_sensor_exposure_of(const pupil_sensor_config *config, double exposure_s);
double pupil_sensor_gain_of(const pupil_sensor_config *config, double gain);
/* The limits that the setting stands at, and the one that keeps it from going on. */
uint32_t pupil_sensor_limits(const pupil_sensor_object *object);
uint32_t pupil_sensor_limit(const pupil_sensor_object *object, int dark);

/* The mean and the highlight quantile of a frame that is partly clipped, as far as that can be guessed. */
void pupil_sensor_guess(const pupil_sensor_config *config, const pupil_sensor_light *light, double *mean,
                        double *highlight);

#endif
