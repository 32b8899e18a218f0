/* docs/examples/full.c unchanged, with the fake camera instead of the kernel: it settles on the light, follows it, maps
 * every frame, and when the camera is unplugged it reports that and restores every control. Also with writes that take
 * several frames, and with a camera that is busy while the light changes: the library handles both by itself. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "pupil/camera_controls.h"
#include "pupil/pupil.h"

#define MOST 400
#define STEP 80 /* the first frame with eight times the light; it promises to rest within 60 */

static fake_v4l2 *fake;
static const pupil_v4l2_system *fakes;
static jmp_buf ended;
static pupil_camera *opened;
static double exposure_s[MOST + 1];
static unsigned char middle[MOST + 1];

/* How the camera handles writes. */
static int write_frames;          /* how many frames a write takes */
static int busy_from, busy_until; /* for how many frames it is busy */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* of what follows */
static pthread_cond_t frame_came = PTHREAD_COND_INITIALIZER;
static int frames, is_over, writing, done_at, refused; /* is_over: no more frames */

static int fake_call(void *context, int fd, unsigned long request, void *argument)
{
    (void)context;
    pthread_mutex_lock(&lock);
    int is_busy = 0;
    if (request == VIDIOC_S_EXT_CTRLS && frames) { /* not those of open */
        writing = 1;
        done_at = frames + write_frames;
        pthread_cond_broadcast(&frame_came);
        while (frames < done_at && !is_over)
            pthread_cond_wait(&frame_came, &lock);
        is_busy = frames >= busy_from && frames < busy_until;
        refused += is_busy;
        writing = 0;
    }
    pthread_mutex_unlock(&lock);
    if (!is_busy)
        return fakes->ioctl(fakes->context, fd, request, argument);
    errno = EBUSY;
    return -1;
}

/* Delivers the next frame, but not before the last setting is written, unless writes are slow: a real camera's frame
 * takes its time. Returns the total exposure in force from then on. */
static double next_frame(void)
{
    pupil_camera_status status;
    pthread_mutex_lock(&lock);
    frames++;
    pthread_cond_broadcast(&frame_came);
    for (;;) {
        const int is_slow = writing && done_at > frames;
        pthread_mutex_unlock(&lock);
        pupil_camera_get_status(opened, &status);
        if (is_slow || status.written == status.asks)
            return status.exposure_s.taken * status.gain.taken;
        usleep(20);
        pthread_mutex_lock(&lock);
    }
}

static pupil_camera *open_camera(const pupil_camera_options *options, pupil_why *why)
{
    static const pupil_camera_calls calls = {NULL, fake_call};
    pupil_camera_options with_fake = *options;
    with_fake.calls = &calls;
    return opened = pupil_camera_open(&with_fake, why);
}

static int open_device(const char *path, int flags)
{
    CHECK(flags == O_RDWR);
    return fakes->open(fakes->context, path);
}

/* DQBUF of a file in blocking mode. */
static int device_ioctl(int fd, unsigned long request, ...)
{
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    if (request != VIDIOC_DQBUF)
        return fakes->ioctl(fakes->context, fd, request, argument);
    struct pollfd p = {fd, POLLIN, 0};
    const double total_s = next_frame();
    if (frames == STEP)
        fake_v4l2_light(fake, 8);
    if (frames <= MOST)
        exposure_s[frames] = total_s;
    fakes->poll(fakes->context, &p, 1, 1000);
    const int result = fakes->ioctl(fakes->context, fd, request, argument);
    const int error = errno;
    pthread_mutex_lock(&lock);
    is_over = result < 0;
    pthread_cond_broadcast(&frame_came);
    pthread_mutex_unlock(&lock);
    errno = error;
    return result;
}

static int fake_clock(clockid_t clock, struct timespec *time)
{
    const int64_t ns = fakes->now_ns(fakes->context);
    CHECK(clock == CLOCK_MONOTONIC);
    *time = (struct timespec){ns / 1000000000, ns % 1000000000};
    return 0;
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
    if (frames <= MOST)
        middle[frames] = ((const unsigned char *)picture)[(24 * 64 + 32) * 3 + 1];
    return 1;
}

/* The program exits at a failure, here again and again: its picture is freed with this process. */
static void *picture_memory(size_t bytes)
{
    static unsigned char picture[64 * 48 * 3];
    CHECK(bytes == sizeof picture);
    return picture;
}

#define main                       full_main
#define malloc(bytes)              picture_memory(bytes)
#define exit(code)                 longjmp(ended, (code) + 1)
#define open(path, flags)          open_device(path, flags)
#define ioctl                      device_ioctl
#define mmap                       map
#define clock_gettime(clock, time) fake_clock(clock, time)
#define fwrite                     keep_picture
#define pupil_camera_open(o, w)    open_camera(o, w)
int full_main(int argc, char **argv);
#include "../../docs/examples/full.c"
#undef main
#undef exit
#undef open
#undef malloc

static int run_it(const fake_v4l2_config *config, const char *device)
{
    static char program[] = "full", path[64];
    static char *arguments[] = {program, path, NULL};
    fake = fake_v4l2_new(config);
    fakes = fake_v4l2_system(fake);
    snprintf(path, sizeof path, "%s", device);
    frames = 0;
    is_over = 0;
    const int code = setjmp(ended);
    if (code == 0)
        full_main(2, arguments);
    return code - 1;
}

/* Eight times the light in frame STEP, on a camera that is unplugged in frame `last`. */
static void follow_light(int slow_frames, int busy_frames, int last)
{
    fake_v4l2_config config;
    pupil_why why;
    fake_v4l2_config_default(&config);
    config.flat = 512; /* an eighth of full at 10 ms */
    config.unplug_at = (uint64_t)last;
    write_frames = slow_frames;
    busy_from = STEP - 5;
    busy_until = busy_from + busy_frames;
    refused = 0;
    CHECK(run_it(&config, "/dev/video0") == 1 && frames == last + 1);
    /* exposure x gain at which an eighth of full, at 10 ms, is at the key of 0.18; a code of YUYV is 2 % of the light
     */
    const double right_s = 0.18 / (512.0 / FAKE_SCENE_WHITE) * 0.01;
    printf("writes of %d frames, busy for %d: %g s before the step, %g s at the end, %d writes refused\n", slow_frames,
           busy_frames, exposure_s[STEP - 1], exposure_s[last], refused);
    CHECK_MSG(fabs(log2(exposure_s[STEP - 1] / right_s)) < 0.21, "%g s for %g", exposure_s[STEP - 1], right_s);
    CHECK_MSG(fabs(log2(exposure_s[last] / right_s * 8)) < 0.21, "writes of %d frames, busy for %d: %g s for %g",
              slow_frames, busy_frames, exposure_s[last], right_s / 8);
    CHECK_MSG(abs(middle[STEP - 1] - middle[last]) <= 4, "%d, %d", middle[STEP - 1], middle[last]);
    double beyond = 0.0; /* stops by which it was ever too dark */
    for (int i = 1; i <= last; i++)
        beyond = fmax(beyond, log2(right_s / (i < STEP ? 1 : 8) / exposure_s[i]));
    /* light above white cannot be measured: one step goes further than it has to */
    CHECK_MSG(beyond < 0.6, "writes of %d frames, busy for %d: %g EV darker than it should be", slow_frames,
              busy_frames, beyond);
    CHECK(middle[last] > 90 && middle[last] < 135); /* 0.18 of the key is sRGB 118 */
    CHECK_MSG(busy_frames ? refused > 1 : refused == 0, "%d writes were refused", refused);
    /* The controls of the unplugged camera cannot be restored, and no other's may be left changed. */
    pupil_camera_close(camera, &why);
    camera = NULL;
    fake_v4l2_free(fake);
}

int main(int argc, char **argv)
{
    fake_v4l2_config config;
    check_begin(argc, argv);
    follow_light(0, 0, 140);
    follow_light(0, 60, 210);
    follow_light(2, 0, 190);
    follow_light(10, 0, 340);
    follow_light(3, 60, 340);

    write_frames = 0;
    fake_v4l2_config_default(&config);
    CHECK(run_it(&config, "/dev/video9") == 1 && frames == 0);
    fake_v4l2_free(fake);
    config.only_format = V4L2_PIX_FMT_GREY;
    CHECK(run_it(&config, "/dev/video0") == 1 && frames == 0);
    fake_v4l2_free(fake);
    return check_end();
}
