/* faults.c: runs in the guest (test_faults.sh). Every error that vivid can inject, in the middle of a recorded stream:
 * the message, that nothing is left open, that nothing waits too long, and that the recording has every delivered
 * frame, complete. */
#include <fcntl.h>
#include <linux/videodev2.h>
#include <pthread.h>
#include <unistd.h>

#include "check.h"
#include "file/recording/recording.h"
#include "live/live.h"
#include "vm/node.h"

#define BEFORE    5   /* frames before the error */
#define MOST      200 /* of one case */
#define TIMEOUT_S 5.0
#define REOPEN_S  10.0

static pupil_why why;
static char path[32];

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* FNV-1a (Fowler, Noll, Vo) of a frame's rows. */
static uint64_t digest(const pupil_image_const *image)
{
    uint64_t h = UINT64_C(0xcbf29ce484222325);
    for (uint32_t y = 0; y < image->height; y++) {
        const unsigned char *row = (const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes;
        for (size_t i = 0; i < pupil_row_bytes(image->pixel, image->width); i++)
            h = (h ^ row[i]) * UINT64_C(0x100000001b3);
    }
    return h;
}

/* --- a stream that is recorded --- */

typedef struct play {
    const char *name;
    const char *control; /* pressed or set to `value` ... */
    int value;
    uint64_t at; /* ... after so many frames; 0: before the camera is opened */
    unsigned frames;
    double reopen_s;
    const char *sentence; /* the sentence that the stream ends with, or a part; NULL: it continues */
    uint64_t got;         /* frames that came */
    uint64_t hash[MOST];
    pupil_live_counts counts;
    uint64_t first_sequence, last_sequence;
    uint32_t memory;
} play;

static void check_recording(const play *p, const char *folder)
{
    pupil_source *source = NULL;
    uint64_t n = 0;
    const int failed = pupil_recording_open(folder, NULL, &source, &why);
    CHECK_MSG(!failed, "%s: %s", p->name, why.text);
    for (pupil_frame frame; !failed && pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME; n++) {
        CHECK_MSG(n < p->got && digest(&frame.image) == p->hash[n], "%s: frame %llu of the recording is another one",
                  p->name, (unsigned long long)n);
        pupil_source_done(source, &frame);
    }
    CHECK_MSG(n == p->got, "%s: %llu frames came, %llu are recorded", p->name, (unsigned long long)p->got,
              (unsigned long long)n);
    pupil_source_close(source);
}

/* Runs until the stream ends, or p->frames came. */
static void stream(play *p, pupil_source *source, int control_fd, const char *folder)
{
    const pupil_recorder_options options = {.camera = path, .fps = 60, .overwrite = 1, .wait = 1};
    pupil_recorder *recorder = NULL;
    int got = PUPIL_SOURCE_FRAME;
    while (p->got < p->frames) {
        pupil_frame frame;
        if (p->control && p->at && p->got == p->at)
            CHECK(node_set(control_fd, p->control, p->value) == 0);
        got = pupil_source_next(source, &frame, &why);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        if (!recorder)
            CHECK_MSG(pupil_recorder_open(&recorder, folder, &frame, &options, &why) == 0, "%s", why.text);
        CHECK_MSG(!recorder || pupil_recorder_write(recorder, &frame, &why) == 0, "%s", why.text);
        p->first_sequence = p->got ? p->first_sequence : frame.info.sequence;
        CHECK_MSG(!p->got || frame.info.sequence > p->last_sequence, "%s: number %llu after %llu", p->name,
                  (unsigned long long)frame.info.sequence, (unsigned long long)p->last_sequence);
        p->last_sequence = frame.info.sequence;
        p->hash[p->got++] = digest(&frame.image);
        pupil_source_done(source, &frame);
    }
    CHECK_MSG(p->sentence ? got == PUPIL_SOURCE_FAILED && strstr(why.text, p->sentence) : got == PUPIL_SOURCE_FRAME,
              "%s: %llu frames, then %d, %s", p->name, (unsigned long long)p->got, got, why.text);
    pupil_why unused;
    if (recorder)
        CHECK_MSG(pupil_recorder_close(recorder, &unused) == 0, "%s: %s", p->name, unused.text);
}

static void run(play *p)
{
    const pupil_v4l2_options o = {
        .width = 320, .height = 180, .fps = 60, .timeout_s = TIMEOUT_S, .reopen_s = p->reopen_s};
    char folder[64];
    pupil_source *source = NULL;
    const int control_fd = node_open(path);
    const node_held before = node_holds();
    const double began_s = now_s();
    snprintf(folder, sizeof folder, "%s/recording", getenv("TMPDIR"));
    if (p->control && !p->at)
        CHECK(node_set(control_fd, p->control, p->value) == 0);
    if (pupil_live_open(path, NULL, &(pupil_live_options){.capture = o, .hands_off = 1}, &source, &why)) {
        CHECK_MSG(p->sentence && strstr(why.text, p->sentence), "%s: %s", p->name, why.text);
    } else {
        p->memory = pupil_live_capture(source)->memory;
        stream(p, source, control_fd, folder);
        p->counts = pupil_live_capture(source)->counts;
        pupil_source_close(source);
        if (p->got)
            check_recording(p, folder);
    }
    const node_held after = node_holds();
    CHECK_MSG(after.files == before.files && after.maps == before.maps, "%s: %d files and %d maps are left", p->name,
              after.files - before.files, after.maps - before.maps);
    /* Sixty frames a second, some of them dropped, and emulated; only the waits have bounds. */
    const double bound_s = p->frames / 10.0 + TIMEOUT_S + p->reopen_s + 5.0, took_s = now_s() - began_s;
    CHECK_MSG(took_s < bound_s, "%s: %g s", p->name, took_s);
    printf("%s: %llu frames, %llu lost, %llu flagged, %.1f s%s%s\n", p->name, (unsigned long long)p->got,
           (unsigned long long)p->counts.lost, (unsigned long long)p->counts.flagged, took_s, p->sentence ? ": " : "",
           p->sentence ? why.text : "");
    close(control_fd);
}

/* --- the errors --- */

static void test_refusals(void)
{
    play buffers = {.name = "REQBUFS", .control = "Inject VIDIOC_REQBUFS Error", .value = 1, .frames = 10};
    run(&buffers); /* our own memory instead */
    CHECK(buffers.got == 10 && buffers.memory == V4L2_MEMORY_USERPTR);
    play queue = {.name = "QBUF",
                  .control = "Inject VIDIOC_QBUF Error",
                  .value = 1,
                  .frames = 10,
                  .sentence = ": takes no buffers: Invalid argument"};
    run(&queue);
    play start = {.name = "STREAMON",
                  .control = "Inject VIDIOC_STREAMON Error",
                  .value = 1,
                  .frames = 10,
                  .sentence = ": does not start: Invalid argument"};
    run(&start);
}

static void test_streams(void)
{
    play flagged = {.name = "a flagged buffer", .control = "Inject V4L2_BUF_FLAG_ERROR", .value = 1, .at = BEFORE};
    flagged.frames = 15;
    run(&flagged);
    CHECK(flagged.got == 15 && flagged.counts.flagged == 1);

    play queue = {.name = "QBUF in mid-stream", .control = "Inject VIDIOC_QBUF Error", .value = 1, .at = BEFORE};
    queue.frames = 20; /* one buffer less from then on */
    run(&queue);
    CHECK(queue.got == 20);

    play dropped = {.name = "dropped", .control = "Percentage of Dropped Buffers", .value = 50, .frames = 40};
    run(&dropped);
    CHECK(dropped.got == 40 && dropped.counts.lost > 5);
    CHECK(dropped.last_sequence - dropped.first_sequence + 1 == dropped.got + dropped.counts.lost);
    play whole = {.name = "none dropped", .control = "Percentage of Dropped Buffers", .value = 0, .frames = 5};
    run(&whole);

    /* vivid begins 128 frames before its numbers of 32 bits wrap. */
    play wrap = {.name = "numbers that wrap", .control = "Wrap Sequence Number", .value = 1, .frames = 150};
    run(&wrap);
    CHECK(wrap.got == 150 && wrap.last_sequence > UINT64_C(1) << 32 && wrap.counts.lost < 1000);
    play straight = {.name = "numbers that do not", .control = "Wrap Sequence Number", .value = 0, .frames = 5};
    run(&straight);

    play fatal = {.name = "a fatal error", .control = "Inject Fatal Streaming Error", .value = 1, .at = BEFORE};
    fatal.frames = 20;
    fatal.sentence = ": its driver reports that the stream broke: Input/output error";
    run(&fatal);
    CHECK(fatal.got >= BEFORE && fatal.got < 20);
    play again = {.name = "a fatal error, and on", .control = "Inject Fatal Streaming Error", .value = 1, .at = BEFORE};
    again.frames = 20;
    again.reopen_s = REOPEN_S;
    run(&again);
    CHECK(again.got == 20 && again.counts.reopened == 1);
}

/* --- unplugged --- */

static void driver_says(const char *what)
{
    char file[64];
    snprintf(file, sizeof file, "/sys/bus/platform/drivers/vivid/%s", what);
    const int fd = open(file, O_WRONLY | O_CLOEXEC);
    CHECK_MSG(fd >= 0 && write(fd, "vivid.0", 7) == 7, "%s", file);
    close(fd);
}

static void *unplug(void *closure)
{
    const int back = *(const int *)closure;
    usleep(500000);
    driver_says("unbind");
    usleep(1500000);
    if (back)
        driver_says("bind");
    return NULL;
}

static void test_unplugged(void)
{
    play gone = {.name = "disconnected", .control = "Disconnect", .value = 1, .at = BEFORE, .frames = 20};
    gone.sentence = ": the camera was unplugged";
    run(&gone);
    CHECK(gone.got >= BEFORE && gone.got < 20);
    driver_says("unbind"); /* a disconnected device does not come back by itself */
    driver_says("bind");

    for (int back = 0; back < 2; back++) {
        pthread_t thread;
        play unbound = {.name = back ? "unbound, and back" : "unbound", .frames = MOST};
        unbound.sentence = back ? NULL : ": the camera was unplugged";
        unbound.reopen_s = back ? REOPEN_S : 0.0;
        CHECK(pthread_create(&thread, NULL, unplug, &back) == 0);
        run(&unbound);
        pthread_join(thread, NULL);
        CHECK_MSG(unbound.got > 2 && (back ? unbound.counts.reopened == 1 : unbound.got < MOST), "%llu frames",
                  (unsigned long long)unbound.got);
        if (!back)
            driver_says("bind");
    }
}

/* The HDMI cable is unplugged. */
static void test_signal(void)
{
    const int fd = node_open(path);
    pupil_source *source = NULL;
    const pupil_v4l2_options o = {.timeout_s = TIMEOUT_S};
    int got = PUPIL_SOURCE_FAILED;
    CHECK(node_input(fd, 3) == 0 && node_timings(fd, 640, 480, 60) == 0);
    CHECK_MSG(pupil_live_open(path, NULL, &(pupil_live_options){.capture = o, .hands_off = 1}, &source, &why) == 0,
              "%s", why.text);
    for (int i = 0; source && i < 20; i++) {
        pupil_frame frame;
        if (i == BEFORE)
            CHECK(node_set(fd, "DV Timings Signal Mode", 1) == 0); /* the menu's "No Signal" */
        got = pupil_source_next(source, &frame, &why);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        pupil_source_done(source, &frame);
    }
    CHECK_MSG(got == PUPIL_SOURCE_FAILED && strstr(why.text, "signal changed in mid-stream"), "%d, %s", got, why.text);
    pupil_source_close(source);
    CHECK(node_set(fd, "DV Timings Signal Mode", 0) == 0 && node_input(fd, 0) == 0);
    close(fd);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    setvbuf(stdout, NULL, _IOLBF, 0);
    CHECK(node_find("vivid", 0, 0, path) == 0);
    test_refusals();
    test_streams();
    test_signal();
    test_unplugged();
    return check_end();
}
