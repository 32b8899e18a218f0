/* Sequences of stills: what is opened, in which order, when, and what happens at a lost frame. */
#include "still_check.h"

#include "file/file_source.h"
#include "file/still/natural_order.h"
#include "file/still/stills_source.h"

static pupil_why why;

/* A grey picture of one value. */
static void put_still(const char *name, float value)
{
    bytes b = {.size = 0};
    add_text(&b, "Pf 2 1 -1\n");
    add(&b, &value, 4);
    add(&b, &value, 4);
    write_file(scratch(name), b.data, b.size);
}

static void put_folder(const char *name)
{
    if (mkdir(scratch(name), 0777) != 0)
        abort();
}

static void test_order(void)
{
    /* Each sorts before all that follow. */
    static const char *const rising[] = {"a",
                                         "a-1",
                                         "a0",
                                         "a00",
                                         "a01",
                                         "a1",
                                         "a2",
                                         "a10",
                                         "a10b2",
                                         "a10b10",
                                         "a11",
                                         "a100",
                                         "a999999999999999999999",
                                         "a1000000000000000000000",
                                         "b"};
    const int count = sizeof rising / sizeof *rising;
    unsigned wrong = 0;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) {
            const int order = pupil_natural_compare(rising[i], rising[j]);
            wrong += (order > 0) - (order < 0) != (i > j) - (i < j);
        }
    CHECK_MSG(wrong == 0, "%u pairs", wrong);
    CHECK(pupil_natural_compare("f2.exr", "f10.exr") < 0 && pupil_natural_compare("f02.exr", "f2.exr") < 0);
    CHECK(pupil_natural_compare("x1y02", "x01y1") > 0); /* a later number counts more than leading zeros */
}

static pupil_source *open_one(const char *input, double fps)
{
    const pupil_source_options options = {.fps = fps};
    pupil_source *source = NULL;
    why.text[0] = 0;
    if (pupil_file_source_open(&input, 1, &options, &source, &why) != 0)
        return NULL;
    return source;
}

/* The values of all frames in order, in one string; "!" where one was lost. */
static const char *values(pupil_source *source)
{
    static char text[256];
    pupil_frame frame;
    int got;
    text[0] = 0;
    if (!source)
        return why.text;
    while ((got = pupil_source_next(source, &frame, &why)) != PUPIL_SOURCE_END) {
        const size_t used = strlen(text);
        if (got == PUPIL_SOURCE_FRAME) {
            snprintf(text + used, sizeof text - used, "%g ", *(const float *)frame.image.data);
            pupil_source_done(source, &frame);
        } else {
            snprintf(text + used, sizeof text - used, "! ");
        }
    }
    pupil_source_close(source);
    return text;
}

static void test_inputs(void)
{
    const char *two[2] = {scratch("one/f10.pfm"), scratch("two")};
    const char *with_video[2] = {scratch("one/f10.pfm"), scratch("clip.mp4")};
    pupil_source *source = NULL;
    put_folder("one");
    put_folder("one/sub.exr"); /* a folder is not a still, regardless of its name */
    put_folder("two");
    put_folder("none");
    put_still("one/f10.pfm", 10);
    put_still("one/f9.PFM", 9);
    put_still("one/f2.hdr", 2); /* the first bytes give the format, the extension only that it is a still */
    put_still("one/.f1.pfm", 1);
    put_still("one/notes.txt", 77);
    put_still("two/x1.pfm", 101);
    put_still("two/[x]1.pfm", 100);
    write_file(scratch("clip.mp4"), "no video", 8);

    CHECK(strcmp(values(open_one(scratch("one"), 0)), "2 9 10 ") == 0);
    CHECK(strcmp(values(open_one(scratch("one/"), 0)), "2 9 10 ") == 0);
    CHECK(strcmp(values(open_one(scratch("one/f*"), 0)), "2 9 10 ") == 0);
    CHECK(strcmp(values(open_one(scratch("*/?[0-9]*.pfm"), 0)), "10 101 ") == 0);
    CHECK(strcmp(values(open_one(scratch("two/[x]1.pfm"), 0)), "100 ") == 0); /* a literal name before a pattern */
    CHECK(pupil_file_source_open(two, 2, NULL, &source, &why) == 0 && source->frames == 3);
    CHECK(strcmp(values(source), "10 100 101 ") == 0);

    CHECK(!open_one(scratch("none"), 0) && strstr(why.text, "none: the folder holds no still (.exr,"));
    CHECK(!open_one(scratch("none/*.exr"), 0) && strstr(why.text, "none/*.exr: no still"));
    CHECK(!open_one(scratch("one/f11.pfm"), 0) && strstr(why.text, "one/f11.pfm: cannot be opened: No such file"));
    CHECK(pupil_file_source_open(with_video, 2, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "clip.mp4: must be the only input"));
    with_video[1] = "-";
    CHECK(pupil_file_source_open(with_video, 2, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "-: must be the only input"));
    with_video[1] = "pan:room.hdr";
    CHECK(pupil_file_source_open(with_video, 2, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "pan:room.hdr: must be the only input"));
    CHECK(pupil_file_source_open(two, 0, NULL, &source, &why) == PUPIL_SOURCE_FAILED && *why.text);
    CHECK(!open_one("", 0) && strstr(why.text, "the name of an input is empty"));
    CHECK(!open_one(scratch("clip.mp4"), 0) && strstr(why.text, "clip.mp4"));  /* goes to the video source */
    CHECK(!open_one("pan:nothing.hdr", 0) && strstr(why.text, "nothing.hdr")); /* and this to the panorama's */
}

static void test_frames(void)
{
    const char *paths[3] = {scratch("one/f2.hdr"), scratch("lost.pfm"), scratch("one/f10.pfm")};
    const pupil_source_options options = {.fps = 25}, bad = {.fps = -1};
    pupil_source *source;
    pupil_frame frame;
    const void *pixels;
    put_still("lost.pfm", 5);
    CHECK(pupil_stills_source_open(paths, 3, &options, &source, &why) == 0);
    CHECK(source->fps == 25 && source->frames == 3);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
    CHECK(frame.image.width == 2 && frame.image.height == 1 && frame.image.pixel == PUPIL_PIXEL_RGB32F);
    CHECK(frame.image.stride_bytes == 24 && strcmp(frame.name, paths[0]) == 0);
    CHECK(frame.info.timestamp_ns == 0 && frame.info.exposure_s == 0 && frame.info.gain == 0);
    pixels = frame.image.data;
    pupil_source_done(source, &frame);
    write_file(scratch("lost.pfm"), "Pf 2 1 -1\n1234", 14); /* damaged after it was opened */
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_DAMAGED);
    CHECK(strncmp(why.text, paths[1], strlen(paths[1])) == 0 && strstr(why.text, "need 8 bytes"));
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
    CHECK(frame.image.data == pixels);                                      /* the same memory again */
    CHECK(frame.info.sequence == 2 && frame.info.timestamp_ns == 80000000); /* a lost frame keeps its time slot */
    pupil_source_done(source, &frame);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);

    CHECK(pupil_stills_source_open(paths, 3, NULL, &source, &why) == 0 && source->fps == 30);
    remove(paths[0]);
    CHECK(strcmp(values(source), "! ! 10 ") == 0); /* missing, damaged, there */
    CHECK(pupil_stills_source_open(paths, 3, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "f2.hdr: cannot be opened"));
    CHECK(pupil_stills_source_open(paths + 2, 1, &bad, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(strstr(why.text, "fps is -1"));
    CHECK(pupil_stills_source_open(paths, 0, NULL, &source, &why) == PUPIL_SOURCE_FAILED && *why.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_order();
    test_inputs();
    test_frames();
    scratch_clear(scratch_folder);
    return check_end();
}
