/* uvc.c: uvc CAMERA: runs in the guest (test_uvc.sh). The closed loop on the kernel's uvcvideo: a camera in user space
 * (CAMERA: uvc_camera.c) answers exposure time and gain, and the light changes.
 *
 * Checked: the picture shows what pupil sets; the level settles in as many frames as the controller promises
 * (docs/sim.md) and stays; the controls are restored afterwards; unplugging ends it, but not with the option to
 * wait. */
#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "live/live.h"
#include "pupil/pupil.h"
#include "vm/node.h"
#include "vm/uvc_seen.h"

#define FPS       15.0 /* slow, so that an emulated machine has time for the work of a frame */
#define TIMEOUT_S 10.0

static pupil_why why;
static char path[32];
static const char *program;
static pid_t process;

/* --- the camera --- */

static void camera_plug(const char *answers)
{
    process = fork();
    if (process == 0) {
        execl(program, program, answers, (char *)NULL);
        _exit(127);
    }
    CHECK_MSG(uvc_await(path) == 0, "there is no camera after 20 s");
}

/* --- the loop --- */

typedef struct loop {
    pupil_source *source;
    pupil_t pupil;
    pupil_sensor sensor;
    pupil_sensor_config config;
    pupil_sensor_setting setting;
    int is_linear;   /* the camera's luma is linear, which YUYV cannot express */
    double error_ev; /* of the last frame, relative to the key */
    uvc_truth truth; /* of the last frame */
    uint64_t sequence;
    double worst_ev;          /* the difference of a frame's level and its true settings */
    unsigned truths;          /* how many frames were compared */
    uint64_t asked_at, delay; /* delay: the longest so far from an ask to its frame, or with wrong metadata */
    uint64_t wrong;           /* frames in a row with wrong metadata */
    int misled;               /* there was one in this light */
    unsigned all_wrong;       /* the total */
    uint64_t longest;         /* the largest `delay` in any light */
    pupil_frame_info info;    /* of the last frame */
} loop;

static int loop_open(loop *l, int is_linear, double reopen_s)
{
    const pupil_live_options options = {
        .capture = {.width = 320, .height = 240, .fps = FPS, .timeout_s = TIMEOUT_S, .reopen_s = reopen_s}};
    pupil_config config;
    memset(l, 0, sizeof *l);
    l->is_linear = is_linear;
    const int failed = pupil_live_open(path, NULL, &options, &l->source, &why);
    CHECK_MSG(!failed, "%s", why.text);
    if (failed)
        return -1;
    CHECK_MSG(pupil_live_camera(l->source) != NULL, "%s", pupil_live_no_controls(l->source));
    pupil_config_default(&config);
    config.histogram = 1;
    CHECK(pupil_init(&l->pupil, &config) == PUPIL_OK);
    pupil_sensor_config_default(&l->config);
    l->config.frame_s = 1.0 / FPS;
    if (pupil_live_camera(l->source))
        pupil_camera_configure(pupil_live_camera(l->source), &l->config);
    l->config.delay_frames = 4; /* as long as a write over this USB may take */
    CHECK(pupil_sensor_init(&l->sensor, &l->config) == PUPIL_OK);
    if (!pupil_live_camera(l->source))
        return -1;
    pupil_camera_status status; /* from the camera's automatic setting; the first setting is written, too */
    pupil_camera_get_status(pupil_live_camera(l->source), &status);
    pupil_sensor_start(&l->sensor, status.exposure_s.taken, status.gain.taken);
    CHECK(pupil_sensor_get(&l->sensor, &l->setting) == PUPIL_OK);
    const pupil_camera_setting first = {.exposure_s = l->setting.exposure_s, .gain = l->setting.gain};
    pupil_camera_ask(pupil_live_camera(l->source), &first);
    return 0;
}

/* How many frames after an ask the picture has it and the metadata is right: the time that a busy machine takes for a
 * write is not the loop's fault. */
static void follow_delay(loop *l)
{
    const int is_there = fabs(l->setting.exposure_s * 1e4 - l->truth.exposure_100us) < 1.5 &&
                         fabs(l->setting.gain * 16.0 - l->truth.gain_16ths) < 1.5;
    const double said = l->info.exposure_s * l->info.gain,
                 is = l->truth.exposure_100us * 1e-4 * l->truth.gain_16ths / 16;
    l->wrong = fabs(said / is - 1.0) > 0.03 ? l->wrong + 1 : 0;
    l->delay = l->wrong > l->delay ? l->wrong : l->delay;
    l->misled |= l->wrong > 0;
    l->all_wrong += l->wrong > 0;
    if (!l->asked_at || !is_there)
        return;
    l->delay = l->sequence - l->asked_at > l->delay ? l->sequence - l->asked_at : l->delay;
    l->asked_at = 0;
}

/* One frame: PUPIL_SOURCE_FRAME, or what ended it. */
static int loop_frame(loop *l)
{
    static pupil_stats stats;
    pupil_frame frame;
    double mean = 0.0;
    const int got = pupil_source_next(l->source, &frame, &why);
    if (got != PUPIL_SOURCE_FRAME)
        return got;
    l->truth = uvc_read_truth(&frame.image);
    l->sequence = frame.info.sequence;
    l->info = frame.info;
    CHECK(uvc_meter(&l->pupil, &frame.image, l->is_linear, &stats) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &mean) == PUPIL_OK);
    l->error_ev = mean - log2(l->config.key);
    if (uvc_level(&l->truth) < -UVC_STOPS / 2 && uvc_level(&l->truth) > -4.0 && !l->truth.automatic) {
        l->worst_ev = fmax(l->worst_ev, fabs(mean - uvc_level(&l->truth)));
        l->truths++;
    }
    CHECK(pupil_sensor_frame(&l->sensor, &stats, &frame.info) == PUPIL_OK);
    CHECK(pupil_sensor_get(&l->sensor, &l->setting) == PUPIL_OK);
    follow_delay(l);
    if (pupil_live_camera(l->source))
        pupil_camera_learn(pupil_live_camera(l->source), l->setting.exposure_delay, l->setting.gain_delay);
    if (l->setting.changed && pupil_live_camera(l->source)) { /* a camera that just came back may have none yet */
        const pupil_camera_setting wanted = {.exposure_s = l->setting.exposure_s, .gain = l->setting.gain};
        pupil_camera_ask(pupil_live_camera(l->source), &wanted);
        l->asked_at = l->sequence;
    }
    pupil_source_done(l->source, &frame);
    return PUPIL_SOURCE_FRAME;
}

/* The loop steps if the error is above far_ev, and makes no steps below hold_ev; the camera rounds gain and exposure
 * down, by up to a sixteenth and a hundredth. The rest is left to the slow filter. */
static int is_right(const loop *l)
{
    const double near_ev = l->config.far_ev + l->config.hold_ev;
    return l->error_ev < near_ev && l->error_ev > -near_ev - log2(17.0 / 16.0) - log2(1.01);
}

/* Frames, counted by the camera, from the first with this light until the level is right and stays so for eight. */
static void settle(loop *l, uint32_t light, unsigned looks, const char *what)
{
    uint64_t first = 0, right_from = 0;
    unsigned right = 0, lines = 0;
    l->delay = 0;
    l->misled = 0;
    static char story[150][128]; /* printed if it goes wrong */
    for (int i = 0; i < 150 && right < 8; i++) {
        const int got = loop_frame(l);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s: %s", what, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            return;
        snprintf(story[lines++], sizeof story[0],
                 "%llu: light %u, %.1f ms x %.2f (said: %.1f x %.2f), %+.2f EV, asks %.1f x %.2f",
                 (unsigned long long)l->sequence, l->truth.light, l->truth.exposure_100us / 10.0,
                 l->truth.gain_16ths / 16.0, l->info.exposure_s * 1e3, l->info.gain, l->error_ev,
                 l->setting.exposure_s * 1e3, l->setting.gain);
        if (l->truth.light != light)
            continue;
        first = first ? first : l->sequence + 1; /* 0: none yet */
        right_from = right ? right_from : l->sequence + 1;
        right = is_right(l) ? right + 1 : 0;
    }
    /* A reaction takes at most delay_frames, and so does each further look. If a write takes effect before it returns,
     * frames are described by the previous setting: that costs one look. */
    l->longest = l->delay > l->longest ? l->delay : l->longest;
    const uint64_t believed = l->config.delay_frames, took = right_from - first;
    const unsigned promised = (unsigned)((2 * (looks + (unsigned)l->misled) - 1) * believed);
    CHECK_MSG(right == 8, "%s: not right", what);
    if (l->delay > believed) /* the promise only holds for configured delays */
        printf("%s: a setting took %llu frames on this busy machine\n", what, (unsigned long long)l->delay);
    else
        CHECK_MSG(took <= promised, "%s: %llu frames; promised in %u", what, (unsigned long long)took, promised);
    for (unsigned i = 0; (right < 8 || took > promised) && i < lines; i++)
        puts(story[i]);
    printf("%s: %llu frames (promised: %u)%s, then %.3f EV off, exposure %.2f ms, gain %.2f\n", what,
           (unsigned long long)took, promised, l->misled ? ", misled" : "", l->error_ev, l->truth.exposure_100us / 10.0,
           l->truth.gain_16ths / 16.0);
}

/* At rest: the level does not drift, and the reported setting is in force. */
static void rest(loop *l, const char *what)
{
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 20; i++) {
        pupil_camera_status status;
        CHECK(loop_frame(l) == PUPIL_SOURCE_FRAME);
        least = fmin(least, l->error_ev);
        most = fmax(most, l->error_ev);
        pupil_camera_get_status(pupil_live_camera(l->source), &status);
        const uint64_t changed = status.exposure_s.from_frame > status.gain.from_frame ? status.exposure_s.from_frame
                                                                                       : status.gain.from_frame;
        if (i >= 8 && status.asks == status.written && l->sequence > changed + l->config.delay_frames)
            CHECK_MSG(fabs(status.exposure_s.taken * 1e4 - l->truth.exposure_100us) < 0.5 &&
                          fabs(status.gain.taken * 16.0 - l->truth.gain_16ths) < 0.5,
                      "%s: %g s, gain %g are said to be in force; the frame has %u and %u", what,
                      status.exposure_s.taken, status.gain.taken, l->truth.exposure_100us, l->truth.gain_16ths);
    }
    CHECK_MSG(most - least < 0.112, "%s: %g EV from end to end at rest", what, most - least);
}

/* --- the tests --- */

static const char *const names[] = {"Auto Exposure", "Exposure Time, Absolute", "Exposure, Dynamic Framerate", "Gain"};
#define NAMES (sizeof names / sizeof names[0])

/* A full cycle: brighter, darker, much brighter (clipped), much darker. */
static void test_loop(const char *answers)
{
    static loop l;
    int before[NAMES], after[NAMES];
    char what[64];
    camera_plug(answers);
    const int fd = node_open(path);
    CHECK(node_set(fd, names[0], 1) == 0 && node_set(fd, names[1], 77) == 0 && node_set(fd, names[2], 1) == 0 &&
          node_set(fd, names[3], 40) == 0 && node_set(fd, names[0], 3) == 0);
    for (size_t i = 0; i < NAMES; i++)
        CHECK(node_get(fd, names[i], &before[i]) == 0);
    if (loop_open(&l, strcmp(answers, "linear") == 0, 0.0) == 0) {
        static const struct {
            const char *name;
            int light;
            unsigned looks; /* a second one because 8 bits are coarse in the dark and clipped light cannot be measured;
                             * a third if light is below one code, or the settings of the first frames are unknown */
        } steps[] = {{"from automatic", 8, 3}, {"-3 EV", 7, 2}, {"+3 EV", 8, 2}, {"+6 EV", 10, 3}, {"-6 EV", 8, 4}};
        for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
            CHECK(sigqueue(process, UVC_SET_LIGHT, (union sigval){.sival_int = steps[i].light}) == 0);
            snprintf(what, sizeof what, "%s, %s", answers, steps[i].name);
            settle(&l, (uint32_t)steps[i].light, steps[i].looks, what);
            rest(&l, what);
        }
        CHECK_MSG(l.truths > 100 && l.worst_ev < 0.1, "%s: %u frames, and one is %g EV from what its setting makes",
                  answers, l.truths, l.worst_ev);
        printf("%s: %u frames show what was set, %.3f EV off at most\n", answers, l.truths, l.worst_ev);
        pupil_camera_limits limits = {0};
        if (pupil_live_camera(l.source))
            pupil_camera_get_limits(pupil_live_camera(l.source), &limits);
        printf("%s: frames show delays of %u and %u, the controls are taken to need %u and %u; %u frames were said to "
               "be taken otherwise than they were\n",
               answers, l.setting.exposure_delay, l.setting.gain_delay, limits.exposure_delay, limits.gain_delay,
               l.all_wrong);
        /* for an unknown camera 3 is assumed; this one draws each frame with its present settings */
        if (l.longest <= l.config.delay_frames)
            CHECK_MSG(limits.exposure_delay < 3, "%s: the delay was not learned", answers);
        pupil_source_close(l.source);
    }
    for (size_t i = 0; i < NAMES; i++) {
        CHECK(node_get(fd, names[i], &after[i]) == 0);
        CHECK_MSG(after[i] == before[i], "%s was %d and is %d", names[i], before[i], after[i]);
    }
    close(fd);
    uvc_unplug(process);
}

static void test_unplugged(void)
{
    static loop l;
    const node_held before = node_holds();
    camera_plug("display");
    if (loop_open(&l, 0, 0.0) == 0) {
        int got = PUPIL_SOURCE_FRAME;
        for (int i = 0; i < 40 && got == PUPIL_SOURCE_FRAME; i++) {
            if (i == 10)
                kill(process, SIGTERM);
            got = loop_frame(&l);
        }
        CHECK_MSG(got == PUPIL_SOURCE_FAILED && strstr(why.text, "the camera was unplugged"), "%d, %s", got, why.text);
        printf("unplugged: %s\n", why.text);
        pupil_source_close(l.source);
    }
    uvc_unplug(process);
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%d files and %d maps are left",
              after.files - before.files, after.maps - before.maps);
}

/* Unplugged, and plugged in again: it continues, with working controls. */
static void test_back(void)
{
    static loop l;
    camera_plug("display");
    if (loop_open(&l, 0, 20.0) == 0) {
        for (int i = 0; i < 10; i++)
            CHECK_MSG(loop_frame(&l) == PUPIL_SOURCE_FRAME, "%s", why.text);
        kill(process, SIGTERM);
        waitpid(process, NULL, 0);
        process = fork();
        if (process == 0) {
            sleep(2);
            execl(program, program, "display", (char *)NULL);
            _exit(127);
        }
        int manual = 0;
        for (int i = 0; i < 60; i++) {
            CHECK_MSG(loop_frame(&l) == PUPIL_SOURCE_FRAME, "%s", why.text);
            manual = l.truth.automatic ? 0 : manual + 1;
        }
        CHECK_MSG(manual >= 30, "of sixty frames the last %d were steered", manual);
        CHECK(pupil_live_capture(l.source)->counts.reopened == 1);
        pupil_source_close(l.source);
    }
    uvc_unplug(process);
}

int main(int argc, char **argv)
{
    if (argc < 2)
        return 2;
    program = argv[1];
    check_begin(argc - 1, argv + 1);
    setvbuf(stdout, NULL, _IOLBF, 0);
    test_loop("linear");
    test_loop("display");
    test_unplugged();
    test_back();
    return check_end();
}
