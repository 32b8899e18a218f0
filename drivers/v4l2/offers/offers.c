/* What a camera says of itself: formats, controls, sensor. Nothing is set. */
#include "offers.h"

#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "v4l2/media/media.h"
#include "v4l2/modes.h"

/* --- names of colour --- */

static const char *name_of(const char *const *names, size_t count, uint32_t value)
{
    return value < count && names[value] ? names[value] : "unknown";
}

#define NAME_OF(names, value) name_of(names, sizeof names / sizeof names[0], value)

static const char *colorspace_name(uint32_t value)
{
    static const char *const names[] = {"default",      "SMPTE 170M",    "SMPTE 240M", "Rec. 709", "BT.878",
                                        "470 System M", "470 System BG", "JPEG",       "sRGB",     "opRGB",
                                        "BT.2020",      "raw",           "DCI-P3"};
    return NAME_OF(names, value);
}

static const char *transfer_name(uint32_t value)
{
    static const char *const names[] = {"default",    "Rec. 709", "sRGB",   "opRGB",
                                        "SMPTE 240M", "none",     "DCI-P3", "SMPTE 2084 (PQ)"};
    return NAME_OF(names, value);
}

static const char *encoding_name(uint32_t value)
{
    static const char *const names[] = {"default",   "601",  "Rec. 709", "xvYCC 601",
                                        "xvYCC 709", "sYCC", "BT.2020",  "BT.2020 constant luminance",
                                        "SMPTE 240M"};
    return NAME_OF(names, value);
}

static const char *range_name(uint32_t value)
{
    static const char *const names[] = {"default", "full", "limited"};
    return NAME_OF(names, value);
}

void pupil_v4l2_colour_names(const pupil_v4l2_format *format, pupil_live_stream *stream)
{
    stream->colorspace = colorspace_name(format->colorspace);
    stream->transfer = transfer_name(format->xfer_func);
    stream->encoding = encoding_name(format->ycbcr_enc);
    stream->range = range_name(format->quantization);
}

/* --- controls --- */

/* What drivers/v4l2/controls turns off, where it is on. */
static int is_automatic(const pupil_live_control *c)
{
    switch (c->id) {
    case V4L2_CID_EXPOSURE_AUTO:
        return c->value != V4L2_EXPOSURE_MANUAL;
    case V4L2_CID_AUTOGAIN:
    case V4L2_CID_AUTO_WHITE_BALANCE:
    case V4L2_CID_EXPOSURE_AUTO_PRIORITY:
    case V4L2_CID_BACKLIGHT_COMPENSATION:
        return c->value != 0;
    default:
        return 0;
    }
}

static void read_value(const pupil_v4l2_system *system, int fd, const struct v4l2_query_ext_ctrl *query,
                       pupil_live_control *c)
{
    struct v4l2_ext_control one = {.id = query->id};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
    struct v4l2_querymenu item = {.id = query->id};
    c->value = (double)query->default_value;
    if (pupil_v4l2_ioctl(system, fd, VIDIOC_G_EXT_CTRLS, &all) == 0)
        c->value = (double)(query->type == V4L2_CTRL_TYPE_INTEGER64 ? one.value64 : one.value);
    item.index = (uint32_t)(int64_t)c->value;
    if (query->type == V4L2_CTRL_TYPE_MENU && pupil_v4l2_ioctl(system, fd, VIDIOC_QUERYMENU, &item) == 0)
        snprintf(c->item, sizeof c->item, "%.31s", (const char *)item.name);
    else if (query->type == V4L2_CTRL_TYPE_INTEGER_MENU && pupil_v4l2_ioctl(system, fd, VIDIOC_QUERYMENU, &item) == 0)
        snprintf(c->item, sizeof c->item, "%lld", (long long)item.value);
    c->automatic = is_automatic(c);
}

static void read_controls(pupil_live_offers *o, const pupil_v4l2_system *system, int fd, int on_sensor)
{
    uint32_t last = 0;
    for (int i = 0; i < 4 * PUPIL_LIVE_CONTROLS && o->controls < PUPIL_LIVE_CONTROLS; i++) {
        struct v4l2_query_ext_ctrl query = {.id = last | V4L2_CTRL_FLAG_NEXT_CTRL};
        if (pupil_v4l2_ioctl(system, fd, VIDIOC_QUERY_EXT_CTRL, &query) != 0 || query.id <= last)
            return;
        last = query.id;
        if (query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_WRITE_ONLY) || query.nr_of_dims ||
            (query.type != V4L2_CTRL_TYPE_INTEGER && query.type != V4L2_CTRL_TYPE_BOOLEAN &&
             query.type != V4L2_CTRL_TYPE_MENU && query.type != V4L2_CTRL_TYPE_INTEGER_MENU &&
             query.type != V4L2_CTRL_TYPE_INTEGER64 && query.type != V4L2_CTRL_TYPE_BITMASK))
            continue;
        pupil_live_control *c = &o->control[o->controls++];
        *c = (pupil_live_control){.id = query.id,
                                  .least = (double)query.minimum,
                                  .most = (double)query.maximum,
                                  .step = (double)query.step,
                                  .usual = (double)query.default_value,
                                  .on_sensor = on_sensor};
        snprintf(c->name, sizeof c->name, "%.31s", query.name);
        read_value(system, fd, &query, c);
        if (query.id == V4L2_CID_ANALOGUE_GAIN || (query.id == V4L2_CID_GAIN && !o->gain_place))
            o->gain_place = o->controls;
    }
}

/* --- all --- */

static void read_sensor(pupil_live_offers *o, const pupil_v4l2_device *device)
{
    const pupil_v4l2_system *system = device->system;
    pupil_v4l2_sensor sensor;
    pupil_why unused;
    o->has_entity = pupil_v4l2_media_sensor(device, &sensor, &unused) == 0;
    if (!o->has_entity)
        return;
    snprintf(o->entity, sizeof o->entity, "%s", sensor.entity);
    snprintf(o->entity_path, sizeof o->entity_path, "%s", sensor.path);
    o->has_sensor = pupil_camera_find_sensor(NULL, sensor.entity, &o->sensor, &unused) == 1;
    const int fd = system->open(system->context, sensor.path);
    if (fd < 0)
        return;
    read_controls(o, system, fd, 1);
    system->close(system->context, fd);
}

void pupil_v4l2_identify(const pupil_v4l2_device *device, pupil_live_identity *is)
{
    snprintf(is->path, sizeof is->path, "%s", device->path);
    snprintf(is->name, sizeof is->name, "%s", device->name);
    snprintf(is->driver, sizeof is->driver, "%s", device->driver);
    snprintf(is->bus, sizeof is->bus, "%s", device->bus);
}

int pupil_v4l2_offers_read(pupil_live_offers *offers, const pupil_v4l2_system *system, const char *which,
                           pupil_why *why)
{
    pupil_v4l2_device device;
    if (pupil_v4l2_device_open(&device, system, which, why))
        return -1;
    pupil_v4l2_identify(&device, &offers->is);
    const int failed = pupil_v4l2_modes_read(&device, &offers->modes, why);
    if (!failed) {
        read_sensor(offers, &device);
        read_controls(offers, device.system, device.fd, 0);
    }
    pupil_v4l2_device_close(&device);
    return failed ? -1 : 0;
}
