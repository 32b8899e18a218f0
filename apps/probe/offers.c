/* What a camera says of itself: formats, controls, sensor. Nothing is set. */
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "probe.h"

/* --- names --- */

static const char *name_of(const char *const *names, size_t count, uint32_t value)
{
    return value < count && names[value] ? names[value] : "unknown";
}

#define NAME_OF(names, value) name_of(names, sizeof names / sizeof names[0], value)

const char *probe_colorspace(uint32_t value)
{
    static const char *const names[] = {"default",      "SMPTE 170M",    "SMPTE 240M", "Rec. 709", "BT.878",
                                        "470 System M", "470 System BG", "JPEG",       "sRGB",     "opRGB",
                                        "BT.2020",      "raw",           "DCI-P3"};
    return NAME_OF(names, value);
}

const char *probe_transfer(uint32_t value)
{
    static const char *const names[] = {"default",    "Rec. 709", "sRGB",   "opRGB",
                                        "SMPTE 240M", "none",     "DCI-P3", "SMPTE 2084 (PQ)"};
    return NAME_OF(names, value);
}

const char *probe_encoding(uint32_t value)
{
    static const char *const names[] = {"default",   "601",  "Rec. 709", "xvYCC 601",
                                        "xvYCC 709", "sYCC", "BT.2020",  "BT.2020 constant luminance",
                                        "SMPTE 240M"};
    return NAME_OF(names, value);
}

const char *probe_range(uint32_t value)
{
    static const char *const names[] = {"default", "full", "limited"};
    return NAME_OF(names, value);
}

const char *probe_stamp(uint32_t stamp)
{
    static const char *const names[] = {"none", "end of frame", "start of exposure"};
    return NAME_OF(names, stamp);
}

void probe_law_text(const pupil_camera_gain *law, char *text, size_t text_bytes)
{
    const double *p = law->p;
    *text = 0;
    if (law->law == PUPIL_CAMERA_DB)
        snprintf(text, text_bytes, "%g dB a code", p[0]);
    else if (law->law == PUPIL_CAMERA_OCTAVES)
        snprintf(text, text_bytes, "%g codes an octave", p[0]);
    else if (law->law == PUPIL_CAMERA_TABLE)
        snprintf(text, text_bytes, "a table of %u", law->rows);
    else if (p[1] == 0.0 && p[2] == 0.0)
        snprintf(text, text_bytes, "code / %g", p[3] / p[0]);
    else if (p[0] == 0.0 && p[2] == -1.0)
        snprintf(text, text_bytes, "%g / (%g - code)", p[1], p[3]);
    else
        snprintf(text, text_bytes, "(%g code + %g) / (%g code + %g)", p[0], p[1], p[2], p[3]);
}

/* --- controls --- */

/* What drivers/v4l2/controls turns off, where it is on. */
static int is_automatic(const probe_control *c)
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
                       probe_control *c)
{
    struct v4l2_ext_control one = {.id = query->id};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
    struct v4l2_querymenu item = {.id = query->id};
    c->value = query->default_value;
    if (pupil_v4l2_ioctl(system, fd, VIDIOC_G_EXT_CTRLS, &all) == 0)
        c->value = query->type == V4L2_CTRL_TYPE_INTEGER64 ? one.value64 : one.value;
    item.index = (uint32_t)c->value;
    if (query->type == V4L2_CTRL_TYPE_MENU && pupil_v4l2_ioctl(system, fd, VIDIOC_QUERYMENU, &item) == 0)
        snprintf(c->item, sizeof c->item, "%.31s", (const char *)item.name);
    else if (query->type == V4L2_CTRL_TYPE_INTEGER_MENU && pupil_v4l2_ioctl(system, fd, VIDIOC_QUERYMENU, &item) == 0)
        snprintf(c->item, sizeof c->item, "%lld", (long long)item.value);
    c->automatic = is_automatic(c);
}

static void read_controls(probe_report *r, const pupil_v4l2_system *system, int fd, int on_subdevice)
{
    uint32_t last = 0;
    for (int i = 0; i < 4 * PROBE_CONTROLS && r->controls < PROBE_CONTROLS; i++) {
        struct v4l2_query_ext_ctrl query = {.id = last | V4L2_CTRL_FLAG_NEXT_CTRL};
        if (pupil_v4l2_ioctl(system, fd, VIDIOC_QUERY_EXT_CTRL, &query) != 0 || query.id <= last)
            return;
        last = query.id;
        if (query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_WRITE_ONLY) || query.nr_of_dims ||
            (query.type != V4L2_CTRL_TYPE_INTEGER && query.type != V4L2_CTRL_TYPE_BOOLEAN &&
             query.type != V4L2_CTRL_TYPE_MENU && query.type != V4L2_CTRL_TYPE_INTEGER_MENU &&
             query.type != V4L2_CTRL_TYPE_INTEGER64 && query.type != V4L2_CTRL_TYPE_BITMASK))
            continue;
        probe_control *c = &r->control[r->controls++];
        *c = (probe_control){.id = query.id,
                             .least = query.minimum,
                             .most = query.maximum,
                             .step = (int64_t)query.step,
                             .usual = query.default_value,
                             .on_subdevice = on_subdevice};
        snprintf(c->name, sizeof c->name, "%.31s", query.name);
        read_value(system, fd, &query, c);
    }
}

/* --- all --- */

static void read_sensor(probe_report *r, const pupil_v4l2_system *system)
{
    pupil_why unused;
    r->has_entity = pupil_v4l2_media_sensor(&r->device, &r->entity, &unused) == 0;
    if (!r->has_entity)
        return;
    r->has_sensor = pupil_camera_find_sensor(NULL, r->entity.entity, &r->sensor, &unused) == 1;
    const int fd = system->open(system->context, r->entity.path);
    if (fd < 0)
        return;
    read_controls(r, system, fd, 1);
    system->close(system->context, fd);
}

int probe_offers(probe_report *r, const pupil_v4l2_system *system, const char *which, pupil_why *why)
{
    if (pupil_v4l2_device_open(&r->device, system, which, why))
        return -1;
    const int failed = pupil_v4l2_modes_read(&r->device, &r->modes, why);
    if (!failed) {
        read_sensor(r, r->device.system);
        read_controls(r, r->device.system, r->device.fd, 0);
    }
    pupil_v4l2_device_close(&r->device);
    return failed ? -1 : 0;
}

void probe_free(probe_report *r)
{
    pupil_v4l2_modes_free(&r->modes);
}
