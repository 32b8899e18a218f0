/* drivers/gstreamer/source_properties.h: the properties of a camera's exposure, as camera_stream takes them. The
 * element holds its lock around set and get.
 */
#ifndef PUPIL_DRIVERS_GSTREAMER_SOURCE_PROPERTIES_H
#define PUPIL_DRIVERS_GSTREAMER_SOURCE_PROPERTIES_H

#include "camera_stream.h"
#include "picture_properties.h"

enum {
    SOURCE_DEVICE = PICTURE_PROPERTIES_END,
    SOURCE_SENSOR_FORMAT,
    SOURCE_AE_ENABLE,
    SOURCE_AWB_ENABLE,
    SOURCE_EXPOSURE_TIME_RANGE,
    SOURCE_GAIN_RANGE,
    SOURCE_AE_ANTIBANDING,
    SOURCE_PROPERTIES_END
};

typedef struct source_properties {
    gchar *device;
    gchar *format; /* a fourcc; "": as it is set */
    gboolean ae, awb;
    picture_properties picture;
    camera_settings camera; /* except for the picture */
} source_properties;

void source_properties_install(GObjectClass *klass);
void source_properties_begin(source_properties *p);
void source_properties_end(source_properties *p);

/* As picture_properties_set, and these call it. */
gboolean source_properties_set(source_properties *p, guint id, const GValue *value, const gchar **refused);
gboolean source_properties_get(source_properties *p, guint id, GValue *value);

void source_properties_write(const source_properties *p, camera_settings *settings);

#endif
