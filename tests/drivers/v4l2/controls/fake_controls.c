#include "fake_controls.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static fake_control *find(fake_controls *fake, int fd, uint32_t id)
{
    for (int i = 0; i < fake->count; i++)
        if (fake->control[i].id == id && (fd < 0 || fake->control[i].fd == fd))
            return &fake->control[i];
    return NULL;
}

static int set(fake_controls *fake, int fd, uint32_t id, int32_t *value, uint32_t call)
{
    fake_control *c = find(fake, fd, id), *mode = find(fake, fd, V4L2_CID_EXPOSURE_AUTO);
    if (!c)
        return -EINVAL;
    if (id == V4L2_CID_PIXEL_RATE || id == V4L2_CID_HBLANK)
        return -EACCES;
    if (c->menu && !(*value >= 0 && *value < 32 && c->menu >> *value & 1))
        return -ERANGE;
    if (id == V4L2_CID_EXPOSURE_ABSOLUTE && fake->needs_manual && mode && mode->value != V4L2_EXPOSURE_MANUAL)
        return -EACCES;
    c->value = *value < c->least ? c->least : *value > c->most ? c->most : *value;
    c->value = c->least + (c->value - c->least) / c->step * c->step;
    *value = (int32_t)c->value;
    if (id == V4L2_CID_VBLANK && fake->height) { /* as sensors' drivers do: the exposure must fit into the frame */
        fake_control *e = find(fake, fd, V4L2_CID_EXPOSURE);
        e->most = fake->height + c->value - 4;
        e->value = e->value > e->most ? e->most : e->value;
    }
    if (fake->logged < FAKE_LOG)
        fake->log[fake->logged++] = (fake_write){id, call, c->value};
    return 0;
}

static int query(fake_controls *fake, int fd, struct v4l2_query_ext_ctrl *q)
{
    const fake_control *c = find(fake, fd, q->id);
    if (!c)
        return -EINVAL;
    q->minimum = c->least;
    q->maximum = c->most;
    q->step = (uint64_t)c->step;
    q->default_value = c->usual;
    q->flags = 0;
    return 0;
}

static int write_all(fake_controls *fake, int fd, struct v4l2_ext_controls *all, uint32_t call)
{
    if (fake->one_by_one && all->count > 1)
        return -EINVAL;
    for (uint32_t i = 0; i < all->count; i++) {
        int32_t value = all->controls[i].value; /* the kernel's structure is packed */
        const int error = set(fake, fd, all->controls[i].id, &value, call);
        all->controls[i].value = value;
        if (error) {
            all->error_idx = i;
            return error;
        }
    }
    return 0;
}

static int answer(fake_controls *fake, int fd, unsigned long request, void *argument)
{
    struct v4l2_ext_controls *all = argument;
    const uint32_t call = (uint32_t)++fake->calls;
    if (fake->fail_at && fake->calls >= fake->fail_at && fake->calls <= fake->fail_at + fake->fail_for)
        return -fake->fail_errno;
    if (request == VIDIOC_QUERY_EXT_CTRL)
        return fake->no_query_ext ? -ENOTTY : query(fake, fd, argument);
    if (request == VIDIOC_QUERYCTRL) {
        struct v4l2_queryctrl *older = argument;
        struct v4l2_query_ext_ctrl q = {.id = older->id};
        const int error = query(fake, fd, &q);
        older->minimum = (int32_t)q.minimum;
        older->maximum = (int32_t)q.maximum;
        older->step = (int32_t)q.step;
        older->default_value = (int32_t)q.default_value;
        return error;
    }
    if (request == VIDIOC_QUERYMENU) {
        const struct v4l2_querymenu *menu = argument;
        const fake_control *c = find(fake, fd, menu->id);
        return c && menu->index < 32 && c->menu >> menu->index & 1 ? 0 : -EINVAL;
    }
    if (request == VIDIOC_G_EXT_CTRLS) {
        const fake_control *c = find(fake, fd, all->controls->id);
        if (!c)
            return -EINVAL;
        if (c->id == V4L2_CID_PIXEL_RATE)
            all->controls->value64 = c->value;
        else
            all->controls->value = (int32_t)c->value;
        return 0;
    }
    return request == VIDIOC_S_EXT_CTRLS ? write_all(fake, fd, all, call) : -ENOTTY;
}

static int fake_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    fake_controls *fake = context;
    pthread_mutex_lock(&fake->lock);
    const long sleep_ms = request == VIDIOC_S_EXT_CTRLS ? fake->sleep_ms : 0;
    if (sleep_ms) {
        fake->sleep_ms = 0;
        pthread_mutex_unlock(&fake->lock);
        usleep((useconds_t)sleep_ms * 1000);
        pthread_mutex_lock(&fake->lock);
    }
    while (request == VIDIOC_S_EXT_CTRLS && fake->stuck)
        pthread_cond_wait(&fake->moved, &fake->lock);
    const int result = answer(fake, fd, request, argument);
    pthread_mutex_unlock(&fake->lock);
    errno = result < 0 ? -result : errno;
    return result < 0 ? -1 : 0;
}

static void begin(fake_controls *fake)
{
    memset(fake, 0, sizeof *fake);
    pthread_mutex_init(&fake->lock, NULL);
    pthread_cond_init(&fake->moved, NULL);
    fake->fail_errno = EIO;
    fake->table = (pupil_camera_calls){.context = fake, .ioctl = fake_ioctl};
}

static void add(fake_controls *fake, fake_control control)
{
    fake->control[fake->count++] = control;
}

void fake_uvc(fake_controls *fake)
{
    begin(fake);
    fake->needs_manual = 1;
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_EXPOSURE_AUTO, 0, 3, 1, 3, 3, 1 << 1 | 1 << 3});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_EXPOSURE_ABSOLUTE, 3, 2047, 1, 250, 250, 0});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, 1, 1, 0, 1, 0});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_GAIN, 0, 255, 1, 16, 40, 0});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_AUTO_WHITE_BALANCE, 0, 1, 1, 1, 1, 0});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_BACKLIGHT_COMPENSATION, 0, 2, 1, 1, 1, 0});
    add(fake, (fake_control){FAKE_VIDEO, V4L2_CID_POWER_LINE_FREQUENCY, 0, 2, 1, 2, 2, 7});
}

/* 3448 pixels a line at 182.4 MHz are 18.9 us; 1763 lines are 1/30 s. */
void fake_sensor(fake_controls *fake)
{
    begin(fake);
    fake->height = 1080;
    add(fake, (fake_control){FAKE_SUBDEVICE, V4L2_CID_PIXEL_RATE, 182400000, 182400000, 1, 182400000, 182400000, 0});
    add(fake, (fake_control){FAKE_SUBDEVICE, V4L2_CID_HBLANK, 1528, 1528, 1, 1528, 1528, 0});
    add(fake, (fake_control){FAKE_SUBDEVICE, V4L2_CID_VBLANK, 32, 64455, 1, 683, 683, 0});
    add(fake, (fake_control){FAKE_SUBDEVICE, V4L2_CID_EXPOSURE, 4, 1759, 1, 1600, 1600, 0});
    add(fake, (fake_control){FAKE_SUBDEVICE, V4L2_CID_ANALOGUE_GAIN, 0, 232, 1, 0, 0, 0});
}

int64_t fake_value(fake_controls *fake, uint32_t id)
{
    pthread_mutex_lock(&fake->lock);
    const fake_control *c = find(fake, -1, id);
    const int64_t value = c ? c->value : -1;
    pthread_mutex_unlock(&fake->lock);
    return value;
}

void fake_release(fake_controls *fake)
{
    pthread_mutex_lock(&fake->lock);
    fake->stuck = 0;
    fake->sleep_ms = 0;
    pthread_cond_broadcast(&fake->moved);
    pthread_mutex_unlock(&fake->lock);
}

pupil_camera_options fake_uvc_options(fake_controls *fake)
{
    return (pupil_camera_options){.calls = &fake->table, .fd = FAKE_VIDEO, .subdevice_fd = -1};
}

pupil_camera_options fake_sensor_options(fake_controls *fake)
{
    return (pupil_camera_options){.calls = &fake->table,
                                  .fd = -1,
                                  .subdevice_fd = FAKE_SUBDEVICE,
                                  .sensor_name = "imx219 10-0010",
                                  .width = 1920,
                                  .height = 1080};
}
