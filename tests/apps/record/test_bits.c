/* pupil record on a fake camera: a recording replays with the bits of the live frames' statistics. */
#include "check.h"
#include "scratch.h"

#include <linux/videodev2.h>
#include <math.h>
#include <stdarg.h>
#include <time.h>

#include "common/open_input.h"
#include "fake_v4l2/fake_v4l2.h"
#include "file/recording/recording.h"
#include "live/live.h"
#include "pupil/pupil.h"
#include "record/record.h"

#define FRAMES 12

static pupil_why why;

typedef struct metered {
    pupil_stats stats[FRAMES];
    pupil_exposure exposure[FRAMES];
    pupil_frame_info info[FRAMES];
    int count, coded;
} metered;

/* Runs the command as a user would; standard error goes to a file of the scratch folder. */
static int record(fake_v4l2 *fake, const char *words, ...)
{
    char text[4096];
    char *argv[32] = {"record"};
    int argc = 1;
    va_list arguments;
    va_start(arguments, words);
    vsnprintf(text, sizeof text, words, arguments);
    va_end(arguments);
    for (char *word = strtok(text, " "); word && argc < 31; word = strtok(NULL, " "))
        argv[argc++] = word;
    fflush(stderr);
    const int kept = dup(2);
    if (!freopen(scratch("said"), "w", stderr))
        abort();
    const pupil_live_system system = {.v4l2 = fake ? fake_v4l2_system(fake) : NULL};
    const int status = record_on(&system, argc, argv);
    fflush(stderr);
    dup2(kept, 2);
    close(kept);
    return status;
}

/* Its standard error, for messages. */
static const char *said(void)
{
    static char text[4096];
    FILE *f = fopen(scratch("said"), "r");
    text[f ? fread(text, 1, sizeof text - 1, f) : 0] = 0;
    if (f)
        fclose(f);
    return text;
}

static void meter(pupil_source *source, metered *m, pupil_recorder **recorder)
{
    static pupil_t pupil;
    pupil_config config;
    pupil_frame frame;
    pupil_config_default(&config);
    config.histogram = 1;
    pupil_init(&pupil, &config);
    memset(m, 0, sizeof *m);
    while (m->count < FRAMES && pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME) {
        const pupil_recorder_options options = {.fps = source->fps, .wait = 1};
        if (recorder && !*recorder)
            CHECK_MSG(pupil_recorder_open(recorder, scratch("live"), &frame, &options, &why) == 0, "%s", why.text);
        if (recorder && *recorder)
            CHECK_MSG(pupil_recorder_write(*recorder, &frame, &why) == 0, "%s", why.text);
        pupil_stats_clear(&m->stats[m->count]);
        CHECK(pupil_meter_rows(&pupil, &frame.image, 0, frame.image.height, &m->stats[m->count]) == PUPIL_OK);
        CHECK(pupil_adapt(&pupil, &m->stats[m->count], &frame.info) == PUPIL_OK);
        pupil_get_exposure(&pupil, &m->exposure[m->count]);
        m->coded += frame.coded != NULL;
        m->info[m->count++] = frame.info;
        pupil_source_done(source, &frame);
    }
}

/* The fake camera is metered while it is recorded; then the recording is metered. */
static void test_same_statistics(uint32_t fourcc, int extra_bytes)
{
    static metered live, again;
    const pupil_live_options options = {.capture = {.fourcc = fourcc}};
    pupil_live_options of_fake = options;
    fake_v4l2_config config;
    pupil_recorder *recorder = NULL;
    pupil_source *source;
    fake_v4l2_config_default(&config);
    config.seed = check_random();
    config.dropped = 0.2;
    config.extra_bytes = extra_bytes;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    of_fake.capture.system = fake_v4l2_system(fake);
    CHECK_MSG(pupil_live_open("0", NULL, &of_fake, &source, &why) == 0, "%s", why.text);
    meter(source, &live, &recorder);
    pupil_source_close(source);
    CHECK_MSG(pupil_recorder_close(recorder, &why) == 0, "%s", why.text);
    fake_v4l2_free(fake);

    const char *inputs[] = {scratch("live")};
    const pupil_source_options none = {0};
    CHECK_MSG(open_input(inputs, 1, &none, &source, &why) == 0, "%s", why.text);
    meter(source, &again, NULL);
    pupil_source_close(source);
    CHECK(live.coded == again.coded && live.coded == (fourcc == V4L2_PIX_FMT_MJPEG ? FRAMES : 0));
    CHECK(live.count == FRAMES && again.count == FRAMES && live.info[5].exposure_s > 0);
    CHECK(memcmp(live.stats, again.stats, sizeof live.stats) == 0);
    CHECK(memcmp(live.exposure, again.exposure, sizeof live.exposure) == 0);
    CHECK(memcmp(live.info, again.info, sizeof live.info) == 0);
    scratch_clear(scratch("live"));
}

static int frames_in(const char *folder, metered *m)
{
    pupil_source *source;
    if (pupil_recording_open(folder, NULL, &source, &why))
        return -1;
    meter(source, m, NULL);
    pupil_source_close(source);
    return m->count;
}

static void test_command(void)
{
    static metered m;
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const char *folder = scratch("rec");
    CHECK_MSG(record(fake, "-q -d 0 -n 5 %s", folder) == 0 && !*said(), "%s", said());
    CHECK(frames_in(folder, &m) == 5 && m.info[4].exposure_s == 0 && m.info[4].gain == 0); /* nobody looked */
    CHECK(record(fake, "-n 5 %s", folder) == 1 && strstr(said(), "is a recording already"));
    CHECK(frames_in(folder, &m) == 5);
    CHECK(record(fake, "-y -n 6 --format RG10 --width 32 --height 24 %s", folder) == 0 &&
          strstr(said(), "recorded 6 frames"));
    CHECK(frames_in(folder, &m) == 6 && m.stats[0].pixels == 16 * 12);
    CHECK(record(fake, "-y -t 0.2 --framerate 15 %s", folder) == 0);
    CHECK_MSG(frames_in(folder, &m) == 3, "%d", m.count);
    /* meanwhile a thread writes the controls; on a busy machine it may have to wait, for a minute at most */
    for (const time_t begin = time(NULL); time(NULL) - begin < 60 && m.info[11].gain != 2;) {
        CHECK_MSG(record(fake, "-y -n 12 --shutter 5ms --gain 2 %s", folder) == 0, "%s", said());
        CHECK(frames_in(folder, &m) == 12);
    }
    CHECK_MSG(m.info[11].exposure_s == 0.005 && m.info[11].gain == 2, "%g s, %g", m.info[11].exposure_s,
              m.info[11].gain);
    CHECK(record(fake, "-y -n 2 --shutter 100s %s", folder) == 1 &&
          strstr(said(), "--shutter: this camera exposes from"));
    CHECK(frames_in(folder, &m) == 12); /* refused before anything was touched */
    CHECK(record(fake, "-y -n 2 --gain 60000 %s", folder) == 1 && strstr(said(), "--gain: this camera has gains from"));
    CHECK(fake_v4l2_holds(fake).files == 0 && fake_v4l2_holds(fake).maps == 0);
    fake_v4l2_free(fake);
    scratch_clear(folder);
}

/* Exposure times gain of the first frame and of the last one. */
static void ends_of(const char *folder, double ends[2])
{
    pupil_source *source;
    pupil_frame frame;
    CHECK_MSG(pupil_recording_open(folder, NULL, &source, &why) == 0, "%s", why.text);
    for (int i = 0; pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME; i++) {
        ends[1] = frame.info.exposure_s * frame.info.gain;
        ends[0] = i ? ends[0] : ends[1];
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
}

/* In constant light the level divided by exposure and gain is constant from the first frame on: each line has the
 * setting of its own frame. */
static void test_told(void)
{
    static metered m;
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.real_time = 1;
    config.control_delay = 3; /* what pupil assumes */
    config.flat = 300;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const char *folder = scratch("told");
    CHECK_MSG(record(fake, "-q -n 12 --auto %s", folder) == 0, "%s", said());
    CHECK(frames_in(folder, &m) == 12);
    CHECK(m.info[11].exposure_s > 0 && m.info[11].exposure_s != m.info[0].exposure_s);
    CHECK_MSG(fabs(m.exposure[11].metered_ev - m.exposure[0].metered_ev) < 0.05, "%g EV became %g EV",
              m.exposure[0].metered_ev, m.exposure[11].metered_ev);
    fake_v4l2_free(fake);
    scratch_clear(folder);
}

/* The scene is far too dark for the setting; --auto reaches what the loop wants. */
static void test_auto(void)
{
    fake_v4l2_config config;
    double ends[2] = {1, 1};
    fake_v4l2_config_default(&config);
    config.real_time = 1; /* the thread that writes the controls needs its turns */
    config.fps = 60;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    fake_v4l2_light(fake, 0.1);
    const char *folder = scratch("auto");
    for (int tries = 0; tries < 20 && ends[1] <= 2 * ends[0]; tries++) {
        CHECK_MSG(record(fake, "-q -y -n 40 --auto %s", folder) == 0, "%s", said());
        ends_of(folder, ends);
    }
    CHECK_MSG(ends[1] > 2 * ends[0], "from %g to %g s", ends[0], ends[1]);
    fake_v4l2_free(fake);
    scratch_clear(folder);
}

/* The camera is unplugged, or the disk is full: earlier frames are kept. */
static void test_ends(void)
{
    static metered m;
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.unplug_at = 7;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const char *folder = scratch("ends");
    CHECK(record(fake, "%s", folder) == 1 && strstr(said(), "recorded 7 frames"));
    CHECK_MSG(frames_in(folder, &m) == 7, "%d: %s", m.count, said());
    fake_v4l2_free(fake);
    scratch_clear(folder);

    config.unplug_at = 0;
    fake = fake_v4l2_new(&config);
    scratch_limit(40000); /* six frames of 64 x 48 YUYV */
    const int status = record(fake, "-n 200 %s", folder);
    scratch_limit(0);
    CHECK_MSG(status == 1 && strstr(said(), "frames.mkv: cannot be written: File too large; the 6 frames before are"),
              "%s", said());
    CHECK(frames_in(folder, &m) == 6);
    fake_v4l2_free(fake);
    scratch_clear(folder);
}

static void check_usage(const char *words, const char *sentence)
{
    CHECK_MSG(record(NULL, "%s", words) == 2 && strstr(said(), sentence), "%s: %s", words, said());
}

static void test_usage(void)
{
    check_usage("", "no folder to record into");
    check_usage("synth:walk -", "-: a recording is a folder");
    check_usage("--nonsense x", "--nonsense: no such option");
    check_usage("-n 0 x", "--frames 0: must be a whole number of frames, 1 or more");
    check_usage("--shutter 10m x", "--shutter 10m: must be a time: 10ms");
    check_usage("--shutter 0 x", "--shutter 0: must be a time: 10ms");
    check_usage("--gain 0 x", "--gain 0: must be a factor");
    check_usage("--format TOOLONG x", "--format TOOLONG: must be a format's name");
    check_usage("--width 70000 x", "--width 70000: must be pixels, from 1 to 16384");
    check_usage("-d 0 synth:walk x", "synth:walk: -d names a camera already");
    check_usage("--auto synth:walk x", "are a camera's");
    CHECK(record(NULL, "-n 2 synth:nowhere %s", scratch("x")) == 1 && !scratch_exists(scratch("x")));
    CHECK(record(NULL, "-n 2 synth:walk %s/none/x", scratch_folder) == 1 && strstr(said(), "make it first"));
    CHECK(record(NULL, "-n 2 synth:walk /dev/null") == 1 && strstr(said(), "/dev/null: is not a folder"));
}

int main(int argc, char **argv)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_YUYV,
                                       V4L2_PIX_FMT_NV12,
                                       V4L2_PIX_FMT_SRGGB10,
                                       V4L2_PIX_FMT_SRGGB10P,
                                       V4L2_PIX_FMT_GREY,
                                       V4L2_PIX_FMT_MJPEG,
                                       V4L2_PIX_FMT_YUV420,
                                       V4L2_PIX_FMT_YVU420,
                                       V4L2_PIX_FMT_UYVY,
                                       V4L2_PIX_FMT_NV21,
                                       V4L2_PIX_FMT_NV16,
                                       v4l2_fourcc('P', '0', '1', '0'),
                                       v4l2_fourcc('Y', '1', '0', 'P'),
                                       v4l2_fourcc('Y', '1', '2', 'P'),
                                       V4L2_PIX_FMT_BGR24,
                                       V4L2_PIX_FMT_XBGR32,
                                       V4L2_PIX_FMT_RGBX32};
    check_begin(argc, argv);
    scratch_begin();
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        for (int extra = 0; extra <= (formats[i] == V4L2_PIX_FMT_MJPEG ? 0 : 16); extra += 16)
            test_same_statistics(formats[i], extra);
    test_command();
    test_told();
    test_auto();
    test_ends();
    test_usage();
    scratch_clear(scratch_folder);
    return check_end();
}
