/* docs/examples/full.c as it stands, with the fake camera in the place of the kernel: it settles on the light, follows
 * it, maps the picture all along, and when the camera is pulled out it says so and puts every control back. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "pupil/camera_controls.h"
#include "pupil/pupil.h"

#define FRAMES 80
#define STEP   40 /* the frame from which on there is eight times the light */

static fake_v4l2 *fake;
static const pupil_v4l2_system *fakes;
static jmp_buf ended;
static int frames;
static pupil_camera *opened;
static double exposure_s[FRAMES + 1];
static unsigned char middle[FRAMES + 1];

static int fake_call(void *user, int fd, unsigned long request, void *argument)
{
    (void)user;
    return fakes->ioctl(fakes->context, fd, request, argument) == 0 ? 0 : -errno;
}

static pupil_camera *open_camera(const pupil_camera_options *options, pupil_why *why)
{
    static const pupil_camera_calls calls = {.ioctl = fake_call};
    pupil_camera_options with_fake = *options;
    with_fake.calls = &calls;
    return opened = pupil_camera_open(&with_fake, why);
}

static int open_device(const char *path, int flags)
{
    CHECK(flags == O_RDWR);
    return fakes->open(fakes->context, path);
}

/* DQBUF of a file that was opened to block; and no frame before the last setting is written, as it would be. */
static int device_ioctl(int fd, unsigned long request, ...)
{
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    if (request == VIDIOC_DQBUF) {
        struct pollfd p = {fd, POLLIN, 0};
        pupil_camera_status status;
        do {
            pupil_camera_get_status(opened, &status);
            usleep(20);
        } while (status.written < status.asks);
        if (++frames == STEP)
            fake_v4l2_light(fake, 8);
        if (frames <= FRAMES)
            exposure_s[frames] = status.exposure_s.taken * status.gain.taken;
        fakes->poll(fakes->context, &p, 1, 1000);
    }
    return fakes->ioctl(fakes->context, fd, request, argument);
}

static void *map(void *where, size_t bytes, int protection, int flags, int fd, off_t offset)
{
    CHECK(!where && protection == (PROT_READ | PROT_WRITE) && flags == MAP_SHARED);
    void *memory = fakes->mmap(fakes->context, bytes, fd, offset);
    return memory ? memory : MAP_FAILED;
}

static size_t keep_picture(const void *picture, size_t bytes, size_t count, FILE *file)
{
    CHECK(bytes == 64 * 48 * 3 && count == 1 && file == stdout);
    if (frames <= FRAMES)
        middle[frames] = ((const unsigned char *)picture)[(24 * 64 + 32) * 3 + 1];
    return 1;
}

#define main                    full_main
#define exit(code)              longjmp(ended, (code) + 1)
#define open(path, flags)       open_device(path, flags)
#define ioctl                   device_ioctl
#define mmap                    map
#define fwrite                  keep_picture
#define pupil_camera_open(o, w) open_camera(o, w)
int full_main(int argc, char **argv);
#include "../../docs/examples/full.c"
#undef main
#undef exit
#undef open

static int run_it(const fake_v4l2_config *config, const char *device)
{
    static char program[] = "full", path[64];
    static char *arguments[] = {program, path, NULL};
    fake = fake_v4l2_new(config);
    fakes = fake_v4l2_system(fake);
    snprintf(path, sizeof path, "%s", device);
    frames = 0;
    const int code = setjmp(ended);
    if (code == 0)
        full_main(2, arguments);
    return code - 1;
}

int main(int argc, char **argv)
{
    fake_v4l2_config config;
    pupil_why why;
    check_begin(argc, argv);
    fake_v4l2_config_default(&config);
    config.flat = 512; /* an eighth of full at 10 ms */
    config.unplug_at = FRAMES;
    CHECK(run_it(&config, "/dev/video0") == 1 && frames == FRAMES + 1);
    /* exposure x gain at which an eighth of full, at 10 ms, is at the key of 0.18; a code of YUYV is 2 % of the light
     */
    const double right_s = 0.18 / (512.0 / FAKE_SCENE_WHITE) * 0.01;
    CHECK_MSG(fabs(log2(exposure_s[STEP - 1] / right_s)) < 0.21, "%g s for %g", exposure_s[STEP - 1], right_s);
    CHECK_MSG(fabs(log2(exposure_s[FRAMES] / right_s * 8)) < 0.21, "%g s for %g", exposure_s[FRAMES], right_s / 8);
    CHECK_MSG(abs(middle[STEP - 1] - middle[FRAMES]) <= 4, "%d, %d", middle[STEP - 1], middle[FRAMES]);
    CHECK(middle[FRAMES] > 90 && middle[FRAMES] < 135); /* 0.18 of the key is sRGB 118 */
    /* The camera that is gone cannot be put back; nor can anybody else's be left behind. */
    pupil_camera_close(camera, &why);
    camera = NULL;
    fake_v4l2_free(fake);

    fake_v4l2_config_default(&config);
    CHECK(run_it(&config, "/dev/video9") == 1 && frames == 0);
    fake_v4l2_free(fake);
    config.only_format = V4L2_PIX_FMT_GREY;
    CHECK(run_it(&config, "/dev/video0") == 1 && frames == 0);
    fake_v4l2_free(fake);
    return check_end();
}
