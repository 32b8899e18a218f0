/* What is known of a live camera and its frames, and the precedence of options. */
#include <errno.h>
#include <linux/media.h>
#include <linux/videodev2.h>

#include "live_camera.h"

static void close_all(pupil_source *source, fake_v4l2 *fake)
{
    pupil_source_close(source);
    CHECK(fake_v4l2_holds(fake).files == 0);
    fake_v4l2_free(fake);
}

static const pupil_v4l2_system *inside;

/* The graph's sensor is an IMX219. */
static int as_imx219(void *context, int fd, unsigned long request, void *argument)
{
    const int result = inside->ioctl(context, fd, request, argument);
    if (result || request != MEDIA_IOC_G_TOPOLOGY)
        return result;
    const struct media_v2_topology *t = argument;
    struct media_v2_entity *entity = (struct media_v2_entity *)(uintptr_t)t->ptr_entities;
    for (uint32_t i = 0; entity && i < t->num_entities; i++)
        if (entity[i].function == MEDIA_ENT_F_CAM_SENSOR)
            snprintf(entity[i].name, sizeof entity[i].name, "imx219 10-0010");
    return 0;
}

/* A sensor behind a media graph is known by its name; a webcam has none. */
static void test_sensor(void)
{
    enum { WEBCAM, UNKNOWN, IMX219 };
    for (int which = WEBCAM; which <= IMX219; which++) {
        fake_v4l2_config config;
        pupil_camera_sensor known = {.name = ""};
        pupil_source *source = NULL;
        fake_v4l2_config_default(&config);
        config.media = which == WEBCAM ? FAKE_MEDIA_NONE : FAKE_MEDIA_RIGHT;
        config.only_format = which == WEBCAM ? 0 : V4L2_PIX_FMT_SRGGB10;
        fake_v4l2 *fake = fake_v4l2_new(&config);
        inside = fake_v4l2_system(fake);
        pupil_v4l2_system system = *inside;
        system.ioctl = which == IMX219 ? as_imx219 : system.ioctl;
        const pupil_live_options options = {.capture = {.system = &system}};
        CHECK_MSG(pupil_live_open("/dev/video0", NULL, &options, &source, &why) == 0, "%s", why.text);
        CHECK(pupil_live_find_sensor(source, &known) == (which == IMX219));
        CHECK_MSG(strcmp(known.name, which == IMX219 ? "imx219" : "") == 0, "%s", known.name);
        close_all(source, fake);
    }
}

/* Timestamps of a frame's end or of its exposure's beginning give the same frame in progress, and the same number of
 * frames until a setting is in force. */
static void test_stamps(void)
{
    uint64_t from[2];
    for (uint32_t stamp = FAKE_STAMP_END_OF_FRAME; stamp <= FAKE_STAMP_START_OF_EXPOSURE; stamp++) {
        fake_v4l2_config config;
        pupil_frame_info info = {0};
        pupil_camera_status status;
        fake_v4l2_config_default(&config);
        config.stamp = stamp;
        fake_v4l2 *fake = fake_v4l2_new(&config);
        pupil_source *source = open_camera(fake, NULL, (pupil_live_options){0});
        for (int i = 0; i < 5; i++)
            CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
        CHECK(pupil_live_get(source)->times.stamp == (stamp == FAKE_STAMP_START_OF_EXPOSURE
                                                          ? PUPIL_LIVE_STAMP_START_OF_EXPOSURE
                                                          : PUPIL_LIVE_STAMP_END_OF_FRAME));
        pupil_camera *camera = pupil_live_camera(source);
        const uint64_t asked = pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.001});
        do
            pupil_camera_get_status(camera, &status);
        while (status.written != asked);
        from[stamp] = status.exposure_s.from_frame - info.sequence;
        close_all(source, fake);
    }
    CHECK_MSG(from[0] == from[1], "%llu and %llu frames", (unsigned long long)from[0], (unsigned long long)from[1]);
}

static int asked_to_stop;

static int stop(void)
{
    return asked_to_stop;
}

static int never(void)
{
    return 0;
}

/* Options of any source take precedence over those of cameras, but only if they are set. */
static void test_options(void)
{
    fake_v4l2_config config;
    pupil_frame_info info;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const pupil_live_options more = {.capture = {.width = 320, .height = 240, .fps = 15, .stop = never}};
    pupil_source *source = open_camera(fake, &(pupil_source_options){.width = 32, .height = 24, .stop = stop}, more);
    CHECK(pupil_live_get(source)->stream.width == 32 && pupil_live_get(source)->stream.height == 24);
    CHECK_MSG(source->fps == 15.0, "%g a second", source->fps);
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
    asked_to_stop = 1;
    CHECK(next_info(source, &info) == PUPIL_SOURCE_END);
    close_all(source, fake);
    fake = fake_v4l2_new(&config);
    source = open_camera(fake, &(pupil_source_options){.fps = 30}, more);
    CHECK(pupil_live_get(source)->stream.width == 320 && source->fps == 30.0);
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME); /* its own stop says no */
    close_all(source, fake);
}

/* Without controls there is nothing to mark, to restore or to give back. */
static void test_hands_off(void)
{
    fake_v4l2_config config;
    pupil_frame_info info;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_source *source = open_camera(fake, NULL, (pupil_live_options){.hands_off = 1});
    pupil_live_mark(source);
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
    pupil_live_mark(source);
    pupil_live_restore(source);
    CHECK(pupil_live_give_back(source, &why) == 0);
    close_all(source, fake);
    fake = fake_v4l2_new(&config);
    source = open_camera(fake, NULL, (pupil_live_options){0});
    pupil_live_mark(source); /* before the first frame none is in progress */
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
    close_all(source, fake);
}

static int no_list(void *context, const char *folder, void (*found)(void *closure, const char *name), void *closure)
{
    (void)context, (void)folder, (void)found, (void)closure;
    errno = EACCES;
    return -1;
}

static int count(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *words)
{
    (void)is, (void)modes, (void)words;
    ++*(int *)closure;
    return 0;
}

static void test_no_folder(void)
{
    fake_v4l2_config config;
    int seen = 0;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_v4l2_system system = *fake_v4l2_system(fake);
    system.list = no_list;
    CHECK(pupil_live_cameras(&(pupil_live_system){&system, NULL}, 1, count, &seen, &why) == -1 && seen == 0);
    CHECK_MSG(strstr(why.text, "/dev: cannot be listed"), "%s", why.text);
    fake_v4l2_free(fake);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_sensor();
    test_stamps();
    test_options();
    test_hands_off();
    test_no_folder();
    return check_end();
}
