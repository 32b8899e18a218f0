/* A libcamera stream: requests that do not come back, cameras that are unplugged and come back, names, layouts. */
#include "rig.h"

#include <time.h>

static uint64_t frames_of(rig *r, int most)
{
    uint64_t frames = 0;
    for (int i = 0; i < most && rig_next(r, 0) == PUPIL_SOURCE_FRAME; i++)
        frames++;
    return frames;
}

/* Up to two lost requests cost at most speed; after more the stream is started again. */
static void test_lost(void)
{
    for (uint64_t lose = 1; lose <= 4; lose++)
        for (int i = 0; i < 2; i++) {
            fake_libcamera_config c;
            rig r;
            fake_libcamera_config_default(&c);
            c.lose_at = i ? 9 : 1;
            c.lose = lose;
            CHECK_MSG(rig_open(&r, &c, NULL) == 0, "%s", why.text);
            const uint64_t came = frames_of(&r, 200);
            CHECK_MSG(came == 200, "%llu lost: %llu frames, %s", (unsigned long long)lose, (unsigned long long)came,
                      why.text);
            CHECK_MSG(rig_counts(&r)->restarted == (lose >= 3), "%llu lost: %llu restarts", (unsigned long long)lose,
                      (unsigned long long)rig_counts(&r)->restarted);
            CHECK(!fake_libcamera_automatic(r.fake)); /* after a restart, too */
            rig_close(&r);
        }
}

/* A pipeline with a single buffer. */
static void test_one_buffer(void)
{
    fake_libcamera_config c;
    rig r;
    fake_libcamera_config_default(&c);
    c.buffers = 1;
    CHECK(rig_open(&r, &c, NULL) == 0);
    CHECK(frames_of(&r, 50) == 50 && rig_counts(&r)->restarted == 0);
    rig_close(&r);
}

/* No frame, or only cancelled ones: a sentence, after the stream was restarted once. */
static void test_stalled(void)
{
    for (int cancels = 0; cancels < 2; cancels++) {
        fake_libcamera_config c;
        rig r;
        fake_libcamera_config_default(&c);
        c.dead = !cancels;
        c.cancels = cancels;
        CHECK_MSG(rig_open(&r, &c, &(pupil_live_options){.capture = {.timeout_s = 2.0}}) == 0, "%s", why.text);
        CHECK(rig_next(&r, 0) == PUPIL_SOURCE_FAILED);
        CHECK_MSG(strstr(why.text, "no frame within 2 seconds, and none after the stream was started again"), "%s",
                  why.text);
        CHECK(rig_next(&r, 0) == PUPIL_SOURCE_FAILED && strstr(why.text, "the camera is closed"));
        rig_close(&r);
    }
}

static void test_unplugged(void)
{
    fake_libcamera_config c;
    rig r;
    fake_libcamera_config_default(&c);
    c.unplug_at = 20;
    CHECK(rig_open(&r, &c, NULL) == 0);
    CHECK(frames_of(&r, 100) == 20);
    CHECK_MSG(strcmp(why.text, "libcamera:\\_SB_.PCI0.XHCI-2.1:1.0-1bcf:2b9e: the camera was unplugged") == 0, "%s",
              why.text);
    rig_close(&r);

    CHECK(rig_open(&r, &c, &(pupil_live_options){.capture = {.reopen_s = 1.0}}) == 0);
    CHECK(frames_of(&r, 100) == 20);
    CHECK_MSG(strstr(why.text, "unplugged; it did not come back within 1 seconds"), "%s", why.text);
    rig_close(&r);

    c.back_s = 0.4;
    CHECK(rig_open(&r, &c, &(pupil_live_options){.capture = {.reopen_s = 5.0}}) == 0);
    CHECK(frames_of(&r, 20) == 20);
    const uint64_t last = r.info.sequence;
    CHECK_MSG(frames_of(&r, 1) == 1, "%s", why.text);
    CHECK(r.info.sequence == last + 1 && rig_counts(&r)->reopened == 1);
    CHECK(pupil_live_camera(r.source) != NULL && !fake_libcamera_automatic(r.fake));
    rig_close(&r);
}

static int stops;

static int stop(void)
{
    return stops;
}

static void test_stopped(void)
{
    fake_libcamera_config c;
    rig r;
    fake_libcamera_config_default(&c);
    CHECK(rig_open(&r, &c, &(pupil_live_options){.capture = {.stop = stop}}) == 0);
    CHECK(frames_of(&r, 5) == 5);
    stops = 1;
    CHECK(rig_next(&r, 0) == PUPIL_SOURCE_END);
    stops = 0;
    rig_close(&r);
}

/* Late frames, by the numbers; with `newest` they are left out, and counted. */
static void test_late(void)
{
    for (int newest = 0; newest < 2; newest++) {
        fake_libcamera_config c;
        rig r;
        fake_libcamera_config_default(&c);
        CHECK(rig_open(&r, &c, &(pupil_live_options){.capture = {.late = newest}}) == 0);
        CHECK(frames_of(&r, 5) == 5);
        const uint64_t before = r.info.sequence;
        fake_libcamera_pass(r.fake, 1.0); /* 4 wait, and 26 are lost */
        CHECK(frames_of(&r, 1) == 1);
        CHECK_MSG(r.info.sequence == before + (newest ? 4 : 1), "%llu after %llu", (unsigned long long)r.info.sequence,
                  (unsigned long long)before);
        CHECK(rig_counts(&r)->late == (newest ? 3 : 0));
        CHECK(frames_of(&r, 10) == 10);
        CHECK_MSG(rig_counts(&r)->lost == 26, "%llu lost", (unsigned long long)rig_counts(&r)->lost);
        rig_close(&r);
    }
}

static void test_hands_off(void)
{
    fake_libcamera_config c;
    rig r;
    const fake_libcamera_log *log;
    fake_libcamera_config_default(&c);
    CHECK(rig_open(&r, &c, &(pupil_live_options){.hands_off = 1}) == 0);
    CHECK(frames_of(&r, 20) == 20 && !pupil_live_camera(r.source));
    CHECK(strstr(pupil_live_no_controls(r.source), "left alone") != NULL && r.info.exposure_s == 0.0);
    const size_t logged = fake_libcamera_logged(r.fake, &log);
    for (size_t i = 0; i < logged; i++)
        CHECK(!log[i].ask.automatic && log[i].ask.exposure_s == 0.0);
    CHECK(fake_libcamera_automatic(r.fake));
    rig_close(&r);
    c.no_exposure = 1; /* vimc */
    CHECK(rig_open(&r, &c, NULL) == 0);
    CHECK(frames_of(&r, 5) == 5 && !pupil_live_camera(r.source));
    CHECK_MSG(strstr(pupil_live_no_controls(r.source), "libcamera has no control of this camera's exposure time"), "%s",
              pupil_live_no_controls(r.source));
    rig_close(&r);
}

/* The black level from the frame's metadata, and the positions of rows and planes. */
static void test_layout(void)
{
    fake_libcamera_config c;
    rig r;
    pupil_frame frame;
    pupil_camera_sensor known;
    fake_libcamera_config_default(&c);
    c.sensor = 1;
    c.fourcc = V4L2_PIX_FMT_SRGGB10;
    c.black = 4096;
    c.padding_bytes = 32;
    CHECK(rig_open(&r, &c, NULL) == 0);
    CHECK(pupil_live_find_sensor(r.source, &known) == 1 && strcmp(known.name, "imx219") == 0);
    CHECK(pupil_source_next(r.source, &frame, &why) == PUPIL_SOURCE_FRAME);
    CHECK(frame.image.coding->black == 64.0f && frame.image.pixel == PUPIL_PIXEL_BAYER10);
    CHECK(frame.image.stride_bytes == 64 * 2 + 32 && frame.image.width == 64 && frame.image.height == 48);
    const unsigned char *last = (const unsigned char *)frame.image.data + 47 * frame.image.stride_bytes;
    CHECK(memcmp(last, frame.image.data, 128) == 0);
    pupil_source_done(r.source, &frame);
    rig_close(&r);

    fake_libcamera_config_default(&c);
    c.fourcc = V4L2_PIX_FMT_NV12;
    CHECK_MSG(rig_open(&r, &c, NULL) == 0, "%s", why.text);
    for (int i = 0; i < 6; i++) {
        CHECK(pupil_source_next(r.source, &frame, &why) == PUPIL_SOURCE_FRAME);
        const unsigned char *chroma = frame.image.chroma;
        CHECK(chroma[0] == (frame.info.sequence & 255) && chroma[64 * 24 - 1] == (frame.info.sequence & 255));
        CHECK(frame.info.timestamp_ns == (int64_t)(frame.info.sequence) * 33333333 &&
              pupil_live_get(r.source)->times.stamp == PUPIL_LIVE_STAMP_START_OF_EXPOSURE);
        pupil_source_done(r.source, &frame);
    }
    rig_close(&r);

    CHECK(rig_open(&r, &c, &(pupil_live_options){.capture = {.width = 65}}) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "has no frames of 65x48; the nearest are of 64x48"), "%s", why.text);
    CHECK(fake_libcamera_opened(r.fake) == 0);
    fake_libcamera_free(r.fake);

    c.fourcc = V4L2_PIX_FMT_MJPEG;
    CHECK(rig_open(&r, &c, NULL) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "only compressed frames") && strstr(why.text, "v4l2:"), "%s", why.text);
    CHECK(fake_libcamera_opened(r.fake) == 0);
    fake_libcamera_free(r.fake);
}

static void test_names(void)
{
    static const struct {
        const char *name, *sentence; /* NULL: it is the camera */
    } cases[] = {{"libcamera:", NULL},
                 {"libcamera:0", NULL},
                 {"libcamera:imx219", NULL},
                 {"libcamera:IMX", NULL},
                 {"libcamera:/base/soc/i2c0mux/i2c@1/imx219@10", NULL},
                 {"libcamera:1", "libcamera:1: libcamera has no such camera"}, /* i2c@1 is no number */
                 {"libcamera:ov5647", "libcamera has no such camera"}};
    fake_libcamera_config c;
    fake_libcamera_config_default(&c);
    c.sensor = 1;
    fake_libcamera *fake = fake_libcamera_new(&c);
    const pupil_live_system system = {.libcamera = fake_libcamera_layer(fake)};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        pupil_source *source = NULL;
        const pupil_live_options options = {.system = &system};
        const int failed = pupil_live_open(cases[i].name, NULL, &options, &source, &why);
        CHECK_MSG(failed == (cases[i].sentence ? PUPIL_SOURCE_FAILED : 0), "%s: %s", cases[i].name, why.text);
        if (failed)
            CHECK_MSG(strstr(why.text, cases[i].sentence), "%s: %s", cases[i].name, why.text);
        pupil_source_close(source);
        CHECK(pupil_live_is_camera(cases[i].name));
    }
    pupil_live_offers offers = {.controls = 0};
    CHECK(pupil_live_offers_read(&offers, &system, "libcamera:0", &why) == 0);
    CHECK(strcmp(offers.is.name, "imx219") == 0 && strcmp(offers.is.driver, "libcamera") == 0 && offers.controls == 1);
    CHECK(offers.has_sensor && offers.modes.count == 1 && strcmp(offers.entity, "imx219") == 0);
    pupil_live_modes_free(&offers.modes);
    fake_libcamera_free(fake);

    const pupil_live_system none = {.libcamera = NULL};
    pupil_source *source = NULL;
    CHECK(pupil_live_open("libcamera:0", NULL, &(pupil_live_options){.system = &none}, &source, &why));
    CHECK_MSG(strstr(why.text, "built without libcamera (PUPIL_LIBCAMERA=OFF"), "%s", why.text);
}

/* A full model name selects that camera, even if it is part of another's. */
static void test_twins(void)
{
    static const struct {
        const char *name, *sentence;
    } cases[] = {{"libcamera:imx219", NULL},
                 {"libcamera:IMX219", NULL},
                 {"libcamera:i2c@1/", NULL},
                 {"libcamera:imx", "more than one camera has this name"},
                 {"libcamera:wide", "imx219_wide@10: there is no such camera"}};
    fake_libcamera_config c;
    fake_libcamera_config_default(&c);
    c.sensor = c.twin = 1;
    fake_libcamera *fake = fake_libcamera_new(&c);
    const pupil_live_system system = {.libcamera = fake_libcamera_layer(fake)};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        pupil_live_offers offers = {.controls = 0};
        const int failed = pupil_live_offers_read(&offers, &system, cases[i].name, &why);
        CHECK_MSG(!failed == !cases[i].sentence, "%s: %s", cases[i].name, why.text);
        if (failed && cases[i].sentence)
            CHECK_MSG(strstr(why.text, cases[i].sentence), "%s: %s", cases[i].name, why.text);
        if (!failed)
            CHECK_MSG(strcmp(offers.is.name, "imx219") == 0, "%s: %s", cases[i].name, offers.is.name);
        pupil_live_modes_free(&offers.modes);
    }
    fake_libcamera_free(fake);
}

/* Only frames, at a rate; and a camera that cannot set one. */
static void test_hands_off_rate(void)
{
    fake_libcamera_config c;
    rig r;
    const fake_libcamera_log *log;
    fake_libcamera_config_default(&c);
    const pupil_live_options options = {.capture = {.fps = 15.0}, .hands_off = 1};
    CHECK(rig_open(&r, &c, &options) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "cannot set the frame rate"), "%s", why.text);
    fake_libcamera_free(r.fake);
    c.sensor = 1;
    CHECK(rig_open(&r, &c, &options) == 0 && r.source->fps == 15.0);
    CHECK(fake_libcamera_logged(r.fake, &log) == 4 && fabs(log[0].ask.frame_most_s - 1.0 / 15) < 1e-9);
    CHECK(log[0].ask.automatic == 0 && log[1].ask.frame_most_s == 0.0);
    rig_close(&r);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_lost();
    test_one_buffer();
    test_stalled();
    test_unplugged();
    test_stopped();
    test_late();
    test_hands_off();
    test_layout();
    test_names();
    test_twins();
    test_hands_off_rate();
    return check_end();
}
