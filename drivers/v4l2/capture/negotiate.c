/* drivers/v4l2/capture/negotiate.c: which format, size and rate a camera is to stream with. */
#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "capture.h"
#include "refuse.h"
#include "v4l2/modes.h"

#define RATE_TOLERANCE 0.02 /* of the rate asked for: 29.97 is 30, 25 is not */

static uint32_t fourcc_of(const struct v4l2_format *f)
{
    return f->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat;
}

/* Lists the camera's formats, "YUYV, MJPG", or those of them that are read; returns the first that is read natively,
 * else the first JPEG, which costs a decoder's time and its losses, or 0. */
static uint32_t look_over(const pupil_v4l2_device *d, int all, char *names, size_t names_bytes)
{
    uint32_t first = 0, first_jpeg = 0;
    *names = 0;
    for (uint32_t i = 0; i < 128; i++) {
        struct v4l2_fmtdesc description = {.index = i, .type = d->type};
        if (pupil_v4l2_ask(d, VIDIOC_ENUM_FMT, &description) != 0)
            break;
        const uint32_t fourcc = description.pixelformat;
        const size_t used = strlen(names);
        if (all || pupil_v4l2_is_read(fourcc))
            snprintf(names + used, names_bytes - used, "%s%s", used ? ", " : "", pupil_v4l2_fourcc_name(fourcc).text);
        uint32_t *found = pupil_v4l2_pixel_of(fourcc) ? &first : &first_jpeg;
        if (!*found && pupil_v4l2_is_read(fourcc))
            *found = fourcc;
    }
    return first ? first : first_jpeg;
}

static uint32_t choose(const pupil_v4l2_capture *c, const struct v4l2_format *set, pupil_why *why)
{
    char names[400];
    const uint32_t asked = c->options.fourcc;
    if (asked && !pupil_v4l2_is_read(asked)) {
        pupil_refuse(why, "%s: format %s is not supported; supported: %s", c->device.path,
                     pupil_v4l2_fourcc_name(asked).text, pupil_v4l2_natives);
        return 0;
    }
    if (asked || pupil_v4l2_pixel_of(fourcc_of(set)))
        return asked ? asked : fourcc_of(set);
    const uint32_t first = look_over(&c->device, 1, names, sizeof names);
    if (!first)
        pupil_refuse(why, "%s: %s offers %s, which is not supported; supported: %s", c->device.path, c->device.name,
                     *names ? names : "no format", pupil_v4l2_natives);
    return first;
}

/* The sizes or rates of a format, for a sentence; empty where the driver does not report them. */
static void offers(const pupil_v4l2_capture *c, uint32_t fourcc, char *text, size_t text_bytes)
{
    pupil_live_modes modes;
    pupil_why unused;
    *text = 0;
    pupil_v4l2_modes_read(&c->device, &modes, &unused);
    for (uint32_t i = 0; i < modes.count && !*text; i++)
        if (modes.mode[i].fourcc == fourcc)
            pupil_live_mode_text(&modes.mode[i], text, text_bytes);
    pupil_live_modes_free(&modes);
}

static int refuse(const pupil_v4l2_capture *c, const char *wanted, const char *instead, uint32_t fourcc, pupil_why *why)
{
    char text[600], names[400];
    offers(c, fourcc, text, sizeof text);
    look_over(&c->device, 0, names, sizeof names);
    pupil_refuse(why, "%s: %s offers no %s (%s instead); it has %s%s%s", c->device.path, c->device.name, wanted,
                 instead, names, *text ? ": " : "", text);
    return PUPIL_V4L2_FAILED;
}

static int set_format(pupil_v4l2_capture *c, pupil_why *why)
{
    const pupil_v4l2_options *o = &c->options;
    struct v4l2_format f = {.type = c->device.type};
    if (pupil_v4l2_ask(&c->device, VIDIOC_G_FMT, &f) != 0)
        return pupil_v4l2_failed(&c->device, "does not report its format", errno, why);
    const uint32_t fourcc = choose(c, &f, why);
    if (!fourcc)
        return PUPIL_V4L2_FAILED;

    struct v4l2_format wanted = f; /* with its colours: behind a media graph they have to match the sensor's */
    const int multi = wanted.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    const uint32_t width = o->width ? o->width : multi ? f.fmt.pix_mp.width : f.fmt.pix.width;
    const uint32_t height = o->height ? o->height : multi ? f.fmt.pix_mp.height : f.fmt.pix.height;
    if (multi) {
        wanted.fmt.pix_mp.width = width;
        wanted.fmt.pix_mp.height = height;
        wanted.fmt.pix_mp.field = V4L2_FIELD_NONE;
        wanted.fmt.pix_mp.pixelformat = fourcc;
        memset(wanted.fmt.pix_mp.plane_fmt, 0, sizeof wanted.fmt.pix_mp.plane_fmt); /* rows as the driver chooses */
    } else {
        wanted.fmt.pix.width = width;
        wanted.fmt.pix.height = height;
        wanted.fmt.pix.field = V4L2_FIELD_NONE;
        wanted.fmt.pix.pixelformat = fourcc;
        wanted.fmt.pix.bytesperline = wanted.fmt.pix.sizeimage = 0;
    }
    if (pupil_v4l2_ask(&c->device, VIDIOC_S_FMT, &wanted) != 0)
        return pupil_v4l2_failed(&c->device, "refuses the format", errno, why);
    const uint32_t took_width = multi ? wanted.fmt.pix_mp.width : wanted.fmt.pix.width;
    const uint32_t took_height = multi ? wanted.fmt.pix_mp.height : wanted.fmt.pix.height;
    if (fourcc_of(&wanted) != fourcc || (o->width && took_width != width) || (o->height && took_height != height)) {
        char asked[64], instead[64];
        snprintf(asked, sizeof asked, "%ux%u of %s", width, height, pupil_v4l2_fourcc_name(fourcc).text);
        snprintf(instead, sizeof instead, "%ux%u of %s", took_width, took_height,
                 pupil_v4l2_fourcc_name(fourcc_of(&wanted)).text);
        return refuse(c, asked, instead, fourcc, why);
    }
    pupil_why words;
    if (pupil_v4l2_format_read(&wanted, &c->format, &words)) {
        pupil_refuse(why, "%s: %s: %s", c->device.path, c->device.name, words.text);
        return PUPIL_V4L2_FAILED;
    }
    return 0;
}

/* After the format, because setting that may reset the rate. */
static int set_rate(pupil_v4l2_capture *c, pupil_why *why)
{
    struct v4l2_streamparm p = {.type = c->device.type};
    struct v4l2_captureparm *capture = &p.parm.capture;
    const double fps = c->options.fps;
    c->fps = 0.0;
    if (pupil_v4l2_ask(&c->device, VIDIOC_G_PARM, &p) != 0)
        return errno == ENODEV ? pupil_v4l2_failed(&c->device, "its rate", errno, why) : 0;
    if (fps > 0.0 && capture->capability & V4L2_CAP_TIMEPERFRAME) {
        p = (struct v4l2_streamparm){.type = c->device.type};
        capture->timeperframe.numerator = 1000; /* thousandths of a frame a second: 29.97 is 1000/29970 */
        capture->timeperframe.denominator = (uint32_t)(fps * 1000.0 + 0.5);
        if (pupil_v4l2_ask(&c->device, VIDIOC_S_PARM, &p) != 0)
            return pupil_v4l2_failed(&c->device, "refuses the rate", errno, why);
    }
    if (!capture->timeperframe.numerator || !capture->timeperframe.denominator)
        return 0;
    c->fps = (double)capture->timeperframe.denominator / capture->timeperframe.numerator;
    if (fps > 0.0 && capture->capability & V4L2_CAP_TIMEPERFRAME && fabs(c->fps / fps - 1.0) > RATE_TOLERANCE) {
        char asked[64], instead[32];
        snprintf(asked, sizeof asked, "%g frames a second at %ux%u", fps, c->format.width, c->format.height);
        snprintf(instead, sizeof instead, "%.6g", c->fps);
        return refuse(c, asked, instead, c->format.fourcc, why);
    }
    return 0;
}

int pupil_v4l2_negotiate(pupil_v4l2_capture *c, pupil_why *why)
{
    const pupil_v4l2_options *o = &c->options;
    const char *path = c->device.path;
    if (o->width > PUPIL_MAX_SIDE_PX || o->height > PUPIL_MAX_SIDE_PX)
        pupil_refuse(why, "%s: a size of %ux%u; at most %ux%u", path, o->width, o->height, PUPIL_MAX_SIDE_PX,
                     PUPIL_MAX_SIDE_PX);
    else if (o->fps != 0.0 && !(o->fps >= 0.001 && o->fps <= 1e5))
        pupil_refuse(why, "%s: %g frames a second; it must be from 0.001 to 100000", path, o->fps);
    else
        return set_format(c, why) || set_rate(c, why) ? PUPIL_V4L2_FAILED : 0;
    return PUPIL_V4L2_FAILED;
}
