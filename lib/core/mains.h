/* lib/core/mains.h: the frequency of the mains, found from the bands that lamps leave in frames. */
#ifndef PUPIL_CORE_MAINS_H
#define PUPIL_CORE_MAINS_H

#include "pupil/stats.h"

#define PUPIL_MAINS_GROUPS 21 /* of three of the statistics' bands each */

/* [2]: light of 100 Hz and of 120 Hz. Sums forget: a frame counts 7/8 of the one after it. */
typedef struct pupil_mains {
    float before[PUPIL_MAINS_GROUPS];    /* log2 of the groups' light, over the mean of all, in the frame before */
    float sum[2][PUPIL_MAINS_GROUPS][2]; /* of what it moved by times what the wave moved by: cosine, sine */
    double gram[2][3];                   /* of what the wave moved by: cosine^2, cosine x sine, sine^2 */
    double phase[2], wave[2][2];         /* of the frame before: turns; cosine, sine */
    double energy;                       /* of the moves */
    double exposure_s;                   /* of the frame before */
    double modulation;                   /* of the light, when hz was found */
    uint32_t hz;                         /* found: 50, 60; 0: not yet */
    uint32_t frames;                     /* since the last restart, up to 255 */
    uint32_t likely, times;              /* what the last frames say, and how many of them in a row */
} pupil_mains;

/* A frame, taken so many seconds after the one before. */
void pupil_mains_frame(pupil_mains *mains, const pupil_stats *stats, double exposure_s, double dt_s);

#endif
