/* libcamera.c: libcamera CAMERA: runs in the guest (test_libcamera.sh). libcamera's webcams, on the kernel's uvcvideo:
 * a camera in user space (CAMERA: uvc_camera.c) answers exposure time and gain, and the light changes.
 *
 * Checked: light times 8 and divided by 8 is settled to 0.1 EV in delay + 3 frames and does not overshoot by more; the
 * controls are restored afterwards; a refused control does not stop frames; unplugging gives one sentence, and with the
 * option to wait, it continues. */
#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "pupil/camera_loop.h"
#include "pupil/pupil.h"
#include "vm/node.h"
#include "vm/uvc_seen.h"

#define TIMEOUT_S 10.0
#define KEY       0.03 /* so low that light times 8 does not clip, and can be measured */
#define SETTLED   0.1  /* EV */
#define MORE      3    /* frames */
#define GAIN      17   /* the user's; libcamera leaves it; so low that exposure steps of 100 us are below SETTLED */

static pupil_why why;
static char path[32];
static const char *program;
static pid_t process;

static void camera_start(const char *answers, const char *how, unsigned after_s)
{
    process = fork();
    if (process == 0) {
        sleep(after_s);
        execl(program, program, answers, how, (char *)NULL);
        _exit(127);
    }
}

static void camera_plug(const char *answers, const char *how)
{
    camera_start(answers, how, 0);
    CHECK_MSG(uvc_await(path) == 0, "there is no camera after 20 s");
    sleep(2); /* for udevd */
}

static void camera_unplug(void)
{
    uvc_unplug(process);
    sleep(1);
}

/* ---- the loop, as in pupil run ---- */

typedef struct loop {
    pupil_source *source;
    pupil_t pupil;
    pupil_camera_loop loop;
    pupil_sensor_config config;
    int is_linear, steers;
    uvc_truth truth; /* of the last frame */
    uint64_t sequence;
    pupil_frame_info info;
    unsigned frames;
} loop;

static int loop_open(loop *l, int is_linear, double reopen_s)
{
    const pupil_live_options options = {
        .capture = {.width = 320, .height = 240, .timeout_s = TIMEOUT_S, .reopen_s = reopen_s}};
    pupil_config config;
    memset(l, 0, sizeof *l);
    l->is_linear = is_linear;
    int failed = 1; /* until udevd has announced the camera: on a busy machine seconds after the kernel has it */
    for (int i = 0; i < 20 && failed; i++) {
        failed = pupil_live_open("libcamera:0", NULL, &options, &l->source, &why);
        sleep(failed && i < 19);
    }
    CHECK_MSG(!failed, "%s", why.text);
    if (failed)
        return -1;
    pupil_config_default(&config);
    config.histogram = 1;
    CHECK(pupil_init(&l->pupil, &config) == PUPIL_OK);
    return 0;
}

/* The camera's present controls. */
static void loop_take(loop *l)
{
    pupil_camera *camera = pupil_live_camera(l->source);
    if (!camera) {
        pupil_camera_loop_lost(&l->loop);
        l->steers = 0;
        return;
    }
    if (l->steers && camera == l->loop.camera)
        return;
    pupil_sensor_config_default(&l->config);
    l->config.frame_s = 1.0 / l->source->fps;
    pupil_camera_configure(camera, &l->config);
    l->config.linear = (uint32_t)l->is_linear;
    l->config.key = KEY;
    CHECK_MSG(pupil_camera_loop_begin(&l->loop, camera, &l->config, 0.0, &why) == 0, "%s", why.text);
    l->steers = 1;
}

static int loop_frame(loop *l)
{
    static pupil_stats stats;
    pupil_frame frame;
    const int got = pupil_source_next(l->source, &frame, &why);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    loop_take(l);
    l->truth = uvc_read_truth(&frame.image);
    l->sequence = frame.info.sequence;
    l->info = frame.info;
    CHECK(uvc_meter(&l->pupil, &frame.image, l->is_linear, &stats) == PUPIL_OK);
    if (l->steers) {
        pupil_live_mark(l->source);
        CHECK(pupil_camera_loop_frame(&l->loop, &stats, &frame.info) == PUPIL_OK);
    }
    pupil_source_done(l->source, &frame);
    l->frames++;
    return PUPIL_SOURCE_FRAME;
}

/* ---- the tests ---- */

static double rest(loop *l, const char *what)
{
    int still = 0;
    for (int i = 0; i < 120 && still < 10; i++) {
        const uvc_truth before = l->truth;
        CHECK_MSG(loop_frame(l) == PUPIL_SOURCE_FRAME, "%s: %s", what, why.text);
        still = !l->truth.automatic && before.exposure_100us == l->truth.exposure_100us ? still + 1 : 0;
    }
    CHECK_MSG(still == 10, "%s: it does not come to rest", what);
    return uvc_level(&l->truth);
}

/* Starts at rest; frames are counted by the camera, from the first with the new light. */
static void step(loop *l, int light, const char *what)
{
    const double aim = rest(l, what);
    static char story[64][128];
    uint64_t first = 0, settled = 0;
    double over = 0.0, direction = light > (int)l->truth.light ? 1.0 : -1.0;
    unsigned lines = 0;
    CHECK(sigqueue(process, UVC_SET_LIGHT, (union sigval){.sival_int = light}) == 0);
    for (int i = 0; i < 40; i++) {
        CHECK_MSG(loop_frame(l) == PUPIL_SOURCE_FRAME, "%s: %s", what, why.text);
        const double off = uvc_level(&l->truth) - aim;
        snprintf(story[lines++], sizeof story[0], "%llu: light %u, %.1f ms (said: %.1f), %+.2f EV, asks %.1f, %s",
                 (unsigned long long)l->sequence, l->truth.light, l->truth.exposure_100us / 10.0,
                 l->info.exposure_s * 1e3, off, l->loop.setting.exposure_s * 1e3,
                 pupil_sensor_state_name(l->loop.setting.state));
        if ((int)l->truth.light != light)
            continue;
        first = first ? first : l->sequence + 1;
        if (fabs(off) > SETTLED)
            settled = 0;
        else if (!settled)
            settled = l->sequence + 1;
        over = fmax(over, -off * direction);
    }
    const uint64_t took = settled - first;
    CHECK_MSG(settled && took <= l->config.delay_frames + MORE, "%s: %llu frames; %u are promised", what,
              (unsigned long long)took, l->config.delay_frames + MORE);
    CHECK_MSG(over <= SETTLED, "%s: %.2f EV too far", what, over);
    for (unsigned i = 0; i < lines && (!settled || took > l->config.delay_frames + MORE || over > SETTLED); i++)
        puts(story[i]);
    printf("%s: settled in %llu frames (delay %u + %d), overshoot %.3f EV\n", what, (unsigned long long)took,
           l->config.delay_frames, MORE, over);
}

static const char *const names[] = {"Auto Exposure", "Exposure Time, Absolute", "Exposure, Dynamic Framerate", "Gain"};
#define NAMES (sizeof names / sizeof names[0])

static void test_light(const char *answers)
{
    static loop l;
    int before[NAMES], after[NAMES];
    char what[64];
    camera_plug(answers, "slow");
    const int fd = node_open(path);
    CHECK(node_set(fd, names[0], 1) == 0 && node_set(fd, names[1], 77) == 0 && node_set(fd, names[2], 1) == 0 &&
          node_set(fd, names[3], GAIN) == 0);
    for (size_t i = 0; i < NAMES; i++)
        CHECK(node_get(fd, names[i], &before[i]) == 0);
    if (loop_open(&l, strcmp(answers, "linear") == 0, 0.0) == 0) {
        const int lights[] = {7, 8, 7, 8};
        CHECK(strstr(pupil_live_get(l.source)->remark.text, "v4l2:") != NULL);
        for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
            snprintf(what, sizeof what, "%s, light %d", answers, lights[i]);
            step(&l, lights[i], what);
        }
        CHECK(pupil_live_get(l.source)->counts.cancelled == 0);
        pupil_source_close(l.source);
    }
    for (size_t i = 0; i < NAMES; i++) {
        CHECK(node_get(fd, names[i], &after[i]) == 0);
        CHECK_MSG(after[i] == before[i], "%s was %d and is %d", names[i], before[i], after[i]);
    }
    close(fd);
    camera_unplug();
}

/* A third of the writes is refused: those requests are cancelled, and frames still come. */
static void test_refused(void)
{
    static loop l;
    camera_plug("display", "hard");
    if (loop_open(&l, 0, 0.0) == 0) {
        for (int i = 0; i < 200; i++) {
            if (i % 12 == 6)
                CHECK(sigqueue(process, UVC_SET_LIGHT, (union sigval){.sival_int = 8 + i / 12 % 2}) == 0);
            CHECK_MSG(loop_frame(&l) == PUPIL_SOURCE_FRAME, "frame %d: %s", i, why.text);
        }
        const pupil_live_counts *c = &pupil_live_get(l.source)->counts;
        printf("refused: %llu settings, %llu requests cancelled, %u frames came, the stream was restarted %llu times\n",
               (unsigned long long)l.loop.refusals, (unsigned long long)c->cancelled, l.frames,
               (unsigned long long)c->restarted);
        CHECK(c->cancelled >= 4 && l.loop.refusals >= 4); /* the number of buffers: without requeuing it would stop */
        CHECK(c->restarted == 0);
        pupil_source_close(l.source);
    }
    camera_unplug();
}

static void test_unplugged(void)
{
    static loop l;
    camera_plug("display", "slow");
    if (loop_open(&l, 0, 0.0) == 0) {
        int got = PUPIL_SOURCE_FRAME;
        for (int i = 0; i < 60 && got == PUPIL_SOURCE_FRAME; i++) {
            if (i == 10)
                kill(process, SIGTERM);
            got = loop_frame(&l);
        }
        CHECK_MSG(got == PUPIL_SOURCE_FAILED && strstr(why.text, "the camera was unplugged"), "%d, %s", got, why.text);
        printf("unplugged: %s\n", why.text);
        pupil_source_close(l.source);
    }
    camera_unplug();
}

static void test_back(void)
{
    static loop l;
    camera_plug("display", "slow");
    if (loop_open(&l, 0, 30.0) == 0) {
        for (int i = 0; i < 10; i++)
            CHECK_MSG(loop_frame(&l) == PUPIL_SOURCE_FRAME, "%s", why.text);
        kill(process, SIGTERM);
        waitpid(process, NULL, 0);
        camera_start("display", "slow", 2);
        int manual = 0;
        for (int i = 0; i < 40; i++) {
            CHECK_MSG(loop_frame(&l) == PUPIL_SOURCE_FRAME, "%s", why.text);
            manual = l.truth.automatic ? 0 : manual + 1;
        }
        CHECK_MSG(manual >= 20, "of forty frames the last %d were steered", manual);
        CHECK(pupil_live_get(l.source)->counts.reopened == 1);
        printf("back: opened again once, %d frames steered\n", manual);
        pupil_source_close(l.source);
    }
    camera_unplug();
}

int main(int argc, char **argv)
{
    if (argc < 2)
        return 2;
    program = argv[1];
    check_begin(argc - 1, argv + 1);
    setvbuf(stdout, NULL, _IOLBF, 0);
    test_light("display"); /* codes of 8 bits that are linear have no eighth of KEY */
    test_refused();
    test_unplugged();
    test_back();
    return check_end();
}
