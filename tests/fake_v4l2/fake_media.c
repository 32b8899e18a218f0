/* tests/fake_v4l2/fake_media.c: the fake camera's media graph: sensor -> receiver -> node. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <linux/media-bus-format.h>
#include <linux/media.h>
#include <linux/v4l2-subdev.h>
#include <stdio.h>
#include <string.h>

enum { SENSOR = 1, RECEIVER, NODE, INTERFACE_SENSOR, INTERFACE_RECEIVER, INTERFACE_NODE, PADS = 10, LINKS = 20 };

static void copy_out(uint64_t to, uint32_t room, uint32_t *count, const void *from, uint32_t items, size_t item_bytes)
{
    if (to && room >= items)
        memcpy((void *)(uintptr_t)to, from, items * item_bytes);
    *count = items;
}

static int topology(const fake_v4l2 *f, struct media_v2_topology *t)
{
    const struct media_v2_entity entities[] = {
        {.id = NODE, .name = "fake capture", .function = MEDIA_ENT_F_IO_V4L},
        {.id = SENSOR, .name = "fake 1-0010", .function = MEDIA_ENT_F_CAM_SENSOR},
        {.id = RECEIVER, .name = "fake csi", .function = MEDIA_ENT_F_VID_IF_BRIDGE}};
    const struct media_v2_interface interfaces[] = {
        {.id = INTERFACE_SENSOR, .intf_type = MEDIA_INTF_T_V4L_SUBDEV, .devnode = {FAKE_MAJOR, FAKE_SENSOR_MINOR}},
        {.id = INTERFACE_RECEIVER, .intf_type = MEDIA_INTF_T_V4L_SUBDEV, .devnode = {FAKE_MAJOR, FAKE_RECEIVER_MINOR}},
        {.id = INTERFACE_NODE, .intf_type = MEDIA_INTF_T_V4L_VIDEO, .devnode = {FAKE_MAJOR, (uint32_t)f->node}}};
    const struct media_v2_pad pads[] = {
        {.id = PADS, .entity_id = SENSOR, .flags = MEDIA_PAD_FL_SOURCE},
        {.id = PADS + 1, .entity_id = RECEIVER, .flags = MEDIA_PAD_FL_SINK},
        {.id = PADS + 2, .entity_id = RECEIVER, .flags = MEDIA_PAD_FL_SOURCE, .index = 1},
        {.id = PADS + 3, .entity_id = NODE, .flags = MEDIA_PAD_FL_SINK}};
    const uint32_t on = MEDIA_LNK_FL_ENABLED;
    const struct media_v2_link links[] = {
        {.id = LINKS, .source_id = PADS, .sink_id = PADS + 1, .flags = f->config.media == FAKE_MEDIA_LINK_OFF ? 0 : on},
        {.id = LINKS + 1, .source_id = PADS + 2, .sink_id = PADS + 3, .flags = on},
        {.id = LINKS + 2, .source_id = INTERFACE_SENSOR, .sink_id = SENSOR, .flags = MEDIA_LNK_FL_INTERFACE_LINK},
        {.id = LINKS + 3, .source_id = INTERFACE_RECEIVER, .sink_id = RECEIVER, .flags = MEDIA_LNK_FL_INTERFACE_LINK},
        {.id = LINKS + 4, .source_id = INTERFACE_NODE, .sink_id = NODE, .flags = MEDIA_LNK_FL_INTERFACE_LINK}};
    uint32_t count;
    copy_out(t->ptr_entities, t->num_entities, &count, entities, 3, sizeof entities[0]);
    t->num_entities = count;
    copy_out(t->ptr_interfaces, t->num_interfaces, &count, interfaces, 3, sizeof interfaces[0]);
    t->num_interfaces = count;
    copy_out(t->ptr_pads, t->num_pads, &count, pads, 4, sizeof pads[0]);
    t->num_pads = count;
    copy_out(t->ptr_links, t->num_links, &count, links, 5, sizeof links[0]);
    t->num_links = count;
    return 0;
}

/* All pads have 64x48; one that is to differ has 320x240, or RGB. */
static int pad_format(const fake_v4l2 *f, int kind, struct v4l2_subdev_format *s)
{
    const uint32_t media = f->config.media;
    const int sends = s->pad == (kind == FAKE_RECEIVER ? 1 : 0);
    const int larger = (media == FAKE_MEDIA_PADS_DIFFER && kind == FAKE_SENSOR) ||
                       (media == FAKE_MEDIA_NODE_DIFFERS && kind == FAKE_RECEIVER && sends);
    const int rgb = media == FAKE_MEDIA_CODES_DIFFER && kind == FAKE_SENSOR;
    if (s->pad > (kind == FAKE_RECEIVER ? 1u : 0u))
        return fake_fail(EINVAL);
    s->format = (struct v4l2_mbus_framefmt){.width = larger ? 320 : 64,
                                            .height = larger ? 240 : 48,
                                            .code = rgb ? MEDIA_BUS_FMT_RGB888_1X24 : MEDIA_BUS_FMT_SRGGB10_1X10};
    return 0;
}

/* How a pad adjusts a format: the receiver takes raw formats only. */
static int try_format(const fake_v4l2 *f, int kind, struct v4l2_subdev_format *s)
{
    if (s->which != V4L2_SUBDEV_FORMAT_TRY)
        return fake_fail(EBUSY);
    return kind == FAKE_RECEIVER && s->format.code == MEDIA_BUS_FMT_RGB888_1X24 ? pad_format(f, kind, s) : 0;
}

int fake_media_ioctl(const fake_v4l2 *f, int kind, unsigned long request, void *argument)
{
    if (kind == FAKE_MEDIA && request == MEDIA_IOC_G_TOPOLOGY)
        return topology(f, argument);
    if ((kind == FAKE_SENSOR || kind == FAKE_RECEIVER) && request == VIDIOC_SUBDEV_G_FMT)
        return pad_format(f, kind, argument);
    if ((kind == FAKE_SENSOR || kind == FAKE_RECEIVER) && request == VIDIOC_SUBDEV_S_FMT)
        return try_format(f, kind, argument);
    return fake_fail(ENOTTY);
}

int fake_media_name(const fake_v4l2 *f, uint32_t major, uint32_t minor, char *name, size_t name_bytes)
{
    (void)f;
    if (major != FAKE_MAJOR || (minor != FAKE_SENSOR_MINOR && minor != FAKE_RECEIVER_MINOR))
        return fake_fail(ENOENT);
    snprintf(name, name_bytes, "v4l-subdev%d", minor == FAKE_SENSOR_MINOR ? 0 : 1);
    return 0;
}
