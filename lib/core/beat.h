/* lib/core/beat.h: the beat of mains light with the frame rate: all light goes up and down by some percent, at a
 * frequency that only the lamps (100 or 120 Hz) and the frames' times make. It is found in the light of whole frames,
 * exposure and gain divided out, and told for each frame, so that it can be taken out of it. */
#ifndef PUPIL_CORE_BEAT_H
#define PUPIL_CORE_BEAT_H

#include <stdint.h>

#define PUPIL_BEAT_LAMPS     2 /* 100 and 120 Hz */
#define PUPIL_BEAT_HARMONICS 2 /* the wave of a lamp, and twice its frequency, as of a rectified sine */

typedef struct pupil_beat_lamp {
    double turn;                          /* of the lamp's wave at the last frame, in turns */
    double off_hz;                        /* the mains are never exactly at 50 or 60 */
    double wave[PUPIL_BEAT_HARMONICS][2]; /* cosine and sine, shares of the mean light */
    double moved, left;                   /* mean squares, stops: the light from frame to frame; less the wave */
    double age;                           /* how often it could have been learned anew; at most BEAT_OLD */
    double gate;                          /* share of the beat that is told, 0..1 */
    uint32_t gone;                        /* frames that say that the lamp is off */
    uint32_t reserved;
} pupil_beat_lamp;

typedef struct pupil_beat {
    int64_t timestamp_ns; /* of the last frame; 0: none */
    double light;         /* log2 */
    double exposure_s;
    double period_s; /* of frames */
    double late_s;   /* of the last frame's timestamp, against frames that are a period apart */
    double frames;   /* that period and lateness are from; at most CLOCK_FRAMES */
    pupil_beat_lamp lamp[PUPIL_BEAT_LAMPS];
} pupil_beat;

/* A frame: log2 of its light. An exposure of 0 is not known. */
void pupil_beat_frame(pupil_beat *beat, double light, double exposure_s, int64_t timestamp_ns);

/* By how many stops a frame near the last one is brighter than the lamps' mean; 0 where nothing is certain. */
double pupil_beat_at(const pupil_beat *beat, int64_t timestamp_ns);

#endif
