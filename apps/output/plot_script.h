/* apps/output/plot_script.h: a run's records as a script for gnuplot, with its data. */
#ifndef PUPIL_APPS_OUTPUT_PLOT_SCRIPT_H
#define PUPIL_APPS_OUTPUT_PLOT_SCRIPT_H

#include <stddef.h>
#include <stdio.h>

#include "frame_log.h"

void plot_script(FILE *out, int is_png, const frame_log_entry *records, size_t count, const char *title);

#endif
