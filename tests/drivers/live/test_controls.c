/* A live camera: frames report what they were taken with; controls are set and restored, even if a write hangs, or the
 * camera is unplugged and comes back. */
#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "live_camera.h"

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.control_delay = 3; /* the delay assumed of an unknown camera */
    return config;
}

static int control(fake_v4l2 *fake, uint32_t id, int set, int value)
{
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    struct v4l2_control c = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    CHECK(system->ioctl(system->context, fd, set ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &c) == 0);
    system->close(system->context, fd);
    return c.value;
}

static pupil_source *open_live(fake_v4l2 *fake, double reopen_s)
{
    return open_camera(fake, NULL, (pupil_live_options){.capture = {.reopen_s = reopen_s}});
}

static void doze(long ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&t, NULL);
}

/* Waits until the setting is written; the whole test has a time limit. */
static void await_write(pupil_camera *camera)
{
    pupil_camera_status status;
    for (pupil_camera_get_status(camera, &status); status.written != status.asks;
         pupil_camera_get_status(camera, &status))
        doze(1);
}

static void close_all(pupil_source *source, fake_v4l2 *fake)
{
    pupil_source_close(source);
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(fake);
}

static void test_in_force(void)
{
    const fake_v4l2_config config = usual();
    fake_v4l2 *fake = fake_v4l2_new(&config);
    control(fake, V4L2_CID_EXPOSURE_AUTO, 1, 3);
    control(fake, V4L2_CID_EXPOSURE_ABSOLUTE, 1, 77);
    control(fake, V4L2_CID_GAIN, 1, 40);
    pupil_source *source = open_live(fake, 0.0);
    pupil_camera *camera = pupil_live_camera(source);
    pupil_frame_info info = {0};
    CHECK(camera != NULL);
    CHECK(control(fake, V4L2_CID_EXPOSURE_AUTO, 0, 0) == V4L2_EXPOSURE_MANUAL);
    for (int i = 0; i < 3; i++)
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && fabs(info.exposure_s - 7.7e-3) < 1e-9 &&
              info.gain == 2.5);
    await_write(camera);
    pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.02, .gain = 3.0});
    await_write(camera);
    const uint64_t from = info.sequence + 1 + 3; /* the next frame is being exposed */
    for (int i = 0; i < 8; i++) {
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
        CHECK_MSG(info.gain == (info.sequence < from ? 2.5 : 3.0), "frame %d: gain %g", (int)info.sequence, info.gain);
        CHECK(fabs(info.exposure_s - (info.sequence < from ? 7.7e-3 : 0.02)) < 1e-9);
    }
    CHECK(pupil_live_give_back(source, &why) == 0 && !pupil_live_camera(source));
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && info.exposure_s == 0.0);
    CHECK(control(fake, V4L2_CID_EXPOSURE_AUTO, 0, 0) == 3);
    CHECK(control(fake, V4L2_CID_EXPOSURE_ABSOLUTE, 0, 0) == 77);
    CHECK(control(fake, V4L2_CID_GAIN, 0, 0) == 40);
    close_all(source, fake);
}

static void test_hands_off(void)
{
    const fake_v4l2_config config = usual();
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const pupil_live_options options = {.capture = {.system = fake_v4l2_system(fake)}, .hands_off = 1};
    pupil_source *source = NULL;
    pupil_frame_info info;
    control(fake, V4L2_CID_EXPOSURE_AUTO, 1, 3);
    CHECK(pupil_live_open("0", NULL, &options, &source, &why) == 0);
    CHECK(!pupil_live_camera(source) && strstr(pupil_live_no_controls(source), "left alone"));
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && info.exposure_s == 0.0 && info.gain == 0.0);
    CHECK(control(fake, V4L2_CID_EXPOSURE_AUTO, 0, 0) == 3);
    close_all(source, fake);
}

static const pupil_v4l2_system *inside;

static int as_uvc(void *context, int fd, unsigned long request, void *argument)
{
    const int result = inside->ioctl(context, fd, request, argument);
    if (request == VIDIOC_QUERYCAP && result == 0)
        memcpy(((struct v4l2_capability *)argument)->driver, "uvcvideo", sizeof "uvcvideo");
    return result;
}

/* Raw frames are linear, pictures are not; a USB camera's grey is only if its driver says so. */
static void test_linear(void)
{
    static const struct {
        uint32_t fourcc, transfer;
        int linear, of_uvc;
    } cases[] = {{V4L2_PIX_FMT_YUYV, V4L2_XFER_FUNC_DEFAULT, 0, 0},
                 {V4L2_PIX_FMT_YUYV, V4L2_XFER_FUNC_709, 0, 0},
                 {V4L2_PIX_FMT_YUYV, V4L2_XFER_FUNC_NONE, 1, 1},
                 {V4L2_PIX_FMT_NV12, V4L2_XFER_FUNC_SRGB, 0, 0},
                 {V4L2_PIX_FMT_MJPEG, V4L2_XFER_FUNC_DEFAULT, 0, 0},
                 {V4L2_PIX_FMT_RGB24, V4L2_XFER_FUNC_DEFAULT, 0, 0},
                 {V4L2_PIX_FMT_GREY, V4L2_XFER_FUNC_DEFAULT, 1, 0},
                 {V4L2_PIX_FMT_GREY, V4L2_XFER_FUNC_NONE, 1, 1},
                 {V4L2_PIX_FMT_GREY, V4L2_XFER_FUNC_SRGB, 0, 0},
                 {V4L2_PIX_FMT_Y12, V4L2_XFER_FUNC_DEFAULT, 1, 0},
                 {v4l2_fourcc('Y', '1', '0', 'P'), V4L2_XFER_FUNC_DEFAULT, 1, 0},
                 {v4l2_fourcc('Y', '1', '2', 'P'), V4L2_XFER_FUNC_709, 0, 0},
                 {v4l2_fourcc('P', '0', '1', '0'), V4L2_XFER_FUNC_SMPTE2084, 0, 0},
                 {V4L2_PIX_FMT_BGR24, V4L2_XFER_FUNC_DEFAULT, 0, 0},
                 {V4L2_PIX_FMT_SRGGB10, V4L2_XFER_FUNC_DEFAULT, 1, 1}};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i++) {
        fake_v4l2_config config = usual();
        config.only_format = cases[i / 2].fourcc;
        config.xfer_func = cases[i / 2].transfer;
        fake_v4l2 *fake = fake_v4l2_new(&config);
        inside = fake_v4l2_system(fake);
        pupil_v4l2_system uvc = *inside;
        uvc.ioctl = as_uvc;
        const pupil_live_options options = {.capture = {.system = i % 2 ? &uvc : inside}};
        pupil_source *source = NULL;
        CHECK_MSG(pupil_live_open("0", NULL, &options, &source, &why) == 0, "%s", why.text);
        if (!source)
            exit(check_end());
        const int wanted = i % 2 ? cases[i / 2].of_uvc : cases[i / 2].linear;
        CHECK_MSG(pupil_live_is_linear(source) == wanted, "%.4s, transfer %u, %s: not %d",
                  (const char *)&cases[i / 2].fourcc, cases[i / 2].transfer, i % 2 ? "UVC" : "no UVC", wanted);
        close_all(source, fake);
    }
}

/* For a handler of fatal signals. */
static void test_restore(void)
{
    const fake_v4l2_config config = usual();
    fake_v4l2 *fake = fake_v4l2_new(&config);
    control(fake, V4L2_CID_EXPOSURE_AUTO, 1, 3);
    pupil_source *source = open_live(fake, 0.0);
    CHECK(control(fake, V4L2_CID_EXPOSURE_AUTO, 0, 0) == V4L2_EXPOSURE_MANUAL);
    pupil_live_restore(source);
    CHECK(control(fake, V4L2_CID_EXPOSURE_AUTO, 0, 0) == 3);
    close_all(source, fake);
}

/* The camera comes back with its factory settings; `sleep_s`: a write hangs while it is gone. */
static void test_again(double sleep_s)
{
    fake_v4l2_config config = usual();
    config.unplug_at = 5;
    config.back_s = 2.0;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_source *source = open_live(fake, 10.0);
    pupil_frame_info info = {0};
    int frames = 0, without = 0;
    for (; frames < 3; frames++)
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && info.exposure_s > 0.0);
    await_write(pupil_live_camera(source));
    if (sleep_s > 0.0) {
        config.sleep_s = sleep_s;
        config.sleep_at = 1;
        fake_v4l2_reconfigure(fake, &config);
        pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.gain = 2.0});
    }
    const pupil_camera *before = pupil_live_camera(source);
    for (; frames < 5; frames++)
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
    CHECK(before == pupil_live_camera(source));
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && pupil_live_capture(source)->counts.reopened == 1);
    for (; !pupil_live_camera(source) && without < 100000; without++) {
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
        doze(1);
    }
    CHECK_MSG(pupil_live_camera(source) != NULL, "%s", pupil_live_no_controls(source));
    CHECK_MSG(sleep_s == 0.0 || without > 10, "%d frames while the write hung", without);
    pupil_camera *camera = pupil_live_camera(source);
    if (camera) {
        await_write(camera);
        pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.015, .gain = 2.0});
        await_write(camera);
    }
    CHECK(control(fake, V4L2_CID_EXPOSURE_ABSOLUTE, 0, 0) == 150);
    pupil_source_close(source);
    while (fake_v4l2_holds(fake).files) /* if a write hung: until it ends; the test has a time limit */
        doze(10);
    fake_v4l2_free(fake);
}

static int says_stop(void)
{
    return 1;
}

/* A write that does not end in time: frames continue, the run ends, and controls are restored after the write.
 */
static void test_hang(void)
{
    fake_v4l2_config config = usual();
    fake_v4l2 *fake = fake_v4l2_new(&config);
    pupil_source *source = open_live(fake, 0.0);
    pupil_frame_info info;
    CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME);
    await_write(pupil_live_camera(source));
    config.sleep_s = 2.5;
    config.sleep_at = 1;
    fake_v4l2_reconfigure(fake, &config);
    pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.015, .gain = 2.0});
    pupil_camera_status status = {0};
    while (!status.writing)
        pupil_camera_get_status(pupil_live_camera(source), &status);
    int frames = 0;
    for (; frames < 150; frames++) /* five seconds of the camera's clock; the write's 2.5 are the machine's */
        CHECK(next_info(source, &info) == PUPIL_SOURCE_FRAME && info.gain == 1.0);
    pupil_camera_get_status(pupil_live_camera(source), &status);
    CHECK(status.writing);
    pupil_source_close(source);
    CHECK(pupil_live_await(10.0, says_stop) == -1 && pupil_live_await(0.02, NULL) == -1);
    CHECK(pupil_live_await(10.0, NULL) == 0 && pupil_live_await(0.0, says_stop) == 0);
    CHECK(control(fake, V4L2_CID_EXPOSURE_ABSOLUTE, 0, 0) == 100 && control(fake, V4L2_CID_GAIN, 0, 0) == 16);
    CHECK(fake_v4l2_holds(fake).files == 0 && fake_v4l2_holds(fake).maps == 0);
    fake_v4l2_free(fake);
}

/* Every n-th call fails in turn: a sentence or frames, no leak, no hang. Whether the controls are restored depends on
 * the call. */
static unsigned long session(unsigned long fail_at, int error)
{
    fake_v4l2_config config = usual();
    fake_faults faults;
    pupil_source *source = NULL;
    pupil_frame_info info;
    config.media = FAKE_MEDIA_RIGHT;
    config.unplug_at = 4;
    config.back_s = 0.5;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    fake_faults_begin(&faults, fake_v4l2_system(fake), fail_at, 1, error);
    const pupil_live_options options = {.capture = {.system = &faults.system, .reopen_s = 2.0}};
    *why.text = 0;
    const int result = pupil_live_open("/dev/video0", NULL, &options, &source, &why);
    CHECK_MSG(result == 0 || *why.text, "call %lu fails without a sentence", fail_at);
    for (int i = 0; !result && i < 12 && next_info(source, &info) == PUPIL_SOURCE_FRAME; i++)
        if (pupil_live_camera(source))
            pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.001 * i, .gain = 2.0});
        else
            CHECK(*pupil_live_no_controls(source));
    if (!result)
        pupil_source_close(source);
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "call %lu leaves %d files and %d maps", fail_at, held.files,
              held.maps);
    fake_v4l2_free(fake);
    return faults.calls;
}

static void test_faults(void)
{
    static const int errors[] = {EIO, ENODEV, EINVAL, EBUSY};
    const unsigned long calls = session(0, 0);
    CHECK_MSG(calls > 100, "%lu calls", calls);
    for (unsigned long n = 1; n <= calls; n++)
        session(n, errors[n % 4]);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const pid_t waits = fork(); /* in parallel with other tests: like them it mostly waits */
    if (!waits) {
        test_again(2.5);
        return check_end();
    }
    test_in_force();
    test_hands_off();
    test_linear();
    test_restore();
    test_again(0.0);
    test_hang();
    test_faults();
    int status = -1;
    CHECK(waits > 0 && waitpid(waits, &status, 0) == waits && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return check_end();
}
