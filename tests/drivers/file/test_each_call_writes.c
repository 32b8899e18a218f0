/* Each call of everything that writes a file fails once: a sentence and nothing left, or the right file. */
#include "each_call.h"
#include "each_call_inputs.h"

#include "file/common/pending.h"
#include "file/file_sink.h"
#include "file/file_source.h"
#include "file/sink/picture_sink.h"

enum { WIDTH = 32, HEIGHT = 24 };

typedef struct writing {
    int linear, frames;
    pupil_sink_options options;
} writing;

static uint8_t display[HEIGHT][WIDTH][3];
static float linear[HEIGHT][WIDTH][3];

static int write_frames(pupil_sink *sink, const writing *w, pupil_why *why)
{
    static const char *const names[] = {"shots/a.exr", "shots/b.exr", "other/a.exr"};
    const pupil_image_const of_display = {
        .data = display, .stride_bytes = sizeof *display, .width = WIDTH, .height = HEIGHT, .pixel = PUPIL_PIXEL_RGB8};
    const pupil_image_const of_light = {
        .data = linear, .stride_bytes = sizeof *linear, .width = WIDTH, .height = HEIGHT, .pixel = PUPIL_PIXEL_RGB32F};
    for (int n = 0; n < w->frames; n++) {
        const pupil_frame_info info = {.timestamp_ns = n * INT64_C(300000000), .sequence = (uint64_t)n};
        sink->frame_name = names[n % 3];
        if (pupil_sink_write(sink, w->linear ? &of_light : &of_display, &info, why))
            return -1;
    }
    return pupil_sink_finish(sink, why);
}

static int act_write(const each_call *c, uint64_t *digest, pupil_why *why)
{
    (void)digest;
    const writing *w = c->given;
    pupil_sink *sink = NULL;
    int failed = w->linear ? pupil_linear_sink_open(c->path, &w->options, &sink, why)
                           : pupil_file_sink_open(c->path, &w->options, &sink, why);
    if (failed) {
        CHECK(!sink);
    } else if ((failed = write_frames(sink, w, why)) != 0) {
        pupil_sink_discard(sink);
    }
    return failed;
}

/* A video without its sound is complete, because a sentence says so; here it counts as a failure. */
static int act_sound(const each_call *c, uint64_t *digest, pupil_why *why)
{
    pupil_why without = {""};
    writing w = *(const writing *)c->given;
    each_call inner = *c;
    w.options.sound = (pupil_sink_sound){scratch("sound.mkv"), 100000000};
    w.options.without = &without;
    inner.given = &w;
    if (act_write(&inner, digest, why))
        return -1;
    if (!*without.text)
        return 0;
    *why = without;
    remove(c->path);
    return -1;
}

static int act_record(const each_call *c, uint64_t *digest, pupil_why *why)
{
    const test_frames *frames = c->given;
    const pupil_recorder_options options = {.camera = "a camera", .fps = 30, .overwrite = 1, .wait = 1};
    (void)digest;
    return frames_record(frames, c->path, &options, why) == frames->count ? 0 : -1;
}

/* Matroska's own identifiers are random. */
static uint64_t video_frames(const each_call *c)
{
    pupil_why why = {""};
    pupil_source *source = NULL;
    uint64_t digest = 0;
    CHECK_MSG(pupil_file_source_open(&c->path, 1, NULL, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(!source || each_call_frames(source, &digest, &why) == 0, "%s", why.text);
    return digest;
}

static uint64_t recorded_frames(const each_call *c)
{
    pupil_why why = {""};
    pupil_source *source = NULL;
    uint64_t digest = 0;
    CHECK_MSG(pupil_recording_open(c->path, NULL, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(!source || each_call_frames(source, &digest, &why) == 0, "%s", why.text);
    return digest;
}

static void put_old_file(const each_call *c)
{
    scratch_put(c->path, "old");
}

static void put_old_folder(const each_call *c)
{
    char inside[1100];
    mkdir(c->path, 0777);
    snprintf(inside, sizeof inside, "%s/frame_000007.png", c->path);
    scratch_put(inside, "old");
}

static void put_other_folder(const each_call *c)
{
    char inside[1100];
    mkdir(c->path, 0777);
    snprintf(inside, sizeof inside, "%s/notes.txt", c->path);
    scratch_put(inside, "old");
}

static void put_old_recording(const each_call *c)
{
    pupil_why why = {""};
    uint64_t unused;
    CHECK_MSG(act_record(c, &unused, &why) == 0, "%s", why.text);
}

#define DISPLAY(number, ...)                                                                                           \
    &(const writing)                                                                                                   \
    {                                                                                                                  \
        0, number,                                                                                                     \
        {                                                                                                              \
            .width = WIDTH, .height = HEIGHT, .fps = 30, .primaries = PUPIL_PRIMARIES_BT709,                           \
            .transfer = PUPIL_TRANSFER_SRGB, __VA_ARGS__                                                               \
        }                                                                                                              \
    }
#define LINEAR(number, ...)                                                                                            \
    &(const writing)                                                                                                   \
    {                                                                                                                  \
        1, number,                                                                                                     \
        {                                                                                                              \
            .width = WIDTH, .height = HEIGHT, .fps = 30, __VA_ARGS__                                                   \
        }                                                                                                              \
    }

int main(int argc, char **argv)
{
    test_frames grey, colour;
    check_begin(argc, argv);
    scratch_begin();
    frames_make(&grey, PUPIL_PIXEL_GREY8, WIDTH, HEIGHT, 3);
    frames_make(&colour, PUPIL_PIXEL_NV12, WIDTH, HEIGHT, 2);
    input_sound(scratch("sound.mkv"), 1);
    for (uint32_t i = 0; i < sizeof display; i++) {
        (&display[0][0][0])[i] = (uint8_t)check_random();
        (&linear[0][0][0])[i] = (float)check_uniform();
    }
    const each_call all[] = {
        {.name = "PNG", .act = act_write, .path = scratch("out/a.png"), .given = DISPLAY(1, .overwrite = 0)},
        {.name = "PNG over a file",
         .act = act_write,
         .prepare = put_old_file,
         .path = scratch("out/a.png"),
         .given = DISPLAY(1, .overwrite = 1)},
        {.name = "JPEG", .act = act_write, .path = scratch("out/a.jpg"), .given = DISPLAY(1, .overwrite = 0)},
        {.name = "TIFF", .act = act_write, .path = scratch("out/a.tif"), .given = DISPLAY(1, .overwrite = 0)},
        {.name = "a folder", .act = act_write, .path = scratch("out/a"), .given = DISPLAY(2, .overwrite = 0)},
        {.name = "over a folder",
         .act = act_write,
         .prepare = put_old_folder,
         .path = scratch("out/a"),
         .given = DISPLAY(2, .overwrite = 1)},
        {.name = "named frames", .act = act_write, .path = scratch("out/a"), .given = DISPLAY(3, .named = 1)},
        {.name = "named frames into a folder",
         .act = act_write,
         .prepare = put_other_folder,
         .path = scratch("out/a"),
         .given = DISPLAY(3, .named = 1),
         .keeps = 1},
        {.name = "Y4M",
         .act = act_write,
         .path = scratch("out/a.y4m"),
         .given = DISPLAY(2, .keep_time = 1, .gap_most_s = 1.0),
         .gives_way = 1},
        {.name = "a live Y4M",
         .act = act_write,
         .path = scratch("out/a.y4m"),
         .given = DISPLAY(2, .live = 1),
         .keeps = 1,
         .gives_way = 1},
        {.name = "a live folder",
         .act = act_write,
         .path = scratch("out/a"),
         .given = DISPLAY(2, .live = 1),
         .keeps = 1},
        {.name = "MP4", .act = act_write, .path = scratch("out/a.mp4"), .given = DISPLAY(3, .overwrite = 0)},
        {.name = "MKV",
         .act = act_write,
         .path = scratch("out/a.mkv"),
         .given = DISPLAY(3, .overwrite = 0),
         .made = video_frames},
        {.name = "a live MP4",
         .act = act_write,
         .path = scratch("out/a.mp4"),
         .given = DISPLAY(6, .live = 1),
         .keeps = 1},
        {.name = "a live MKV",
         .act = act_write,
         .path = scratch("out/a.mkv"),
         .given = DISPLAY(6, .live = 1),
         .made = video_frames,
         .keeps = 1},
        {.name = "EXR", .act = act_write, .path = scratch("out/a.exr"), .given = LINEAR(1, .overwrite = 0)},
        {.name = "Radiance", .act = act_write, .path = scratch("out/a.hdr"), .given = LINEAR(1, .overwrite = 0)},
        {.name = "PFM", .act = act_write, .path = scratch("out/a.pfm"), .given = LINEAR(1, .overwrite = 0)},
        {.name = "a folder of EXR", .act = act_write, .path = scratch("out/a"), .given = LINEAR(2, .overwrite = 0)},
        {.name = "MKV with sound",
         .act = act_sound,
         .path = scratch("out/a.mkv"),
         .given = DISPLAY(3, .overwrite = 0),
         .made = video_frames,
         .gives_way = 1},
        {.name = "MOV with sound",
         .act = act_sound,
         .path = scratch("out/a.mov"),
         .given = DISPLAY(3, .overwrite = 0),
         .gives_way = 1},
        {.name = "a recording",
         .act = act_record,
         .path = scratch("out/a"),
         .given = &grey,
         .made = recorded_frames,
         .keeps = 1},
        {.name = "a recording over one",
         .act = act_record,
         .prepare = put_old_recording,
         .path = scratch("out/a"),
         .given = &colour,
         .made = recorded_frames,
         .keeps = 1},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (argc < 3 || strcmp(argv[2], all[i].name) == 0)
            each_call_sweep(&all[i]);
    frames_free(&grey);
    frames_free(&colour);
    scratch_clear(scratch_folder);
    return check_end();
}
