/* A libcamera webcam and its V4L2 node: found by where it is plugged in, its controls saved, and restored in every
 * case. This program has its own sysfs (CMakeLists.txt). */
#include <errno.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include "check.h"
#include "fake_libcamera/fake_libcamera.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"

#define ID    "\\_SB_.PCI0.XHC_-2.1:1.0-1bcf:2b9e"
#define OTHER 33

static const char *place; /* the target of the node's device link; NULL: none */

ssize_t __wrap_readlink(const char *path, char *to, size_t bytes);
ssize_t __wrap_readlink(const char *path, char *to, size_t bytes)
{
    CHECK(strcmp(path, "/sys/class/video4linux/video0/device") == 0);
    return place ? (ssize_t)snprintf(to, bytes, "%s", place) : -1;
}

static int32_t value_of(const pupil_v4l2_system *s, uint32_t id)
{
    struct v4l2_ext_control one = {.id = id};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
    const int fd = s->open(s->context, "/dev/video0");
    CHECK(s->ioctl(s->context, fd, VIDIOC_G_EXT_CTRLS, &all) == 0);
    s->close(s->context, fd);
    return one.value;
}

static void set(const pupil_v4l2_system *s, int fd, uint32_t id, int32_t value)
{
    struct v4l2_ext_control one = {.id = id, .value = value};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
    CHECK(s->ioctl(s->context, fd, VIDIOC_S_EXT_CTRLS, &all) == 0);
}

/* The exposure after a session that changed it. */
static int32_t session(const pupil_v4l2_system *system, const pupil_v4l2_system *faulty, const char *id)
{
    fake_libcamera_config webcam;
    fake_libcamera_config_default(&webcam);
    webcam.id = id;
    fake_libcamera *camera = fake_libcamera_new(&webcam);
    const pupil_live_system machine = {faulty, fake_libcamera_layer(camera)};
    pupil_source *source = NULL;
    pupil_frame frame;
    pupil_why why = {""};
    const int fd = system->open(system->context, "/dev/video0");
    const int opened =
        pupil_live_open("libcamera:", NULL, &(pupil_live_options){.system = &machine}, &source, &why) == 0;
    CHECK_MSG(opened, "%s", why.text);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
    pupil_source_done(source, &frame);
    set(system, fd, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
    set(system, fd, V4L2_CID_EXPOSURE_ABSOLUTE, OTHER);
    pupil_source_close(source);
    system->close(system->context, fd);
    CHECK(fake_libcamera_opened(camera) == 0);
    fake_libcamera_free(camera);
    return value_of(system, V4L2_CID_EXPOSURE_ABSOLUTE);
}

static void test_places(void)
{
    static const struct {
        const char *place;
        int is_it;
    } cases[] = {{"../../../3-2.1:1.0", 1}, {"3-2.1:1.0", 1}, {"../../../3-2.2:1.0", 0},
                 {"../../../32.1:1.0", 0},  {"", 0},          {NULL, 0},
                 {"../../../1-12.1:1.0", 0}};
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_v4l2 *fake = fake_v4l2_new(&config);
        const pupil_v4l2_system *s = fake_v4l2_system(fake);
        const int32_t before = value_of(s, V4L2_CID_EXPOSURE_ABSOLUTE);
        place = cases[i].place;
        CHECK_MSG(session(s, s, ID) == (cases[i].is_it ? before : OTHER), "%s", place ? place : "nowhere");
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
    }
}

/* Each call to the node fails once: frames still come, and nothing stays open. A signal makes no difference. */
static void test_each_call(int error)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    place = "../../../3-2.1:1.0";
    for (unsigned long at = 1, more = 1; more; at++) {
        fake_v4l2 *fake = fake_v4l2_new(&config);
        const pupil_v4l2_system *s = fake_v4l2_system(fake);
        const int32_t before = value_of(s, V4L2_CID_EXPOSURE_ABSOLUTE);
        fake_faults f;
        fake_faults_begin(&f, s, at, 1, error);
        const int32_t after = session(s, &f.system, ID);
        more = f.failed != NULL;
        CHECK_MSG(after == before || (more && (error != EINTR || strcmp(f.failed, "ioctl") != 0)),
                  "call %lu (%s): %d, not %d", at, f.failed, after, before);
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_places();
    test_each_call(EIO);
    test_each_call(EINTR);
    return check_end();
}
