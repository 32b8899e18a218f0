/* drivers/gstreamer/metering.h: what counts in a frame, as properties of an element. */
#ifndef PUPIL_DRIVERS_GSTREAMER_METERING_H
#define PUPIL_DRIVERS_GSTREAMER_METERING_H

#include <gst/gst.h>

#include "pupil/config.h"

typedef enum metering_pattern { METERING_UNIFORM = 0, METERING_CENTRE, METERING_SPOT } metering_pattern;

typedef struct metering {
    metering_pattern pattern;
    double roi[4]; /* x, y, width and height, 0..1 of the frame; where the width is 0 the pattern counts */
} metering;

/* The enumeration as GObject has it. */
GType metering_pattern_type(void);

/* ae-metering and roi. */
void metering_install(GObjectClass *klass, guint id_pattern, guint id_roi);

/* "x,y,width,height", or "" for none. 0; -1: it is neither. */
int metering_roi_set(metering *m, const gchar *text);
gchar *metering_roi_text(const metering *m); /* to be freed */

void metering_write(const metering *m, pupil_config *config);

#endif
