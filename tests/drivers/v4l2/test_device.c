/* Finding a camera, querying it, negotiating a format; what is refused, and with which sentence. */
#include "fake_source.h"

#include <errno.h>
#include <linux/videodev2.h>

#include "v4l2/media/media.h"
#include "v4l2/modes.h"

static pupil_why why;

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    return config;
}

static void test_which(void)
{
    static const struct {
        const char *which, *path, *refusal;
    } cases[] = {
        {"/dev/video0", "/dev/video0", NULL},
        {"0", "/dev/video0", NULL},
        {"000", "/dev/video0", NULL},
        {"3", "/dev/video3", NULL},
        {FAKE_V4L2_NAME, "/dev/video0", NULL}, /* a full name comes before a part of another one */
        {"fake camera", "/dev/video0", NULL},
        {FAKE_V4L2_TWIN, "/dev/video3", NULL},
        {"the other", "/dev/video3", NULL},
        {"fake", NULL,
         "fake: more than one camera has this name; there are Fake Camera (/dev/video0), Fake Camera, the "
         "other (/dev/video3)"},
        {"monitor", NULL, "monitor: no camera has this name; there are Fake Camera (/dev/video0)"},
        {"", NULL, "no camera was named"},
        {"7", NULL, "/dev/video7: is not there; 'pupil list' shows"},
        {"12345", NULL, "255 at most"},
        {"/dev/nothing", NULL, "/dev/nothing: is not there; 'pupil list' shows"},
        {"/dev/video1", NULL, "/dev/video1: Fake Camera is a camera's metadata; a node that captures video is needed"},
        {"2", NULL, "/dev/video2: Fake Monitor is a video output"},
        {"/dev/media0", NULL, "/dev/media0: is not a video device"},
    };
    fake_v4l2_config config = usual();
    config.twin = 1;
    config.media = FAKE_MEDIA_RIGHT;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fake_v4l2 *fake = fake_v4l2_new(&config);
        pupil_v4l2_device d;
        const int error = pupil_v4l2_device_open(&d, fake_v4l2_system(fake), cases[i].which, &why);
        CHECK_MSG((error != 0) == (cases[i].refusal != NULL), "'%s': %s", cases[i].which, error ? why.text : d.path);
        if (error)
            CHECK_MSG(cases[i].refusal && strstr(why.text, cases[i].refusal), "'%s': %s", cases[i].which, why.text);
        else
            CHECK_MSG(cases[i].path && strcmp(d.path, cases[i].path) == 0, "'%s': %s", cases[i].which, d.path);
        CHECK((d.fd >= 0) == (error == 0));
        pupil_v4l2_device_close(&d);
        pupil_v4l2_device_close(&d);
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
    }
    config.absent = 1;
    config.twin = 0;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_v4l2_device d;
    CHECK(pupil_v4l2_device_open(&d, fake_v4l2_system(fake), "webcam", &why));
    CHECK_MSG(strcmp(why.text, "webcam: there is no camera") == 0, "%s", why.text);
    char longest[300];
    memset(longest, '/', sizeof longest);
    longest[sizeof longest - 1] = 0;
    CHECK(pupil_v4l2_device_open(&d, fake_v4l2_system(fake), longest, &why) && strstr(why.text, "longer than 255"));
    fake_v4l2_free(fake);
}

static const pupil_live_mode *find(const pupil_live_modes *modes, uint32_t fourcc)
{
    for (uint32_t i = 0; i < modes->count; i++)
        if (modes->mode[i].fourcc == fourcc)
            return &modes->mode[i];
    return NULL;
}

static void test_modes(void)
{
    fake_v4l2_config config = usual();
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_v4l2_device d;
    pupil_live_modes modes;
    char text[256], little[12];
    CHECK(pupil_v4l2_device_open(&d, fake_v4l2_system(fake), "0", &why) == 0);
    CHECK(strcmp(d.name, FAKE_V4L2_NAME) == 0 && strcmp(d.driver, "fake") == 0 && strcmp(d.bus, "fake:1") == 0);
    CHECK(pupil_v4l2_modes_read(&d, &modes, &why) == 0 && modes.count == 49);
    const pupil_live_mode *yuyv = find(&modes, V4L2_PIX_FMT_YUYV), *any = find(&modes, V4L2_PIX_FMT_Y16);
    const pupil_live_mode *mjpg = find(&modes, V4L2_PIX_FMT_MJPEG);
    CHECK(yuyv && yuyv->sizes == 3 && yuyv->read && !yuyv->compressed);
    CHECK(yuyv && yuyv->size[0].rates == 3 && yuyv->size[0].fps[0] == 5.0 && yuyv->size[0].fps[2] == 30.0);
    CHECK(mjpg && mjpg->compressed && mjpg->read);
    pupil_live_mode_text(yuyv, text, sizeof text);
    CHECK_MSG(strcmp(text, "64x48@30,15,5 32x24@30,15,5 320x240@30,15,5") == 0, "%s", text);
    pupil_live_mode_text(any, text, sizeof text);
    CHECK_MSG(strcmp(text, "32x24..320x240@30,15,5") == 0, "%s", text);
    pupil_live_mode_text(yuyv, little, sizeof little);
    CHECK(strcmp(little, "64x48@30,15") == 0);
    pupil_live_modes_free(&modes);
    pupil_v4l2_device_close(&d);
    fake_v4l2_free(fake);
}

/* A request is fulfilled, or refused with what is available. */
static void test_agreement(void)
{
    static const struct {
        pupil_v4l2_options options;
        uint32_t fourcc, width;
        double fps;
        const char *refusal;
    } cases[] = {
        {{0}, V4L2_PIX_FMT_YUYV, 64, 30, NULL},
        {{.fourcc = V4L2_PIX_FMT_NV12, .width = 320, .height = 240, .fps = 15}, V4L2_PIX_FMT_NV12, 320, 15, NULL},
        {{.fps = 5}, V4L2_PIX_FMT_YUYV, 64, 5, NULL},
        {{.fps = 29.97}, V4L2_PIX_FMT_YUYV, 64, 30, NULL},
        {{.width = 320}, V4L2_PIX_FMT_YUYV, 320, 30, NULL}, /* the height that the driver has for it */
        {{.width = 640, .height = 480},
         0,
         0,
         0,
         "/dev/video0: Fake Camera offers no 640x480 of YUYV (320x240 of YUYV instead); it has MJPG, YUYV, NV12, "},
        {{.width = 640, .height = 480}, 0, 0, 0, ", XB24, XR24, AR24: 64x48@30"},
        {{.width = 640, .height = 480}, 0, 0, 0, ": 64x48@30,15,5 32x24@30,15,5 320x240@30,15,5"},
        {{.fps = 25}, 0, 0, 0, "offers no 25 frames a second at 64x48 (30 instead)"},
        {{.fps = -1}, 0, 0, 0, "-1 frames a second; it must be from 0.001"},
        {{.width = 20000}, 0, 0, 0, "a size of 20000x0; at most 16384x16384"},
        {{.fourcc = V4L2_PIX_FMT_MJPEG}, V4L2_PIX_FMT_MJPEG, 64, 30, NULL},
        {{.fourcc = V4L2_PIX_FMT_H264}, 0, 0, 0, "format H264 is not supported; supported: RGGB"},
        {{.fourcc = V4L2_PIX_FMT_NV12M}, 0, 0, 0, "offers no 64x48 of NM12 (64x48 of MJPG instead)"},
        {{.buffers = 1}, 0, 0, 0, "1 buffers; it must be from 2 to 32"},
        {{.buffers = 33}, 0, 0, 0, "33 buffers"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const fake_v4l2_config config = usual();
        fake_source s = fake_source_open("/dev/video0", &config, &cases[i].options);
        CHECK_MSG((s.result != 0) == (cases[i].refusal != NULL), "case %zu: %s", i, s.result ? s.why.text : "taken");
        if (cases[i].refusal) {
            CHECK_MSG(strstr(s.why.text, cases[i].refusal), "case %zu: %s", i, s.why.text);
        } else if (s.source) {
            const pupil_v4l2_format *f = &pupil_live_capture(s.source)->format;
            CHECK_MSG(f->fourcc == cases[i].fourcc && f->width == cases[i].width && s.source->fps == cases[i].fps,
                      "case %zu: %s %u %g", i, pupil_v4l2_fourcc_name(f->fourcc).text, f->width, s.source->fps);
        }
        fake_source_close(&s);
    }
}

static void check_refused(const fake_v4l2_config *config, const char *sentence)
{
    fake_source s = fake_source_open("/dev/video0", config, NULL);
    CHECK_MSG(s.result == PUPIL_SOURCE_FAILED && strstr(s.why.text, sentence), "%s", s.why.text);
    fake_source_close(&s);
}

static void test_refusals(void)
{
    fake_v4l2_config c = usual();
    c.format_error = EBUSY;
    check_refused(&c, "/dev/video0: refuses the format: another program is using the camera");
    c = usual();
    c.start_error = ENOSPC;
    check_refused(&c, "/dev/video0: does not start: the USB bus has no room");
    c = usual();
    c.most_buffers = 1;
    check_refused(&c, "its driver gives 1 buffer; two are the least");
    c = usual();
    c.only_format = V4L2_PIX_FMT_H264;
    check_refused(&c, "Fake Camera offers H264, which is not supported; supported: RGGB, RG10");
    c = usual();
    c.xfer_func = V4L2_XFER_FUNC_DCI_P3;
    check_refused(&c, "/dev/video0: Fake Camera: its transfer function is DCI-P3; sRGB, Rec. 709, SMPTE 2084 (PQ) or "
                      "none can be read");

    /* Two programs. */
    c = usual();
    fake_source first = fake_source_open("/dev/video0", &c, NULL);
    const pupil_v4l2_options options = {.system = fake_v4l2_system(first.fake)};
    pupil_source *second = NULL;
    CHECK(pupil_live_open("/dev/video0", NULL, &(pupil_live_options){.capture = options, .hands_off = 1}, &second,
                          &why) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "another program is using the camera"), "%s", why.text);
    fake_source_close(&first);

    /* A camera without any extras. */
    c = usual();
    c.no_rate = c.no_events = c.no_sizes = c.no_mmap = 1;
    fake_source plain = fake_source_open("v4l2:0", &c, NULL);
    pupil_frame frame;
    CHECK_MSG(plain.result == 0 && plain.source->fps == 30.0, "%s", plain.why.text);
    CHECK(fake_source_next(&plain, &frame) == PUPIL_SOURCE_FRAME);
    CHECK(pupil_live_capture(plain.source)->memory == V4L2_MEMORY_USERPTR);
    fake_source_close(&plain);

    /* The options of any source take precedence over those of cameras. */
    c = usual();
    fake_v4l2 *fake = fake_v4l2_new(&c);
    const pupil_source_options any = {.width = 32, .height = 24, .fps = 15};
    const pupil_v4l2_options more = {.system = fake_v4l2_system(fake), .width = 320, .height = 240};
    CHECK(pupil_live_open("0", &any, &(pupil_live_options){.capture = more, .hands_off = 1}, &second, &why) == 0 &&
          second->fps == 15.0);
    CHECK(pupil_live_capture(second)->format.width == 32);
    pupil_source_close(second);
    fake_v4l2_free(fake);
}

static void test_media(void)
{
    static const struct {
        uint32_t media;
        int error;
        const char *sentence;
    } cases[] = {
        {FAKE_MEDIA_LINK_OFF, ENOLINK,
         "/dev/video0: does not start: the link from fake 1-0010 to fake csi is off; this turns it on: media-ctl -d "
         "/dev/media0 -l '\"fake 1-0010\":0 -> \"fake csi\":0 [1]'"},
        {FAKE_MEDIA_PADS_DIFFER, EPIPE,
         "/dev/video0: does not start: fake 1-0010 sends SRGGB10_1X10/320x240, but fake csi takes SRGGB10_1X10/64x48; "
         "this mends it: media-ctl -d /dev/media0 -V '\"fake csi\":0 [fmt:SRGGB10_1X10/320x240]'"},
        {FAKE_MEDIA_CODES_DIFFER, EPIPE,
         "fake 1-0010 sends RGB888_1X24/64x48, but fake csi takes SRGGB10_1X10/64x48; this mends it: media-ctl -d "
         "/dev/media0 -V '\"fake 1-0010\":0 [fmt:SRGGB10_1X10/64x48]'"}, /* the receiver would not take RGB */
        {FAKE_MEDIA_NODE_DIFFERS, EPIPE,
         "fake csi sends SRGGB10_1X10/320x240, and 64x48 of RG10 are asked for; ask for what is sent, or change it: "
         "media-ctl -d /dev/media0 -V '\"fake csi\":1 [fmt:SRGGB10_1X10/64x48]'"},
        {FAKE_MEDIA_RIGHT, EPIPE,
         "does not start: what leads to it in /dev/media0 agrees; its sensor may feed another node that is set to "
         "another format ('media-ctl -d /dev/media0 -p'"},
        {FAKE_MEDIA_NONE, EPIPE, "does not start: Broken pipe"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fake_v4l2_config c = usual();
        c.only_format = V4L2_PIX_FMT_SRGGB10;
        c.media = cases[i].media;
        c.start_error = cases[i].error;
        check_refused(&c, cases[i].sentence);

        pupil_v4l2_device d;
        pupil_v4l2_sensor sensor;
        fake_v4l2 *fake = fake_v4l2_new(&c);
        CHECK(pupil_v4l2_device_open(&d, fake_v4l2_system(fake), "0", &why) == 0);
        const int error = pupil_v4l2_media_sensor(&d, &sensor, &why);
        if (c.media == FAKE_MEDIA_NONE) {
            CHECK_MSG(error && strcmp(why.text, "/dev/video0: has no media graph") == 0, "%s", why.text);
        } else { /* with its link disabled, the path ends at the receiver */
            const int off = c.media == FAKE_MEDIA_LINK_OFF;
            CHECK(error == 0 && strcmp(sensor.entity, off ? "fake csi" : "fake 1-0010") == 0);
            CHECK(strcmp(sensor.path, off ? "/dev/v4l-subdev1" : "/dev/v4l-subdev0") == 0);
            CHECK(strcmp(sensor.media, "/dev/media0") == 0);
        }
        pupil_v4l2_device_close(&d);
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
    }
}

/* A node with another format than its input. */
static void test_media_format(void)
{
    fake_v4l2_config c = usual();
    c.only_format = V4L2_PIX_FMT_SRGGB8;
    c.media = FAKE_MEDIA_RIGHT;
    c.start_error = EPIPE;
    check_refused(&c,
                  "fake csi sends SRGGB10_1X10/64x48, and 64x48 of RGGB are asked for; ask for what is sent, or change "
                  "it: media-ctl -d /dev/media0 -V '\"fake csi\":1 [fmt:SRGGB8_1X8/64x48]'");
    c.only_format = V4L2_PIX_FMT_SRGGB10P; /* the same in memory, packed */
    check_refused(&c, "what leads to it in /dev/media0 agrees");
    c.only_format = V4L2_PIX_FMT_NV12; /* may be driven by anything */
    check_refused(&c, "what leads to it in /dev/media0 agrees");
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_which();
    test_modes();
    test_agreement();
    test_refusals();
    test_media();
    test_media_format();
    return check_end();
}
