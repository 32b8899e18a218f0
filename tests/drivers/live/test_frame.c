/* What a frame of a controlled camera costs: no memory at all, on any thread, no page fault, and few system calls, only
 * of the kinds listed here. The allocator is wrapped by the linker (tests/CMakeLists.txt); the system calls are counted
 * in the table through which the camera code makes all of them. Memory of shared libraries is not counted:
 * libavformat's, on the recorder's thread (docs/realtime.md). Page faults of all threads are counted. */
#include <linux/videodev2.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "check.h"
#include "colour/white_balance.h"
#include "fake_v4l2/fake_v4l2.h"
#include "file/recording/recording.h"
#include "live/live.h"
#include "pupil/pupil.h"
#include "scratch.h"

#define FRAMES 600
#define FIRST  10 /* frames before counting starts: those of the first large steps */

/* --- memory --- */

static atomic_ulong taken, given;

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *memory, size_t bytes);
void *__real_aligned_alloc(size_t alignment, size_t bytes);
int __real_posix_memalign(void **memory, size_t alignment, size_t bytes);
void __real_free(void *memory);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *memory, size_t bytes);
void *__wrap_aligned_alloc(size_t alignment, size_t bytes);
int __wrap_posix_memalign(void **memory, size_t alignment, size_t bytes);
void __wrap_free(void *memory);

void *__wrap_malloc(size_t bytes)
{
    taken++;
    return __real_malloc(bytes);
}

void *__wrap_calloc(size_t count, size_t bytes)
{
    taken++;
    return __real_calloc(count, bytes);
}

void *__wrap_realloc(void *memory, size_t bytes)
{
    taken++;
    return __real_realloc(memory, bytes);
}

void *__wrap_aligned_alloc(size_t alignment, size_t bytes)
{
    taken++;
    return __real_aligned_alloc(alignment, bytes);
}

int __wrap_posix_memalign(void **memory, size_t alignment, size_t bytes)
{
    taken++;
    return __real_posix_memalign(memory, alignment, bytes);
}

void __wrap_free(void *memory)
{
    given += memory != NULL;
    __real_free(memory);
}

/* --- system calls --- */

static int locked; /* what is in memory stays there */
static fake_v4l2 *fake;
static struct {
    atomic_ulong poll, dequeue, queue, write, read_back, other;
} calls;

static int count_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    switch (request) {
    case VIDIOC_DQBUF:
        calls.dequeue++;
        break;
    case VIDIOC_QBUF:
        calls.queue++;
        break;
    case VIDIOC_S_CTRL:
    case VIDIOC_S_EXT_CTRLS:
        calls.write++;
        break;
    case VIDIOC_G_CTRL:
    case VIDIOC_G_EXT_CTRLS:
        calls.read_back++;
        break;
    default:
        calls.other++;
    }
    return fake_v4l2_system(fake)->ioctl(context, fd, request, argument);
}

static int count_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    calls.poll++;
    return fake_v4l2_system(fake)->poll(context, fds, count, timeout_ms);
}

static int count_open(void *context, const char *path)
{
    calls.other++;
    return fake_v4l2_system(fake)->open(context, path);
}

static int count_close(void *context, int fd)
{
    calls.other++;
    return fake_v4l2_system(fake)->close(context, fd);
}

static void *count_mmap(void *context, size_t bytes, int fd, off_t offset)
{
    calls.other++;
    return fake_v4l2_system(fake)->mmap(context, bytes, fd, offset);
}

static int count_munmap(void *context, void *memory, size_t bytes)
{
    calls.other++;
    return fake_v4l2_system(fake)->munmap(context, memory, bytes);
}

/* --- the loop --- */

typedef struct loop {
    pupil_source *source;
    pupil_t pupil;
    pupil_sensor sensor;
    pupil_white_balance colour;
    pupil_recorder *recorder; /* NULL: nothing is recorded */
    unsigned long asks;
    unsigned char out[64 * 48 * 3];
} loop;

static pupil_why why;

static void one_frame(loop *l)
{
    pupil_frame frame;
    pupil_stats stats;
    pupil_sensor_setting s;
    pupil_camera_status status;
    const pupil_image out = {
        .data = l->out, .stride_bytes = 3 * 64, .width = 64, .height = 48, .pixel = PUPIL_PIXEL_RGB8};
    CHECK_MSG(pupil_source_next(l->source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
    if (l->recorder)
        CHECK_MSG(pupil_recorder_write(l->recorder, &frame, &why) == 0, "%s", why.text);
    frame.image.coding = &l->colour.coding;
    CHECK(pupil_process(&l->pupil, &frame.image, &frame.info, &out) == PUPIL_OK);
    CHECK(pupil_get_stats(&l->pupil, &stats) == PUPIL_OK);
    CHECK(pupil_sensor_frame(&l->sensor, &stats, &frame.info) == PUPIL_OK);
    CHECK(pupil_sensor_get(&l->sensor, &s) == PUPIL_OK);
    if (s.changed) {
        pupil_camera *camera = pupil_live_camera(l->source);
        const uint64_t number = pupil_camera_ask(camera, &(pupil_camera_setting){s.exposure_s, s.gain, 0});
        l->asks++;
        do { /* the writer uses the machine's clock, the camera its own */
            usleep(20);
            pupil_camera_get_status(camera, &status);
        } while (status.written < number);
    }
    pupil_white_balance_frame(&l->colour, &frame.image, &frame.info);
    pupil_source_done(l->source, &frame);
}

/* If that is allowed without a limit, and not skipped by a sanitizer. */
static void lock_memory(void)
{
#ifndef PUPIL_SANITIZED
    struct rlimit most = {0, 0};
    getrlimit(RLIMIT_MEMLOCK, &most);
    locked = (geteuid() == 0 || most.rlim_cur == RLIM_INFINITY) && mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
#endif
}

static long faults(void)
{
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return used.ru_minflt + used.ru_majflt;
}

/* Light that swings by four stops, so that controls are written again and again. */
static void run(loop *l, const char *what)
{
    unsigned long asks = 0;
    long faulted = 0;
    for (int i = 0; i < FIRST + FRAMES; i++) {
        if (i == FIRST) {
            taken = given = 0;
            calls.poll = calls.dequeue = calls.queue = calls.write = calls.read_back = calls.other = 0;
            asks = l->asks;
            faulted = faults();
        }
        if (i % 10 == 0)
            fake_v4l2_light(fake, (double)(1 << i / 10 % 5));
        one_frame(l);
    }
    asks = l->asks - asks;
    faulted = faults() - faulted;
    printf("%s: %d frames: %lu poll, %lu DQBUF, %lu QBUF; %lu asks: %lu writes, %lu reads of controls; %lu others\n",
           what, FRAMES, calls.poll, calls.dequeue, calls.queue, asks, calls.write, calls.read_back, calls.other);
    printf("%s: memory taken %lu times, given back %lu times; %ld page faults%s\n", what, taken, given, faulted,
           locked ? ", all memory locked" : "");
    CHECK(taken == 0 && given == 0);
    CHECK(!locked || faulted == 0);
    CHECK(calls.poll == FRAMES && calls.dequeue == FRAMES && calls.queue == FRAMES && calls.other == 0);
    CHECK(asks > FRAMES / 20);
    CHECK(calls.write <= 2 * asks && calls.read_back <= 2 * asks); /* of exposure and of gain */
}

static void begin(loop *l, const pupil_v4l2_system *system)
{
    const pupil_live_options options = {.capture = {.system = system, .monotonic = 1}};
    const pupil_colour_options automatic = {0};
    pupil_config adapting;
    pupil_sensor_config regulating;
    const unsigned long before = taken;
    CHECK_MSG(pupil_live_open("0", NULL, &options, &l->source, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_live_camera(l->source), "%s", pupil_live_no_controls(l->source));
    CHECK_MSG(taken >= before + 2 && calls.other > 0, "what is counted is not wrapped");
    const pupil_v4l2_format *format = &pupil_live_capture(l->source)->format;
    CHECK_MSG(pupil_white_balance_begin(&l->colour, &automatic, &format->coding, format->pixel, NULL, &why) == 0 &&
                  l->colour.follows,
              "%s", why.text);
    pupil_config_default(&adapting);
    pupil_sensor_config_default(&regulating);
    pupil_camera_configure(pupil_live_camera(l->source), &regulating);
    CHECK(pupil_init(&l->pupil, &adapting) == PUPIL_OK && pupil_sensor_init(&l->sensor, &regulating) == PUPIL_OK);
}

static void begin_recording(loop *l, const char *folder)
{
    const pupil_recorder_options options = {.fps = 30, .wait = 1};
    pupil_frame frame;
    CHECK_MSG(pupil_source_next(l->source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
    CHECK_MSG(pupil_recorder_open(&l->recorder, folder, &frame, &options, &why) == 0, "%s", why.text);
    pupil_source_done(l->source, &frame);
}

static uint64_t frames_in(const char *folder)
{
    pupil_source *source = NULL;
    pupil_frame frame;
    uint64_t count = 0;
    CHECK_MSG(pupil_recording_open(folder, NULL, &source, &why) == 0, "%s", why.text);
    while (source && pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME) {
        pupil_source_done(source, &frame);
        count++;
    }
    pupil_source_close(source);
    return count;
}

static void end(loop *l)
{
    if (l->recorder) {
        CHECK_MSG(pupil_recorder_close(l->recorder, &why) == 0, "%s", why.text);
        l->recorder = NULL;
    }
    CHECK_MSG(pupil_live_give_back(l->source, &why) == 0, "%s", why.text);
    pupil_source_close(l->source);
    CHECK(given >= 2);
}

int main(int argc, char **argv)
{
    static loop l;
    fake_v4l2_config config;
    check_begin(argc, argv);
    scratch_begin();
    lock_memory();
    fake_v4l2_config_default(&config);
    config.only_format = V4L2_PIX_FMT_SRGGB10;
    fake = fake_v4l2_new(&config);
    pupil_v4l2_system system = *fake_v4l2_system(fake);
    system.open = count_open;
    system.close = count_close;
    system.ioctl = count_ioctl;
    system.mmap = count_mmap;
    system.munmap = count_munmap;
    system.poll = count_poll;
    begin(&l, &system);
    run(&l, "live");
    end(&l);
    begin(&l, &system);
    begin_recording(&l, scratch("recording"));
    run(&l, "recorded, too");
    end(&l);
    CHECK(frames_in(scratch("recording")) == FIRST + FRAMES);
    fake_v4l2_free(fake);
    scratch_clear(scratch_folder);
    return check_end();
}
