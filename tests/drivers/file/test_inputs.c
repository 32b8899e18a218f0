/* What a name on the command line is taken for, and the sentence if it cannot be read. */
#include "file/file_sink.h"
#include "file/file_source.h"

#include "check.h"
#include "scratch.h"

static pupil_why why;

/* Refused, with these words. */
static void refused(const char *const *names, size_t count, const char *words)
{
    pupil_source *source = NULL;
    why.text[0] = 0;
    const int got = pupil_file_source_open(names, count, NULL, &source, &why);
    CHECK_MSG(got == PUPIL_SOURCE_FAILED && !source && strstr(why.text, words), "%s: %s", count ? names[0] : "nothing",
              why.text);
}

static void put(const char *name, const char *bytes, size_t size)
{
    FILE *file = fopen(name, "wb");
    CHECK(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
}

static void test_refusals(void)
{
    static const char nothing[] = "these bytes are no picture and no video at all";
    const char *const headless[] = {scratch("a.raw"), scratch("a.BIN"), scratch("a.txt"), scratch("none")};
    for (size_t i = 0; i < sizeof headless / sizeof *headless; i++) {
        put(headless[i], nothing, sizeof nothing);
        refused(&headless[i], 1, headless[i]);
        CHECK_MSG((strstr(why.text, "frames without a header are read as raw:") != NULL) == (i < 2), "%s", why.text);
    }
    refused(NULL, 0, "no input was named");
    refused((const char *const[]){"rtsp://camera/1"}, 1, "files are read, not addresses: ffmpeg -i 'rtsp://camera/1'");
    refused((const char *const[]){"seq.%04d.exr"}, 1, "a sequence is a pattern in quotes");
    refused((const char *const[]){"absent.exr"}, 1, "absent.exr: cannot be opened: No such file");
    refused((const char *const[]){"a.raw/%d.exr"}, 1, "a.raw/%d.exr");
    refused((const char *const[]){scratch("*.exr")}, 1, "matches the pattern");
    refused((const char *const[]){scratch_folder}, 1, "holds no still");
    refused((const char *const[]){"pan:a.exr", "b.exr"}, 2, "must be the only input");
    refused((const char *const[]){"a.exr", "-"}, 2, "must be the only input");
    refused((const char *const[]){"absent.exr", "absent.pfm"}, 2, "absent.exr");
    refused((const char *const[]){scratch("a.txt"), "absent.exr"}, 2, "must be the only input");
}

/* A name without a folder, without an extension, in another case. */
static void test_read(void)
{
    static const char pfm[] = "PF\n1 1\n-1\n\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f";
    static const char *const names[] = {"a.PFM", "./b.pfm", "c.pfm"};
    char before[4096];
    CHECK(getcwd(before, sizeof before) && chdir(scratch_folder) == 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        pupil_source *source = NULL;
        pupil_frame frame;
        put(names[i], pfm, sizeof pfm - 1);
        CHECK_MSG(pupil_file_source_open(&names[i], 1, NULL, &source, &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
        pupil_source_done(source, &frame);
        pupil_source_close(source);
    }
    CHECK(chdir(before) == 0);
}

/* A leading "." does not begin an extension: a folder of pictures. */
static void test_outputs(void)
{
    const pupil_sink_options options = {.width = 2, .height = 2, .fps = 30};
    const char *const folders[] = {scratch(".hidden"), scratch("plain"), scratch("slash.png/")};
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        uint8_t *memory;
        const pupil_image image = scratch_image(2, 2, 0, &memory);
        const pupil_image_const shown = pupil_image_as_const(image);
        scratch_noise(&image);
        pupil_sink *sink = NULL;
        CHECK_MSG(pupil_file_sink_open(folders[i], &options, &sink, &why) == 0, "%s", why.text);
        CHECK(pupil_sink_write(sink, &shown, NULL, &why) == 0 && pupil_sink_finish(sink, &why) == 0);
        CHECK_MSG(scratch_entries(folders[i]) == 1, "%s", folders[i]);
        free(memory);
    }
    pupil_sink *sink = NULL;
    CHECK(pupil_file_sink_open("", &options, &sink, &why) == -1 && strstr(why.text, "an output needs a name"));
    CHECK(pupil_file_sink_open("a.gif", &options, &sink, &why) == -1 && strstr(why.text, "no kind of output ends in"));
    CHECK(pupil_file_sink_open(scratch(".."), &options, &sink, &why) == -1 && !sink);
    const struct {
        uint32_t width, height;
    } sizes[] = {{0, 2}, {2, 0}, {16385, 2}, {2, 16385}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const pupil_sink_options other = {.width = sizes[i].width, .height = sizes[i].height, .fps = 30};
        CHECK_MSG(pupil_file_sink_open(scratch("a.y4m"), &other, &sink, &why) == -1 && !sink, "%ux%u", sizes[i].width,
                  sizes[i].height);
    }
    CHECK(!scratch_exists(scratch("a.y4m")));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_refusals();
    test_read();
    test_outputs();
    scratch_clear(scratch_folder);
    return check_end();
}
