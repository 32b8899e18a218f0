/* Recordings that were not finished: killed while they are written, cut at every byte, damaged. */
#include "check.h"
#include "scratch.h"

#include <fcntl.h>
#include <sys/wait.h>

#include "file/recording/recording.h"
#include "recording_frames.h"

#define KILLS 30

static pupil_why why;
static const pupil_recorder_options waiting = {.fps = 30, .wait = 1};

typedef struct file {
    char path[1100];
    unsigned char *bytes;
    size_t size;
} file;

static file load(const char *folder, const char *name)
{
    file f;
    snprintf(f.path, sizeof f.path, "%s/%s", folder, name);
    FILE *in = fopen(f.path, "r");
    if (!in)
        abort();
    fseek(in, 0, SEEK_END);
    f.size = (size_t)ftell(in);
    rewind(in);
    f.bytes = malloc(f.size + 1);
    if (fread(f.bytes, 1, f.size, in) != f.size)
        abort();
    fclose(in);
    return f;
}

/* Not truncated first: some file systems then write it to the disk at every close. */
static void store(const file *f, size_t size)
{
    const int fd = open(f->path, O_WRONLY);
    if (fd < 0 || write(fd, f->bytes, size) != (ssize_t)size || ftruncate(fd, (off_t)size) || close(fd))
        abort();
}

/* Lines that have their newline: frames that must come back. */
static int whole_lines(const file *f, size_t size)
{
    int lines = 0;
    for (size_t i = 0; i < size; i++)
        lines += f->bytes[i] == '\n';
    return lines;
}

/* --- kill -9 --- */

static void record_until_killed(const test_frames *frames, const char *folder)
{
    pupil_recorder *recorder;
    pupil_frame frame = frames->frame[0];
    frame.info = (pupil_frame_info){0};
    if (pupil_recorder_open(&recorder, folder, &frame, &waiting, &why))
        _exit(1);
    for (uint64_t i = 0;; i++) {
        frame = frames->frame[i % (uint64_t)frames->count];
        frame.info = (pupil_frame_info){.timestamp_ns = (int64_t)i * 1000, .sequence = 3 * i, .exposure_s = 1.0 / 3};
        if (pupil_recorder_write(recorder, &frame, &why))
            _exit(2);
    }
}

/* How many came back unchanged; -1: one differs. */
static int check_killed(const test_frames *frames, const char *folder)
{
    pupil_source *source;
    pupil_frame frame;
    uint64_t n = 0;
    int got = pupil_recording_open(folder, NULL, &source, &why);
    if (got)
        return -1;
    while ((got = pupil_source_next(source, &frame, &why)) == PUPIL_SOURCE_FRAME) {
        const pupil_frame_info info = {.timestamp_ns = (int64_t)n * 1000, .sequence = 3 * n, .exposure_s = 1.0 / 3};
        if (!frames_same_image(&frame.image, &frames->frame[n % (uint64_t)frames->count].image) ||
            memcmp(&frame.info, &info, sizeof info))
            got = -1;
        n++;
        pupil_source_done(source, &frame);
        if (got < 0)
            break;
    }
    pupil_source_close(source);
    return got == PUPIL_SOURCE_END ? (int)n : -1;
}

static void test_killed(void)
{
    test_frames frames;
    int most = 0;
    printf("seed %llu\n", (unsigned long long)check_state.seed);
    frames_make(&frames, PUPIL_PIXEL_YUYV, 320, 240, 16);
    for (int i = 0; i < KILLS; i++) {
        const char *folder = scratch("killed");
        const useconds_t after_us = (useconds_t)(check_random() % 20000);
        fflush(stdout);
        const pid_t child = fork();
        if (child == 0)
            record_until_killed(&frames, folder);
        /* every other time counted from the first frame: a busy machine may need more than 20 ms to write it */
        for (int ms = 0; i % 2 && ms < 10000 && !pupil_is_recording(folder); ms++)
            usleep(1000);
        usleep(after_us);
        int status;
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
        CHECK_MSG(WIFSIGNALED(status), "it ended by itself: %d", status);
        if (!pupil_is_recording(folder)) { /* before the first frame */
            CHECK(scratch_entries(folder) <= 3);
            scratch_clear(folder);
            continue;
        }
        file lines = load(folder, "frames.jsonl");
        const int right = whole_lines(&lines, lines.size), there = check_killed(&frames, folder);
        CHECK_MSG(there == right, "after %u us: %d frames, %d lines: %s", after_us, there, right, why.text);
        most = there > most ? there : most;
        free(lines.bytes);
        scratch_clear(folder);
    }
    CHECK_MSG(most > 0, "never a frame before it was killed");
    printf("killed %d times, with up to %d frames\n", KILLS, most);
    frames_free(&frames);
}

/* --- cut and damaged --- */

static void test_cut(void)
{
    test_frames frames;
    size_t ends[8];
    frames_make(&frames, PUPIL_PIXEL_BAYER8, 16, 4, 8);
    const char *folder = scratch("cut");
    CHECK(frames_record(&frames, folder, &waiting, &why) == 8);
    file mkv = load(folder, "frames.mkv"), lines = load(folder, "frames.jsonl"), about = load(folder, "recording.json");
    frames_ends(&frames, mkv.bytes, mkv.size, ends);
    for (size_t size = 0; size <= mkv.size; size++) {
        int right = 0;
        while (right < 8 && size >= ends[right])
            right++;
        store(&mkv, size);
        const int there = frames_replay(&frames, folder, &why);
        CHECK_MSG(there == right, "frames.mkv cut at %zu: %d of %d: %s", size, there, right, why.text);
    }
    for (size_t size = 0; size <= lines.size; size++) {
        store(&lines, size);
        const int there = frames_replay(&frames, folder, &why);
        CHECK_MSG(there == whole_lines(&lines, size), "frames.jsonl cut at %zu: %d: %s", size, there, why.text);
    }
    for (size_t size = 0; size < about.size - 2; size++) {
        store(&about, size);
        CHECK(frames_replay(&frames, folder, &why) == -1 && strstr(why.text, "recording.json:"));
    }
    store(&about, about.size);

    /* Any other byte, anywhere: frames or a sentence. */
    file *all[] = {&mkv, &lines, &about};
    for (int i = 0; i < 4000; i++) {
        file *f = all[check_random() % 3];
        const size_t at = check_random() % f->size;
        const unsigned char kept = f->bytes[at];
        f->bytes[at] = (unsigned char)check_random();
        store(f, f->size);
        pupil_source *source;
        pupil_frame frame;
        int n = 0, got = pupil_recording_open(folder, NULL, &source, &why);
        if (!got) {
            while ((got = pupil_source_next(source, &frame, &why)) == PUPIL_SOURCE_FRAME)
                n++;
            CHECK(n <= 8 && (got == PUPIL_SOURCE_END || (got == PUPIL_SOURCE_FAILED && *why.text)));
            pupil_source_close(source);
        }
        f->bytes[at] = kept;
        store(f, f->size);
    }
    CHECK(frames_replay(&frames, folder, &why) == 8);
    free(mkv.bytes), free(lines.bytes), free(about.bytes);
    scratch_clear(folder);
    frames_free(&frames);
}

/* A frame in the middle that Matroska readers skip: its line does not get another frame's pixels. */
static void test_passed_over(void)
{
    test_frames frames;
    const char *folder = scratch("over");
    frames_make(&frames, PUPIL_PIXEL_BAYER8, 16, 4, 8);
    CHECK(frames_record(&frames, folder, &waiting, &why) == 8);
    file mkv = load(folder, "frames.mkv");
    unsigned char *at = mkv.bytes - 1;
    for (int i = 0; i < 8; i++) {
        at = memmem(at + 1, mkv.size - (size_t)(at + 1 - mkv.bytes), "\x1f\x43\xb6\x75", 4); /* a cluster's ID */
        CHECK(at);
        at[3] ^= 1;
        store(&mkv, mkv.size);
        pupil_source *source;
        pupil_frame frame;
        int n = 0, got = pupil_recording_open(folder, NULL, &source, &why);
        while (source && (got = pupil_source_next(source, &frame, &why)) == PUPIL_SOURCE_FRAME) {
            CHECK(n < i && frames_same(&frame, &frames.frame[n]));
            n++;
        }
        pupil_source_close(source);
        CHECK_MSG(n == i, "frame %d is not there: %d came", i, n);
        CHECK_MSG(i == 7 || (got == PUPIL_SOURCE_FAILED && strstr(why.text, "frames.mkv: frame") &&
                             strstr(why.text, "is damaged")),
                  "frame %d: %d %s", i, got, why.text);
        at[3] ^= 1;
    }
    store(&mkv, mkv.size);
    CHECK(frames_replay(&frames, folder, &why) == 8);
    free(mkv.bytes);
    scratch_clear(folder);
    frames_free(&frames);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_killed();
    test_cut();
    test_passed_over();
    scratch_clear(scratch_folder);
    return check_end();
}
