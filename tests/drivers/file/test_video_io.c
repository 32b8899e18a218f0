/* Where a video's bytes come from: a file whose index comes last, so that reading seeks, by name and from memory; a
 * file that was partly read before; a pipe without a writer until a stop is requested. */
#include "file/video/video_source.h"

#include <fcntl.h>

#include "clip.h"
#include "scratch.h"

static pupil_why why;

static int noise(const clip *c, int frame, int component, int x, int y)
{
    (void)c, (void)frame, (void)component, (void)x, (void)y;
    return (int)(check_random() >> 16 & 255);
}

/* Digest of all frames; 0: one did not come. */
static uint64_t digest_of(pupil_source *source, int frames)
{
    uint64_t digest = 1;
    pupil_frame f;
    for (int n = 0; n < frames; n++) {
        if (pupil_source_next(source, &f, &why) != PUPIL_SOURCE_FRAME)
            return 0;
        const float *pixels = f.image.data;
        for (size_t i = 0; i < (size_t)f.image.width * f.image.height * 3; i++)
            digest = digest * 31 + (uint64_t)(pixels[i] * 65536.0f);
        pupil_source_done(source, &f);
    }
    return pupil_source_next(source, &f, &why) == PUPIL_SOURCE_END ? digest : 0;
}

static const clip large = {.container = "mov",
                           .codec = "png",
                           .format = AV_PIX_FMT_RGB24,
                           .width = 160,
                           .height = 120,
                           .frames = 5,
                           .space = AVCOL_SPC_RGB,
                           .primaries = AVCOL_PRI_UNSPECIFIED,
                           .code = noise};

static void test_larger_than_a_buffer(void)
{
    const char *path = scratch("large.mov");
    size_t size = 0;
    pupil_source *source = NULL;
    CHECK(clip_write(&large, path) == 0);
    uint8_t *bytes = clip_load(path, &size);
    CHECK_MSG(size > 200000, "%zu bytes", size);
    CHECK_MSG(pupil_video_source_open(path, NULL, &source, &why) == 0, "%s", why.text);
    const uint64_t by_name = digest_of(source, large.frames);
    pupil_source_close(source);
    CHECK_MSG(by_name != 0, "%s", why.text);
    CHECK(pupil_video_source_open_bytes(bytes, size, "memory", 1 << 20, NULL, &source, &why) == 0);
    CHECK_MSG(digest_of(source, large.frames) == by_name, "%s", why.text);
    pupil_source_close(source);
    /* damaged so that its boxes point anywhere: a sentence or frames, and no read beyond the bytes */
    for (size_t at = size - 800; at < size; at += 29) {
        const uint8_t before = bytes[at];
        pupil_frame f;
        bytes[at] ^= 0xff;
        why.text[0] = 0;
        if (pupil_video_source_open_bytes(bytes, size, "memory", 1 << 20, NULL, &source, &why) == 0) {
            int got = PUPIL_SOURCE_FRAME;
            for (int n = 0; n < 3 && (got == PUPIL_SOURCE_FRAME || got == PUPIL_SOURCE_DAMAGED); n++)
                if ((got = pupil_source_next(source, &f, &why)) == PUPIL_SOURCE_FRAME)
                    pupil_source_done(source, &f);
            pupil_source_close(source);
        } else {
            CHECK_MSG(strlen(why.text) > 10, "byte %zu: '%s'", at, why.text);
        }
        bytes[at] = before;
    }
    free(bytes);
}

/* Standard input is a file, but not at its beginning: file offsets are not the video's. */
static void test_read_before(void)
{
    clip c = large;
    c.container = "nut";
    c.codec = "rawvideo";
    c.width = c.height = 32;
    const char *path = scratch("b.nut"), *both = scratch("both");
    size_t size = 0;
    CHECK(clip_write(&c, path) == 0);
    uint8_t *bytes = clip_load(path, &size);
    FILE *file = fopen(both, "wb");
    CHECK(file && fwrite("0123456789", 1, 10, file) == 10 && fwrite(bytes, 1, size, file) == size);
    CHECK(file && fclose(file) == 0);
    free(bytes);
    pupil_source *source = NULL;
    const int saved = dup(STDIN_FILENO), fd = open(both, O_RDONLY);
    CHECK(lseek(fd, 10, SEEK_SET) == 10 && dup2(fd, STDIN_FILENO) >= 0);
    close(fd);
    CHECK_MSG(pupil_video_source_open("-", NULL, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(digest_of(source, c.frames) != 0, "%s", why.text);
    pupil_source_close(source);
    dup2(saved, STDIN_FILENO);
    close(saved);
}

static int asked, most;

static int stop(void)
{
    return asked++ >= most;
}

static void test_silent_pipe(void)
{
    for (most = 0; most < 3; most++) { /* at once, and while waiting */
        int ends[2];
        pupil_source *source = NULL;
        const int saved = dup(STDIN_FILENO);
        CHECK(pipe(ends) == 0);
        dup2(ends[0], STDIN_FILENO);
        close(ends[0]);
        asked = 0;
        CHECK(pupil_video_source_open("-", &(pupil_source_options){.stop = stop}, &source, &why) != 0 && !source);
        CHECK_MSG(asked == most + 1, "asked %d times", asked);
        CHECK_MSG(strstr(why.text, "Interrupted") != NULL, "%s", why.text);
        dup2(saved, STDIN_FILENO);
        close(saved);
        close(ends[1]);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_larger_than_a_buffer();
    test_read_before();
    test_silent_pipe();
    scratch_clear(scratch_folder);
    return check_end();
}
