/* tests/fake_v4l2/fake_controls.c: exposure and gain of the fake camera, as of a webcam. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const struct {
    uint32_t id, type;
    int32_t least, most, usual;
    size_t offset;
    const char *name;
} controls[] = {
    {V4L2_CID_GAIN, V4L2_CTRL_TYPE_INTEGER, 16, 1024, 16, offsetof(fake_settings, gain_16ths), "Gain"},
    {V4L2_CID_EXPOSURE_AUTO, V4L2_CTRL_TYPE_MENU, 0, 3, 1, offsetof(fake_settings, automatic), "Auto Exposure"},
    {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, 1, 10000, 100, offsetof(fake_settings, exposure_100us),
     "Exposure Time, Absolute"},
    {V4L2_CID_EXPOSURE_AUTO_PRIORITY, V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 0, offsetof(fake_settings, priority),
     "Exposure, Dynamic Framerate"},
};
#define CONTROLS (sizeof controls / sizeof controls[0])

static size_t find(uint32_t id) /* CONTROLS: none */
{
    size_t i = 0;
    if (id & V4L2_CTRL_FLAG_NEXT_CTRL) {
        while (i < CONTROLS && controls[i].id <= (id & V4L2_CTRL_ID_MASK))
            i++;
        return i;
    }
    while (i < CONTROLS && controls[i].id != id)
        i++;
    return i;
}

static int32_t *value_of(fake_v4l2 *f, size_t i)
{
    return (int32_t *)(void *)((char *)&f->settings + controls[i].offset);
}

static int query(struct v4l2_queryctrl *q)
{
    const size_t i = find(q->id);
    if (i == CONTROLS)
        return fake_fail(EINVAL);
    *q = (struct v4l2_queryctrl){.id = controls[i].id,
                                 .type = controls[i].type,
                                 .minimum = controls[i].least,
                                 .maximum = controls[i].most,
                                 .step = 1,
                                 .default_value = controls[i].usual};
    snprintf((char *)q->name, sizeof q->name, "%s", controls[i].name);
    return 0;
}

static int query_extended(struct v4l2_query_ext_ctrl *q)
{
    struct v4l2_queryctrl simple = {.id = q->id};
    if (query(&simple))
        return -1;
    memset(q, 0, sizeof *q);
    q->id = simple.id;
    q->type = simple.type;
    memcpy(q->name, simple.name, sizeof simple.name);
    q->minimum = simple.minimum;
    q->maximum = simple.maximum;
    q->step = 1;
    q->default_value = simple.default_value;
    q->elem_size = 4;
    q->elems = 1;
    return 0;
}

static int query_menu(struct v4l2_querymenu *m)
{
    if (m->id != V4L2_CID_EXPOSURE_AUTO || (m->index != 1 && m->index != 3))
        return fake_fail(EINVAL);
    snprintf((char *)m->name, sizeof m->name, "%s", m->index == 1 ? "Manual Mode" : "Aperture Priority Mode");
    return 0;
}

/* The value that the driver takes: integers are clamped, menus refused. -1: no such control or item. */
static int settle(uint32_t id, int32_t *value)
{
    const size_t i = find(id);
    if (i == CONTROLS)
        return fake_fail(EINVAL);
    if (controls[i].type == V4L2_CTRL_TYPE_MENU && *value != 1 && *value != 3)
        return fake_fail(ERANGE);
    *value = *value < controls[i].least ? controls[i].least : *value > controls[i].most ? controls[i].most : *value;
    return 0;
}

static int one(fake_v4l2 *f, struct v4l2_control *c, int set)
{
    int32_t taken = set ? c->value : 1; /* every control takes 1 or is clamped */
    if (settle(c->id, &taken))
        return -1;
    int32_t *value = value_of(f, find(c->id));
    if (set)
        *value = taken;
    c->value = *value;
    return 0;
}

static int several(fake_v4l2 *f, struct v4l2_ext_controls *all, int set, int try)
{
    for (uint32_t i = 0; i < all->count; i++) { /* all of them are checked before the first is set */
        int32_t taken = set || try ? all->controls[i].value : 1;
        if (settle(all->controls[i].id, &taken)) {
            all->error_idx = set ? all->count : i;
            return -1;
        }
        all->controls[i].value = taken;
    }
    for (uint32_t i = 0; i < all->count && !try; i++) {
        int32_t *value = value_of(f, find(all->controls[i].id));
        if (set)
            *value = all->controls[i].value;
        all->controls[i].value = *value;
    }
    return 0;
}

/* A sensor driver's read-only controls for its lines, one at a time. 1: not one of them. */
static int line_ioctl(const fake_v4l2 *f, unsigned long request, void *argument)
{
    struct v4l2_query_ext_ctrl *q = argument;
    struct v4l2_ext_controls *all = argument;
    const int queries = request == VIDIOC_QUERY_EXT_CTRL, gets = request == VIDIOC_G_EXT_CTRLS && all->count == 1;
    const uint32_t id = queries ? q->id : gets ? all->controls[0].id : 0;
    if (f->config.pixel_rate <= 0 || (id != V4L2_CID_PIXEL_RATE && id != V4L2_CID_HBLANK))
        return 1;
    const int64_t value = id == V4L2_CID_PIXEL_RATE ? f->config.pixel_rate : f->config.hblank;
    if (queries)
        *q = (struct v4l2_query_ext_ctrl){.id = id, .minimum = value, .maximum = value, .step = 1};
    else if (id == V4L2_CID_PIXEL_RATE)
        all->controls[0].value64 = value;
    else
        all->controls[0].value = (int32_t)value;
    return 0;
}

int fake_controls_ioctl(fake_v4l2 *f, unsigned long request, void *argument)
{
    if (line_ioctl(f, request, argument) == 0)
        return 0;
    switch (request) {
    case VIDIOC_QUERYCTRL:
        return query(argument);
    case VIDIOC_QUERY_EXT_CTRL:
        return query_extended(argument);
    case VIDIOC_QUERYMENU:
        return query_menu(argument);
    case VIDIOC_G_CTRL:
        return one(f, argument, 0);
    case VIDIOC_S_CTRL:
        return one(f, argument, 1);
    case VIDIOC_G_EXT_CTRLS:
        return several(f, argument, 0, 0);
    case VIDIOC_S_EXT_CTRLS:
        return several(f, argument, 1, 0);
    case VIDIOC_TRY_EXT_CTRLS:
        return several(f, argument, 0, 1);
    default:
        return 1;
    }
}
