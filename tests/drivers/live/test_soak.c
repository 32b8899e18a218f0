/* 24 hours of a camera at 30 frames a second, on the fake's clock, with everything that can happen to it: light that
 * changes, lost and damaged frames, a late program, clocks that are set, signals that change, stalls, and a camera that
 * is unplugged and comes back with another format and size. Metering, adaptation, mapping and the exposure loop run all
 * along.
 *     test_live_soak [SEED [HOURS]] */
#include <dirent.h>
#include <linux/videodev2.h>
#include <math.h>
#include <unistd.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "pupil/pupil.h"
#include "resident.h"

#define FPS         30
#define EVENT_EVERY 1500 /* frames, on average */
#define SOON        16   /* frames in which an event has happened */
#define QUIET       600  /* frames: 22 time constants toward the dark, 0.9 s */
#define SIDE_PX     16
#define FLAT        512  /* of FAKE_SCENE_WHITE */
#define LIGHT_EV    0.03 /* the loop's estimate of the light: an 8-bit step at the key is 2 % of light (YUYV) */
#define LEVEL_EV    0.01 /* exp(-22) of any step is nothing; rounding to 8 bits matters just after a setting moved */

enum { LIGHT, LATE, STORM, CLOCK, CHANGE, STALL, BREAK, UNPLUG, EVENTS };
static const char *const event_names[EVENTS] = {"light",  "late",  "storm", "clock",
                                                "change", "stall", "break", "unplug"};

static struct {
    fake_v4l2 *fake;
    fake_v4l2_config config;
    pupil_source *source;
    pupil_config adapting;
    pupil_t pupil;
    pupil_sensor_config regulating;
    pupil_sensor sensor;
    double light;
    uint64_t frames, quiet, storm, happened[EVENTS], checked, without;
    uint64_t last_sequence, left_out, reopened;
    double worst_level_ev, worst_light_ev;
    unsigned char out[SIDE_PX * SIDE_PX * 3];
} day;

static pupil_why why;

static int files_open(void)
{
    DIR *folder = opendir("/proc/self/fd");
    int count = 0;
    while (folder && readdir(folder))
        count++;
    closedir(folder);
    return count;
}

/* Waits until it is written: threads use the machine's clock, the camera its own. */
static void ask(const pupil_sensor_setting *s)
{
    const pupil_camera_setting setting = {s->exposure_s, s->gain, 0};
    pupil_camera *camera = pupil_live_camera(day.source);
    const uint64_t number = pupil_camera_ask(camera, &setting);
    pupil_camera_status status;
    do {
        usleep(20);
        pupil_camera_get_status(camera, &status);
    } while (status.written < number);
}

/* --- what happens --- */

static double between(double low, double high)
{
    return low + (high - low) * check_uniform();
}

static void set_usual(void)
{
    day.config.unplug_at = day.config.stall_at = day.config.break_at = day.config.change_at = 0;
    day.config.dropped = 0.004;
    day.config.flagged = day.config.cut = 0.002;
}

static void happen(void)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_SRGGB12, V4L2_PIX_FMT_SGBRG10P,
                                       V4L2_PIX_FMT_RGB24};
    const pupil_v4l2_system *system = fake_v4l2_system(day.fake);
    const uint64_t soon = pupil_live_frame(day.source)->sequence + 2 + check_random() % (SOON - 4);
    const int event = (int)(check_random() % EVENTS);
    set_usual();
    day.happened[event]++;
    day.quiet = 0;
    switch (event) {
    case LIGHT: /* what exposures up to a frame's time and the gain can follow */
        day.light = exp2(between(-4, 5));
        fake_v4l2_light(day.fake, day.light);
        break;
    case LATE:
        system->poll(system->context, NULL, 0, (int)between(50, 3000));
        break;
    case STORM:
        day.config.dropped = day.config.flagged = 0.4;
        day.storm = 100;
        break;
    case CLOCK:
        day.config.stamps_ns = (int64_t)(between(0, 7200) * 1e9);
        break;
    case CHANGE:
        day.config.change_at = soon;
        break;
    case STALL:
        day.config.stall_at = soon;
        break;
    case BREAK:
        day.config.break_at = soon;
        break;
    default:
        day.config.unplug_at = soon;
        day.config.back_s = between(0.1, 20);
        day.config.back_as = (int)(check_random() % 2) * 4;
        day.config.only_format = formats[check_random() % (sizeof formats / sizeof formats[0])];
        day.config.width = 8 + 4 * (uint32_t)(check_random() % 3);
        day.config.height = 8 + 4 * (uint32_t)(check_random() % 3);
    }
    fake_v4l2_reconfigure(day.fake, &day.config);
}

/* --- what must be --- */

/* Every frame is delivered or counted. A stream that restarts counts from the beginning. */
static void check_counts(const pupil_frame *frame)
{
    const pupil_live_counts *c = &pupil_live_capture(day.source)->counts;
    const uint64_t left_out = c->lost + c->flagged + c->cut;
    if (day.frames && c->reopened == day.reopened)
        CHECK_MSG(frame->info.sequence - day.last_sequence - 1 == left_out - day.left_out, "frame %llu after %llu",
                  (unsigned long long)frame->info.sequence, (unsigned long long)day.last_sequence);
    else if (day.frames)
        CHECK(frame->info.sequence == day.last_sequence + 1);
    CHECK(c->frames == day.frames + 1 && c->late == 0 && c->repeated == 0);
    day.last_sequence = frame->info.sequence;
    day.left_out = left_out;
}

/* After a quiet stretch the level is that of a fresh pupil, the sensor rests, and its light is the fake's. */
static void check_rest(const pupil_frame *frame, const pupil_image *out, const pupil_sensor_setting *s)
{
    const fake_v4l2_held held = fake_v4l2_holds(day.fake);
    const pupil_v4l2_capture *capture = pupil_live_capture(day.source);
    pupil_exposure old, new;
    pupil_t fresh;
    CHECK(pupil_init(&fresh, &day.adapting) == PUPIL_OK);
    CHECK(pupil_process(&fresh, &frame->image, &frame->info, out) == PUPIL_OK);
    CHECK(pupil_get_exposure(&fresh, &new) == PUPIL_OK && pupil_get_exposure(&day.pupil, &old) == PUPIL_OK);
    const double level_ev = fabs(old.adapted_ev - new.adapted_ev);
    /* 1 is full: flat / white x light x exposure / 10 ms x gain */
    const double light_ev = fabs(s->scene_ev - log2((double)FLAT / FAKE_SCENE_WHITE * day.light * 100));
    day.worst_level_ev = fmax(day.worst_level_ev, level_ev);
    day.worst_light_ev = fmax(day.worst_light_ev, light_ev);
    CHECK_MSG(level_ev < LEVEL_EV, "%g EV, a fresh pupil's is %g", old.adapted_ev, new.adapted_ev);
    CHECK_MSG(light_ev < LIGHT_EV, "%g EV of light off", light_ev);
    CHECK_MSG(s->state == PUPIL_SENSOR_CONVERGED && fabs(s->error_ev) < day.regulating.far_ev,
              "state %u, reason %u, %g EV off; light %g", s->state, s->reason, s->error_ev, day.light);
    CHECK(old.state == PUPIL_STATE_SETTLED);
    CHECK_MSG(held.files == 2 && held.maps == (int)capture->buffers, "%d files, %d maps", held.files, held.maps);
    day.checked++;
}

static void one_frame(const pupil_frame *frame)
{
    pupil_stats stats;
    pupil_exposure exposure;
    pupil_sensor_setting s;
    const pupil_image out = {.data = day.out,
                             .stride_bytes = 3 * (ptrdiff_t)frame->image.width,
                             .width = frame->image.width,
                             .height = frame->image.height,
                             .pixel = PUPIL_PIXEL_RGB8};
    check_counts(frame);
    const uint64_t reopened = pupil_live_capture(day.source)->counts.reopened;
    if (!day.frames || reopened != day.reopened) {
        set_usual();
        fake_v4l2_reconfigure(day.fake, &day.config);
        day.quiet = 0;
    }
    day.reopened = reopened;
    CHECK(pupil_process(&day.pupil, &frame->image, &frame->info, &out) == PUPIL_OK);
    CHECK(pupil_get_stats(&day.pupil, &stats) == PUPIL_OK && pupil_get_exposure(&day.pupil, &exposure) == PUPIL_OK);
    CHECK(pupil_sensor_frame(&day.sensor, &stats, &frame->info) == PUPIL_OK);
    CHECK(pupil_sensor_get(&day.sensor, &s) == PUPIL_OK);
    CHECK(isfinite(exposure.adapted_ev) && isfinite(exposure.scale) && isfinite(s.total_s) && isfinite(s.scene_ev));
    CHECK(s.exposure_s > 0 && s.gain >= 1 && s.frame_digital > 0 && exposure.dt_s >= 0);
    if (!pupil_live_camera(day.source)) { /* they are being opened again, on the machine's clock */
        usleep(50);
        day.without++;
        day.quiet = 0;
    } else {
        pupil_camera_learn(pupil_live_camera(day.source), s.exposure_delay, s.gain_delay);
        if (s.changed || day.quiet == 0)
            ask(&s);
        day.quiet++;
    }
    if (day.quiet == QUIET)
        check_rest(frame, &out, &s);
    day.frames++;
}

static void live(double hours)
{
    const pupil_v4l2_system *system = fake_v4l2_system(day.fake);
    const int64_t began_ns = system->now_ns(system->context), length_ns = (int64_t)(hours * 3600e9);
    const int files = files_open();
    long resident = -1;
    pupil_frame frame;
    for (int64_t past_ns = 0; past_ns < length_ns; past_ns = system->now_ns(system->context) - began_ns) {
        const int got = pupil_source_next(day.source, &frame, &why);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s", why.text);
        if (got != PUPIL_SOURCE_FRAME)
            return;
        one_frame(&frame);
        pupil_source_done(day.source, &frame);
        if (resident < 0 && past_ns > length_ns / 20)
            resident = resident_kib();
        if (day.storm && --day.storm == 0) {
            set_usual();
            fake_v4l2_reconfigure(day.fake, &day.config);
            day.quiet = 0;
        } else if (!day.storm && day.quiet > SOON && check_uniform() * EVENT_EVERY < 1) {
            happen();
        }
    }
    const long grown = resident_kib() - resident;
#ifndef PUPIL_SANITIZED /* which keep what is freed for a while */
    CHECK_MSG(grown <= 128, "%ld KiB more than after the first hour or so", grown);
#endif
    CHECK_MSG(files_open() == files, "%d files, %d before", files_open(), files);
    printf("memory: %ld KiB more after %g h than after %g h\n", grown, hours, hours / 20);
}

int main(int argc, char **argv)
{
    const double hours = argc > 2 ? atof(argv[2]) : 24;
    pupil_live_options options = {.capture = {.timeout_s = 1, .reopen_s = 60, .monotonic = 1}};
    check_begin(argc, argv);
    fake_v4l2_config_default(&day.config);
    day.config.seed = check_random();
    day.config.fps = FPS;
    day.config.only_format = V4L2_PIX_FMT_Y16;
    day.config.width = day.config.height = 8;
    day.config.flat = FLAT;
    set_usual();
    day.fake = fake_v4l2_new(&day.config);
    day.light = 1;
    options.capture.system = fake_v4l2_system(day.fake);
    pupil_config_default(&day.adapting);
    pupil_sensor_config_default(&day.regulating);
    CHECK(pupil_init(&day.pupil, &day.adapting) == PUPIL_OK);
    if (pupil_live_open(FAKE_V4L2_NAME, NULL, &options, &day.source, &why) != 0) {
        CHECK_MSG(0, "%s", why.text);
        return check_end();
    }
    CHECK_MSG(pupil_live_camera(day.source), "%s", pupil_live_no_controls(day.source));
    pupil_camera_configure(pupil_live_camera(day.source), &day.regulating);
    CHECK(pupil_sensor_init(&day.sensor, &day.regulating) == PUPIL_OK);
    live(hours);
    uint64_t again = day.happened[CHANGE] + day.happened[STALL] + day.happened[BREAK] + day.happened[UNPLUG];
    CHECK_MSG(day.reopened <= again && day.reopened + 1 >= again, "%llu reopened, %llu events",
              (unsigned long long)day.reopened, (unsigned long long)again);
    CHECK((double)day.checked > 0.3 * (double)day.frames / EVENT_EVERY);
    CHECK((double)day.frames > 0.9 * hours * 3600 * FPS);
    printf("seed %llu, %g h: %llu frames, %llu left out, %llu times opened again, %llu frames without "
           "controls, %llu quiet stretches\n",
           (unsigned long long)check_state.seed, hours, (unsigned long long)day.frames,
           (unsigned long long)day.left_out, (unsigned long long)day.reopened, (unsigned long long)day.without,
           (unsigned long long)day.checked);
    for (int i = 0; i < EVENTS; i++)
        printf("%s %llu%s", event_names[i], (unsigned long long)day.happened[i], i + 1 < EVENTS ? ", " : "\n");
    printf("worst after a quiet stretch: level %.2g EV, light %.2g EV\n", day.worst_level_ev, day.worst_light_ev);
    CHECK_MSG(pupil_live_give_back(day.source, &why) == 0, "%s", why.text);
    pupil_source_close(day.source);
    const fake_v4l2_held held = fake_v4l2_holds(day.fake);
    CHECK(held.files == 0 && held.maps == 0);
    fake_v4l2_free(day.fake);
    return check_end();
}
