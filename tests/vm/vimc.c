/* vimc.c: runs in the guest (test_vimc.sh). A sensor behind a media graph (vimc): it is found from its video node; what
 * refuses to start is told with the line that mends it; its raw frames are those that it draws. */
#include <errno.h>
#include <fcntl.h>
#include <linux/media-bus-format.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "check.h"
#include "v4l2/v4l2_media.h"
#include "v4l2/v4l2_source.h"
#include "vm/node.h"
#include "vm/pattern.h"

#define WIDTH  640u
#define HEIGHT 480u

static char why[PUPIL_WHY_BYTES], path[32];
static pupil_v4l2_sensor sensor;

static void test_sensor(void)
{
    pupil_v4l2_device device;
    CHECK_MSG(pupil_v4l2_device_open(&device, NULL, path, why, sizeof why) == 0, "%s", why);
    CHECK_MSG(pupil_v4l2_media_sensor(&device, &sensor, why, sizeof why) == 0, "%s", why);
    CHECK_MSG(strcmp(sensor.entity, "Sensor A") == 0 && strncmp(sensor.path, "/dev/v4l-subdev", 15) == 0, "%s at %s",
              sensor.entity, sensor.path);
    printf("%s: %s, %s\n", path, sensor.entity, sensor.path);
    pupil_v4l2_device_close(&device);
}

/* What media-ctl does with the line of the sentence. */
static int set_sensor(uint32_t code)
{
    struct v4l2_subdev_format f = {.which = V4L2_SUBDEV_FORMAT_ACTIVE};
    const int fd = open(sensor.path, O_RDWR | O_CLOEXEC);
    if (fd < 0 || ioctl(fd, VIDIOC_SUBDEV_G_FMT, &f) != 0)
        return -1;
    f.format.width = WIDTH;
    f.format.height = HEIGHT;
    f.format.code = code;
    const int failed = ioctl(fd, VIDIOC_SUBDEV_S_FMT, &f) != 0 || f.format.code != code;
    close(fd);
    return failed ? -1 : 0;
}

static const struct {
    const char *name;
    uint32_t code, other; /* other: what the sensor sends when it is refused */
} raws[] = {{"RGGB", MEDIA_BUS_FMT_SRGGB8_1X8, MEDIA_BUS_FMT_RGB888_1X24},
            {"BA81", MEDIA_BUS_FMT_SBGGR8_1X8, MEDIA_BUS_FMT_SRGGB8_1X8},
            {"RG10", MEDIA_BUS_FMT_SRGGB10_1X10, MEDIA_BUS_FMT_SRGGB8_1X8},
            {"RG12", MEDIA_BUS_FMT_SRGGB12_1X12, MEDIA_BUS_FMT_SRGGB10_1X10}};

static void test_raw(size_t i, const char *mbus)
{
    const pupil_v4l2_options o = {
        .fourcc = pupil_v4l2_fourcc(raws[i].name), .width = WIDTH, .height = HEIGHT, .timeout_s = 20};
    pupil_source *source = NULL;
    pupil_frame frame;
    char line[256];
    const node_held before = node_holds();
    const int fd = node_open(sensor.path);
    CHECK_MSG(set_sensor(raws[i].other) == 0, "%s", raws[i].name);
    CHECK(node_set(fd, "Test Pattern", PATTERN_CHECKERS) == 0 && node_set(fd, "OSD Text Mode", 2) == 0);
    CHECK(pupil_v4l2_source_open(path, NULL, &o, &source, why, sizeof why) == PUPIL_SOURCE_FAILED);
    snprintf(line, sizeof line, "media-ctl -d %s -V '\"Sensor A\":0 [fmt:%s/%ux%u]'", sensor.media, mbus, WIDTH,
             HEIGHT);
    CHECK_MSG(strstr(why, "does not start") && strstr(why, line), "%s", why);

    CHECK(set_sensor(raws[i].code) == 0);
    const int failed = pupil_v4l2_source_open(path, NULL, &o, &source, why, sizeof why);
    CHECK_MSG(!failed, "%s: %s", raws[i].name, why);
    for (int n = 0; !failed && n < 6; n++) {
        CHECK_MSG(pupil_source_next(source, &frame, why, sizeof why) == PUPIL_SOURCE_FRAME, "%s", why);
        const pupil_v4l2_format *f = &pupil_v4l2_source_capture(source)->format;
        const double off = pattern_off(&frame.image, f, PATTERN_CHECKERS, 0);
        CHECK_MSG(off <= pattern_tolerance(f, PATTERN_CHECKERS), "%s: frame %d is off by %g codes", raws[i].name, n,
                  off);
        pupil_source_done(source, &frame);
    }
    if (!failed)
        pupil_source_close(source);
    close(fd);
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%s: %d files and %d maps are left",
              raws[i].name, after.files - before.files, after.maps - before.maps);
    printf("%s: refused with '%s', then right\n", raws[i].name, line);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    setvbuf(stdout, NULL, _IOLBF, 0);
    CHECK(node_find("vimc", 0, 0, path) == 0);
    test_sensor();
    test_raw(0, "SRGGB8_1X8");
    test_raw(1, "SBGGR8_1X8");
    test_raw(2, "SRGGB10_1X10");
    test_raw(3, "SRGGB12_1X12");
    return check_end();
}
