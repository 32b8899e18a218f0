/* A camera's stream: times, numbers, lost and damaged frames, and every way in which it can end. */
#include "fake_source.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    return config;
}

static int64_t clock_of(const fake_source *s)
{
    const pupil_v4l2_system *system = fake_v4l2_system(s->fake);
    return system->now_ns(system->context);
}

static void test_times(void)
{
    for (uint32_t stamp = FAKE_STAMP_END_OF_FRAME; stamp <= FAKE_STAMP_NONE; stamp++)
        for (int monotonic = 0; monotonic < 2; monotonic++) {
            fake_v4l2_config config = usual();
            config.stamp = stamp;
            config.first_sequence = UINT32_MAX - 2;
            const pupil_v4l2_options options = {.monotonic = monotonic};
            fake_source s = fake_source_open("/dev/video0", &config, &options);
            CHECK_MSG(s.result == 0 && s.source->fps == 30.0, "%s", s.why.text);
            int64_t last_ns = 0;
            for (uint64_t i = 0; i < 8; i++) {
                pupil_frame frame;
                CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
                const pupil_v4l2_frame *f = pupil_live_frame(s.source);
                CHECK(frame.info.sequence == UINT32_MAX - 2 + i); /* continues after a 32-bit overflow */
                CHECK(f->sequence == UINT32_MAX - 2 + (uint32_t)i);
                CHECK(f->stamp == (stamp == FAKE_STAMP_NONE           ? PUPIL_LIVE_STAMP_NONE
                                   : stamp == FAKE_STAMP_END_OF_FRAME ? PUPIL_LIVE_STAMP_END_OF_FRAME
                                                                      : PUPIL_LIVE_STAMP_START_OF_EXPOSURE));
                CHECK(f->taken_ns >= f->stamp_ns && f->taken_ns - f->stamp_ns < 1000000);
                CHECK(i || frame.info.timestamp_ns == (monotonic ? f->stamp_ns : 0));
                const int64_t step = frame.info.timestamp_ns - last_ns;
                CHECK_MSG(i == 0 || llabs(step - 33333333) < 20000, "%lld ns", (long long)step);
                last_ns = frame.info.timestamp_ns;
                CHECK(frame.info.exposure_s == 0 && frame.info.gain == 0);
                CHECK(strncmp(frame.name, "/dev/video0 frame ", 18) == 0);
                pupil_source_done(s.source, &frame);
            }
            CHECK(fake_source_counts(&s)->lost == 0 && fake_source_counts(&s)->frames == 8);
            CHECK(fake_source_counts(&s)->unstamped == (stamp == FAKE_STAMP_NONE ? 8 : 0));
            fake_source_close(&s);
        }
}

/* Timestamps that cannot be from the stated clock: frames get their time of arrival. */
static void test_other_clock(void)
{
    static const int64_t ahead_ns[] = {INT64_C(1700000000000000000), 2000000000, -INT64_C(990000000000), 3000000, 0};
    for (int k = 0; k < 5; k++) {
        fake_v4l2_config config = usual();
        const pupil_v4l2_options options = {.monotonic = 1};
        const int ours = llabs(ahead_ns[k]) < 10000000;
        config.stamps_ns = ahead_ns[k];
        fake_source s = fake_source_open("/dev/video0", &config, &options);
        CHECK_MSG(s.result == 0, "%s", s.why.text);
        for (int i = 0; i < 4; i++) {
            pupil_frame frame;
            CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
            const pupil_v4l2_frame *f = pupil_live_frame(s.source);
            CHECK((f->stamp == PUPIL_LIVE_STAMP_NONE) == !ours);
            CHECK(ours || f->stamp_ns == f->taken_ns);
            CHECK(llabs(frame.info.timestamp_ns - f->taken_ns) < 10000000);
            pupil_source_done(s.source, &frame);
        }
        CHECK(fake_source_counts(&s)->unstamped == (ours ? 0 : 4));
        fake_source_close(&s);
    }
}

/* Random lost, damaged and truncated frames: every frame is either delivered or counted. */
static void test_losses(void)
{
    for (int multiplanar = 0; multiplanar < 2; multiplanar++) {
        fake_v4l2_config config = usual();
        config.seed = check_random();
        config.multiplanar = multiplanar;
        config.dropped = 0.1;
        config.flagged = 0.1;
        config.cut = 0.1;
        fake_source s = fake_source_open("/dev/video0", &config, NULL);
        const pupil_live_counts *c = fake_source_counts(&s);
        uint64_t last = 0, missing = 0, lost = 0, before = 0;
        for (int i = 0; i < 2000; i++) {
            pupil_frame frame;
            if (fake_source_next(&s, &frame) != PUPIL_SOURCE_FRAME) {
                CHECK_MSG(0, "%s", s.why.text);
                break;
            }
            lost += pupil_live_frame(s.source)->lost;
            CHECK_MSG(*(const unsigned char *)frame.image.data != 0xee, "a flagged frame came out");
            CHECK(i == 0 || frame.info.sequence > last);
            if (i == 0)
                before = c->lost + c->flagged + c->cut;
            else
                missing += frame.info.sequence - last - 1;
            last = frame.info.sequence;
            pupil_source_done(s.source, &frame);
        }
        CHECK(c->frames == 2000 && c->lost == lost && c->repeated == 0);
        CHECK_MSG(missing == c->lost + c->flagged + c->cut - before, "%llu missing", (unsigned long long)missing);
        /* Of some 2700 frames, each share is a tenth of what the previous one leaves. */
        CHECK_MSG(
            c->lost > 200 && c->lost < 350 && c->flagged > 180 && c->flagged < 320 && c->cut > 150 && c->cut < 300,
            "%llu %llu %llu", (unsigned long long)c->lost, (unsigned long long)c->flagged, (unsigned long long)c->cut);
        fake_source_close(&s);
    }
}

/* A driver that does not number its frames does not count as losing them. */
static void test_no_numbers(void)
{
    fake_v4l2_config config = usual();
    pupil_frame frame;
    config.no_sequence = 1;
    fake_source s = fake_source_open("/dev/video0", &config, NULL);
    for (uint64_t i = 0; i < 10; i++) {
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME && frame.info.sequence == i);
        pupil_source_done(s.source, &frame);
    }
    CHECK(fake_source_counts(&s)->repeated == 9 && fake_source_counts(&s)->lost == 0);
    fake_source_close(&s);
}

/* A program that needs three frames' time for each: the queue would always be full, and each frame late by its length.
 * This is detected, and the newest frame is taken until the program is fast again. A recording keeps all frames. */
static void test_pace(void)
{
    for (int late = PUPIL_LIVE_LATE_KEPT; late <= PUPIL_LIVE_LATE_BY_PACE; late++) {
        fake_v4l2_config config = usual();
        const pupil_v4l2_options options = {.late = late, .buffers = 6};
        const int adapts = late == PUPIL_LIVE_LATE_BY_PACE;
        pupil_frame frame;
        fake_source s = fake_source_open("/dev/video0", &config, &options);
        const pupil_v4l2_system *system = fake_v4l2_system(s.fake);
        int64_t age_ns = 0;
        for (int i = 0; i < 40; i++) {
            CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
            age_ns = pupil_live_get(s.source)->times.taken_ns - pupil_live_get(s.source)->times.stamp_ns;
            system->poll(system->context, NULL, 0, 100);
            pupil_source_done(s.source, &frame);
        }
        CHECK_MSG((fake_source_counts(&s)->late > 0) == adapts, "%llu late",
                  (unsigned long long)fake_source_counts(&s)->late);
        CHECK_MSG((age_ns < 100000000) == adapts, "late %d: the last frame was %lld ns old", late, (long long)age_ns);
        const uint64_t lost = fake_source_counts(&s)->lost, left_out = fake_source_counts(&s)->late;
        CHECK_MSG(adapts ? lost < 20 : lost > 60, "late %d: %llu lost", late, (unsigned long long)lost);
        for (int i = 0; i < 40; i++) { /* as fast as the camera again */
            CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
            pupil_source_done(s.source, &frame);
        }
        CHECK(fake_source_counts(&s)->late <= left_out + 6);
        system->poll(system->context, NULL, 0, 140); /* a single delay: nothing is left out */
        const uint64_t before = frame.info.sequence;
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME && frame.info.sequence == before + 1);
        pupil_source_done(s.source, &frame);
        fake_source_close(&s);
    }
}

/* A caller that is late: without options.late the frames that waited come one by one, with it the last of them. */
static void test_newest(void)
{
    for (int newest = 0; newest < 2; newest++) {
        fake_v4l2_config config = usual();
        const pupil_v4l2_options options = {.late = newest, .buffers = 6};
        pupil_frame frame;
        fake_source s = fake_source_open("/dev/video0", &config, &options);
        const pupil_v4l2_system *system = fake_v4l2_system(s.fake);
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME && frame.info.sequence == 0);
        pupil_source_done(s.source, &frame);
        system->poll(system->context, NULL, 0, 140); /* four frames */
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
        CHECK_MSG(frame.info.sequence == (newest ? 4 : 1), "%llu", (unsigned long long)frame.info.sequence);
        pupil_source_done(s.source, &frame);
        CHECK(fake_source_counts(&s)->late == (newest ? 3 : 0) && fake_source_counts(&s)->lost == 0);
        system->poll(system->context, NULL, 0, 1000); /* thirty: more than the number of buffers */
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
        pupil_source_done(s.source, &frame);
        for (int i = 0; i < 7; i++) {
            CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
            pupil_source_done(s.source, &frame);
        }
        CHECK(fake_source_counts(&s)->lost > 10);
        fake_source_close(&s);
    }
}

/* Takes frames until something else comes; returns that. */
static int run(fake_source *s, uint64_t most, uint64_t *frames)
{
    pupil_frame frame;
    int got = PUPIL_SOURCE_END;
    for (*frames = 0; *frames < most; ++*frames) {
        got = fake_source_next(s, &frame);
        if (got != PUPIL_SOURCE_FRAME)
            return got;
        pupil_source_done(s->source, &frame);
    }
    return got;
}

/* Each way to end, by its sentence; then once more, which must give a sentence again; neither waits longer than the
 * timeout. */
static void check_end_of(const char *what, const fake_v4l2_config *config, uint64_t frames, int expected,
                         const char *sentence)
{
    const pupil_v4l2_options options = {.timeout_s = 2};
    uint64_t got;
    fake_source s = fake_source_open("/dev/video0", config, &options);
    CHECK_MSG(s.result == 0, "%s: %s", what, s.why.text);
    const int end = run(&s, 1000, &got);
    CHECK_MSG(end == expected && got == frames, "%s: %d after %llu", what, end, (unsigned long long)got);
    CHECK_MSG(expected == PUPIL_SOURCE_END || strstr(s.why.text, sentence), "%s: %s", what, s.why.text);
    CHECK_MSG(expected == PUPIL_SOURCE_END || strncmp(s.why.text, "/dev/video0: ", 13) == 0, "%s: %s", what,
              s.why.text);
    const int64_t before = clock_of(&s);
    CHECK_MSG(run(&s, 1000, &got) == expected && got == 0, "%s: goes on", what);
    CHECK_MSG(clock_of(&s) - before < INT64_C(2200000000), "%s: waits %lld ns", what,
              (long long)(clock_of(&s) - before));
    fake_source_close(&s);
}

static void test_ends(void)
{
    fake_v4l2_config c = usual();
    c.unplug_at = 7;
    check_end_of("unplugging", &c, 7, PUPIL_SOURCE_FAILED, "the camera was unplugged");
    c = usual();
    c.stall_at = 5;
    check_end_of("a stall", &c, 5, PUPIL_SOURCE_FAILED, "no frame within 2 seconds");
    c = usual();
    c.flagged = 1;
    check_end_of("damaged frames only", &c, 0, PUPIL_SOURCE_FAILED,
                 "no whole frame within 2 seconds; the driver flags");
    c = usual();
    c.break_at = 9;
    check_end_of("a fault of the driver", &c, 9, PUPIL_SOURCE_FAILED, "its driver reports that the stream broke");
    c = usual();
    c.end_at = 4;
    check_end_of("the end", &c, 5, PUPIL_SOURCE_END, "");
    c.no_events = 1;
    check_end_of("the end without events", &c, 5, PUPIL_SOURCE_END, "");
}

static void test_change(void)
{
    fake_v4l2_config c = usual();
    uint64_t frames;
    c.change_at = 6;
    fake_source s = fake_source_open("/dev/video0", &c, NULL);
    CHECK(run(&s, 1000, &frames) == PUPIL_SOURCE_FAILED && frames == 6);
    CHECK_MSG(strstr(s.why.text, "the camera's signal changed"), "%s", s.why.text);
    fake_source_close(&s);
}

/* With options.reopen_s the same events are gaps. */
static void test_reopen(void)
{
    const pupil_v4l2_options options = {.timeout_s = 1, .reopen_s = 20};
    for (int which = 0; which < 5; which++) {
        fake_v4l2_config c = usual();
        pupil_frame frame = {0};
        uint64_t frames;
        c.unplug_at = which < 2 ? 7 : 0;
        c.back_s = 5;
        c.back_as = which == 1 ? 4 : 0; /* on another node */
        c.stall_at = which == 2 ? 7 : 0;
        c.break_at = which == 3 ? 7 : 0;
        c.change_at = which == 4 ? 7 : 0;
        fake_source s = fake_source_open(which == 1 ? FAKE_V4L2_NAME : "/dev/video0", &c, &options);
        const int64_t began_ns = clock_of(&s);
        CHECK_MSG(run(&s, 7, &frames) == PUPIL_SOURCE_FRAME && frames == 7, "%s", s.why.text);
        CHECK_MSG(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME, "%d: %s", which, s.why.text);
        CHECK(fake_source_counts(&s)->reopened == 1);
        CHECK_MSG(frame.info.sequence == 7 && frame.info.timestamp_ns > 200000000, "%d: frame %llu", which,
                  (unsigned long long)frame.info.sequence);
        CHECK(which != 1 || strncmp(frame.name, "/dev/video4 ", 12) == 0);
        CHECK_MSG(frame.image.width == (which == 4 ? 32 : 64), "%u", frame.image.width);
        if (which < 2)
            CHECK(clock_of(&s) - began_ns > INT64_C(5000000000) && clock_of(&s) - began_ns < INT64_C(7000000000));
        pupil_source_done(s.source, &frame);
        CHECK(run(&s, 5, &frames) == PUPIL_SOURCE_FRAME && frames == 5 && fake_source_counts(&s)->frames == 13);
        fake_source_close(&s);
    }
    /* A camera that does not come back. */
    fake_v4l2_config c = usual();
    uint64_t frames;
    c.unplug_at = 3;
    fake_source s = fake_source_open("/dev/video0", &c, &options);
    CHECK(run(&s, 1000, &frames) == PUPIL_SOURCE_FAILED && frames == 3);
    CHECK_MSG(strstr(s.why.text, "it did not come back within 20 seconds"), "%s", s.why.text);
    CHECK(clock_of(&s) > INT64_C(1020000000000) && clock_of(&s) < INT64_C(1021000000000));
    CHECK(run(&s, 10, &frames) == PUPIL_SOURCE_FAILED && frames == 0 && *s.why.text);
    fake_source_close(&s);
    /* A camera that comes back each time, but has no frame. */
    c = usual();
    c.flagged = 1;
    s = fake_source_open("/dev/video0", &c, &options);
    const int64_t began_ns = clock_of(&s);
    CHECK(run(&s, 1000, &frames) == PUPIL_SOURCE_FAILED && frames == 0);
    CHECK_MSG(strstr(s.why.text, "no whole frame within 1 seconds"), "%s", s.why.text);
    CHECK(clock_of(&s) - began_ns < INT64_C(23) * 1000000000);
    fake_source_close(&s);
}

static int stops_left;

static int stop(void)
{
    return stops_left-- <= 0;
}

/* options.stop is called while waiting for a frame or a camera, and between frames. */
static void test_stop(void)
{
    const pupil_v4l2_options options = {.timeout_s = 100, .reopen_s = 100, .stop = stop};
    for (int which = 0; which < 3; which++) {
        fake_v4l2_config c = usual();
        uint64_t frames;
        c.stall_at = which == 1 ? 1 : 0;
        c.unplug_at = which == 2 ? 1 : 0;
        stops_left = 10;
        fake_source s = fake_source_open("/dev/video0", &c, &options);
        const int64_t began_ns = clock_of(&s);
        CHECK(s.result == 0 && run(&s, 1000, &frames) == PUPIL_SOURCE_END && frames <= 10);
        CHECK(clock_of(&s) - began_ns < INT64_C(2000000000));
        fake_source_close(&s);
    }
}

/* Exposure and gain change the picture in proportion, so many frames later. */
static void test_controls(void)
{
    fake_v4l2_config c = usual();
    const pupil_v4l2_options options = {.fourcc = V4L2_PIX_FMT_Y16, .width = 64, .height = 48};
    struct v4l2_ext_control both[2] = {{.id = V4L2_CID_EXPOSURE_ABSOLUTE, .value = 50},
                                       {.id = V4L2_CID_GAIN, .value = 8}};
    struct v4l2_ext_controls all = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 2, .controls = both};
    c.control_delay = 3;
    fake_source s = fake_source_open("/dev/video0", &c, &options);
    CHECK_MSG(s.result == 0, "%s", s.why.text);
    const pupil_v4l2_device *device = &pupil_live_capture(s.source)->device;
    for (uint32_t i = 0; i < 12; i++) {
        pupil_frame frame;
        uint16_t first;
        CHECK(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME);
        memcpy(&first, frame.image.data, 2);
        const double light = fake_v4l2_scene(1, i, 0, 0, 1) * 65535.0 / FAKE_SCENE_WHITE;
        const double factor = i < 5 + 3 ? 1.0 : 0.5; /* set after frame 4 was delivered; gain is clamped to 16/16 */
        CHECK_MSG(first - light * factor < 1 && first - light * factor > -1, "frame %u: %u for %g", i, first,
                  light * factor);
        if (i == 4)
            CHECK(pupil_v4l2_ask(device, VIDIOC_S_EXT_CTRLS, &all) == 0 && both[1].value == 16);
        pupil_source_done(s.source, &frame);
    }
    fake_source_close(&s);
}

/* A day at one frame in five seconds, with every failure: nothing accumulates. */
static void test_long(void)
{
    fake_v4l2_config c = usual();
    const pupil_v4l2_options options = {.width = 32, .height = 24, .timeout_s = 60, .late = 1};
    uint64_t frames;
    c.only_format = V4L2_PIX_FMT_SRGGB8;
    c.fps = 0.2;
    c.dropped = 0.02;
    c.flagged = 0.02;
    c.cut = 0.02;
    fake_source s = fake_source_open("/dev/video0", &c, &options);
    const fake_v4l2_held first = fake_v4l2_holds(s.fake);
    const int64_t began_ns = clock_of(&s);
    CHECK(run(&s, 17280, &frames) == PUPIL_SOURCE_FRAME && frames == 17280);
    CHECK(clock_of(&s) - began_ns > INT64_C(86400) * 1000000000);
    const fake_v4l2_held last = fake_v4l2_holds(s.fake);
    CHECK(last.files == 1 && last.files == first.files && last.maps == first.maps);
    fake_source_close(&s);
}

/* A frame costs three system calls; waiting adds at most one per time slice. */
static void test_calls(void)
{
    const fake_v4l2_config c = usual();
    fake_v4l2 *fake = fake_v4l2_new(&c);
    fake_faults counter;
    pupil_source *source = NULL;
    pupil_frame frame;
    pupil_why why;
    fake_faults_begin(&counter, fake_v4l2_system(fake), 0, 0, 0);
    const pupil_v4l2_options options = {.system = &counter.system};
    CHECK(pupil_live_open("0", NULL, &(pupil_live_options){.capture = options, .hands_off = 1}, &source, &why) == 0);
    const unsigned long before = counter.calls;
    for (int i = 0; source && i < 600; i++) {
        CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
        pupil_source_done(source, &frame);
    }
    CHECK_MSG(counter.calls - before == 3 * 600, "%lu calls", counter.calls - before);
    pupil_source_close(source);
    fake_v4l2_free(fake);
}

/* The same frames as dma-bufs. */
static void test_share(void)
{
    for (int refused = 0; refused < 2; refused++) {
        fake_v4l2_config c = usual();
        pupil_frame frame;
        c.multiplanar = 1;
        c.no_share = refused;
        const pupil_v4l2_options options = {.fourcc = V4L2_PIX_FMT_NV12M, .share = 1};
        fake_source s = fake_source_open("/dev/video0", &c, &options);
        CHECK_MSG(fake_source_next(&s, &frame) == PUPIL_SOURCE_FRAME, "%s", s.why.text);
        const pupil_v4l2_capture *capture = pupil_live_capture(s.source);
        const pupil_v4l2_buffer *b = &capture->buffer[pupil_live_frame(s.source)->index];
        const void *planes[2] = {frame.image.data, frame.image.chroma};
        for (int i = 0; i < 2; i++) {
            CHECK(refused ? b->dmabuf[i] == -1 : b->dmabuf[i] >= 0);
            if (refused || b->dmabuf[i] < 0)
                continue;
            void *again = mmap(NULL, capture->format.size_bytes[i], PROT_READ, MAP_SHARED, b->dmabuf[i], 0);
            CHECK(again != MAP_FAILED && memcmp(again, planes[i], capture->format.needs_bytes[i]) == 0);
            munmap(again, capture->format.size_bytes[i]);
        }
        pupil_source_done(s.source, &frame);
        fake_source_close(&s);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_times();
    test_other_clock();
    test_losses();
    test_no_numbers();
    test_newest();
    test_pace();
    test_ends();
    test_change();
    test_reopen();
    test_stop();
    test_controls();
    test_long();
    test_calls();
    test_share();
    return check_end();
}
