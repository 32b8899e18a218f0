/* lib/flicker/temporal.h: temporal flicker of mains light: at some frame rates all light of a frame goes up and down by
 * some percent from frame to frame. It is found in the light of whole frames, exposure and gain divided out. */
#ifndef PUPIL_FLICKER_TEMPORAL_H
#define PUPIL_FLICKER_TEMPORAL_H
#include <stdint.h>

typedef struct pupil_flicker_light {
    double turn;        /* of the lamp's wave at the last frame */
    double off_hz;      /* the mains are never exactly at 50 or 60 */
    double wave[2];     /* cosine and sine, shares of the mean light */
    double moved, left; /* mean squares, stops: the light from frame to frame; less the wave */
    double gate;        /* share of the flicker that is reported; below 0: how long it still has to be clear */
    uint32_t gone;      /* frames that say that the lamp is off */
} pupil_flicker_light;

typedef struct pupil_flicker {
    int64_t timestamp_ns; /* of the last frame; 0: none */
    double light, exposure_s;
    double period_s, late_s;     /* of frames; of the last timestamp, against frames that are a period apart */
    double frames;               /* that period_s and late_s are from */
    double step_s;               /* to the last frame from the one before, without jitter; 0: not known */
    pupil_flicker_light lamp[2]; /* 100 and 120 Hz */
} pupil_flicker;

/* A frame: log2 of its light. An exposure of 0 is not known. */
void pupil_flicker_frame(pupil_flicker *flicker, double light, double exposure_s, int64_t timestamp_ns);
/* By how many stops a frame near the last one is brighter than the lamps' mean; 0 where nothing is certain. */
double pupil_flicker_at(const pupil_flicker *flicker, int64_t timestamp_ns);
#endif
