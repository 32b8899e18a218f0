/* A webcam of libcamera's, and the V4L2 node that it is: found by where it is plugged in, its controls noted, and put
 * back whatever happened. sysfs is this program's own (CMakeLists.txt). */
#include <errno.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "libcamera/libcamera_private.h"

#define ID "\\_SB_.PCI0.XHC_-2.1:1.0-1bcf:2b9e"

static const char *place; /* where the node's device leads; NULL: nowhere */

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
        libcamera_node node;
        place = cases[i].place;
        libcamera_node_open(&node, fake_v4l2_system(fake), ID);
        CHECK_MSG((node.fd >= 0) == cases[i].is_it, "%s: %d", place ? place : "nowhere", node.fd);
        libcamera_node_close(&node);
        libcamera_node_open(&node, fake_v4l2_system(fake), "-1");
        CHECK(node.fd < 0 && libcamera_node_put_back(&node) == 0);
        libcamera_node_close(&node);
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
    }
}

/* Each call fails once: what was noted is put back, and no more; a signal makes no difference. */
static void test_each_call(int error)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    place = "../../../3-2.1:1.0";
    for (unsigned long at = 0; at < 200; at++) {
        fake_v4l2 *fake = fake_v4l2_new(&config);
        const pupil_v4l2_system *s = fake_v4l2_system(fake);
        const int32_t before = value_of(s, V4L2_CID_EXPOSURE_ABSOLUTE);
        fake_faults f;
        libcamera_node node;
        fake_faults_begin(&f, s, at, 1, error);
        libcamera_node_open(&node, &f.system, ID);
        const int noted = node.saved_count;
        CHECK(noted <= LIBCAMERA_NODE_CONTROLS && (at > 0 || noted >= 2) && (at > 0 || node.frame_s > 0));
        if (error == EINTR && f.failed && strcmp(f.failed, "ioctl") == 0 && node.fd >= 0)
            CHECK_MSG(noted == LIBCAMERA_NODE_CONTROLS || noted == 2, "call %lu: %d noted", at, noted);
        if (node.fd >= 0) {
            set(s, node.fd, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
            set(s, node.fd, V4L2_CID_EXPOSURE_ABSOLUTE, before / 2);
        }
        const int failed = libcamera_node_put_back(&node);
        CHECK(failed == 0 || (f.failed && error != EINTR));
        if (at == 0 || (error == EINTR && node.fd >= 0))
            CHECK_MSG(value_of(s, V4L2_CID_EXPOSURE_ABSOLUTE) == before, "call %lu (%s): %d, not %d", at, f.failed,
                      value_of(s, V4L2_CID_EXPOSURE_ABSOLUTE), before);
        libcamera_node_close(&node);
        CHECK(fake_v4l2_holds(fake).files == 0);
        fake_v4l2_free(fake);
        if (at && !f.failed)
            break;
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
