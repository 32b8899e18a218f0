/* apps/output/plot.h: --plot: the exposure over time, drawn by gnuplot. */
#ifndef PUPIL_APPS_OUTPUT_PLOT_H
#define PUPIL_APPS_OUTPUT_PLOT_H

#include <stddef.h>
#include <stdio.h>

#include "frame_log.h"
#include "pupil/error.h"

/* By the path: 1 for .png, 0 for .svg; -1 and a sentence. */
int pupil_plot_kind(const char *path, pupil_why *why);

/* Checks early what would otherwise fail at the end of a long run: the ending, the folder, an existing file that is not
 * to be replaced (unless overwrite), whether there is a gnuplot that runs. 0, or -1 and a sentence. */
int pupil_plot_check(const char *path, int overwrite, pupil_why *why);

/* Draws the records into an .svg or .png file: metered and adapted EV with the frame's range of light, the display's
 * level and the wanted one, the shares of clipped, black and white. For a camera under control the level is replaced by
 * its exposure and gain, and the errors of its frames and of the shown ones. Complete or absent. 0, or -1 and a
 * sentence. */
int pupil_plot_write(const char *path, int overwrite, const frame_log_entry *records, size_t count, const char *title,
                     pupil_why *why);

/* The same for any script: `script` writes the input for gnuplot, with a terminal for the kind of file and no
 * output. */
typedef void pupil_plot_script(FILE *out, int is_png, const void *context);
int pupil_plot_draw(const char *path, int overwrite, pupil_plot_script *script, const void *context, pupil_why *why);

#endif
