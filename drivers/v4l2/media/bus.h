/* drivers/v4l2/media/bus.h: formats between chips (MEDIA_BUS_FMT_...) and what they are in memory. */
#ifndef PUPIL_DRIVERS_V4L2_MEDIA_BUS_H
#define PUPIL_DRIVERS_V4L2_MEDIA_BUS_H

#include <stdint.h>

typedef struct pupil_v4l2_bus_text {
    char text[24];
} pupil_v4l2_bus_text;

/* As media-ctl names it: "SRGGB10_1X10"; the number of one that is not known here. */
pupil_v4l2_bus_text pupil_v4l2_bus_name(uint32_t code);

/* The code that arrives in memory as this fourcc, if there is only one; 0: there may be others. */
uint32_t pupil_v4l2_bus_code(uint32_t fourcc);

#endif
