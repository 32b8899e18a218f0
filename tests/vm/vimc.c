/* vimc.c: runs in the guest (test_vimc.sh). A sensor behind a media graph (vimc): it is found from its video node; if
 * the graph refuses to start, the message has the line that repairs it; its raw frames are those that it draws. */
#include <fcntl.h>
#include <linux/media-bus-format.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "v4l2/media/media.h"
#include "vm/node.h"
#include "vm/pattern.h"

#define WIDTH  640u
#define HEIGHT 480u

static pupil_why why;
static char path[32];
static pupil_v4l2_sensor sensor;

static void test_sensor(void)
{
    pupil_v4l2_device device;
    CHECK_MSG(pupil_v4l2_device_open(&device, NULL, path, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_v4l2_media_sensor(&device, &sensor, &why) == 0, "%s", why.text);
    CHECK_MSG(strcmp(sensor.entity, "Sensor A") == 0 && strncmp(sensor.path, "/dev/v4l-subdev", 15) == 0, "%s at %s",
              sensor.entity, sensor.path);
    printf("%s: %s, %s\n", path, sensor.entity, sensor.path);
    pupil_v4l2_device_close(&device);
}

/* The subdevice with a name. */
static int open_entity(const char *entity)
{
    for (int i = 0; i < 16; i++) {
        char file[64], name[64] = "";
        snprintf(file, sizeof file, "/sys/class/video4linux/v4l-subdev%d/name", i);
        FILE *text = fopen(file, "re");
        if (!text)
            continue;
        const int read = fscanf(text, "%63[^\n]", name);
        fclose(text);
        snprintf(file, sizeof file, "/dev/v4l-subdev%d", i);
        if (read == 1 && strcmp(name, entity) == 0)
            return open(file, O_RDWR | O_CLOEXEC);
    }
    return -1;
}

static const struct {
    const char *name;
    uint32_t code;
} codes[] = {{"SRGGB8_1X8", MEDIA_BUS_FMT_SRGGB8_1X8},
             {"SBGGR8_1X8", MEDIA_BUS_FMT_SBGGR8_1X8},
             {"SRGGB10_1X10", MEDIA_BUS_FMT_SRGGB10_1X10},
             {"SRGGB12_1X12", MEDIA_BUS_FMT_SRGGB12_1X12}};

/* Does what media-ctl does with the line at the end of a sentence: 0, or -1. */
static int follow_line(const char *sentence)
{
    char entity[64], code[32];
    unsigned pad, width, height;
    struct v4l2_subdev_format f = {.which = V4L2_SUBDEV_FORMAT_ACTIVE};
    const char *line = strstr(sentence, "media-ctl -d /dev/media"), *quote = line ? strchr(line, '"') : NULL;
    if (!quote || sscanf(quote, "\"%63[^\"]\":%u [fmt:%31[^/]/%ux%u]", entity, &pad, code, &width, &height) != 5)
        return -1;
    const int fd = open_entity(entity);
    f.pad = pad;
    int failed = fd < 0 || ioctl(fd, VIDIOC_SUBDEV_G_FMT, &f) != 0;
    f.format.width = width;
    f.format.height = height;
    f.format.code = 0;
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        f.format.code = strcmp(code, codes[i].name) == 0 ? codes[i].code : f.format.code;
    failed = failed || !f.format.code || ioctl(fd, VIDIOC_SUBDEV_S_FMT, &f) != 0;
    if (fd >= 0)
        close(fd);
    return failed ? -1 : 0;
}

/* A format that the graph is not set to is refused, with lines that repair it, one after the other; then it streams. */
static void test_raw(const char *name)
{
    const pupil_v4l2_options o = {.fourcc = pupil_v4l2_fourcc(name), .width = WIDTH, .height = HEIGHT, .timeout_s = 20};
    pupil_source *source = NULL;
    pupil_frame frame;
    int lines = 0;
    const node_held before = node_holds();
    while (pupil_live_open(path, NULL, &(pupil_live_options){.capture = o, .hands_off = 1}, &source, &why)) {
        CHECK_MSG(strstr(why.text, "does not start"), "%s: %s", name, why.text);
        CHECK_MSG(++lines <= 2 && follow_line(why.text) == 0, "%s: %s", name, why.text);
        if (lines > 2)
            return;
    }
    CHECK_MSG(lines >= 1, "%s was not refused", name);
    for (int n = 0; n < 6; n++) {
        CHECK_MSG(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
        const pupil_v4l2_format *f = &pupil_live_capture(source)->format;
        const double off = pattern_off(&frame.image, f, PATTERN_CHECKERS, 0);
        CHECK_MSG(off <= pattern_tolerance(f, PATTERN_CHECKERS), "%s: frame %d is off by %g codes", name, n, off);
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%s: %d files and %d maps are left", name,
              after.files - before.files, after.maps - before.maps);
    printf("%s: right after %d lines; the last sentence: %s\n", name, lines, why.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    setvbuf(stdout, NULL, _IOLBF, 0);
    CHECK(node_find("vimc", 0, 0, path) == 0);
    test_sensor();
    const int fd = node_open(sensor.path);
    CHECK(node_set(fd, "Test Pattern", PATTERN_CHECKERS) == 0 && node_set(fd, "Show Information", 2) == 0);
    close(fd);
    test_raw("RGGB");
    test_raw("BA81");
    test_raw("RG10");
    test_raw("RG12");
    return check_end();
}
