/* YUV4MPEG2 on standard output, a pipe: non-blocking, and with a full disk; a rate that is kept across gaps in the
 * frames' times; pixels that are not square. */
#include "file/file_sink.h"

#include <fcntl.h>
#include <pthread.h>

#include "check.h"
#include "nth_call/nth_call.h"
#include "scratch.h"

enum { SIDE = 256, FRAME_BYTES = 3 * SIDE * SIDE };

static pupil_why why;

typedef struct reader {
    int fd;
    size_t bytes, frames;
    char header[128];
} reader;

/* Reads to the end; counts frames by their bytes. */
static void *read_all(void *of)
{
    static char block[4096];
    reader *r = of;
    for (ssize_t got; (got = read(r->fd, block, sizeof block)) > 0; r->bytes += (size_t)got)
        if (!r->bytes) {
            const char *end = memchr(block, '\n', (size_t)got);
            snprintf(r->header, sizeof r->header, "%.*s", end ? (int)(end - block) : 0, block);
        }
    r->frames = (r->bytes - strlen(r->header) - 1) / (FRAME_BYTES + sizeof "FRAME\n" - 1);
    return NULL;
}

/* Writes frames at these times to a non-blocking pipe; returns the last result of write or finish. `poll_fails`: the
 * wait for the reader fails. */
static int stream(const pupil_sink_options *options, const int64_t *ns, size_t count, int poll_fails, reader *r)
{
    static const char *const only[] = {"poll", NULL};
    const int saved = dup(STDOUT_FILENO);
    int ends[2], failed = 0;
    pthread_t thread;
    uint8_t *memory;
    const char *call;
    const pupil_image image = scratch_image(SIDE, SIDE, 0, &memory);
    const pupil_image_const shown = pupil_image_as_const(image);
    scratch_noise(&image);
    pupil_sink *sink = NULL;
    CHECK(pipe(ends) == 0 && fcntl(ends[1], F_SETFL, O_NONBLOCK) == 0);
    *r = (reader){.fd = ends[0]};
    fflush(stdout);
    dup2(ends[1], STDOUT_FILENO);
    close(ends[1]);
    CHECK_MSG(pupil_file_sink_open("-", options, &sink, &why) == 0, "%s", why.text);
    if (!poll_fails)
        pthread_create(&thread, NULL, read_all, r);
    nth_only(only);
    nth_begin(poll_fails ? 1 : 0, NTH_FAILS);
    for (size_t i = 0; i < count && !failed; i++)
        failed = pupil_sink_write(sink, &shown, ns ? &(pupil_frame_info){.timestamp_ns = ns[i]} : NULL, &why);
    nth_end(&call);
    nth_only(NULL);
    if (failed)
        pupil_sink_discard(sink);
    else
        failed = pupil_sink_finish(sink, &why);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    if (!poll_fails)
        pthread_join(thread, NULL);
    close(ends[0]);
    free(memory);
    return failed;
}

static void test_pipe(void)
{
    pupil_why without = {"?"};
    const pupil_sink_options options = {
        .width = SIDE, .height = SIDE, .fps = 30, .aspect = {4, 3}, .sound = {.path = "a.mkv"}, .without = &without};
    reader r;
    CHECK_MSG(stream(&options, NULL, 3, 0, &r) == 0, "%s", why.text);
    CHECK_MSG(r.frames == 3 && strstr(r.header, " A4:3 "), "%zu frames, %s", r.frames, r.header);
    CHECK_MSG(strcmp(without.text, "Y4M has none") == 0, "%s", without.text);
    const pupil_sink_options square = {.width = SIDE, .height = SIDE, .fps = 30, .without = &without};
    CHECK(stream(&square, NULL, 1, 0, &r) == 0 && strstr(r.header, " A1:1 ") && !*without.text);
    CHECK(stream(&square, NULL, 3, 1, &r) == -1);
    CHECK_MSG(strstr(why.text, "standard output: cannot be written"), "%s", why.text);
}

/* A frame is written as often as its time requires: not at all if its slot is taken, repeated over a gap, once if the
 * gap is too long or time goes backwards. */
static void test_times(void)
{
    static const int64_t frame_ns = 100000000;
    static const struct {
        int64_t ns[4];
        size_t frames;
    } cases[] = {{{0, 1, 2, 3}, 4}, {{0, 1, 4, 5}, 6}, {{0, 0, 1, 2}, 4}, {{0, 1, 100, 101}, 4}, {{5, 6, 3, 4}, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const pupil_sink_options options = {.width = SIDE, .height = SIDE, .fps = 10, .keep_time = 1, .gap_most_s = 1};
        int64_t ns[4];
        reader r;
        for (int k = 0; k < 4; k++)
            ns[k] = cases[i].ns[k] * frame_ns;
        CHECK_MSG(stream(&options, ns, 4, 0, &r) == 0, "%s", why.text);
        CHECK_MSG(r.frames == cases[i].frames, "case %zu: %zu frames", i, r.frames);
    }
    /* twice as fast as it plays: every other one */
    const pupil_sink_options options = {.width = SIDE, .height = SIDE, .fps = 10, .keep_time = 1, .gap_most_s = 1};
    const int64_t fast[4] = {0, frame_ns / 2, frame_ns, frame_ns * 3 / 2};
    reader r;
    CHECK(stream(&options, fast, 4, 0, &r) == 0);
    CHECK_MSG(r.frames == 3, "%zu frames", r.frames);
}

/* A disk that is full stays full, however often it is tried. */
static void test_full(void)
{
    const pupil_sink_options options = {.width = SIDE, .height = SIDE, .fps = 30};
    const int saved = dup(STDOUT_FILENO), full = open("/dev/full", O_WRONLY);
    uint8_t *memory;
    const pupil_image image = scratch_image(SIDE, SIDE, 0, &memory);
    const pupil_image_const shown = pupil_image_as_const(image);
    scratch_noise(&image);
    pupil_sink *sink = NULL;
    int failed = 0;
    fflush(stdout);
    dup2(full, STDOUT_FILENO);
    const int opened = pupil_file_sink_open("-", &options, &sink, &why) == 0;
    for (int i = 0; i < 3 && opened; i++)
        failed += pupil_sink_write(sink, &shown, NULL, &why) != 0;
    if (opened)
        pupil_sink_discard(sink);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    close(full);
    free(memory);
    CHECK_MSG(opened && failed == 3, "%d failed", failed);
    CHECK_MSG(strstr(why.text, "standard output: cannot be written: No space left"), "%s", why.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_pipe();
    test_times();
    test_full();
    return check_end();
}
