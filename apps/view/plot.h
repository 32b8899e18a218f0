/* apps/view/plot.h: the last ten seconds of the level, over the picture in the window. */
#ifndef PUPIL_APPS_VIEW_PLOT_H
#define PUPIL_APPS_VIEW_PLOT_H

#include "output/frame_log.h"
#include "paint.h"

enum { VIEW_PLOT_MOST = 4096 }; /* ten seconds at 400 frames a second; less at faster rates */

typedef struct view_plot_point {
    double time_s, metered_ev, adapted_ev, level, aimed_level;
} view_plot_point;

typedef struct view_plot {
    view_plot_point point[VIEW_PLOT_MOST]; /* a ring */
    size_t next, count;
} view_plot;

void view_plot_add(view_plot *plot, const frame_log_entry *record);

/* At the bottom of a window of that size. */
void view_plot_paint(const view_plot *plot, view_paint *p, float width, float height, float scale, double key);

#endif
