/* Pictures named after their frames, in a folder that may have other files: none of those is lost, and each refusal is
 * a sentence that names the file. */
#include "scratch.h"

#include "file/file_sink.h"

static pupil_why why;
static uint8_t pixels[3 * 4];

static pupil_sink *open_named(int overwrite)
{
    const pupil_sink_options options = {.width = 2, .height = 2, .fps = 30, .named = 1, .overwrite = overwrite};
    pupil_sink *sink = NULL;
    CHECK_MSG(pupil_file_sink_open(scratch("out"), &options, &sink, &why) == 0, "%s", why.text);
    return sink;
}

static int put(pupil_sink *sink, const char *name)
{
    const pupil_image_const image = {
        .data = pixels, .stride_bytes = 6, .width = 2, .height = 2, .pixel = PUPIL_PIXEL_RGB8};
    sink->frame_name = name;
    return pupil_sink_write(sink, &image, &(pupil_frame_info){0}, &why);
}

static void test_names(void)
{
    static const char *const names[][2] = {
        {"shots/a.exr", "out/a.png"},  {"other/a.hdr", "out/a-1.png"}, {"b", "out/b.png"},
        {"c.tar.gz", "out/c.tar.png"}, {".hidden", "out/.hidden.png"}, {"d/.x.exr", "out/.x.png"},
        {"no/dot.d/e", "out/e.png"}};
    pupil_sink *sink = open_named(0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK_MSG(put(sink, names[i][0]) == 0, "%s", why.text);
    CHECK(put(sink, NULL) == 0); /* one without a name: by its number */
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK_MSG(scratch_exists(scratch(names[i][1])), "%s is not there", names[i][1]);
    CHECK(scratch_entries(scratch("out")) == 8);
    scratch_clear(scratch("out"));
}

static void test_long_and_many(void)
{
    char name[300] = "";
    pupil_sink *sink = open_named(0);
    memset(name, 'n', 201);
    CHECK(put(sink, name) == -1 && strstr(why.text, "a name of over 200 bytes"));
    for (int i = 0; i < 1000; i++)
        CHECK(put(sink, "same.exr") == 0);
    CHECK(put(sink, "same.exr") == -1 && strstr(why.text, "same: named by over 1000 inputs"));
    pupil_sink_discard(sink);
    CHECK(!scratch_exists(scratch("out")) && scratch_entries(scratch_folder) == 0);
}

/* With notes.txt and a.png in the folder. */
static void test_kept(void)
{
    pupil_sink *sink;
    CHECK(mkdir(scratch("out"), 0777) == 0);
    scratch_put(scratch("out/notes.txt"), "notes");
    scratch_put(scratch("out/a.png"), "old");
    sink = open_named(0);
    CHECK(put(sink, "b.exr") == 0);
    CHECK(put(sink, "a.exr") == -1 && strstr(why.text, "out/a.png: is there already; -y replaces it"));
    pupil_sink_discard(sink);
    CHECK(scratch_holds(scratch("out/a.png"), "old") && scratch_entries(scratch("out")) == 2);

    sink = open_named(0); /* one that appears in the meantime */
    CHECK(put(sink, "b.exr") == 0 && put(sink, "c.exr") == 0);
    scratch_put(scratch("out/b.png"), "theirs");
    CHECK(pupil_sink_finish(sink, &why) == -1 && strstr(why.text, "out/b.png: is there already"));
    pupil_sink_discard(sink);
    CHECK(scratch_holds(scratch("out/b.png"), "theirs") && !scratch_exists(scratch("out/c.png")));

    sink = open_named(1); /* -y: files are replaced, a folder is not */
    CHECK(put(sink, "a.exr") == 0 && put(sink, "b.exr") == 0);
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    CHECK(!scratch_holds(scratch("out/a.png"), "old") && !scratch_holds(scratch("out/b.png"), "theirs"));
    CHECK(scratch_holds(scratch("out/notes.txt"), "notes"));
    CHECK(mkdir(scratch("out/d.png"), 0777) == 0);
    sink = open_named(1);
    CHECK(put(sink, "d.exr") == 0 && put(sink, "a.exr") == 0);
    CHECK(pupil_sink_finish(sink, &why) == -1 && strstr(why.text, "out/d.png: is there already, and no file"));
    pupil_sink_discard(sink);
    CHECK(scratch_entries(scratch("out")) == 4 && scratch_entries(scratch_folder) == 1);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_names();
    test_long_and_many();
    test_kept();
    scratch_clear(scratch_folder);
    return check_end();
}
