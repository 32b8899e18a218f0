/* drivers/v4l2/output/output_set.c: which format and rate an output node is to take. */
#include <errno.h>
#include <linux/videodev2.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "output.h"
#include "refuse.h"
#include "v4l2/modes.h"

int pupil_v4l2_output_failed(const pupil_v4l2_device *device, const char *what, int error, pupil_why *why)
{
    if (error == ENODEV)
        return pupil_refuse(why, "%s: the output is gone", device->path);
    return pupil_refuse(why, "%s: %s: %s", device->path, what,
                        error == EBUSY   ? "another program is writing to it"
                        : error == EPIPE ? "nothing is connected that takes the picture"
                                         : strerror(error));
}

static uint32_t fourcc_of(const struct v4l2_format *f)
{
    return f->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat;
}

/* 0: the driver takes it, as *output. 1: something else, with a sentence. -1: it fails. */
static int try_format(const pupil_v4l2_device *d, const pupil_sink_options *o, uint32_t fourcc,
                      pupil_v4l2_output *output, pupil_why *why)
{
    struct v4l2_format f = {.type = d->type};
    pupil_why words;
    if (d->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE)
        f.fmt.pix_mp = (struct v4l2_pix_format_mplane){.width = o->width,
                                                       .height = o->height,
                                                       .pixelformat = fourcc,
                                                       .field = V4L2_FIELD_NONE,
                                                       .colorspace = V4L2_COLORSPACE_SRGB,
                                                       .num_planes = 1};
    else
        f.fmt.pix = (struct v4l2_pix_format){.width = o->width,
                                             .height = o->height,
                                             .pixelformat = fourcc,
                                             .field = V4L2_FIELD_NONE,
                                             .colorspace = V4L2_COLORSPACE_SRGB,
                                             .priv = V4L2_PIX_FMT_PRIV_MAGIC};
    if (pupil_v4l2_ask(d, VIDIOC_S_FMT, &f) != 0) {
        const int error = errno;
        pupil_v4l2_output_failed(d, "refuses the format", error, why);
        return error == EINVAL ? 1 : -1;
    }
    if (pupil_v4l2_output_read(&f, output, &words)) {
        pupil_refuse(why, "%s: %s: %s", d->path, d->name, words.text);
        return 1;
    }
    if (output->width == o->width && output->height == o->height)
        return 0;
    pupil_refuse(why, "%s: %s takes frames of %ux%u, not of %ux%u", d->path, d->name, output->width, output->height,
                 o->width, o->height);
    return 1;
}

/* Adds the sizes that a driver lists to the sentence that one was refused. */
static void add_sizes(const pupil_v4l2_device *d, pupil_why *why)
{
    pupil_live_modes modes;
    pupil_why unused;
    pupil_v4l2_modes_read(d, &modes, &unused);
    for (uint32_t i = 0; i < modes.count; i++)
        if (modes.mode[i].sizes && pupil_v4l2_is_written(modes.mode[i].fourcc)) {
            char text[400];
            pupil_live_mode_text(&modes.mode[i], text, sizeof text);
            pupil_refuse_add(why, "; it has %s", text);
            break;
        }
    pupil_live_modes_free(&modes);
}

static int set_format(const pupil_v4l2_device *d, const pupil_sink_options *o, pupil_v4l2_output *output,
                      pupil_why *why)
{
    struct v4l2_format set = {.type = d->type};
    uint32_t order[1 + PUPIL_V4L2_OUTPUTS] = {0};
    pupil_why words;
    pupil_why size_words = {""};
    memcpy(order + 1, pupil_v4l2_outputs, sizeof pupil_v4l2_outputs);
    if (pupil_v4l2_ask(d, VIDIOC_G_FMT, &set) == 0 && pupil_v4l2_is_written(fourcc_of(&set)))
        order[0] = fourcc_of(&set);
    for (size_t i = order[0] ? 0 : 1; i < sizeof order / sizeof order[0]; i++) {
        const int result = try_format(d, o, order[i], output, &words);
        if (result == 0)
            return 0;
        if (result < 0)
            return pupil_refuse(why, "%s", words.text);
        if (!*size_words.text && output->width)
            size_words = words; /* the format is right: the size was refused */
    }
    pupil_refuse(why, "%s", *size_words.text ? size_words.text : words.text);
    if (*size_words.text)
        add_sizes(d, why);
    return -1;
}

/* A driver that has a rate of its own keeps it. */
static int set_rate(const pupil_v4l2_device *d, const pupil_sink_options *o, pupil_why *why)
{
    struct v4l2_streamparm p = {.type = d->type};
    int num = 0, den = 1;
    pupil_fps_ratio(o->fps, &num, &den);
    p.parm.output.timeperframe = (struct v4l2_fract){(uint32_t)den, (uint32_t)num};
    if (pupil_v4l2_ask(d, VIDIOC_S_PARM, &p) != 0 && errno == ENODEV)
        return pupil_v4l2_output_failed(d, "refuses the rate", errno, why);
    return 0;
}

int pupil_v4l2_output_set(const pupil_v4l2_device *device, const pupil_sink_options *options, pupil_v4l2_output *output,
                          pupil_why *why)
{
    return set_format(device, options, output, why) || set_rate(device, options, why) ? -1 : 0;
}
