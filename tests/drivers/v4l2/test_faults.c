/* Every system call fails once, with every plausible error: a sentence, nothing left open, no endless wait; afterwards
 * the camera works as before. */
#include "fake_source.h"
#include "resident.h"
#include "scratch.h"

#include <errno.h>
#include <linux/videodev2.h>

#include "v4l2/media/media.h"
#include "v4l2/modes.h"

static const int errors[] = {EIO, ENODEV, EINTR, EAGAIN, EINVAL, ENOMEM, EBUSY, EPIPE, ENOTTY, EACCES, ENOSPC, EMFILE};

static pupil_why why;

/* A sentence, or an error of the test. */
static void check_why(const fake_faults *f)
{
    CHECK_MSG(strlen(why.text) > 10 && !strchr(why.text, '\n'), "call %lu (%s), %s: '%s'", f->fail_at, f->failed,
              strerror(f->error), why.text);
}

typedef struct scenario {
    const char *name;
    fake_v4l2_config config;
    pupil_v4l2_options options;
    const char *which;
    unsigned frames;
} scenario;

static void play_source(const scenario *s, fake_faults *f)
{
    pupil_v4l2_options options = s->options;
    pupil_source *source = NULL;
    options.system = &f->system;
    why.text[0] = 0;
    if (pupil_live_open(s->which, NULL, &(pupil_live_options){.capture = options, .hands_off = 1}, &source, &why)) {
        CHECK(source == NULL);
        check_why(f);
        return;
    }
    for (unsigned i = 0; i < s->frames; i++) {
        pupil_frame frame;
        why.text[0] = 0;
        const int got = pupil_source_next(source, &frame, &why);
        if (got == PUPIL_SOURCE_FAILED)
            check_why(f);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        CHECK(frame.image.data && frame.image.width == 64 && frame.name);
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
}

/* What a node is and offers, and what feeds it. */
static void play_questions(const scenario *s, fake_faults *f)
{
    pupil_v4l2_device device;
    pupil_live_modes modes;
    pupil_v4l2_sensor sensor;
    why.text[0] = 0;
    if (pupil_v4l2_device_open(&device, &f->system, s->which, &why)) {
        check_why(f);
        return;
    }
    if (pupil_v4l2_modes_read(&device, &modes, &why))
        check_why(f);
    pupil_live_modes_free(&modes);
    why.text[0] = 0;
    if (pupil_v4l2_media_sensor(&device, &sensor, &why))
        check_why(f);
    pupil_v4l2_device_close(&device);
}

/* One fault. Returns whether the scenario got far enough to meet it. */
static int play(const scenario *s, void (*part)(const scenario *, fake_faults *), unsigned long at, unsigned long many,
                int error)
{
    fake_v4l2 *fake = fake_v4l2_new(&s->config);
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    fake_faults f;
    fake_faults_begin(&f, system, at, many, error);
    const int64_t began_ns = system->now_ns(system->context);
    part(s, &f);
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%s, call %lu (%s), %s: %d files and %d maps are left", s->name, at,
              f.failed, strerror(error), held.files, held.maps);
    CHECK_MSG(held.unsynced == 0 || f.failed, "%s: %d syncs missing", s->name, held.unsynced);
    const int64_t took_ns = system->now_ns(system->context) - began_ns;
    const double bound_s = s->frames * (s->options.timeout_s + s->options.reopen_s + 0.2) + 1.0;
    CHECK_MSG((double)took_ns < bound_s * 1e9, "%s, call %lu (%s), %s: %g s", s->name, at, f.failed, strerror(error),
              (double)took_ns * 1e-9);
    CHECK_MSG(f.calls < 50000, "%s, call %lu (%s), %s: %lu calls", s->name, at, f.failed, strerror(error), f.calls);
    if (f.failed && !s->config.unplug_at) { /* the same camera again */
        fake_faults none;
        fake_faults_begin(&none, system, 0, 0, 0);
        part(s, &none);
        CHECK_MSG(s->config.start_error || !*why.text, "%s, after call %lu (%s), %s: %s", s->name, at, f.failed,
                  strerror(error), why.text);
    }
    fake_v4l2_free(fake);
    return f.failed != NULL;
}

/* Each error at every sixth call, so each call meets two errors. */
static void play_all(const scenario *s, void (*part)(const scenario *, fake_faults *))
{
    const unsigned long every = (unsigned long)check_every(6);
    unsigned long calls = 0;
    for (size_t e = 0; e < sizeof errors / sizeof errors[0]; e++)
        for (int many = 0; many < (e < 4 ? 2 : 1); many++) { /* some last longer than a call is retried */
            unsigned long at = 1 + e % every;
            while (play(s, part, at, many ? 150 : 1, errors[e]))
                at += every;
            calls = !calls || at < calls ? at : calls;
        }
    CHECK_MSG(calls > 10, "%s: only %lu calls", s->name, calls);
    printf("%s: %lu calls\n", s->name, calls - 1);
}

static void test_calls(void)
{
    fake_v4l2_config usual;
    fake_v4l2_config_default(&usual);
    usual.flat = 400; /* drawing unused pictures would take most of the time */
    const pupil_v4l2_options patient = {.timeout_s = 0.5};
    scenario s = {"a webcam", usual, patient, "/dev/video0", 5};
    play_all(&s, play_source);

    s = (scenario){"NV12 in two areas, shared, the newest", usual, patient, "Fake Camera", 3};
    s.config.multiplanar = 1;
    s.options.fourcc = V4L2_PIX_FMT_NV12M;
    s.options.share = s.options.late = 1;
    s.options.buffers = 3;
    play_all(&s, play_source);

    s = (scenario){"our own memory", usual, patient, "0", 3};
    s.config.no_mmap = 1;
    s.options.fps = 15;
    play_all(&s, play_source);

    s = (scenario){"slow memory, hints", usual, patient, "0", 3};
    s.config.slow = s.config.hints = 1;
    play_all(&s, play_source);

    s = (scenario){"slow memory, a heap", usual, patient, "0", 3};
    s.config.slow = s.config.contiguous = s.config.multiplanar = 1;
    s.config.heaps = 2;
    s.options.fourcc = V4L2_PIX_FMT_NV12M;
    s.options.buffers = 2;
    play_all(&s, play_source);

    s = (scenario){"slow memory, copied", usual, patient, "0", 3};
    s.config.slow = 1;
    s.options.late = 1;
    play_all(&s, play_source);

    s = (scenario){"MJPG", usual, patient, "0", 3};
    s.options.fourcc = V4L2_PIX_FMT_MJPEG;
    play_all(&s, play_source);

    s = (scenario){"unplugged and back", usual, patient, "/dev/video0", 6};
    s.config.unplug_at = 2;
    s.config.back_s = 1;
    s.config.back_as = 5;
    s.options.reopen_s = 3;
    play_all(&s, play_source);

    s = (scenario){"a refused start", usual, patient, "/dev/video0", 1};
    s.config.media = FAKE_MEDIA_PADS_DIFFER;
    s.config.start_error = EPIPE;
    s.config.only_format = V4L2_PIX_FMT_SRGGB10;
    play_all(&s, play_source);

    s = (scenario){"questions", usual, patient, "fake camera", 0};
    s.config.media = FAKE_MEDIA_RIGHT;
    s.config.only_format = V4L2_PIX_FMT_SRGGB10;
    play_all(&s, play_questions);
}

/* Opened and closed many times, with all failures: memory does not grow. */
static void test_many(void)
{
    scenario s = {"many", .which = "/dev/video0", .frames = 2};
    long first_kib = 0, last_kib;
    fake_v4l2_config_default(&s.config);
    const int files = scratch_entries("/proc/self/fd");
    for (unsigned long i = 0; i < 3000; i++) {
        if (i == 500)
            first_kib = resident_kib();
        s.options.timeout_s = 0.5;
        s.options.share = (int)(i % 2);
        play(&s, play_source, i % 60, 1, errors[i % 12]);
    }
    last_kib = resident_kib();
    CHECK(first_kib > 0 && last_kib > 0); /* the sanitizer keeps freed memory for a while, to recognise it */
    CHECK_MSG(CHECK_SANITIZED || last_kib - first_kib <= 64, "%ld KiB, then %ld KiB", first_kib, last_kib);
    CHECK(scratch_entries("/proc/self/fd") == files);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_calls();
    test_many();
    return check_end();
}
