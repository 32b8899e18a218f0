/* Drivers with one odd answer at a time: a sentence, or the best interpretation; nothing is written out of bounds, and
 * every list ends. */
#include "check.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/media.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fake_v4l2/fake_v4l2.h"
#include "scratch.h"
#include "v4l2/capture/capture.h"
#include "v4l2/media/media.h"
#include "v4l2/modes.h"
#include "v4l2/offers/offers.h"
#include "v4l2/output/v4l2_sink.h"

static pupil_why why;

/* --- a driver with changed answers to one request --- */

typedef struct odd {
    unsigned long request; /* 0: poll's */
    void (*change)(void *answer, int error);
    int tells; /* this driver answers itself: the inner one is not asked */
} odd;

static fake_v4l2 *fake;
static const odd *now;
static pupil_v4l2_system odd_system;

static int odd_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    int result = 0;
    if (!now || now->request != request || !now->tells)
        result = fake_v4l2_system(fake)->ioctl(context, fd, request, argument);
    if (now && now->request == request) {
        errno = 0;
        now->change(argument, result);
        result = errno ? -1 : 0;
    }
    return result;
}

static int odd_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    const int result = fake_v4l2_system(fake)->poll(context, fds, count, timeout_ms);
    if (now && !now->request && count)
        now->change(fds, 0);
    return result;
}

static void plug_in(const odd *how, const fake_v4l2_config *config)
{
    fake_v4l2_config usual;
    fake_v4l2_config_default(&usual);
    fake = fake_v4l2_new(config ? config : &usual);
    odd_system = *fake_v4l2_system(fake);
    odd_system.ioctl = odd_ioctl;
    odd_system.poll = odd_poll;
    now = how;
}

static void unplug(const char *what)
{
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%s: %d files and %d maps are left", what, held.files, held.maps);
    fake_v4l2_free(fake);
}

/* --- an output --- */

#define FORMAT(name, statement)                                                                                        \
    static void name(void *answer, int error)                                                                          \
    {                                                                                                                  \
        struct v4l2_pix_format *p = &((struct v4l2_format *)answer)->fmt.pix;                                          \
        (void)error;                                                                                                   \
        statement;                                                                                                     \
    }
FORMAT(without_stride, p->bytesperline = 0)
FORMAT(short_rows, p->bytesperline = 10)
FORMAT(short_frame, p->sizeimage = 100)
FORMAT(no_width, p->width = 0)
FORMAT(no_height, p->height = 0)
FORMAT(too_wide, p->width = 20000)
FORMAT(too_high, p->height = 20000)
FORMAT(fields, p->field = V4L2_FIELD_TOP)
FORMAT(interlaced, p->field = V4L2_FIELD_INTERLACED)
FORMAT(any_field, p->field = V4L2_FIELD_ANY)
FORMAT(nameless, p->colorspace = 0)
FORMAT(old_driver, p->priv = 0; p->ycbcr_enc = 77)
FORMAT(higher, p->height++; p->sizeimage *= 2)
FORMAT(unknown_format, p->pixelformat = v4l2_fourcc('Q', 'Q', 'Q', 'Q'))

#define CAPABILITY(name, statement)                                                                                    \
    static void name(void *answer, int error)                                                                          \
    {                                                                                                                  \
        struct v4l2_capability *c = answer;                                                                            \
        (void)error;                                                                                                   \
        statement;                                                                                                     \
    }
CAPABILITY(no_device_caps, c->capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING)
CAPABILITY(takes_nothing, c->device_caps = V4L2_CAP_VIDEO_OUTPUT)
CAPABILITY(is_input, c->device_caps = V4L2_CAP_STREAMING)
CAPABILITY(odd_name, strcpy((char *)c->card, "a\033[2J\nb"))

static void small_buffer(void *answer, int error)
{
    (void)error;
    ((struct v4l2_buffer *)answer)->length = 64;
}

static void other_buffer(void *answer, int error)
{
    if (!error)
        ((struct v4l2_buffer *)answer)->index = 77;
    else
        errno = EAGAIN;
}

static void no_buffers(void *answer, int error)
{
    (void)error;
    ((struct v4l2_requestbuffers *)answer)->count = 0;
}

static void refuses(void *answer, int error)
{
    (void)answer, (void)error;
    errno = EIO;
}

static void hung_up(void *answer, int error)
{
    (void)error;
    ((struct pollfd *)answer)->revents = POLLHUP;
}

static void broke(void *answer, int error)
{
    (void)error;
    ((struct pollfd *)answer)->revents = POLLERR;
}

static int show(const char *path, int frames)
{
    static uint8_t pixels[48 * 64 * 3];
    const pupil_sink_options options = {.width = 64, .height = 48, .fps = 30};
    const pupil_image_const image = {
        .data = pixels, .stride_bytes = 64 * 3, .width = 64, .height = 48, .pixel = PUPIL_PIXEL_RGB8};
    pupil_sink *sink = NULL;
    int failed = pupil_v4l2_sink_open(&sink, path, &options, &odd_system, &why);
    for (int n = 0; n < frames && !failed; n++)
        failed = pupil_sink_write(sink, &image, NULL, &why);
    if (failed)
        pupil_sink_discard(sink);
    return failed || pupil_sink_finish(sink, &why);
}

static void test_outputs(void)
{
    static const struct {
        odd how;
        const char *says; /* NULL: it works */
    } cases[] = {
        {{VIDIOC_S_FMT, without_stride, 0}, NULL},
        {{VIDIOC_S_FMT, interlaced, 0}, NULL},
        {{VIDIOC_S_FMT, any_field, 0}, NULL},
        {{VIDIOC_S_FMT, nameless, 0}, NULL},
        {{VIDIOC_S_FMT, old_driver, 0}, NULL},
        {{VIDIOC_S_FMT, short_rows, 0}, "says that a row has 10 bytes"},
        {{VIDIOC_S_FMT, short_frame, 0}, "says that a frame has 100 bytes"},
        {{VIDIOC_S_FMT, no_width, 0}, "it takes 0x48"},
        {{VIDIOC_S_FMT, no_height, 0}, "it takes 64x0"},
        {{VIDIOC_S_FMT, too_wide, 0}, "it takes 20000x48"},
        {{VIDIOC_S_FMT, too_high, 0}, "it takes 64x20000"},
        {{VIDIOC_S_FMT, fields, 0}, "takes single fields (field 2)"},
        {{VIDIOC_S_FMT, higher, 0}, "takes frames of 64x49, not of 64x48"},
        {{VIDIOC_S_FMT, unknown_format, 0}, "it takes QQQQ; formats that can be written"},
        {{VIDIOC_G_FMT, unknown_format, 0}, NULL},
        {{VIDIOC_QUERYCAP, no_device_caps, 0}, NULL},
        {{VIDIOC_QUERYCAP, takes_nothing, 0}, "takes no frames; a driver is needed that streams or has write()"},
        {{VIDIOC_QUERYCAP, is_input, 0}, "is not a video output"},
        {{VIDIOC_QUERYCAP, odd_name, 0}, NULL},
        {{VIDIOC_QUERYBUF, small_buffer, 0}, "its buffers cannot be mapped"},
        {{VIDIOC_REQBUFS, no_buffers, 1}, NULL}, /* by write() */
        {{VIDIOC_REQBUFS, refuses, 1}, "gives no buffers"},
        {{VIDIOC_DQBUF, other_buffer, 0}, "gives buffer 77 back, which it does not have"},
        {{0, hung_up, 0}, "/dev/video2: "},
        {{0, broke, 0}, "its driver reports that the stream broke"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        why.text[0] = 0;
        plug_in(&cases[i].how, NULL);
        const int failed = show("/dev/video2", 8);
        CHECK_MSG(!failed == !cases[i].says && (!failed || strstr(why.text, cases[i].says)), "case %zu: %d %s", i,
                  failed, why.text);
        CHECK_MSG(!strchr(why.text, '\033') && !strchr(why.text, '\n'), "case %zu: %s", i, why.text);
        unplug("an output");
    }
    static const char *const names[][2] = {{"v4l2:2", NULL},
                                           {"v4l2:", "named by its path or number"},
                                           {"v4l2:2x", "named by its path or number"},
                                           {"v4l2:1234", "named by its path or number"},
                                           {"/dev/video9", "cannot be opened"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        plug_in(NULL, NULL);
        const int failed = show(names[i][0], 2);
        CHECK_MSG(!failed == !names[i][1] && (!failed || strstr(why.text, names[i][1])), "%s: %s", names[i][0],
                  why.text);
        unplug(names[i][0]);
    }
    char path[400] = "/dev/";
    memset(path + 5, 'v', sizeof path - 6);
    plug_in(NULL, NULL);
    CHECK(show(path, 1) && strstr(why.text, "the path is longer than"));
    unplug("a long path");
}

/* --- an output with several planes, which the fake lacks: its structs are translated --- */

static int planes_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    const pupil_v4l2_system *inner = fake_v4l2_system(fake);
    int single = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    if (request == VIDIOC_QUERYCAP) {
        struct v4l2_capability *c = argument;
        const int result = inner->ioctl(context, fd, request, c);
        c->device_caps = (c->device_caps & ~(uint32_t)V4L2_CAP_VIDEO_OUTPUT) | V4L2_CAP_VIDEO_OUTPUT_MPLANE;
        return result;
    }
    if (request == VIDIOC_STREAMON || request == VIDIOC_STREAMOFF)
        return inner->ioctl(context, fd, request, &single);
    if (request == VIDIOC_S_FMT || request == VIDIOC_G_FMT) {
        struct v4l2_format *f = argument, s = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT};
        CHECK(f->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE);
        s.fmt.pix = (struct v4l2_pix_format){
            .width = f->fmt.pix_mp.width, .height = f->fmt.pix_mp.height, .pixelformat = f->fmt.pix_mp.pixelformat};
        const int result = inner->ioctl(context, fd, request, &s);
        f->fmt.pix_mp = (struct v4l2_pix_format_mplane){
            .width = s.fmt.pix.width,
            .height = s.fmt.pix.height,
            .pixelformat = s.fmt.pix.pixelformat,
            .field = V4L2_FIELD_NONE,
            .num_planes = now ? 2 : 1,
            .plane_fmt[0] = {.sizeimage = s.fmt.pix.sizeimage, .bytesperline = s.fmt.pix.bytesperline}};
        return result;
    }
    if (request == VIDIOC_REQBUFS) {
        ((struct v4l2_requestbuffers *)argument)->type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
        return inner->ioctl(context, fd, request, argument);
    }
    if (request == VIDIOC_QUERYBUF || request == VIDIOC_QBUF || request == VIDIOC_DQBUF) {
        struct v4l2_buffer *b = argument, s = *b;
        CHECK(b->type == V4L2_BUF_TYPE_VIDEO_OUTPUT_MPLANE && b->length >= 1);
        s.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
        s.bytesused = b->m.planes[0].bytesused;
        const int result = inner->ioctl(context, fd, request, &s);
        b->index = s.index;
        b->m.planes[0].length = s.length;
        b->m.planes[0].m.mem_offset = s.m.offset;
        return result;
    }
    return inner->ioctl(context, fd, request, argument);
}

static void test_planes(void)
{
    static const odd several = {0, NULL, 0};
    fake_v4l2_screen screen;
    plug_in(NULL, NULL);
    odd_system.ioctl = planes_ioctl;
    CHECK_MSG(show("/dev/video2", 8) == 0, "%s", why.text);
    CHECK(fake_v4l2_shown(fake, &screen) == 8 && screen.width == 64 && screen.height == 48);
    unplug("planes");
    plug_in(NULL, NULL);
    odd_system.ioctl = planes_ioctl;
    now = &several;
    odd_system.poll = fake_v4l2_system(fake)->poll;
    CHECK(show("/dev/video2", 2) && strstr(why.text, " in several memory areas"));
    unplug("several areas");
}

/* --- lists --- */

static int endless_rate;

static void rates_without_end(void *answer, int error)
{
    struct v4l2_frmivalenum *i = answer;
    (void)error;
    i->type = V4L2_FRMIVAL_TYPE_DISCRETE;
    i->discrete = (struct v4l2_fract){i->index % 3 ? 1 : 0, endless_rate == 2 ? 1000 - i->index : 1 + i->index / 2};
}

static void rates_between(void *answer, int error)
{
    struct v4l2_frmivalenum *i = answer;
    (void)error;
    i->type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
    i->stepwise.min = (struct v4l2_fract){1, 60};
    i->stepwise.max = (struct v4l2_fract){endless_rate == 4 ? 0 : 1, endless_rate == 5 ? 60 : 5};
}

static void sizes_without_end(void *answer, int error)
{
    struct v4l2_frmsizeenum *s = answer;
    (void)error;
    s->type = V4L2_FRMSIZE_TYPE_DISCRETE;
    s->discrete = (struct v4l2_frmsize_discrete){16 + s->index, 16};
}

static void sizes_in_steps(void *answer, int error)
{
    struct v4l2_frmsizeenum *s = answer;
    (void)error;
    s->type = V4L2_FRMSIZE_TYPE_STEPWISE;
    s->stepwise = (struct v4l2_frmsize_stepwise){16, 4096, 2, 16, 2160, 0};
}

static void formats_without_end(void *answer, int error)
{
    (void)error;
    ((struct v4l2_fmtdesc *)answer)->pixelformat = V4L2_PIX_FMT_YUYV;
}

static uint32_t read_modes(const odd *how, pupil_live_modes *modes)
{
    pupil_v4l2_device device;
    plug_in(how, NULL);
    CHECK_MSG(pupil_v4l2_device_open(&device, &odd_system, "/dev/video0", &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_v4l2_modes_read(&device, modes, &why) == 0, "%s", why.text);
    pupil_v4l2_device_close(&device);
    unplug("modes");
    return modes->count;
}

static void test_lists(void)
{
    static const odd rates = {VIDIOC_ENUM_FRAMEINTERVALS, rates_without_end, 1};
    static const odd between = {VIDIOC_ENUM_FRAMEINTERVALS, rates_between, 1};
    static const odd sizes = {VIDIOC_ENUM_FRAMESIZES, sizes_without_end, 1};
    static const odd steps = {VIDIOC_ENUM_FRAMESIZES, sizes_in_steps, 1};
    static const odd formats = {VIDIOC_ENUM_FMT, formats_without_end, 1};
    pupil_live_modes modes;
    char text[400];
    for (endless_rate = 1; endless_rate < 3; endless_rate++) {
        CHECK(read_modes(&rates, &modes) > 0);
        const pupil_live_size *s = &modes.mode[0].size[0];
        CHECK(s->rates == PUPIL_LIVE_MOST_RATES);
        for (uint32_t k = 1; k < s->rates; k++)
            CHECK(s->fps[k] > s->fps[k - 1]);
        pupil_live_modes_free(&modes);
    }
    for (; endless_rate < 6; endless_rate++) { /* from 5 to 60; from an unknown one; one rate alone */
        CHECK(read_modes(&between, &modes) > 0);
        const pupil_live_size *s = &modes.mode[0].size[0];
        CHECK(s->rates == (endless_rate == 3 ? 2 : 1) && s->fps_between == (endless_rate == 3));
        pupil_live_mode_text(&modes.mode[0], text, sizeof text);
        CHECK_MSG(strstr(text, endless_rate == 3 ? "@5..60" : "@60"), "%s", text);
        pupil_live_modes_free(&modes);
    }
    CHECK(read_modes(&sizes, &modes) > 0 && modes.mode[0].sizes == 256);
    pupil_live_mode_text(&modes.mode[0], text, sizeof text); /* is cut, and ends */
    CHECK(strlen(text) == sizeof text - 1);
    pupil_live_modes_free(&modes);
    CHECK(read_modes(&steps, &modes) > 0 && modes.mode[0].sizes == 1 && modes.mode[0].size[0].max_width == 4096);
    pupil_live_mode_text(&modes.mode[0], text, sizeof text);
    CHECK_MSG(strstr(text, "16x16..4096x2160"), "%s", text);
    modes.mode[0].size[0].step_width = 0; /* steps of the height alone are steps, too */
    modes.mode[0].size[0].step_height = 8;
    pupil_live_mode_text(&modes.mode[0], text, sizeof text);
    CHECK_MSG(strstr(text, "16x16..4096x2160"), "%s", text);
    pupil_live_modes_free(&modes);
    CHECK(read_modes(&formats, &modes) == 128);
    pupil_live_modes_free(&modes);
}

/* --- controls --- */

static uint32_t asked;

/* One of each kind, then the last again and again. */
static void controls_of_all_kinds(void *answer, int error)
{
    static const struct {
        uint32_t type, flags, dimensions;
    } kinds[] = {{V4L2_CTRL_TYPE_INTEGER, 0, 0},
                 {V4L2_CTRL_TYPE_BOOLEAN, V4L2_CTRL_FLAG_DISABLED, 0},
                 {V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_FLAG_WRITE_ONLY, 0},
                 {V4L2_CTRL_TYPE_INTEGER, 0, 2},
                 {V4L2_CTRL_TYPE_BOOLEAN, 0, 0},
                 {V4L2_CTRL_TYPE_MENU, 0, 0},
                 {V4L2_CTRL_TYPE_INTEGER_MENU, 0, 0},
                 {V4L2_CTRL_TYPE_INTEGER64, 0, 0},
                 {V4L2_CTRL_TYPE_BITMASK, 0, 0},
                 {V4L2_CTRL_TYPE_STRING, 0, 0},
                 {V4L2_CTRL_TYPE_BUTTON, 0, 0}};
    struct v4l2_query_ext_ctrl *q = answer;
    const uint32_t n = asked < sizeof kinds / sizeof *kinds ? asked : (uint32_t)(sizeof kinds / sizeof *kinds) - 1;
    (void)error;
    asked++;
    *q = (struct v4l2_query_ext_ctrl){.id = V4L2_CID_BASE + n,
                                      .type = kinds[n].type,
                                      .flags = kinds[n].flags,
                                      .nr_of_dims = kinds[n].dimensions,
                                      .minimum = 0,
                                      .maximum = 3,
                                      .default_value = 2};
    snprintf(q->name, sizeof q->name, "control %u", n);
}

static void controls_without_end(void *answer, int error)
{
    struct v4l2_query_ext_ctrl *q = answer;
    (void)error;
    *q = (struct v4l2_query_ext_ctrl){.id = V4L2_CID_BASE + asked++, .type = V4L2_CTRL_TYPE_INTEGER};
}

static void test_controls(void)
{
    static const odd kinds = {VIDIOC_QUERY_EXT_CTRL, controls_of_all_kinds, 1};
    static const odd endless = {VIDIOC_QUERY_EXT_CTRL, controls_without_end, 1};
    static const odd none = {VIDIOC_QUERYCAP, takes_nothing, 0};
    static pupil_live_offers offers;
    plug_in(&kinds, NULL);
    asked = 0;
    CHECK_MSG(pupil_v4l2_offers_read(&offers, &odd_system, "0", &why) == 0, "%s", why.text);
    CHECK_MSG(offers.controls == 6, "%u controls", offers.controls);
    CHECK(strcmp(offers.control[0].name, "control 0") == 0 && strcmp(offers.control[1].name, "control 4") == 0);
    pupil_live_modes_free(&offers.modes);
    unplug("kinds");
    offers = (pupil_live_offers){0};
    plug_in(&endless, NULL);
    asked = 0;
    CHECK_MSG(pupil_v4l2_offers_read(&offers, &odd_system, "0", &why) == 0, "%s", why.text);
    CHECK(offers.controls == PUPIL_LIVE_CONTROLS);
    pupil_live_modes_free(&offers.modes);
    unplug("controls without end");
    plug_in(&none, NULL);
    CHECK(pupil_v4l2_offers_read(&offers, &odd_system, "/dev/video0", &why) == -1 &&
          strstr(why.text, "is a video output"));
    unplug("no camera");
}

/* --- a camera --- */

static struct timeval odd_time;

static void with_odd_time(void *answer, int error)
{
    struct v4l2_buffer *b = answer;
    if (error)
        errno = EAGAIN;
    else
        b->timestamp = odd_time;
}

/* Times beyond 64 bits of nanoseconds count as none: the frame gets its time of arrival. */
static void test_times(void)
{
    static const odd times = {VIDIOC_DQBUF, with_odd_time, 0};
    /* the first two are, in 64 bits, what the fake's clock says */
    static const struct timeval beyond[] = {{1000 + (INT64_C(1) << 55), 0},
                                            {1000, INT64_C(1) << 61},
                                            {INT64_MIN / 4, 0},
                                            {INT64_MAX / 1000000000, INT64_MAX / 1000},
                                            {INT64_MAX / 1000000000, 0},
                                            {-1, 0}};
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        static pupil_v4l2_capture capture;
        pupil_v4l2_frame frame = {0};
        odd_time = beyond[i];
        plug_in(&times, NULL);
        const pupil_v4l2_options options = {.system = &odd_system, .timeout_s = 0.5};
        CHECK_MSG(pupil_v4l2_capture_open(&capture, "/dev/video0", &options, &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_v4l2_capture_next(&capture, &frame, &why) == PUPIL_V4L2_FRAME, "%s", why.text);
        CHECK_MSG(frame.stamp == PUPIL_LIVE_STAMP_NONE && frame.stamp_ns == frame.taken_ns, "case %zu: stamp %d, %lld",
                  i, (int)frame.stamp, (long long)frame.stamp_ns);
        CHECK(pupil_v4l2_capture_done(&capture, &frame, &why) == 0);
        pupil_v4l2_capture_close(&capture);
        unplug("odd times");
    }
}

static int grown; /* which part of the graph */

static void with_grown_graph(void *answer, int error)
{
    struct media_v2_topology *t = answer;
    if (error) {
        errno = EINVAL;
    } else if (t->ptr_entities) { /* there is room for what was counted before */
        t->num_entities += grown == 0 ? 1000 : 0;
        t->num_interfaces += grown == 1 ? 1000 : 0;
        t->num_pads += grown == 2 ? 1000 : 0;
        t->num_links += grown == 3 ? 1000 : 0;
    }
}

/* A media graph that grows between counting and reading is not read beyond the allocated room. */
static void test_grown_graph(void)
{
    static const odd grows = {MEDIA_IOC_G_TOPOLOGY, with_grown_graph, 0};
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.media = FAKE_MEDIA_RIGHT;
    for (grown = 0; grown < 4; grown++) {
        pupil_v4l2_device device;
        pupil_v4l2_sensor sensor;
        plug_in(&grows, &config);
        CHECK_MSG(pupil_v4l2_device_open(&device, &odd_system, "/dev/video0", &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_v4l2_media_sensor(&device, &sensor, &why) == -1, "part %d: %s", grown, sensor.entity);
        pupil_v4l2_device_close(&device);
        unplug("a graph that grows");
    }
}

/* --- the kernel's own table, where no camera is needed --- */

static void count_names(void *closure, const char *name)
{
    *(int *)closure += *name != '.';
}

static void test_kernel(void)
{
    const pupil_v4l2_system *k = &pupil_v4l2_kernel;
    uint32_t major = 0, minor = 0;
    char name[64] = "";
    int names = 0;
    const int fd = k->open(k->context, "/dev/null");
    CHECK(fd >= 0 && k->device_number(k->context, fd, &major, &minor) == 0 && major == 1 && minor == 3);
    if (access("/sys/dev/char/1:3", F_OK) == 0)
        CHECK(k->device_name(k->context, 1, 3, name, sizeof name) == 0 && strcmp(name, "null") == 0);
    CHECK(k->device_name(k->context, 999, 999, name, sizeof name) == -1 && errno == ENOENT);
    CHECK(k->device_number(k->context, -1, &major, &minor) == -1 && errno == EBADF);
    CHECK(k->write(k->context, fd, "x", 1) == 1 && k->ioctl(k->context, fd, VIDIOC_QUERYCAP, NULL) == -1);
    CHECK(k->mmap(k->context, 4096, fd, 0) == NULL);
    CHECK(k->close(k->context, fd) == 0 && k->close(k->context, fd) == -1);
    CHECK(k->list(k->context, "/nowhere", count_names, &names) == -1 && names == 0);
    CHECK(k->list(k->context, "/dev", count_names, &names) == 0 && names > 2);
    const int file = open(scratch("memory"), O_RDWR | O_CREAT, 0600);
    CHECK(ftruncate(file, 4096) == 0);
    void *memory = k->mmap(k->context, 4096, file, 0);
    CHECK(memory && k->read_ns(k->context, memory, 4096) >= 0 && k->munmap(k->context, memory, 4096) == 0);
    close(file);
    const int64_t before_ns = k->now_ns(k->context);
    CHECK(k->poll(k->context, NULL, 0, 1) == 0 && k->now_ns(k->context) > before_ns);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_outputs();
    test_planes();
    test_lists();
    test_controls();
    test_times();
    test_grown_graph();
    test_kernel();
    scratch_clear(scratch_folder);
    return check_end();
}
