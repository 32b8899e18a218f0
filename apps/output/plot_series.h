/* apps/output/plot_series.h: a run of any length as a few thousand points that look the same. */
#ifndef PUPIL_APPS_OUTPUT_PLOT_SERIES_H
#define PUPIL_APPS_OUTPUT_PLOT_SERIES_H

#include <stddef.h>
#include <stdio.h>

#include "frame_log.h"

#define PLOT_MOST_POINTS 4000 /* more than twice the plot's width in pixels */

/* A number of an entry: its member at `offset` times `factor`, or the result of `derived`. */
typedef struct plot_value {
    size_t offset; /* of a double in frame_log_entry */
    double factor; /* 0: 1 */
    double (*derived)(const frame_log_entry *entry);
} plot_value;

/* Writes lines "time value" of the finite values, at most PLOT_MOST_POINTS: of each stretch the smallest and the
 * largest, in their order, so that no spike is lost. */
void plot_series(FILE *out, const frame_log_entry *records, size_t count, const plot_value *value);

/* Writes lines "time low high": of each stretch the lowest low and the highest high. */
void plot_band(FILE *out, const frame_log_entry *records, size_t count, const plot_value *low, const plot_value *high);

/* The range of the finite values; unchanged if there are none. */
void plot_range(const frame_log_entry *records, size_t count, const plot_value *value, double *low, double *high);

#endif
