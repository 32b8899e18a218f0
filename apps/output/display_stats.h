/* apps/output/display_stats.h: figures of a display frame. */
#ifndef PUPIL_APPS_OUTPUT_DISPLAY_STATS_H
#define PUPIL_APPS_OUTPUT_DISPLAY_STATS_H

#include "pupil/image.h"

#define DISPLAY_STATS_LOWEST (0.5 / 255.0 / 12.92) /* linear light of half the lowest sRGB code (IEC 61966-2-1) */

typedef struct display_stats {
    double level;       /* log-average luminance, linear 0..1; a black pixel counts as half of the lowest code */
    double black_share; /* of the 8-bit samples, 0..1: at code 0 */
    double white_share; /* at code 255 */
} display_stats;

/* Of an RGB8 sRGB image. */
display_stats display_stats_measure(const pupil_image_const *rgb8);

#endif
