#include "modes.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "format.h"

/* Enumerations end by themselves; this is a limit for drivers whose do not. */
#define MOST_MODES 128u
#define MOST_SIZES 256u

static double rate_of(struct v4l2_fract interval)
{
    return interval.numerator ? (double)interval.denominator / interval.numerator : 0.0;
}

static void add_rate(pupil_live_size *size, double fps)
{
    uint32_t i = size->rates;
    if (!(fps > 0.0))
        return;
    for (uint32_t k = 0; k < size->rates; k++)
        if (size->fps[k] == fps)
            return;
    if (size->rates == PUPIL_LIVE_MOST_RATES)
        return;
    for (; i > 0 && size->fps[i - 1] > fps; i--)
        size->fps[i] = size->fps[i - 1];
    size->fps[i] = fps;
    size->rates++;
}

static void read_rates(const pupil_v4l2_device *device, uint32_t fourcc, pupil_live_size *size)
{
    for (uint32_t i = 0; i < 4 * PUPIL_LIVE_MOST_RATES; i++) {
        struct v4l2_frmivalenum interval = {
            .index = i, .pixel_format = fourcc, .width = size->max_width, .height = size->max_height};
        if (pupil_v4l2_ask(device, VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0)
            return;
        if (interval.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
            add_rate(size, rate_of(interval.discrete));
            continue;
        }
        add_rate(size, rate_of(interval.stepwise.max));
        add_rate(size, rate_of(interval.stepwise.min));
        size->fps_between = size->rates == 2;
        return;
    }
}

static int read_sizes(const pupil_v4l2_device *device, pupil_live_mode *mode)
{
    for (uint32_t i = 0; i < MOST_SIZES; i++) {
        struct v4l2_frmsizeenum s = {.index = i, .pixel_format = mode->fourcc};
        if (pupil_v4l2_ask(device, VIDIOC_ENUM_FRAMESIZES, &s) != 0)
            return 0; /* the end, or a driver that does not report it */
        pupil_live_size *size = pupil_live_mode_add_size(mode);
        if (!size)
            return -1;
        *size = (pupil_live_size){.width = s.discrete.width, .height = s.discrete.height};
        if (s.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
            const struct v4l2_frmsize_stepwise *w = &s.stepwise;
            *size = (pupil_live_size){.width = w->min_width,
                                      .height = w->min_height,
                                      .max_width = w->max_width,
                                      .max_height = w->max_height,
                                      .step_width = w->step_width,
                                      .step_height = w->step_height};
        } else {
            size->max_width = size->width;
            size->max_height = size->height;
        }
        read_rates(device, mode->fourcc, size);
        if (s.type != V4L2_FRMSIZE_TYPE_DISCRETE)
            return 0;
    }
    return 0;
}

int pupil_v4l2_modes_read(const pupil_v4l2_device *device, pupil_live_modes *modes, pupil_why *why)
{
    *modes = (pupil_live_modes){0};
    for (uint32_t i = 0; i < MOST_MODES; i++) {
        struct v4l2_fmtdesc d = {.index = i, .type = device->type};
        if (pupil_v4l2_ask(device, VIDIOC_ENUM_FMT, &d) != 0) {
            if (errno == EINVAL || (errno == ENOTTY && i == 0))
                return 0;
            return pupil_v4l2_failed(device, "does not report its formats", errno, why);
        }
        pupil_live_mode *mode = pupil_live_modes_add(modes);
        if (mode) {
            mode->fourcc = d.pixelformat;
            mode->read = pupil_v4l2_is_read(d.pixelformat);
            mode->compressed = (d.flags & V4L2_FMT_FLAG_COMPRESSED) != 0;
            snprintf(mode->name, sizeof mode->name, "%s", pupil_v4l2_fourcc_name(d.pixelformat).text);
            snprintf(mode->description, sizeof mode->description, "%.31s", (const char *)d.description);
        }
        if (!mode || read_sizes(device, mode))
            return pupil_v4l2_failed(device, "its list of formats", ENOMEM, why);
    }
    return 0;
}
