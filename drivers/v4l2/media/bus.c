#include "bus.h"

#include <linux/media-bus-format.h>
#include <linux/videodev2.h>
#include <stddef.h>
#include <stdio.h>

/* A format on the wires between chips, and what it is in memory, one pixel after another and packed. */
typedef struct bus_format {
    uint32_t code;
    const char *name;
    uint32_t fourcc[2];
} bus_format;

#define FOUR(a, b, c, d) v4l2_fourcc(a, b, c, d)
#define BUS(code, plain, packed)                                                                                       \
    {                                                                                                                  \
        MEDIA_BUS_FMT_##code, #code,                                                                                   \
        {                                                                                                              \
            plain, packed                                                                                              \
        }                                                                                                              \
    }

static const bus_format bus_formats[] = {
    BUS(SRGGB8_1X8, V4L2_PIX_FMT_SRGGB8, 0),
    BUS(SGRBG8_1X8, V4L2_PIX_FMT_SGRBG8, 0),
    BUS(SGBRG8_1X8, V4L2_PIX_FMT_SGBRG8, 0),
    BUS(SBGGR8_1X8, V4L2_PIX_FMT_SBGGR8, 0),
    BUS(SRGGB10_1X10, V4L2_PIX_FMT_SRGGB10, V4L2_PIX_FMT_SRGGB10P),
    BUS(SGRBG10_1X10, V4L2_PIX_FMT_SGRBG10, V4L2_PIX_FMT_SGRBG10P),
    BUS(SGBRG10_1X10, V4L2_PIX_FMT_SGBRG10, V4L2_PIX_FMT_SGBRG10P),
    BUS(SBGGR10_1X10, V4L2_PIX_FMT_SBGGR10, V4L2_PIX_FMT_SBGGR10P),
    BUS(SRGGB12_1X12, V4L2_PIX_FMT_SRGGB12, FOUR('p', 'R', 'C', 'C')),
    BUS(SGRBG12_1X12, V4L2_PIX_FMT_SGRBG12, FOUR('p', 'g', 'C', 'C')),
    BUS(SGBRG12_1X12, V4L2_PIX_FMT_SGBRG12, FOUR('p', 'G', 'C', 'C')),
    BUS(SBGGR12_1X12, V4L2_PIX_FMT_SBGGR12, FOUR('p', 'B', 'C', 'C')),
    BUS(SRGGB14_1X14, FOUR('R', 'G', '1', '4'), 0),
    BUS(SGRBG14_1X14, FOUR('G', 'R', '1', '4'), 0),
    BUS(SGBRG14_1X14, FOUR('G', 'B', '1', '4'), 0),
    BUS(SBGGR14_1X14, FOUR('B', 'G', '1', '4'), 0),
    BUS(Y8_1X8, V4L2_PIX_FMT_GREY, 0),
    BUS(Y10_1X10, V4L2_PIX_FMT_Y10, FOUR('Y', '1', '0', 'P')),
    BUS(Y12_1X12, V4L2_PIX_FMT_Y12, FOUR('Y', '1', '2', 'P')),
    BUS(RGB888_1X24, V4L2_PIX_FMT_RGB24, 0),
    BUS(UYVY8_1X16, 0, 0), /* in memory as the last chip makes it */
    BUS(YUYV8_1X16, 0, 0),
    BUS(UYVY8_2X8, 0, 0),
    BUS(YUYV8_2X8, 0, 0),
};
#define BUS_FORMATS (sizeof bus_formats / sizeof bus_formats[0])

pupil_v4l2_bus_text pupil_v4l2_bus_name(uint32_t code)
{
    pupil_v4l2_bus_text name;
    snprintf(name.text, sizeof name.text, "0x%04x", code);
    for (size_t i = 0; i < BUS_FORMATS; i++)
        if (bus_formats[i].code == code)
            snprintf(name.text, sizeof name.text, "%s", bus_formats[i].name);
    return name;
}

uint32_t pupil_v4l2_bus_code(uint32_t fourcc)
{
    for (size_t i = 0; i < BUS_FORMATS; i++)
        if (bus_formats[i].fourcc[0] == fourcc || bus_formats[i].fourcc[1] == fourcc)
            return bus_formats[i].code;
    return 0;
}
