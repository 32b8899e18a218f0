/* `pupil run` and `pupil probe` on a camera in this process:
 *
 *     run_fake [fake:KEY=VALUE ...] [options of pupil run]
 *     run_fake [fake:KEY=VALUE ...] probe [options of pupil probe]
 *
 * Keys: size=WxH, format=FOURCC (that alone), bt2020 (the driver reports its colorspace), fps=N, delay=FRAMES (of
 * controls), flat=N (a scene of one value), colour=R,G,B (of the light), drop=SHARE, flag=SHARE, unplug=FRAME,
 * back=SECONDS, end=FRAME, stall=FRAME, sleep=WRITE,SECONDS (of controls), black=SHARE (of full scale), deaf=exposure
 * or gain (which then does nothing), gain-earlier=FRAMES, curve (sRGB's, regardless of the report), slow=1,HINTS,HEAPS
 * (memory; fake_v4l2.h), refuse=WRITE,COUNT,ERRNO (so many writes of controls), write=SECONDS (each takes so long),
 * work=SECONDS (each takes so much of the processor's time), exposure=LEAST,MOST and gain=LEAST,MOST (what the driver
 * says of these controls), no-menu (of EXPOSURE_AUTO), stamps=SECONDS (ahead of the clock; 0: none), sequence=FIRST,
 * change=FRAME, lamps=HZ,MODULATION,SECONDS (their light, and the readout), lines=PIXEL_RATE,HBLANK (what the driver
 * reports of it), again=WxH@FRAME (the size after it was unplugged), light=FACTOR@FRAME (repeatable), real (the
 * machine's clock), other-light=FACTOR (a second camera, -d /dev/video9, so much more sensitive, else like the first),
 * other-unplug=FRAME, other-gain=MOST, absent, media, no-controls, crash=FRAME, hasty, threads (that sleep, as those of
 * libraries). At its end it prints on standard error how its controls were left: "fake: auto 3, exposure 77, gain 40".
 *
 * The camera's clock (not with real) is stopped while any other thread of the program is busy. Otherwise hundreds of
 * frames could pass before a busy machine runs the thread that writes controls. Sleeping threads are not waited for, so
 * that writes can still be slow by the camera's clock. hasty: no thread is waited for. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "fake_v4l2/fake_v4l2.h"
#include "probe/probe.h"
#include "run/run.h"
#include "v4l2/format.h"

enum { MOST_LIGHTS = 16, MOST_WAITS = 50000 /* ten seconds */ };

static struct {
    fake_v4l2 *fake;
    pupil_v4l2_system system; /* the fake's, with what follows */
    struct {
        double factor;
        unsigned long frame;
    } light[MOST_LIGHTS];
    int lights, no_controls, no_menu, hasty;
    int refused; /* errno */
    double write_s, work_s;
    unsigned long frames, crash_at, writes, refuse_at, refuse_for, again_at;
    int32_t least[2], most[2]; /* of exposure and gain; most 0: as the fake has them */
    fake_v4l2_config again;
    double other_light; /* of the second camera; 0: there is none */
    unsigned long other_unplug;
    int32_t other_gain;
    int is_other; /* this process has the second camera */
} rig;

/* The second camera's process opens the same fake, its own copy. */
static int rig_open(void *context, const char *path)
{
    if (!(rig.other_light > 0.0) || strcmp(path, "/dev/video9") != 0)
        return fake_v4l2_system(rig.fake)->open(context, path);
    if (!rig.is_other) {
        fake_v4l2_config config = rig.again;
        rig.is_other = 1;
        if (rig.other_unplug)
            config.unplug_at = rig.other_unplug;
        fake_v4l2_reconfigure(rig.fake, &config);
        fake_v4l2_light(rig.fake, rig.other_light);
    }
    return fake_v4l2_system(rig.fake)->open(context, "/dev/video0");
}

static int is_control(unsigned long request)
{
    return request == VIDIOC_QUERYCTRL || request == VIDIOC_QUERY_EXT_CTRL || request == VIDIOC_S_CTRL ||
           request == VIDIOC_G_CTRL || request == VIDIOC_S_EXT_CTRLS || request == VIDIOC_G_EXT_CTRLS;
}

/* The range that the driver reports for a control. */
static void narrow(struct v4l2_query_ext_ctrl *q)
{
    const int i = q->id == V4L2_CID_GAIN;
    if (i && rig.is_other && rig.other_gain) {
        q->maximum = rig.other_gain;
        return;
    }
    if ((q->id == V4L2_CID_GAIN || q->id == V4L2_CID_EXPOSURE_ABSOLUTE) && rig.most[i]) {
        q->minimum = rig.least[i];
        q->maximum = rig.most[i];
        q->default_value = rig.least[i];
    }
}

/* Whether a thread of this process runs, is runnable, or waits for a disk. */
static int is_busy(const char *id)
{
    char path[64], line[512];
    snprintf(path, sizeof path, "/proc/self/task/%.20s/stat", id);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) /* it has ended */
        return 0;
    const ssize_t length = read(file, line, sizeof line - 1);
    close(file);
    line[length > 0 ? length : 0] = 0;
    const char *state = strrchr(line, ')'); /* the thread's name comes before, in parentheses: proc(5) */
    return state && (strncmp(state, ") R", 3) == 0 || strncmp(state, ") D", 3) == 0);
}

/* Without allocations: tests/failures makes the program's allocations fail, one after the other. */
static int others_are_busy(void)
{
    _Alignas(struct dirent64) char entries[2048];
    char own[24];
    int busy = 0;
    ssize_t bytes;
    snprintf(own, sizeof own, "%d", (int)gettid());
    const int threads = open("/proc/self/task", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    while (!busy && threads >= 0 && (bytes = getdents64(threads, entries, sizeof entries)) > 0)
        for (ssize_t at = 0; at < bytes && !busy; at += ((const struct dirent64 *)(entries + at))->d_reclen) {
            const char *id = ((const struct dirent64 *)(entries + at))->d_name;
            busy = *id != '.' && strcmp(id, own) != 0 && is_busy(id);
        }
    if (threads >= 0)
        close(threads);
    return busy;
}

/* Only in main's thread: two threads waiting for each other would deadlock. */
static void wait_for_others(void)
{
    const struct timespec moment = {0, 200000};
    for (int i = 0; i < MOST_WAITS && !rig.hasty && gettid() == getpid() && others_are_busy(); i++)
        nanosleep(&moment, NULL);
}

/* Time passes here. */
static int rig_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    wait_for_others();
    return fake_v4l2_system(rig.fake)->poll(context, fds, count, timeout_ms);
}

/* Between a frame's arrival and its metering: finishes a write that was asked for in between, as 33 ms would. */
static int64_t rig_now_ns(void *context)
{
    wait_for_others();
    return fake_v4l2_system(rig.fake)->now_ns(context);
}

static double processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static int rig_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    const pupil_v4l2_system *inner = fake_v4l2_system(rig.fake);
    if (rig.no_controls && is_control(request)) {
        errno = ENOTTY;
        return -1;
    }
    if (request == VIDIOC_S_EXT_CTRLS && rig.refused && ++rig.writes >= rig.refuse_at &&
        rig.writes - rig.refuse_at < rig.refuse_for) {
        errno = rig.refused;
        return -1;
    }
    if (request == VIDIOC_S_EXT_CTRLS && rig.write_s > 0.0) {
        const struct timespec moment = {(time_t)rig.write_s, (long)((rig.write_s - (time_t)rig.write_s) * 1e9)};
        nanosleep(&moment, NULL);
    }
    if (request == VIDIOC_S_EXT_CTRLS)
        for (const double end_s = processor_s() + rig.work_s; processor_s() < end_s;)
            ;
    if (request == VIDIOC_QUERYMENU && rig.no_menu) {
        errno = EINVAL;
        return -1;
    }
    if (rig.crash_at && rig.frames >= rig.crash_at && request == VIDIOC_S_EXT_CTRLS) {
        const struct v4l2_ext_controls *all = argument;
        dprintf(2, "fake: after the crash %x = %d\n", all->controls[0].id, all->controls[0].value);
    }
    const int result = inner->ioctl(context, fd, request, argument);
    if (request == VIDIOC_QUERY_EXT_CTRL && result == 0)
        narrow(argument);
    if (request == VIDIOC_DQBUF && result == 0) {
        rig.frames++;
        for (int i = 0; i < rig.lights; i++)
            if (rig.light[i].frame == rig.frames)
                fake_v4l2_light(rig.fake, rig.light[i].factor * (rig.is_other ? rig.other_light : 1.0));
        if (rig.frames == rig.again_at)
            fake_v4l2_reconfigure(rig.fake, &rig.again);
        if (rig.frames == rig.crash_at)
            raise(SIGSEGV);
    }
    return result;
}

static void *sleep_on(void *none)
{
    for (;;)
        pause();
    return none;
}

static void begin_threads(void)
{
    pthread_t thread;
    for (int i = 0; i < 100; i++)
        pthread_create(&thread, NULL, sleep_on, NULL);
}

static int take(const char *text, fake_v4l2_config *c)
{
    char format[5] = "";
    unsigned long when = 0;
    double x = 0.0, y = 0.0;
    if (strcmp(text, "real") == 0)
        c->real_time = 1;
    else if (strcmp(text, "bt2020") == 0)
        c->colorspace = V4L2_COLORSPACE_BT2020;
    else if (strcmp(text, "hasty") == 0)
        rig.hasty = 1;
    else if (strcmp(text, "threads") == 0)
        begin_threads();
    else if (strcmp(text, "absent") == 0)
        c->absent = 1;
    else if (sscanf(text, "other-light=%lf", &rig.other_light) == 1 ||
             sscanf(text, "other-unplug=%lu", &rig.other_unplug) == 1 ||
             sscanf(text, "other-gain=%d", &rig.other_gain) == 1)
        ;
    else if (strcmp(text, "media") == 0)
        c->media = FAKE_MEDIA_RIGHT;
    else if (strcmp(text, "no-controls") == 0)
        rig.no_controls = 1;
    else if (strcmp(text, "no-menu") == 0)
        rig.no_menu = 1;
    else if (sscanf(text, "exposure=%d,%d", &rig.least[0], &rig.most[0]) == 2 ||
             sscanf(text, "gain=%d,%d", &rig.least[1], &rig.most[1]) == 2)
        return 0;
    else if (sscanf(text, "refuse=%lu,%lu,%d", &rig.refuse_at, &rig.refuse_for, &rig.refused) == 3)
        return 0;
    else if (sscanf(text, "write=%lf", &rig.write_s) == 1 || sscanf(text, "work=%lf", &rig.work_s) == 1)
        return 0;
    else if (strcmp(text, "stamps=0") == 0)
        c->stamp = FAKE_STAMP_NONE;
    else if (sscanf(text, "stamps=%lf", &x) == 1)
        c->stamps_ns = (int64_t)(x * 1e9);
    else if (sscanf(text, "sequence=%u", &c->first_sequence) == 1)
        return 0;
    else if (sscanf(text, "change=%lu", &when) == 1)
        c->change_at = when;
    else if (sscanf(text, "again=%ux%u@%lu", &rig.again.width, &rig.again.height, &rig.again_at) == 3)
        return 0;
    else if (sscanf(text, "size=%ux%u", &c->width, &c->height) == 2)
        return 0;
    else if (sscanf(text, "format=%4s", format) == 1)
        c->only_format = pupil_v4l2_fourcc(format);
    else if (sscanf(text, "fps=%lf", &c->fps) == 1)
        return 0;
    else if (sscanf(text, "delay=%lu", &when) == 1)
        c->control_delay = (uint32_t)when;
    else if (sscanf(text, "black=%lf", &c->black) == 1 || sscanf(text, "gain-earlier=%u", &c->gain_earlier) == 1)
        return 0;
    else if (sscanf(text, "deaf=%4s", format) == 1)
        c->deaf_exposure = *format == 'e', c->deaf_gain = *format == 'g';
    else if (strcmp(text, "curve") == 0)
        c->drawn_xfer = V4L2_XFER_FUNC_SRGB;
    else if (sscanf(text, "slow=%d,%d,%d", &c->slow, &c->hints, &c->heaps) == 3)
        return 0;
    else if (sscanf(text, "flat=%u", &c->flat) == 1)
        return 0;
    else if (sscanf(text, "lamps=%lf,%lf,%lf", &c->lamp_hz, &c->modulation, &c->readout_s) == 3)
        return 0;
    else if (sscanf(text, "lines=%lf,%lf", &x, &y) == 2)
        c->pixel_rate = (int64_t)x, c->hblank = (int64_t)y;
    else if (sscanf(text, "colour=%lf,%lf,%lf", &c->colour[0], &c->colour[1], &c->colour[2]) == 3)
        return 0;
    else if (sscanf(text, "drop=%lf", &c->dropped) == 1 || sscanf(text, "flag=%lf", &c->flagged) == 1)
        return 0;
    else if (sscanf(text, "unplug=%lu", &when) == 1)
        c->unplug_at = when;
    else if (sscanf(text, "back=%lf", &c->back_s) == 1)
        return 0;
    else if (sscanf(text, "end=%lu", &when) == 1)
        c->end_at = when;
    else if (sscanf(text, "stall=%lu", &when) == 1)
        c->stall_at = when;
    else if (sscanf(text, "sleep=%lf,%lf", &x, &y) == 2) {
        c->sleep_at = (uint64_t)x;
        c->sleep_s = y;
    } else if (sscanf(text, "crash=%lu", &when) == 1)
        rig.crash_at = when;
    else if (sscanf(text, "light=%lf@%lu", &x, &when) == 2 && rig.lights < MOST_LIGHTS) {
        rig.light[rig.lights].factor = x;
        rig.light[rig.lights++].frame = when;
    } else
        return -1;
    return 0;
}

static int control(uint32_t id, int set, int value)
{
    const pupil_v4l2_system *system = fake_v4l2_system(rig.fake);
    struct v4l2_control c = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    if (fd < 0)
        return -1;
    system->ioctl(system->context, fd, set ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &c);
    system->close(system->context, fd);
    return c.value;
}

static void tell_controls(void)
{
    fprintf(stderr, "fake: auto %d, exposure %d, gain %d\n", control(V4L2_CID_EXPOSURE_AUTO, 0, 0),
            control(V4L2_CID_EXPOSURE_ABSOLUTE, 0, 0), control(V4L2_CID_GAIN, 0, 0));
}

int main(int argc, char **argv)
{
    fake_v4l2_config config;
    int kept = 1;
    fake_v4l2_config_default(&config);
    for (int i = 1; i < argc; i++) {
        if (strncmp(argv[i], "fake:", 5) != 0)
            argv[kept++] = argv[i];
        else if (take(argv[i] + 5, &config)) {
            fprintf(stderr, "run_fake: %s: no such key\n", argv[i]);
            return 99;
        }
    }
    argv[kept] = NULL;
    const uint32_t width = rig.again.width, height = rig.again.height;
    rig.again = config;
    rig.again.width = width;
    rig.again.height = height;
    rig.fake = fake_v4l2_new(&config);
    if (!rig.fake)
        return 99;
    rig.system = *fake_v4l2_system(rig.fake);
    rig.system.ioctl = rig_ioctl;
    rig.system.open = rig_open;
    rig.system.poll = rig_poll;
    rig.system.now_ns = rig_now_ns;
    rig.hasty |= config.real_time;
    if (!config.absent && !rig.no_controls) { /* as its user had them */
        control(V4L2_CID_EXPOSURE_AUTO, 1, 3);
        control(V4L2_CID_EXPOSURE_ABSOLUTE, 1, 77);
        control(V4L2_CID_GAIN, 1, 40);
        fake_v4l2_reconfigure(rig.fake, &config); /* these writes do not count */
        rig.writes = 0;
    }
    const int probes = kept > 1 && strcmp(argv[1], "probe") == 0;
    const pupil_live_system live = {.v4l2 = &rig.system};
    const int status = probes ? probe_on(&live, kept - 1, argv + 1) : run_on(&live, kept, argv);
    const struct timespec moment = {0, 10000000};
    if (fake_v4l2_holds(rig.fake).files)
        fprintf(stderr, "fake: files are left as it ends, which a program would take with it\n");
    for (int i = 0; fake_v4l2_holds(rig.fake).files && i < 1000; i++)
        nanosleep(&moment, NULL); /* a write that hung, and itself restores the old value */
    if (!config.absent && !rig.no_controls)
        tell_controls();
    const fake_v4l2_held held = fake_v4l2_holds(rig.fake);
    if (held.files || held.maps)
        fprintf(stderr, "fake: %d files and %d maps are left\n", held.files, held.maps);
    fake_v4l2_free(rig.fake);
    return status;
}
