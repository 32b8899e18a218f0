#include "fake_libcamera/fake_libcamera.h"

#include <linux/videodev2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 65536, LOG = 8192, BUFFERS = PUPIL_LIBCAMERA_MOST_BUFFERS };

#define WEBCAM "\\_SB_.PCI0.XHCI-2.1:1.0-1bcf:2b9e"
#define SENSOR "/base/soc/i2c0mux/i2c@1/imx219@10"
#define STOPS  2.0

struct fake_libcamera {
    fake_libcamera_config config;
    pupil_libcamera_layer layer;
    int64_t now_ns;
    double light;
    uint64_t frame; /* the frame being exposed; it is complete at the end of its period */
    double exposure_s[FRAMES], gain[FRAMES];
    int automatic, opened, running, unplugged;
    uint64_t handed_out, asked, queued;
    int64_t gone_ns;
    unsigned char *memory[BUFFERS];
    pupil_libcamera_buffer buffer[BUFFERS];
    struct {
        uint32_t index[BUFFERS];
        uint32_t count;
    } waiting; /* with the driver */
    pupil_libcamera_done done[BUFFERS];
    uint32_t done_count;
    fake_libcamera_log log[LOG];
    size_t logged;
};

void fake_libcamera_config_default(fake_libcamera_config *config)
{
    *config = (fake_libcamera_config){
        .fourcc = V4L2_PIX_FMT_GREY, .width = 64, .height = 48, .buffers = 4, .fps = 30.0, .delay = 3};
}

static const char *id_of(const fake_libcamera *f)
{
    return f->config.id ? f->config.id : f->config.sensor ? SENSOR : WEBCAM;
}

static int64_t period_ns(const fake_libcamera *f)
{
    return (int64_t)(1e9 / f->config.fps);
}

/* The machine has run for a second by then. */
static int64_t end_of(const fake_libcamera *f, uint64_t frame)
{
    return INT64_C(1000000000) + (int64_t)(frame + 1) * period_ns(f);
}

/* ---- pictures ---- */

static uint32_t row_bytes(const fake_libcamera *f)
{
    const int two = f->config.fourcc == V4L2_PIX_FMT_SRGGB10 || f->config.fourcc == V4L2_PIX_FMT_YUYV;
    return f->config.width * (two ? 2 : 1) + f->config.padding_bytes;
}

static void draw(fake_libcamera *f, uint32_t index, uint64_t frame)
{
    const fake_libcamera_config *c = &f->config;
    const double total = f->light * f->exposure_s[frame % FRAMES] * f->gain[frame % FRAMES] / 0.01;
    const double black = c->black / 65535.0;
    unsigned char *data = f->memory[index];
    for (uint32_t x = 0; x < c->width; x++) {
        const double light = 0.18 * total * exp2(STOPS * ((x + 0.5) / c->width - 0.5));
        const double value = fmin(black + (1.0 - black) * light, 1.0);
        const uint32_t code = (uint32_t)(value * 1023.0 + 0.5);
        if (c->fourcc == V4L2_PIX_FMT_SRGGB10) {
            data[2 * x] = (unsigned char)code;
            data[2 * x + 1] = (unsigned char)(code >> 8);
        } else {
            data[x] = (unsigned char)(value * 255.0 + 0.5);
        }
    }
    for (uint32_t y = 1; y < c->height; y++)
        memcpy(data + (size_t)y * row_bytes(f), data, row_bytes(f));
    if (c->fourcc == V4L2_PIX_FMT_NV12) /* the second plane, somewhere else */
        memset((unsigned char *)(uintptr_t)f->buffer[index].memory[1], (int)(frame & 255), f->buffer[index].bytes[1]);
}

/* ---- time ---- */

static void back(fake_libcamera *f, uint32_t index, int cancelled, uint64_t frame)
{
    const fake_libcamera_config *c = &f->config;
    const int says = c->sensor && !c->no_metadata && !cancelled;
    pupil_libcamera_done d = {.index = index, .cancelled = cancelled, .black = -1.0};
    d.sequence = (uint32_t)frame;
    d.stamp_ns = end_of(f, frame) - (c->sensor ? 0 : period_ns(f)); /* webcams: of the frame's start */
    d.used[0] = (size_t)row_bytes(f) * c->height;
    d.used[1] = c->fourcc == V4L2_PIX_FMT_NV12 ? f->buffer[index].bytes[1] : 0;
    if (says) {
        d.exposure_s = f->exposure_s[frame % FRAMES];
        d.gain = f->gain[frame % FRAMES];
        d.black = c->black > 0.0 ? c->black : -1.0;
    }
    if (!cancelled)
        draw(f, index, frame);
    if (f->done_count < BUFFERS)
        f->done[f->done_count++] = d;
}

static void drop_first(fake_libcamera *f)
{
    f->waiting.count--;
    memmove(f->waiting.index, f->waiting.index + 1, f->waiting.count * sizeof f->waiting.index[0]);
}

/* The frame in progress is complete. */
static void complete(fake_libcamera *f)
{
    const fake_libcamera_config *c = &f->config;
    const uint64_t frame = f->frame++;
    f->now_ns = end_of(f, frame);
    if (f->automatic) { /* its own idea, in any light */
        f->exposure_s[(frame + 2) % FRAMES] = 0.01 / f->light;
    }
    if (!f->running || f->unplugged)
        return;
    if (c->unplug_at && f->handed_out >= c->unplug_at && !f->gone_ns) {
        f->unplugged = 1;
        f->gone_ns = f->now_ns;
        return;
    }
    if (c->dead || !f->waiting.count)
        return;
    back(f, f->waiting.index[0], 0, frame);
    drop_first(f);
}

static int64_t now_ns(void *context)
{
    return ((fake_libcamera *)context)->now_ns;
}

void fake_libcamera_pass(fake_libcamera *f, double s)
{
    const int64_t until = f->now_ns + (int64_t)(s * 1e9);
    while (end_of(f, f->frame) <= until)
        complete(f);
    f->now_ns = until;
    if (f->unplugged && f->config.back_s > 0.0 && f->now_ns - f->gone_ns > (int64_t)(f->config.back_s * 1e9)) {
        f->unplugged = 0;
        f->automatic = 1;
    }
}

/* ---- requests ---- */

/* From frame `from` on. */
static void set(fake_libcamera *f, uint64_t from, const pupil_libcamera_ask *ask)
{
    for (uint64_t i = from; i < from + FRAMES / 2; i++) {
        if (ask->exposure_s > 0.0)
            f->exposure_s[i % FRAMES] = ask->exposure_s;
        if (ask->gain > 0.0)
            f->gain[i % FRAMES] = ask->gain;
    }
}

static int refuses(fake_libcamera *f, const pupil_libcamera_ask *ask)
{
    const fake_libcamera_config *c = &f->config;
    if (!(ask->exposure_s > 0.0 || ask->gain > 0.0))
        return 0;
    f->asked++;
    if (!c->sensor && (f->automatic || ask->automatic))
        return 1;
    return c->refuse_at && f->asked >= c->refuse_at && f->asked - c->refuse_at < c->refuse;
}

static int queue(void *context, uint32_t index, const pupil_libcamera_ask *ask)
{
    fake_libcamera *f = context;
    const fake_libcamera_config *c = &f->config;
    if (!f->running || f->unplugged)
        return -1;
    f->queued++;
    const int refused = c->cancels || refuses(f, ask);
    if (f->logged < LOG)
        f->log[f->logged++] = (fake_libcamera_log){*ask, refused};
    if (refused) {
        back(f, index, 1, 0);
        return 0;
    }
    if (ask->automatic)
        f->automatic = ask->automatic > 0;
    set(f, f->frame + c->delay + (c->sensor ? f->waiting.count : 0), ask);
    if (c->lose_at && f->queued >= c->lose_at && f->queued - c->lose_at < c->lose)
        return 0;
    f->waiting.index[f->waiting.count++] = index;
    return 0;
}

static int wait_for(void *context, pupil_libcamera_done *done, int timeout_ms)
{
    fake_libcamera *f = context;
    const int64_t until = f->now_ns + (int64_t)timeout_ms * 1000000;
    while (!f->unplugged && !f->done_count && end_of(f, f->frame) <= until)
        complete(f);
    if (f->unplugged)
        return -1;
    if (!f->done_count) {
        f->now_ns = until;
        return 0;
    }
    *done = f->done[0];
    f->done_count--;
    memmove(f->done, f->done + 1, f->done_count * sizeof f->done[0]);
    f->handed_out += !done->cancelled;
    return 1;
}

/* ---- the camera ---- */

static int list(void *context, void (*found)(void *closure, const char *id, const char *model), void *closure,
                pupil_why *why)
{
    const fake_libcamera *f = context;
    if (f->config.no_list) {
        snprintf(why->text, sizeof why->text, "libcamera does not start: the fake does not");
        return -1;
    }
    if (f->config.twin)
        found(closure, "/base/soc/i2c0mux/i2c@0/imx219_wide@10", "imx219_wide");
    if (!f->unplugged)
        found(closure, id_of(f), f->config.sensor ? "imx219" : "Fake Webcam");
    return 0;
}

static void *open_camera(void *context, const char *id, pupil_why *why)
{
    fake_libcamera *f = context;
    if (f->unplugged)
        fake_libcamera_pass(f, 0.25);
    if (f->unplugged || strcmp(id, id_of(f)) != 0) {
        snprintf(why->text, sizeof why->text, "libcamera:%s: there is no such camera", id);
        return NULL;
    }
    f->opened++;
    return f;
}

static void close_camera(void *context)
{
    ((fake_libcamera *)context)->opened--;
}

static int offers(void *context, pupil_live_offers *o, pupil_libcamera_can *can)
{
    const fake_libcamera *f = context;
    const fake_libcamera_config *c = &f->config;
    const pupil_libcamera_can all = {.controls = (c->no_exposure ? 0 : PUPIL_LIBCAMERA_CAN_EXPOSURE) |
                                                 PUPIL_LIBCAMERA_CAN_GAIN | PUPIL_LIBCAMERA_CAN_AE |
                                                 (c->sensor ? PUPIL_LIBCAMERA_CAN_FRAME : 0),
                                     .exposure_s = {1e-4, 1.0, 0.01},
                                     .gain = {1.0, 16.0, 1.0},
                                     .frame_s = {1.0 / 120, 2.0, 1.0 / c->fps}};
    if (can) {
        *can = all;
        snprintf(can->model, sizeof can->model, c->sensor ? "imx219" : "Fake Webcam");
    }
    if (!o)
        return 0;
    snprintf(o->is.name, sizeof o->is.name, c->sensor ? "imx219" : "Fake Webcam");
    o->control[o->controls++] = (pupil_live_control){
        .id = 7, .name = "ExposureTime", .least = 100, .most = 1e6, .value = (double)NAN, .usual = 1e4};
    pupil_live_mode *mode = pupil_live_modes_add(&o->modes);
    pupil_live_size *size = mode ? pupil_live_mode_add_size(mode) : NULL;
    if (!size)
        return -1;
    mode->fourcc = c->fourcc;
    mode->read = 1;
    snprintf(mode->name, sizeof mode->name, "%.4s", (const char *)&c->fourcc);
    size->width = size->max_width = c->width;
    size->height = size->max_height = c->height;
    return 0;
}

static int configure(void *context, const pupil_libcamera_wanted *wanted, pupil_libcamera_stream *stream,
                     pupil_why *why)
{
    fake_libcamera *f = context;
    const fake_libcamera_config *c = &f->config;
    const size_t bytes = (size_t)row_bytes(f) * c->height;
    if (wanted->fourcc && wanted->fourcc != c->fourcc) {
        snprintf(why->text, sizeof why->text, "the fake has no such format");
        return -1;
    }
    *stream = (pupil_libcamera_stream){.fourcc = c->fourcc,
                                       .width = c->width,
                                       .height = c->height,
                                       .stride_bytes = row_bytes(f),
                                       .size_bytes = (uint32_t)(bytes + bytes / 2),
                                       .buffers = wanted->buffers < c->buffers ? wanted->buffers : c->buffers};
    for (uint32_t i = 0; i < BUFFERS && !f->memory[i]; i++) {
        f->memory[i] = calloc(2, bytes + 4096);
        if (!f->memory[i]) {
            snprintf(why->text, sizeof why->text, "the fake has no memory");
            return -1;
        }
        f->buffer[i] = (pupil_libcamera_buffer){.planes = c->fourcc == V4L2_PIX_FMT_NV12 ? 2 : 1,
                                                .memory = {f->memory[i], f->memory[i] + bytes + 4096},
                                                .bytes = {bytes, bytes / 2},
                                                .dmabuf = {-1, -1}};
    }
    return 0;
}

static const pupil_libcamera_buffer *buffer(void *context, uint32_t index)
{
    return &((fake_libcamera *)context)->buffer[index];
}

static int start(void *context, pupil_why *why)
{
    fake_libcamera *f = context;
    if (f->unplugged) {
        snprintf(why->text, sizeof why->text, "the fake is gone");
        return -1;
    }
    f->running = 1;
    return 0;
}

static void stop(void *context)
{
    fake_libcamera *f = context;
    f->running = 0;
    f->waiting.count = f->done_count = 0;
}

fake_libcamera *fake_libcamera_new(const fake_libcamera_config *config)
{
    fake_libcamera *f = calloc(1, sizeof *f);
    if (!f)
        abort();
    f->config = *config;
    f->light = 1.0;
    f->now_ns = end_of(f, 0) - period_ns(f);
    f->automatic = 1;
    for (int i = 0; i < FRAMES; i++) {
        f->exposure_s[i] = 0.01;
        f->gain[i] = 1.0;
    }
    f->layer = (pupil_libcamera_layer){f,      list,  open_camera, close_camera, offers,   configure,
                                       buffer, start, stop,        queue,        wait_for, now_ns};
    return f;
}

void fake_libcamera_free(fake_libcamera *f)
{
    for (int i = 0; i < BUFFERS; i++)
        free(f->memory[i]);
    free(f);
}

const pupil_libcamera_layer *fake_libcamera_layer(fake_libcamera *f)
{
    return &f->layer;
}

void fake_libcamera_light(fake_libcamera *f, double light)
{
    f->light = light;
}

double fake_libcamera_exposure(const fake_libcamera *f, uint64_t sequence)
{
    return f->exposure_s[sequence % FRAMES];
}

double fake_libcamera_gain(const fake_libcamera *f, uint64_t sequence)
{
    return f->gain[sequence % FRAMES];
}

size_t fake_libcamera_logged(const fake_libcamera *f, const fake_libcamera_log **log)
{
    *log = f->log;
    return f->logged;
}

int fake_libcamera_automatic(const fake_libcamera *f)
{
    return f->automatic;
}

int fake_libcamera_opened(const fake_libcamera *f)
{
    return f->opened;
}
