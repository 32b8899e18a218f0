/* Videos come at their times, from files and pipes; damage is reported, never skipped over. */
#include "clip.h"
#include "scratch.h"

#include "file/video/video_source.h"

#include <sys/wait.h>

static pupil_why why;

/* --- reading from elsewhere, times --- */

static int noise(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    return 60 + (x * 7 + y * 13 + frame * 5 + component * 31 + (int)(check_random() % 20)) % 140;
}

static const clip noisy = {"yuv4mpegpipe",
                           "wrapped_avframe",
                           AV_PIX_FMT_YUV420P,
                           64,
                           36,
                           8,
                           AVCOL_SPC_UNSPECIFIED,
                           AVCOL_TRC_UNSPECIFIED,
                           AVCOL_PRI_UNSPECIFIED,
                           AVCOL_RANGE_UNSPECIFIED,
                           AVCHROMA_LOC_LEFT,
                           NULL,
                           noise,
                           NULL};

/* Counts the frames of an open source, and closes it. Returns the last code of next. */
static int drain(pupil_source *source, int *frames, int *damaged)
{
    pupil_frame f;
    int rc;
    int64_t last = -1;
    *frames = *damaged = 0;
    while ((rc = pupil_source_next(source, &f, &why)) == PUPIL_SOURCE_FRAME || rc == PUPIL_SOURCE_DAMAGED) {
        if (rc == PUPIL_SOURCE_DAMAGED) {
            ++*damaged;
            continue;
        }
        CHECK(*frames ? f.info.timestamp_ns > last : f.info.timestamp_ns == 0);
        last = f.info.timestamp_ns;
        ++*frames;
        pupil_source_done(source, &f);
    }
    pupil_source_close(source);
    return rc;
}

static void test_pipe(void)
{
    size_t size = 0;
    int ends[2], kept = dup(STDIN_FILENO), frames, damaged;
    pupil_source *source;
    clip c = noisy;
    c.codec = "rawvideo"; /* Y4M takes wrapped or raw frames, depending on libav's version */
    CHECK(clip_write(&noisy, scratch("pipe.y4m")) == 0 || clip_write(&c, scratch("pipe.y4m")) == 0);
    uint8_t *bytes = clip_load(scratch("pipe.y4m"), &size);
    CHECK(size > 8 * 64 * 36 && pipe(ends) == 0);
    pid_t writer = fork();
    if (writer == 0) {
        ssize_t written = write(ends[1], bytes, size);
        _exit(written != (ssize_t)size);
    }
    close(ends[1]);
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    CHECK_MSG(pupil_video_source_open("-", NULL, &source, &why) == 0, "%s", why.text);
    CHECK(source->fps == 25);
    CHECK(drain(source, &frames, &damaged) == PUPIL_SOURCE_END);
    CHECK_MSG(frames == 8 && damaged == 0, "%d frames, %d damaged: %s", frames, damaged, why.text);
    dup2(kept, STDIN_FILENO);
    close(kept);
    CHECK(waitpid(writer, NULL, 0) == writer);
    free(bytes);
}

static void test_times(void)
{
    static const int64_t ms[] = {100, 140, 150, 400, 401};
    clip c = noisy;
    pupil_source *source;
    pupil_frame f;
    c.container = "matroska";
    c.codec = "ffv1";
    c.frames = 5;
    c.pts_ms = ms;
    CHECK(clip_write(&c, scratch("times.mkv")) == 0);
    CHECK_MSG(pupil_video_source_open(scratch("times.mkv"), NULL, &source, &why) == 0, "%s", why.text);
    for (int n = 0; n < 5; n++) {
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME);
        CHECK_MSG(f.info.timestamp_ns == (ms[n] - ms[0]) * 1000000, "frame %d at %lld ns", n,
                  (long long)f.info.timestamp_ns);
    }
    pupil_source_close(source);
}

/* --- what is not whole --- */

static void test_refusals(void)
{
    static const struct {
        const char *name, *text, *said;
    } files[] = {
        {"photo.heic", "\1\1\1\030ftypheic\1\1\1\1mif1heic and no more than that", "a HEIC picture, which the"},
        {"text.mp4", "just a line of text, and another one\n", "not an image or a video"},
        {"empty.mkv", "", "empty file"},
        {"list.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\ntimes.mkv\n#EXT-X-ENDLIST\n", ""},
        {"list.ffconcat", "ffconcat version 1.0\nfile times.mkv\n", ""},
        {"sound.wav", "RIFF$\1\0\0WAVEfmt \20\0\0\0\1\0\1\0@\37\0\0@\37\0\0\1\0\10\0data\0\1\0\0", "no video stream"},
    };
    pupil_source *source;
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        char content[300] = {0};
        int is_wav = k + 1 == sizeof files / sizeof *files;
        memcpy(content, files[k].text, is_wav ? 44 : strlen(files[k].text));
        clip_store(scratch(files[k].name), content, is_wav ? 300 : strlen(files[k].text));
        CHECK(pupil_video_source_open(scratch(files[k].name), NULL, &source, &why) == PUPIL_SOURCE_FAILED);
        CHECK_MSG(strstr(why.text, files[k].name) && strstr(why.text, files[k].said) && !strchr(why.text, '\n'),
                  "%s: %s", files[k].name, why.text);
    }
    CHECK(pupil_video_source_open(scratch("absent.mp4"), NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "absent.mp4: No such file"));
    CHECK(pupil_video_source_open(scratch_folder, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "a folder"));
}

static void test_size_change(void)
{
    size_t a_size = 0, b_size = 0;
    clip c = noisy;
    pupil_source *source;
    int frames, damaged;
    c.container = "mjpeg";
    c.codec = "mjpeg";
    c.format = AV_PIX_FMT_YUVJ420P;
    c.frames = 2;
    CHECK(clip_write(&c, scratch("a.mjpeg")) == 0);
    c.width = 48;
    CHECK(clip_write(&c, scratch("b.mjpeg")) == 0);
    uint8_t *a = clip_load(scratch("a.mjpeg"), &a_size), *b = clip_load(scratch("b.mjpeg"), &b_size);
    a = realloc(a, a_size + b_size);
    memcpy(a + a_size, b, b_size);
    CHECK_MSG(pupil_video_source_open_bytes(a, a_size + b_size, "two", 1 << 20, NULL, &source, &why) == 0, "%s",
              why.text);
    CHECK(drain(source, &frames, &damaged) == PUPIL_SOURCE_FAILED && frames == 2);
    CHECK_MSG(strstr(why.text, "48 x 36") && strstr(why.text, "64 x 36"), "%s", why.text);
    if (pupil_video_source_open_bytes(a, a_size, "large", 64 * 36 - 1, NULL, &source, &why) == 0)
        CHECK(drain(source, &frames, &damaged) == PUPIL_SOURCE_FAILED && frames == 0);
    CHECK_MSG(strstr(why.text, "large: "), "%s", why.text);
    free(a);
    free(b);
}

/* Cut anywhere, a video either cannot be opened, or delivers complete frames, reports that some are missing, and
 * ends. */
static void test_cuts(const char *container, const char *codec)
{
    size_t size = 0;
    clip c = noisy;
    pupil_source *source;
    int frames, damaged, before = 0, rc;
    c.container = container;
    c.codec = codec;
    CHECK(clip_write(&c, scratch("cut")) == 0);
    uint8_t *bytes = clip_load(scratch("cut"), &size);
    for (size_t cut = 0; cut <= size; cut += cut == size ? 1 : size - cut < 97 ? size - cut : 97) {
        uint8_t *part = malloc(cut + 1); /* its own block, so that a sanitizer sees reads beyond it */
        memcpy(part, bytes, cut);
        if (pupil_video_source_open_bytes(part, cut, "cut", 1 << 20, NULL, &source, &why) == 0) {
            rc = drain(source, &frames, &damaged);
            CHECK_MSG(frames >= before && frames <= 8, "%s cut at %zu: %d frames", container, cut, frames);
            CHECK_MSG(damaged || frames == 8 || (frames == 0 && rc == PUPIL_SOURCE_FAILED),
                      "%s cut at %zu of %zu: only %d frames", container, cut, size, frames);
            CHECK_MSG(frames == 0 || rc == PUPIL_SOURCE_END, "%s cut at %zu: after %d frames %s", container, cut,
                      frames, why.text);
            before = frames;
        }
        free(part);
    }
    CHECK_MSG(before == 8, "%s: %d frames of the whole file", container, before);
    free(bytes);
}

/* FFV1 has checksums: a changed byte in a frame is found, and only that frame is lost. */
static void test_damage(void)
{
    size_t size = 0;
    clip c = noisy;
    pupil_source *source;
    int frames, damaged, found = 0;
    c.container = "matroska";
    c.codec = "ffv1";
    CHECK(clip_write(&c, scratch("damage.mkv")) == 0);
    uint8_t *bytes = clip_load(scratch("damage.mkv"), &size);
    for (int k = 0; k < 60; k++) {
        size_t place = size / 4 + (size_t)(check_uniform() * (double)size / 2);
        uint8_t bit = (uint8_t)(1 << check_random() % 8);
        bytes[place] ^= bit;
        if (pupil_video_source_open_bytes(bytes, size, "damage", 1 << 20, NULL, &source, &why) == 0) {
            int rc = drain(source, &frames, &damaged);
            CHECK_MSG(frames <= 7 || rc == PUPIL_SOURCE_FAILED || damaged, "byte %zu: %d frames as if nothing was",
                      place, frames);
            found += frames == 7 && damaged == 1 && rc == PUPIL_SOURCE_END && strstr(why.text, "CRC") != NULL;
        }
        bytes[place] ^= bit;
    }
    CHECK_MSG(found >= 50, "%d of 60 told as one damaged frame", found);
    free(bytes);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_pipe();
    test_times();
    test_refusals();
    test_size_change();
    test_cuts("matroska", "ffv1");
    test_cuts("yuv4mpegpipe", "wrapped_avframe");
    test_cuts("avi", "mpeg4");
    test_damage();
    scratch_clear(scratch_folder);
    return check_end();
}
