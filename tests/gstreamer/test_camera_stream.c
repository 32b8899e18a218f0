/* A live camera's frames as in pupilsrc, without an element: settings that are refused, exposure limits within the
 * camera's, a camera that is unplugged and comes back, controls that cannot be written. */
#include "gstreamer/camera_stream.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <time.h>

#include "check.h"
#include "refusing_camera.h"

static pupil_why why;

static camera_settings usual(void)
{
    camera_settings s = {.mains_hz = PUPIL_SENSOR_MAINS_AUTO};
    pupil_config_default(&s.picture);
    return s;
}

static int open_stream(camera_stream *s, const pupil_live_options *more, const camera_settings *settings)
{
    const pupil_colour_options colours = {.balance = PUPIL_COLOUR_OFF};
    pupil_live_options options = more ? *more : (pupil_live_options){0};
    options.system = &rig.system;
    memset(s, 0, sizeof *s);
    why.text[0] = 0;
    return camera_stream_open(s, "/dev/video0", &options, &colours, settings, &why);
}

static void unplug(camera_stream *s)
{
    camera_stream_close(s, &why);
    CHECK(camera_stream_close(s, &why) == 0); /* of a closed one */
    const fake_v4l2_held held = fake_v4l2_holds(rig.fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(rig.fake);
}

static fake_v4l2_config camera_of(uint32_t fourcc)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.only_format = fourcc;
    config.width = 32;
    config.height = 24;
    return config;
}

/* The next frame, into a picture of `width`. Returns what camera_stream_show does. */
static int show(camera_stream *s, uint32_t width)
{
    static unsigned char pixels[64 * 24 * 4];
    const pupil_image out = pupil_image_of(pixels, width, 24, PUPIL_PIXEL_RGBA8);
    pupil_frame frame;
    const int got = pupil_source_next(s->source, &frame, &why);
    CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s", why.text);
    if (got != PUPIL_SOURCE_FRAME)
        return -1;
    const int failed = camera_stream_show(s, &frame, &out, &why);
    pupil_source_done(s->source, &frame);
    return failed;
}

static void doze(void)
{
    const struct timespec moment = {0, 1000000};
    nanosleep(&moment, NULL);
}

/* Waits until the setting is written or refused; the whole test has a time limit. */
static void await_write(const camera_stream *s)
{
    pupil_camera_status status;
    for (pupil_camera_get_status(s->camera, &status); status.written != status.asks;
         pupil_camera_get_status(s->camera, &status))
        doze();
}

static void test_open(void)
{
    fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    camera_settings settings = usual();
    settings.picture.key = 7.0;
    plug_camera(&config);
    CHECK(open_stream(&s, NULL, &settings) == -1 && !s.source);
    CHECK_MSG(strstr(why.text, "/dev/video0: the settings are refused"), "%s", why.text);
    unplug(&s);
    config.absent = 1;
    settings = usual();
    plug_camera(&config);
    CHECK(open_stream(&s, NULL, &settings) == -1 && !s.source);
    CHECK_MSG(strstr(why.text, "is not there"), "%s", why.text);
    unplug(&s);
}

/* Refused settings change nothing, not even by their valid parts. */
static void test_retune(void)
{
    const fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    camera_settings settings = usual(), other = usual();
    plug_camera(&config);
    CHECK(open_stream(&s, NULL, &settings) == 0 && show(&s, 32) == 0);
    other.picture.key = 0.25;
    other.mains_hz = 17;
    CHECK(camera_stream_retune(&s, &other, &why) == -1);
    CHECK_MSG(strstr(why.text, "mains_hz"), "%s", why.text);
    CHECK(s.settings.picture.key == 0.18 && s.config.key == 0.18 && s.settings.mains_hz == PUPIL_SENSOR_MAINS_AUTO);
    other.mains_hz = 50;
    other.picture.key = 7.0;
    CHECK(camera_stream_retune(&s, &other, &why) == -1);
    CHECK_MSG(strstr(why.text, "key"), "%s", why.text);
    CHECK(s.settings.picture.key == 0.18 && s.loop.config.mains_hz == PUPIL_SENSOR_MAINS_AUTO);
    other.picture.key = 0.25;
    CHECK(camera_stream_retune(&s, &other, &why) == 0);
    CHECK(s.settings.picture.key == 0.25 && s.config.key == 0.25 && s.loop.config.mains_hz == 50);
    CHECK(show(&s, 32) == 0);
    unplug(&s);
}

/* Limits of the settings are within the camera's; a frame lasts as long as its shortest exposure. */
static void test_limits(void)
{
    static const struct {
        double exposure_min_s, exposure_max_s, gain_min, gain_max; /* as they are set */
        double least_s, most_s, least, most, frame_s;              /* expected; 0: the camera's */
    } cases[] = {{0, 0, 0, 0, 0, 0, 0, 0, 1.0 / 30},
                 {0.001, 0.004, 2, 3, 0.001, 0.004, 2, 3, 1.0 / 30},
                 {1e-9, 100, 0.1, 1e4, 0, 0, 0, 0, 1.0 / 30},
                 {0.05, 0.06, 0, 0, 0.05, 0.06, 0, 0, 0.05}};
    const fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        camera_stream s;
        pupil_camera_limits l;
        camera_settings settings = usual();
        settings.exposure_min_s = cases[i].exposure_min_s;
        settings.exposure_max_s = cases[i].exposure_max_s;
        settings.gain_min = cases[i].gain_min;
        settings.gain_max = cases[i].gain_max;
        plug_camera(&config);
        CHECK(open_stream(&s, NULL, &settings) == 0);
        CHECK_MSG(show(&s, 32) == 0, "%s", why.text);
        pupil_camera_get_limits(s.camera, &l);
        const pupil_sensor_config *c = &s.loop.config;
        CHECK_MSG(c->exposure_min_s == (cases[i].least_s > 0 ? cases[i].least_s : l.exposure_min_s) &&
                      c->exposure_max_s == (cases[i].most_s > 0 ? cases[i].most_s : l.exposure_max_s),
                  "case %zu: %g to %g s", i, c->exposure_min_s, c->exposure_max_s);
        CHECK_MSG(c->gain_min == (cases[i].least > 0 ? cases[i].least : l.gain_min) &&
                      c->gain_max == (cases[i].most > 0 ? cases[i].most : l.gain_max),
                  "case %zu: %g to %g", i, c->gain_min, c->gain_max);
        CHECK_MSG(fabs(c->frame_s - cases[i].frame_s) < 1e-9, "case %zu: frames of %g s", i, c->frame_s);
        unplug(&s);
    }
}

/* A picture or colours that do not suit the frames: a sentence. */
static void test_refused(void)
{
    const fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    const camera_settings settings = usual();
    plug_camera(&config);
    CHECK(open_stream(&s, NULL, &settings) == 0);
    CHECK(show(&s, 33) == -1);
    CHECK_MSG(strstr(why.text, "/dev/video0 frame 0: "), "%s", why.text);
    CHECK(show(&s, 32) == 0);
    s.has_colour = 0;
    s.colours.knees = 2;
    CHECK(show(&s, 32) == -1);
    CHECK_MSG(strstr(why.text, "knees"), "%s", why.text);
    unplug(&s);
}

/* In hands-off mode nothing is steered: the status is the level's. */
static void test_left_alone(void)
{
    const fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    camera_settings settings = usual();
    plug_camera(&config);
    CHECK(open_stream(&s, &(pupil_live_options){.hands_off = 1}, &settings) == 0 && show(&s, 32) == 0);
    CHECK_MSG(strcmp(camera_stream_state(&s), "settled") == 0, "%s", camera_stream_state(&s));
    CHECK_MSG(strcmp(camera_stream_reason(&s), "none") == 0, "%s", camera_stream_reason(&s));
    settings.mains_hz = 17; /* of the exposure, which is not steered */
    CHECK(camera_stream_retune(&s, &settings, &why) == 0);
    unplug(&s);
}

/* A camera that comes back gets the last wanted total, not its setting at plugging in. */
static void test_comes_back(void)
{
    fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    const camera_settings settings = usual();
    config.unplug_at = 120;
    config.back_s = 0.5;
    config.flat = 60;
    plug_camera(&config);
    CHECK(open_stream(&s, &(pupil_live_options){.capture = {.reopen_s = 10.0}}, &settings) == 0);
    for (int i = 0; i < 120; i++) {
        CHECK(show(&s, 32) == 0);
        await_write(&s);
    }
    const double total_s = s.loop.setting.total_s;
    const pupil_camera *before = s.camera;
    CHECK_MSG(strcmp(camera_stream_state(&s), "converged") == 0, "%s", camera_stream_state(&s));
    unsigned lost = 0;
    do {
        CHECK_MSG(show(&s, 32) == 0, "%s", why.text);
        if (!s.camera) {
            lost++;
            CHECK(strcmp(camera_stream_state(&s), "searching") == 0);
            doze();
        }
    } while (!s.camera);
    CHECK_MSG(lost > 0 && before != NULL, "%u frames without", lost);
    CHECK_MSG(fabs(log2(s.loop.setting.total_s / total_s)) < 0.5, "%g s after %g s", s.loop.setting.total_s, total_s);
    unplug(&s);
}

/* Refused writes are reported and asked for again; at the end it is reported that the controls are not restored. */
static void test_refusals(void)
{
    fake_v4l2_config config = camera_of(V4L2_PIX_FMT_YUYV);
    camera_stream s;
    const camera_settings settings = usual();
    plug_camera(&config);
    struct v4l2_control automatic = {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY};
    const int fd = rig.inside->open(rig.inside->context, "/dev/video0");
    CHECK(rig.inside->ioctl(rig.inside->context, fd, VIDIOC_S_CTRL, &automatic) == 0);
    rig.inside->close(rig.inside->context, fd);
    CHECK(open_stream(&s, NULL, &settings) == 0 && show(&s, 32) == 0);
    await_write(&s);
    rig.refuses = 1;
    fake_v4l2_light(rig.fake, 8.0);
    int frames = 0;
    for (; frames < 30 && strcmp(camera_stream_reason(&s), "refused") != 0; frames++) {
        CHECK(show(&s, 32) == 0);
        await_write(&s);
    }
    CHECK_MSG(frames < 30, "%s, %s", camera_stream_state(&s), camera_stream_reason(&s));
    CHECK(camera_stream_close(&s, &why) == -1);
    CHECK_MSG(strstr(why.text, "/dev/video0"), "%s", why.text);
    unplug(&s);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_open();
    test_retune();
    test_limits();
    test_refused();
    test_left_alone();
    test_comes_back();
    test_refusals();
    return check_end();
}
