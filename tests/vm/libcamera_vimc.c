/* libcamera_vimc.c: runs in the guest (test_libcamera_vimc.sh). Frames of the kernel's simulated sensor (vimc) through
 * libcamera have V4L2's bytes, and so have their dma-bufs; a camera without exposure reports that. */
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "vm/node.h"

#define WIDTH    480u /* multiples of 6: libcamera's pipeline for vimc scales by 3 */
#define HEIGHT   360u
#define FRAMES   8
#define CHECKERS 10 /* of the menu "Test Pattern" (enum tpg_pattern) */

static pupil_why why;

/* "/dev/video3" from an entity's name. */
static int find_named(const char *folder, const char *wanted, char path[64])
{
    for (int i = 0; i < 32; i++) {
        char file[96], name[64] = "";
        snprintf(file, sizeof file, "/sys/class/video4linux/%s%d/name", folder, i);
        FILE *text = fopen(file, "re");
        const int read = text ? fscanf(text, "%63[^\n]", name) : 0;
        if (text)
            fclose(text);
        snprintf(path, 64, "/dev/%s%d", folder, i);
        if (read == 1 && strcmp(name, wanted) == 0)
            return 0;
    }
    return -1;
}

static int open_source(const char *which, uint32_t fourcc, pupil_source **source)
{
    const pupil_live_options options = {
        .capture = {.fourcc = fourcc, .width = WIDTH, .height = HEIGHT, .timeout_s = 20}, .hands_off = 1};
    const int failed = pupil_live_open(which, NULL, &options, source, &why);
    CHECK_MSG(!failed, "%s: %s", which, why.text);
    return failed;
}

/* Every frame of a still picture, row by row without padding. */
static unsigned char *frames_of(const char *which, uint32_t fourcc, size_t *bytes)
{
    pupil_source *source = NULL;
    pupil_frame frame;
    unsigned char *all = NULL;
    if (open_source(which, fourcc, &source))
        return NULL;
    for (int i = 0; i < FRAMES; i++) {
        const int got = pupil_source_next(source, &frame, &why);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s: %s", which, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        const size_t row = pupil_row_bytes(frame.image.pixel, WIDTH);
        *bytes = row * HEIGHT;
        CHECK(frame.image.width == WIDTH && frame.image.height == HEIGHT);
        all = all ? all : calloc(FRAMES, *bytes);
        for (uint32_t y = 0; all && y < HEIGHT; y++)
            memcpy(all + (size_t)i * *bytes + y * row,
                   (const unsigned char *)frame.image.data + (ptrdiff_t)y * frame.image.stride_bytes, row);
        const pupil_frame_dmabuf *b = frame.dmabuf;
        if (b) { /* for OpenGL ES: the same memory */
            const size_t map_bytes = b->offset_bytes[0] + *bytes;
            void *again = mmap(NULL, map_bytes, PROT_READ, MAP_SHARED, b->fd[0], 0);
            CHECK(again != MAP_FAILED &&
                  memcmp((unsigned char *)again + b->offset_bytes[0], frame.image.data, row) == 0);
            munmap(again, map_bytes);
        }
        CHECK((b != NULL) == (strncmp(which, "libcamera:", 10) == 0)); /* V4L2 buffers were not asked to be shared */
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    return all;
}

static void compare(const char *video, uint32_t fourcc, const char *name)
{
    size_t bytes = 0, v4l2_bytes = 0;
    unsigned char *libcamera = frames_of("libcamera:0", fourcc, &bytes);
    unsigned char *v4l2 = frames_of(video, fourcc, &v4l2_bytes); /* the graph is as libcamera left it */
    CHECK(libcamera && v4l2 && bytes == v4l2_bytes);
    if (libcamera && v4l2 && bytes == v4l2_bytes) {
        unsigned same = 0, lit = 0;
        for (int i = 0; i < FRAMES; i++)
            same += memcmp(libcamera + (size_t)i * bytes, v4l2, bytes) == 0;
        for (size_t i = 0; i < bytes; i++)
            lit += v4l2[i] > 128;
        CHECK_MSG(same == FRAMES, "%s: %u of %d frames are the same", name, same, FRAMES);
        CHECK(lit > bytes / 4 && lit < bytes); /* a picture */
        printf("%s: %u of %d frames of %zu bytes are the same through libcamera and V4L2\n", name, same, FRAMES, bytes);
    }
    free(libcamera);
    free(v4l2);
}

static void test_no_exposure(void)
{
    pupil_source *source = NULL;
    CHECK(pupil_live_open("libcamera:", NULL, NULL, &source, &why) == 0);
    if (!source)
        return;
    CHECK(!pupil_live_camera(source) && strstr(pupil_live_no_controls(source), "no control of this camera's exposure"));
    printf("%s: %s\n", pupil_live_get(source)->is.path, pupil_live_no_controls(source));
    pupil_source_close(source);
}

int main(int argc, char **argv)
{
    static const char *const sensors[] = {"Sensor A", "Sensor B"};
    char video[64], sensor[64];
    check_begin(argc, argv);
    setvbuf(stdout, NULL, _IOLBF, 0);
    CHECK(find_named("video", "RGB/YUV Capture", video) == 0);
    for (int i = 0; i < 2; i++) {
        CHECK(find_named("v4l-subdev", sensors[i], sensor) == 0);
        const int fd = node_open(sensor);
        CHECK(node_set(fd, "Test Pattern", CHECKERS) == 0 && node_set(fd, "Show Information", 2) == 0);
        close(fd);
    }
    test_no_exposure();
    const node_held before = node_holds(); /* libcamera keeps one of its files open for the process */
    compare(video, V4L2_PIX_FMT_RGB24, "RGB3");
    compare(video, V4L2_PIX_FMT_BGR24, "BGR3");
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%d files and %d maps are left",
              after.files - before.files, after.maps - before.maps);
    return check_end();
}
