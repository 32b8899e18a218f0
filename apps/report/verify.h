/* apps/report/verify.h: the error of a run, measured on its own frames against references in higher precision. */
#ifndef PUPIL_APPS_REPORT_VERIFY_H
#define PUPIL_APPS_REPORT_VERIFY_H

#include "pupil/pupil.h"

typedef struct verify_figures {
    double log_average_error; /* largest relative error of the log-average against long double */
    int code_error;           /* largest difference, in codes, between a display sample and the double reference */
    uint64_t samples, off;    /* display samples compared, and how many differ */
    unsigned frames, means;   /* frames compared; those whose log-average was compared, too */
} verify_figures;

/* Adds one frame: what went in, the curve that mapped it, the RGB8 that came out (of a mosaic perhaps at half its
 * size), the statistics. If the trim or the metering weights leave light out of the mean, the untrimmed mean is
 * compared. Of weighted frames, and of those that are metered only in some rows, only the map is compared. */
void verify_frame(verify_figures *figures, const pupil_config *config, const pupil_image_const *in,
                  const pupil_curve *curve, const pupil_image_const *out, const pupil_stats *stats);

#endif
