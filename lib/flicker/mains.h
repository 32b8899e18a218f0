/* lib/flicker/mains.h: the frequency of the mains, found from the bands that lamps leave in frames. */
#ifndef PUPIL_FLICKER_MAINS_H
#define PUPIL_FLICKER_MAINS_H

#include "pupil/stats.h"

#define PUPIL_MAINS_GROUPS 21 /* of three of the statistics' bands each */

typedef struct pupil_wave {
    double c, s; /* cosine, sine */
} pupil_wave;

/* [2]: light of 100 Hz and of 120 Hz. Sums forget: a frame counts 7/8 of the one after it. A Gram matrix of two by two
 * is stored as half its trace and a complex number, which turns twice as far as the wave. */
typedef struct pupil_mains {
    float before[PUPIL_MAINS_GROUPS];    /* log2 of the groups' light, over the mean of all, in the frame before */
    float sum[2][PUPIL_MAINS_GROUPS][2]; /* of the light's changes times the wave's changes */
    pupil_wave gram[2];                  /* of the wave's changes */
    double half[2], phase;               /* of gram; of 20 Hz, turns: the waves' are five and six times that */
    double energy, usual;                /* of the changes, each frame's scaled to 1; the mean before scaling; -1: not
                                          * known */
    double exposure_s;                   /* of the frame before */
    double modulation;                   /* of the rows, when it was last seen */
    uint32_t hz;                         /* found: 50, 60; 0: not yet */
} pupil_mains;

/* A frame, taken so many seconds after the one before. */
void pupil_mains_frame(pupil_mains *mains, const pupil_stats *stats, double exposure_s, double dt_s);

#endif
