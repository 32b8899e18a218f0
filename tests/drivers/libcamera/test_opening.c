/* Opening a libcamera camera: its name, format and rate, whether its values are linear; and its state after it is
 * closed. */
#include "odd.h"

#include <errno.h>

/* --- names --- */

static unsigned listed;

static int list_many(void *context, void (*found)(void *closure, const char *id, const char *model), void *closure,
                     pupil_why *words)
{
    (void)context, (void)words;
    for (unsigned i = 0; i < listed; i++) {
        char id[32];
        snprintf(id, sizeof id, "camera %u", i);
        found(closure, id, "model");
    }
    return 0;
}

static const char *opened;

static void *note(void *context, const char *id, pupil_why *words)
{
    static char text[64];
    (void)context;
    snprintf(text, sizeof text, "%s", id);
    opened = text;
    snprintf(words->text, sizeof words->text, "%s is not opened", id);
    return NULL;
}

static void test_lists(void)
{
    fake_libcamera_config c;
    pupil_live_offers offers = {.controls = 0};
    fake_libcamera_config_default(&c);
    odd_begin(&c);
    it.layer.list = list_many;
    it.layer.open = note;
    static const struct {
        unsigned cameras;
        const char *name, *camera; /* camera NULL: refused, with these words */
        const char *words;
    } cases[] = {{40, "31", "camera 31", NULL}, /* 32 are kept */
                 {40, "32", NULL, "no such camera"},
                 {40, "99999999999999999999999", NULL, "no such camera"},
                 {40, "camera 7", "camera 7", NULL},
                 {40, "7x", NULL, "no such camera"},
                 {40, "mod", NULL, "more than one camera"},
                 {1, "mod", "camera 0", NULL},
                 {1, "MODEL", "camera 0", NULL},
                 {0, "", NULL, "libcamera has no camera"},
                 {0, "0", NULL, "libcamera has no camera"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char name[64];
        snprintf(name, sizeof name, "libcamera:%s", cases[i].name);
        listed = cases[i].cameras;
        opened = NULL;
        CHECK(pupil_live_offers_read(&offers, &it.system, name, &why) == -1);
        if (cases[i].camera)
            CHECK_MSG(opened && strcmp(opened, cases[i].camera) == 0, "%s: %s", name, opened ? opened : why.text);
        else
            CHECK_MSG(!opened && strstr(why.text, cases[i].words), "%s: %s", name, why.text);
    }
    odd_end(NULL);
}

static int walked;

static int first_only(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *words)
{
    (void)closure, (void)is, (void)modes, (void)words;
    walked++;
    return 1;
}

static int any(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *words)
{
    (void)modes;
    walked++;
    if (!is)
        snprintf(closure, sizeof why.text, "%s", words);
    return 0;
}

/* There is no V4L2 node: only libcamera's cameras are seen. */
static int no_node(void *context, const char *path)
{
    (void)context, (void)path;
    errno = ENOENT;
    return -1;
}

static void test_walk(void)
{
    fake_libcamera_config c;
    char words[sizeof why.text] = "";
    pupil_v4l2_system none = pupil_v4l2_kernel;
    none.open = no_node;
    fake_libcamera_config_default(&c);
    c.sensor = c.twin = 1;
    odd_begin(&c);
    it.system.v4l2 = &none;
    walked = 0;
    CHECK(pupil_live_cameras(&it.system, 1, any, words, &why) == 0);
    CHECK_MSG(walked == 2 && strstr(words, "imx219_wide@10: there is no such camera"), "%d, %s", walked, words);
    odd_end(NULL);

    c.twin = 0;
    odd_begin(&c);
    it.system.v4l2 = &none;
    it.layer.list = list_many;
    listed = 3;
    it.layer.open = it.real->open;
    walked = 0;
    CHECK(pupil_live_cameras(&it.system, 1, any, words, &why) == 0 && walked == 3);
    odd_end(NULL);

    c.twin = 1;
    odd_begin(&c);
    it.system.v4l2 = &none;
    walked = 0;
    CHECK(pupil_live_cameras(&it.system, 1, first_only, NULL, &why) == 0 && walked == 1);
    odd_end(NULL);

    c.no_list = 1;
    odd_begin(&c);
    it.system.v4l2 = &none;
    words[0] = 0;
    CHECK(pupil_live_cameras(&it.system, 1, any, words, &why) == 0);
    CHECK_MSG(strstr(words, "libcamera does not start"), "%s", words);
    pupil_source *source;
    CHECK(odd_open(&source, NULL) == PUPIL_SOURCE_FAILED && strstr(why.text, "libcamera does not start"));
    odd_end(source);
}

/* A webcam is detected by the end of its id. */
static void test_webcams(void)
{
    static const struct {
        const char *id;
        int is_webcam;
    } cases[] = {{"\\_SB_.PCI0.XHCI-2.1:1.0-1bcf:2b9e", 1},
                 {"a-2.1:1.0-1BCF:2B9E", 1},
                 {"a-2.1:1.0-1bcf:2b9x", 0},
                 {"a-2.1:1.0-1bcf2b9e0", 0},
                 {"a-2.1:1.0_1bcf:2b9e", 0},
                 {"1bcf:2b9e", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_libcamera_config c;
        pupil_live_offers offers = {.controls = 0};
        fake_libcamera_config_default(&c);
        c.id = cases[i].id;
        odd_begin(&c);
        CHECK(pupil_live_offers_read(&offers, &it.system, "libcamera:", &why) == 0);
        CHECK_MSG(offers.has_entity == !cases[i].is_webcam, "%s", cases[i].id);
        pupil_live_modes_free(&offers.modes);
        odd_end(NULL);
    }
}

/* --- format and rate --- */

static pupil_libcamera_wanted wanted;
static uint32_t xfer_func;

static int configure(void *camera, const pupil_libcamera_wanted *to, pupil_libcamera_stream *as, pupil_why *words)
{
    wanted = *to;
    const int failed = it.real->configure(camera, to, as, words);
    as->xfer_func = xfer_func;
    return failed;
}

static void test_asked(void)
{
    fake_libcamera_config c;
    pupil_source *source;
    fake_libcamera_config_default(&c);
    c.buffers = 8;
    odd_begin(&c);
    it.layer.configure = configure;
    const pupil_live_options options = {
        .capture = {.fourcc = V4L2_PIX_FMT_GREY, .width = 64, .height = 48, .buffers = 6}};
    CHECK(odd_open(&source, &options) == 0);
    CHECK(wanted.fourcc == V4L2_PIX_FMT_GREY && wanted.width == 64 && wanted.height == 48 && wanted.buffers == 6);
    CHECK(pupil_live_get(source)->stream.buffers == 6);
    odd_end(source);
    odd_begin(&c);
    CHECK(odd_open(&source, &(pupil_live_options){.capture = {.height = 49}}) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "has no frames of 64x49"), "%s", why.text);
    odd_end(source);
    c.fourcc = v4l2_fourcc('X', 'Y', 'Z', '1');
    odd_begin(&c);
    CHECK(odd_open(&source, NULL) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "XYZ1"), "%s", why.text);
    odd_end(source);
}

static pupil_libcamera_can can;

static int offers_can(void *camera, pupil_live_offers *o, pupil_libcamera_can *to)
{
    if (to)
        *to = can;
    return it.real->offers(camera, o, NULL);
}

/* The frame rate: the requested one, else the camera's usual one, else 30 a second within its limits. */
static void test_rates(void)
{
    static const struct {
        uint32_t controls;
        pupil_libcamera_range frame_s;
        double asked, fps;
    } cases[] = {{PUPIL_LIBCAMERA_CAN_FRAME, {0.01, 0.1, 0.05}, 0, 20},
                 {PUPIL_LIBCAMERA_CAN_FRAME, {0.01, 0.1, 0}, 0, 30},
                 {PUPIL_LIBCAMERA_CAN_FRAME, {0.05, 0.1, 0}, 0, 20},
                 {0, {0.001, 0.01, 0.005}, 0, 100},
                 {0, {0, 0, 0}, 0, 30},
                 {PUPIL_LIBCAMERA_CAN_FRAME, {0, 0, 0}, 15, 15},
                 {PUPIL_LIBCAMERA_CAN_FRAME, {0.01, 0.1, 0.05}, 50, 50}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_libcamera_config c;
        pupil_source *source;
        fake_libcamera_config_default(&c);
        c.sensor = 1;
        odd_begin(&c);
        can = (pupil_libcamera_can){.controls = cases[i].controls, .frame_s = cases[i].frame_s};
        it.layer.offers = offers_can;
        CHECK_MSG(odd_open(&source, &(pupil_live_options){.capture = {.fps = cases[i].asked}}) == 0, "%s", why.text);
        CHECK_MSG(source && fabs(source->fps - cases[i].fps) < 1e-9, "case %zu: %g a second", i,
                  source ? source->fps : 0.0);
        odd_end(source);
    }
}

static void test_linear(void)
{
    static const struct {
        uint32_t fourcc;
        int sensor;
        uint32_t xfer_func;
        int is_linear;
    } cases[] = {{V4L2_PIX_FMT_SRGGB10, 1, 0, 1}, {V4L2_PIX_FMT_GREY, 1, 0, 1},
                 {V4L2_PIX_FMT_GREY, 0, 0, 0},    {V4L2_PIX_FMT_GREY, 0, V4L2_XFER_FUNC_NONE, 1},
                 {V4L2_PIX_FMT_NV12, 1, 0, 0},    {V4L2_PIX_FMT_NV12, 1, V4L2_XFER_FUNC_709, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_libcamera_config c;
        pupil_source *source;
        fake_libcamera_config_default(&c);
        c.fourcc = cases[i].fourcc;
        c.sensor = cases[i].sensor;
        odd_begin(&c);
        it.layer.configure = configure;
        xfer_func = cases[i].xfer_func;
        CHECK_MSG(odd_open(&source, NULL) == 0, "%s", why.text);
        CHECK_MSG(pupil_live_is_linear(source) == cases[i].is_linear, "case %zu", i);
        odd_end(source);
    }
    xfer_func = 0;
}

/* A camera in hands-off mode can still be asked; it has no controls to mark, restore or give back. */
static void test_left_alone(void)
{
    fake_libcamera_config c;
    pupil_source *source;
    pupil_frame frame;
    fake_libcamera_config_default(&c);
    odd_begin(&c);
    CHECK(odd_open(&source, &(pupil_live_options){.hands_off = 1}) == 0);
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    pupil_live_mark(source);
    pupil_live_restore(source);
    CHECK(pupil_live_give_back(source, &why) == 0 && pupil_live_now_ns(source) > 0);
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    odd_end(source);
}

/* --- closing --- */

static int frames_left;

static int wait_runs_out(void *camera, pupil_libcamera_done *done, int timeout_ms)
{
    if (frames_left-- > 0)
        return it.real->wait(camera, done, timeout_ms);
    fake_libcamera_pass(it.fake, timeout_ms * 1e-3);
    return 0;
}

static int queue_never(void *camera, uint32_t index, const pupil_libcamera_ask *ask)
{
    return ask->automatic > 0 ? -1 : it.real->queue(camera, index, ask);
}

/* Automatic exposure is turned on again if there is a control for it, and the camera still answers. */
static void test_turned_on_again(void)
{
    enum { ANSWERS, NO_REQUEST_LEFT, NO_ANSWER, NOT_QUEUED, NO_CONTROL, GONE };
    for (int how = ANSWERS; how <= GONE; how++) {
        fake_libcamera_config c;
        pupil_source *source;
        pupil_frame frame;
        fake_libcamera_config_default(&c);
        c.unplug_at = how == GONE ? 3 : 0;
        odd_begin(&c);
        it.layer.wait = wait_runs_out;
        frames_left = 1000;
        if (how == NOT_QUEUED)
            it.layer.queue = queue_never;
        if (how == NO_CONTROL) {
            it.real->offers(it.fake, NULL, &can);
            can.controls &= ~(uint32_t)PUPIL_LIBCAMERA_CAN_AE;
            it.layer.offers = offers_can;
        }
        CHECK(odd_open(&source, NULL) == 0);
        for (int i = 0; i < 3; i++)
            CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
        CHECK(!fake_libcamera_automatic(it.fake));
        if (how == GONE)
            CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FAILED);
        frames_left = how == NO_REQUEST_LEFT ? 0 : how == NO_ANSWER ? 1 : 1000;
        CHECK(pupil_live_give_back(source, &why) == 0);
        /* If no request comes back, there is none to carry the control. */
        CHECK_MSG(fake_libcamera_automatic(it.fake) == (how == ANSWERS || how == NO_ANSWER), "case %d", how);
        frames_left = 1000;
        CHECK(how == GONE || odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
        odd_end(source);
    }
}

static int stops;

static int stop(void)
{
    return stops-- <= 0;
}

/* Ctrl-C while waiting for a camera that is gone; and for one that can be opened again but has no frame. */
static void test_waited_for(void)
{
    fake_libcamera_config c;
    pupil_source *source;
    pupil_frame frame;
    fake_libcamera_config_default(&c);
    c.unplug_at = 3;
    odd_begin(&c);
    stops = 1000;
    CHECK(odd_open(&source, &(pupil_live_options){.capture = {.reopen_s = 5.0, .stop = stop}}) == 0);
    for (int i = 0; i < 3; i++)
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    stops = 2; /* once more while waiting */
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_END);
    odd_end(source);

    c.unplug_at = 0;
    odd_begin(&c);
    it.layer.wait = wait_runs_out;
    frames_left = 3;
    CHECK(odd_open(&source, &(pupil_live_options){.capture = {.reopen_s = 30.0, .timeout_s = 1.0}}) == 0);
    for (int i = 0; i < 3; i++)
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
    CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "it did not come back within 30 seconds"), "%s", why.text);
    odd_end(source);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_lists();
    test_walk();
    test_webcams();
    test_asked();
    test_rates();
    test_linear();
    test_left_alone();
    test_turned_on_again();
    test_waited_for();
    return check_end();
}
