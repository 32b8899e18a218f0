/* drivers/gstreamer/picture_properties.h: the properties of a picture's level, which both elements have. The element
 * holds its lock around set, get and write.
 */
#ifndef PUPIL_DRIVERS_GSTREAMER_PICTURE_PROPERTIES_H
#define PUPIL_DRIVERS_GSTREAMER_PICTURE_PROPERTIES_H

#include <gst/gst.h>

#include "metering.h"
#include "pupil/config.h"

/* An element's own begin at PICTURE_PROPERTIES_END. */
enum {
    PICTURE_AE_LOCK = 1,
    PICTURE_AE_METERING,
    PICTURE_ROI,
    PICTURE_EXPOSURE_VALUE,
    PICTURE_KEY,
    PICTURE_TAU_LIGHT,
    PICTURE_TAU_DARK,
    PICTURE_HIGHLIGHTS,
    PICTURE_AMPLIFICATION,
    PICTURE_DITHER,
    PICTURE_TONE,
    PICTURE_ACCURACY,
    PICTURE_PROPERTIES_END
};

typedef struct picture_properties {
    pupil_config config;
    metering metered;
} picture_properties;

void picture_properties_install(GObjectClass *klass);
void picture_properties_begin(picture_properties *p); /* the defaults */

/* TRUE: `id` is one of these. A text that is refused leaves the property as it is, and *refused is what would be right
 * (constant text). */
gboolean picture_properties_set(picture_properties *p, guint id, const GValue *value, const gchar **refused);
/* Says what was refused; NULL: nothing was. Without the object's lock. */
void picture_properties_report(GParamSpec *spec, const GValue *value, const gchar *refused);
gboolean picture_properties_get(picture_properties *p, guint id, GValue *value);

/* As a configuration. */
void picture_properties_write(const picture_properties *p, pupil_config *config);

#endif
