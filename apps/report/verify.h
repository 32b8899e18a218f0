/* apps/report/verify.h: the error of a run, measured on its own frames against references in higher precision. */
#ifndef PUPIL_APPS_REPORT_VERIFY_H
#define PUPIL_APPS_REPORT_VERIFY_H

#include "pupil/pupil.h"

typedef struct verify_figures {
    double log_average_error; /* largest relative error of the log-average against long double */
    int code_error;           /* largest distance of a display sample, in codes, to the double reference */
    uint64_t samples, off;    /* display samples compared, and how many differ */
    unsigned frames, means;   /* frames compared; those of them whose log-average was */
} verify_figures;

/* Adds one frame: what went in, the curve that mapped it, the RGB8 that came out (of a mosaic perhaps at half its
 * size), the statistics. Light that the trim or the metering weights leave out of the mean is compared untrimmed;
 * weighted frames, and those of which only some rows are metered, are compared by the map alone. */
void verify_frame(verify_figures *figures, const pupil_config *config, const pupil_image_const *in,
                  const pupil_curve *curve, const pupil_image_const *out, const pupil_stats *stats);

#endif
