/* Each call of everything that reads a file fails once: a sentence, or the unchanged frames. A signal during a read, or
 * a short read, makes no difference. */
#include "each_call.h"
#include "each_call_inputs.h"

#include "file/file_source.h"
#include "raw/raw_source.h"
#include "write_exr.h"
#include "write_gain_map.h"

static int act_read(const each_call *c, uint64_t *digest, pupil_why *why)
{
    const pupil_source_options options = {.fps = 25, .frames = 2};
    pupil_source *source = NULL;
    if (pupil_file_source_open(&c->path, 1, &options, &source, why)) {
        CHECK(!source);
        return -1;
    }
    return each_call_frames(source, digest, why);
}

static int act_raw(const each_call *c, uint64_t *digest, pupil_why *why)
{
    pupil_source *source = NULL;
    return pupil_raw_source_open(c->path, NULL, &source, why) ? -1 : each_call_frames(source, digest, why);
}

static int act_recording(const each_call *c, uint64_t *digest, pupil_why *why)
{
    pupil_source *source = NULL;
    return pupil_recording_open(c->path, NULL, &source, why) ? -1 : each_call_frames(source, digest, why);
}

/* A pipe that has the whole file is standard input. */
static void pipe_in(const each_call *c)
{
    int ends[2];
    size_t size = 0;
    uint8_t *file = clip_load(c->given, &size);
    CHECK(file && size < 60000 && pipe(ends) == 0 && write(ends[1], file, size) == (ssize_t)size);
    CHECK(dup2(ends[0], STDIN_FILENO) == 0);
    close(ends[0]);
    close(ends[1]);
    free(file);
}

static void file_in(const each_call *c)
{
    FILE *file = fopen(c->given, "rb");
    CHECK(file && dup2(fileno(file), STDIN_FILENO) == 0);
    fclose(file);
}

static void make_gain_map(void)
{
    static bytes made;
    const gain_map_file f = {.base = {16, 8, 3, 1, 1, .standard_tables = 1},
                             .map = {8, 8, 1, 1, 1, .standard_tables = 1},
                             .xmp = "hdrgm:GainMapMax=\"3\">",
                             .index = 'M',
                             .orientation = 6};
    write_gain_map(&f, &made);
    clip_store(scratch("gain_map.jpg"), made.data, made.size);
}

/* Luma and chroma, half of it between the pixels; and tiles. */
static void make_exr(void)
{
    static const exr_part parts[] = {
        {.channel = {{"BY", HALF_SAMPLES, 2, 2}, {"RY", HALF_SAMPLES, 2, 2}, {"Y", HALF_SAMPLES, 1, 1}},
         .data = {0, 0, 15, 7},
         .display = {0, 0, 15, 7}},
        {.channel = {{"B", HALF_SAMPLES, 1, 1}, {"G", HALF_SAMPLES, 1, 1}, {"R", HALF_SAMPLES, 1, 1}},
         .data = {0, 0, 15, 7},
         .display = {0, 0, 15, 7},
         .tile = {8, 8}}};
    static const char *const names[] = {"luma.exr", "tiles.exr"};
    for (int i = 0; i < 2; i++) {
        static bytes made;
        made.size = 0;
        write_exr(&made, &parts[i], 1);
        clip_store(scratch(names[i]), made.data, made.size);
    }
}

static void make_inputs(void)
{
    static uint8_t raw[2 * 32 * 16];
    test_frames frames;
    pupil_why why = {""};
    input_write(scratch("a.png"), 0, 1);
    input_write(scratch("a.jpg"), 0, 1);
    input_write(scratch("a.tif"), 0, 1);
    input_write(scratch("folder"), 0, 3);
    input_write(scratch("a.mp4"), 0, 3);
    input_write(scratch("a.exr"), 1, 1);
    input_write(scratch("a.hdr"), 1, 1);
    input_write(scratch("a.pfm"), 1, 1);
    input_write(scratch("a.y4m"), 0, 2);
    input_dng(scratch("a.dng"));
    make_exr();
    make_gain_map();
    CHECK(input_clip(scratch("a.mkv"), "matroska", "ffv1", AV_PIX_FMT_YUV420P10));
    CHECK(input_clip(scratch("turned.mkv"), "matroska", "ffv1", AV_PIX_FMT_GRAY8));
    CHECK(input_clip(scratch("mosaic.nut"), "nut", "rawvideo", AV_PIX_FMT_BAYER_RGGB16LE));
    frames_make(&frames, PUPIL_PIXEL_NV12, 32, 16, 3);
    CHECK_MSG(frames_record(&frames, scratch("recording"), &(pupil_recorder_options){.fps = 30, .wait = 1}, &why) == 3,
              "%s", why.text);
    frames_free(&frames);
    input_recording_of_jpegs(scratch("jpegs"));
    for (size_t i = 0; i < sizeof raw; i++)
        raw[i] = (uint8_t)check_random();
    clip_store(scratch("a.raw"), raw, sizeof raw);
    mkdir(scratch("raws"), 0777);
    clip_store(scratch("raws/1.raw"), raw, sizeof raw);
    clip_store(scratch("raws/2.raw"), raw, sizeof raw);
}

static const char *spec(const char *before, const char *name, const char *after)
{
    char *made = malloc(2048);
    snprintf(made, 2048, "%s%s%s", before, scratch(name), after);
    return made; /* to the end of the program */
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    make_inputs();
    const each_call all[] = {
        {.name = "PNG", .act = act_read, .path = scratch("a.png")},
        {.name = "JPEG", .act = act_read, .path = scratch("a.jpg")},
        {.name = "JPEG with a gain map", .act = act_read, .path = scratch("gain_map.jpg")},
        {.name = "TIFF", .act = act_read, .path = scratch("a.tif")},
        {.name = "EXR", .act = act_read, .path = scratch("a.exr")},
        {.name = "EXR of luma and chroma", .act = act_read, .path = scratch("luma.exr")},
        {.name = "EXR of tiles", .act = act_read, .path = scratch("tiles.exr")},
        {.name = "Radiance", .act = act_read, .path = scratch("a.hdr")},
        {.name = "PFM", .act = act_read, .path = scratch("a.pfm")},
        {.name = "DNG", .act = act_read, .path = scratch("a.dng")},
        {.name = "a folder", .act = act_read, .path = scratch("folder")},
        {.name = "a pattern", .act = act_read, .path = scratch("folder/*.png")},
        {.name = "a panorama", .act = act_read, .path = spec("pan:", "a.hdr", ",size=16x8")},
        {.name = "a path in a panorama", .act = act_read, .path = spec("pan:", "a.hdr", ",path=0/0@0:90/5/60@1")},
        {.name = "MP4", .act = act_read, .path = scratch("a.mp4"), .gives_way = 1},
        {.name = "FFV1 of 10 bits", .act = act_read, .path = scratch("a.mkv"), .gives_way = 1},
        {.name = "a mosaic", .act = act_read, .path = scratch("mosaic.nut"), .gives_way = 1},
        {.name = "a piped PNG", .act = act_read, .prepare = pipe_in, .path = "-", .given = scratch("a.png")},
        {.name = "a piped MP4",
         .act = act_read,
         .prepare = pipe_in,
         .path = "-",
         .given = scratch("a.mp4"),
         .gives_way = 1},
        {.name = "a piped Y4M",
         .act = act_read,
         .prepare = pipe_in,
         .path = "-",
         .given = scratch("a.y4m"),
         .gives_way = 1},
        {.name = "PNG from standard input",
         .act = act_read,
         .prepare = file_in,
         .path = "-",
         .given = scratch("a.png"),
         .gives_way = 1},
        {.name = "raw", .act = act_raw, .path = spec("", "a.raw", ",format=RGGB,size=32x16")},
        {.name = "a folder of raw", .act = act_raw, .path = spec("", "raws", ",format=RGGB,size=32x16,balance=off")},
        {.name = "a recording", .act = act_recording, .path = scratch("recording")},
        {.name = "a recording of JPEGs", .act = act_recording, .path = scratch("jpegs")},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (argc < 3 || strcmp(argv[2], all[i].name) == 0)
            each_call_sweep(&all[i]);
    scratch_clear(scratch_folder);
    return check_end();
}
