/* Which names mean cameras; the exposure loop without a camera, and what it refuses. */
#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "pupil/camera_loop.h"

static pupil_why why;

static void test_names(void)
{
    static const struct {
        const char *name;
        int is_camera;
    } cases[] = {{"libcamera:", 1},  {"libcamera:0", 1},      {"v4l2:0", 1},
                 {"/dev/video0", 1}, {"/dev/v4l/by-id/a", 1}, {"/dev/vide", 0},
                 {"0", 0},           {"video.mkv", 0},        {"", 0},
                 {"libcamera", 0},   {"/dev/media0", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_MSG(pupil_live_is_camera(cases[i].name) == cases[i].is_camera, "%s", cases[i].name);
}

static int count(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *words)
{
    int *left = closure;
    CHECK(!modes || !modes->count);
    (void)is, (void)words;
    return --*left == 0;
}

/* The list without modes ends once the callback has enough. /dev/null is none of the machine's cameras. */
static void test_list(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.twin = 1;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const pupil_live_system system = {fake_v4l2_system(fake), NULL};
    pupil_source *source = NULL;
    for (int most = 1; most < 20; most += 18) {
        int left = most;
        CHECK_MSG(pupil_live_cameras(&system, 0, count, &left, &why) == 0, "%s", why.text);
        CHECK(most == 1 ? left == 0 : left > 0 && left < most);
    }
    CHECK(fake_v4l2_holds(fake).files == 0);
    fake_v4l2_free(fake);
    CHECK(pupil_live_open("/dev/null", NULL, NULL, &source, &why) == PUPIL_SOURCE_FAILED && !source);
    CHECK_MSG(strstr(why.text, "/dev/null: is not a video device"), "%s", why.text);
}

static pupil_source *open_fake(fake_v4l2 *fake)
{
    pupil_source *source = NULL;
    const pupil_live_options options = {.capture = {.system = fake_v4l2_system(fake)}};
    CHECK_MSG(pupil_live_open("/dev/video0", NULL, &options, &source, &why) == 0, "%s", why.text);
    return source;
}

static int take(pupil_source *source, pupil_frame_info *info)
{
    pupil_frame frame;
    if (pupil_source_next(source, &frame, &why) != PUPIL_SOURCE_FRAME)
        return 0;
    *info = frame.info;
    pupil_source_done(source, &frame);
    return 1;
}

static void test_loop(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_source *source = open_fake(fake);
    pupil_camera *camera = pupil_live_camera(source);
    pupil_sensor_config steering, wrong;
    pupil_frame_info info = {0};
    pupil_stats stats;
    static pupil_camera_loop loop;
    CHECK(pupil_camera_loop_announce(&loop, 1.0, 2, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_OK);
    CHECK(pupil_camera_loop_follow(&loop, 0.01) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_camera_loop_frame(&loop, &stats, &info) == PUPIL_OK);
    pupil_camera_loop_lost(&loop);

    CHECK(take(source, &info));
    pupil_camera_loop_hold(&loop, camera, &(pupil_camera_setting){.exposure_s = 0.005});
    CHECK(take(source, &info) && pupil_camera_loop_frame(&loop, &stats, &info) == PUPIL_OK);
    CHECK(pupil_camera_loop_announce(&loop, 1.0, 2, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_OK); /* it is held */
    CHECK(pupil_camera_loop_follow(&loop, 0.01) == PUPIL_OK);

    pupil_sensor_config_default(&steering);
    pupil_camera_configure(camera, &steering);
    wrong = steering;
    wrong.exposure_max_s = -1.0;
    CHECK(pupil_camera_loop_begin(&loop, camera, &wrong, 0.0, &why) == -1);
    CHECK_MSG(strstr(why.text, "the camera's exposure cannot be steered: exposure"), "%s", why.text);
    CHECK_MSG(pupil_camera_loop_begin(&loop, camera, &steering, 0.0, &why) == 0, "%s", why.text);
    CHECK(take(source, &info));
    CHECK(pupil_camera_loop_announce(&loop, 1.0, 2, PUPIL_SENSOR_CHANGE_LIGHT) == PUPIL_OK);
    CHECK(pupil_camera_loop_announce(&loop, NAN, 2, PUPIL_SENSOR_CHANGE_LIGHT) != PUPIL_OK);
    CHECK(pupil_camera_loop_follow(&loop, -1.0) != PUPIL_OK);
    CHECK(pupil_camera_loop_follow(&loop, 0.01) == PUPIL_OK);
    CHECK(fabs(log2(loop.setting.total_s / 0.01)) < 0.6); /* as near as the controls get at once */
    CHECK(pupil_camera_loop_retune(&loop, &wrong) != PUPIL_OK && loop.config.exposure_max_s > 0.0);
    pupil_camera_loop_lost(&loop);
    CHECK(loop.setting.state == PUPIL_SENSOR_SEARCHING && loop.setting.frame_digital == 1.0);
    pupil_source_close(source);
    CHECK(fake_v4l2_holds(fake).files == 0);
    fake_v4l2_free(fake);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_names();
    test_list();
    test_loop();
    return check_end();
}
