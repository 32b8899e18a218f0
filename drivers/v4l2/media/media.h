/* drivers/v4l2/media/media.h: what is behind a video node: the media graph, up to the sensor. */
#ifndef PUPIL_DRIVERS_V4L2_MEDIA_MEDIA_H
#define PUPIL_DRIVERS_V4L2_MEDIA_MEDIA_H

#include "pupil/error.h"
#include "v4l2/device.h"
#include "v4l2/format.h"

typedef struct pupil_v4l2_sensor {
    char media[32];  /* /dev/media0 */
    char entity[64]; /* as media-ctl names it: "imx219 10-0010" */
    char path[64];   /* /dev/v4l-subdev3, whose controls are the sensor's */
} pupil_v4l2_sensor;

/* The sensor that feeds a video node, along the links that are enabled. 0, or -1 and a sentence: the node has no media
 * graph (as webcams, whose controls are the node's own), or no sensor is linked to it. */
int pupil_v4l2_media_sensor(const pupil_v4l2_device *device, pupil_v4l2_sensor *sensor, pupil_why *why);

/* Why a node with this format does not start, as the end of a sentence. It names the first link on its way to the
 * sensor, or else of its graph, that is off or whose ends differ. It has the media-ctl line that corrects it. 0, or -1:
 * there is no graph. */
int pupil_v4l2_media_mend(const pupil_v4l2_device *device, const pupil_v4l2_format *format, char *mend,
                          size_t mend_bytes);

#endif
