/* Each C library call of live cameras, their lists and rendered scenes fails once: a sentence, or the same result as
 * without a failure; nothing stays open, and the controls are as before. (Each call to a driver:
 * drivers.v4l2.faults.) */
#include "drivers/file/each_call.h"

#include <linux/videodev2.h>

#include "fake_libcamera/fake_libcamera.h"
#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "synth/synth_source.h"

static fake_v4l2 *fake;
static fake_libcamera *other;
static pupil_live_system machine;

static void plug_in(const each_call *c)
{
    fake_v4l2_config config;
    fake_libcamera_config webcam;
    if (fake)
        fake_v4l2_free(fake);
    if (other)
        fake_libcamera_free(other);
    fake_v4l2_config_default(&config);
    if (c->given)
        config.only_format = *(const uint32_t *)c->given;
    config.media = c->given && *(const uint32_t *)c->given == V4L2_PIX_FMT_SRGGB10 ? FAKE_MEDIA_RIGHT : FAKE_MEDIA_NONE;
    config.twin = 1;
    fake = fake_v4l2_new(&config);
    fake_libcamera_config_default(&webcam);
    webcam.sensor = 1;
    other = fake_libcamera_new(&webcam);
    machine = (pupil_live_system){fake_v4l2_system(fake), fake_libcamera_layer(other)};
}

static uint64_t is_closed(const each_call *c)
{
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0 && fake_libcamera_opened(other) == 0, "%s: %d files, %d maps, %d",
              c->name, held.files, held.maps, fake_libcamera_opened(other));
    return 0;
}

/* Three frames; the exposure is asked for once, where there are controls. */
static int act_live(const each_call *c, uint64_t *digest, pupil_why *why)
{
    pupil_source *source = NULL;
    pupil_frame frame;
    int got = PUPIL_SOURCE_FRAME;
    const pupil_live_options options = {.system = &machine, .capture = {.timeout_s = 0.5}};
    if (pupil_live_open(c->path, &(pupil_source_options){.fps = 30}, &options, &source, why)) {
        CHECK(!source);
        is_closed(c);
        return -1;
    }
    for (int n = 0; n < 3 && got == PUPIL_SOURCE_FRAME; n++) {
        got = pupil_source_next(source, &frame, why);
        if (got == PUPIL_SOURCE_FRAME)
            pupil_source_done(source, &frame);
        if (n == 0 && pupil_live_camera(source))
            pupil_camera_ask(pupil_live_camera(source), &(pupil_camera_setting){.exposure_s = 0.001});
    }
    *digest = got == PUPIL_SOURCE_FRAME;
    const char *without = pupil_live_no_controls(source);
    if (got == PUPIL_SOURCE_FRAME && without && *without && strlen(why->text) == 0)
        CHECK_MSG(strlen(without) > 10, "'%s'", without);
    pupil_live_give_back(source, NULL);
    pupil_source_close(source);
    is_closed(c);
    return got == PUPIL_SOURCE_FRAME ? 0 : -1;
}

static int seen(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *words)
{
    uint64_t *digest = closure;
    if (is || *words) /* else it is not a camera */
        *digest += is && !*words && modes ? strlen(is->path) + modes->count : 1000;
    return 0;
}

/* A camera that could not be queried is listed as such. */
static int act_list(const each_call *c, uint64_t *digest, pupil_why *why)
{
    const int failed = pupil_live_cameras(&machine, 1, seen, digest, why);
    is_closed(c);
    if (!failed && *digest > 1000)
        snprintf(why->text, sizeof why->text, "a camera could not be asked");
    return failed || *digest > 1000 ? -1 : 0;
}

static int act_offers(const each_call *c, uint64_t *digest, pupil_why *why)
{
    pupil_live_offers *offers = calloc(1, sizeof *offers);
    if (!offers) {
        snprintf(why->text, sizeof why->text, "no memory for the test");
        return -1;
    }
    const int failed = pupil_live_offers_read(offers, &machine, c->path, why);
    *digest = offers->modes.count + offers->controls;
    pupil_live_modes_free(&offers->modes);
    free(offers);
    is_closed(c);
    return failed ? -1 : 0;
}

static int act_output(const each_call *c, uint64_t *digest, pupil_why *why)
{
    static uint8_t pixels[48 * 64 * 3];
    const pupil_sink_options options = {.width = 64, .height = 48, .fps = 30};
    const pupil_image_const image = {
        .data = pixels, .stride_bytes = 64 * 3, .width = 64, .height = 48, .pixel = PUPIL_PIXEL_RGB8};
    pupil_sink *sink = NULL;
    int failed = pupil_live_output_open(&sink, c->path, &options, &machine, why);
    for (int n = 0; n < 3 && !failed; n++)
        failed = pupil_sink_write(sink, &image, NULL, why);
    if (!failed)
        failed = pupil_sink_finish(sink, why);
    else
        pupil_sink_discard(sink);
    *digest = 3;
    is_closed(c);
    return failed;
}

static int act_synth(const each_call *c, uint64_t *digest, pupil_why *why)
{
    const pupil_source_options options = {.width = 8, .height = 8, .frames = 1, .threads = 3};
    pupil_source *source = NULL;
    const int failed = pupil_synth_source_open(c->path, &options, &source, why);
    CHECK(!failed == (source != NULL));
    *digest = source ? source->frames : 0;
    pupil_source_close(source);
    return failed;
}

int main(int argc, char **argv)
{
    static const uint32_t jpeg = V4L2_PIX_FMT_MJPEG, mosaic = V4L2_PIX_FMT_SRGGB10;
    static const each_call all[] = {
        {.name = "a camera", .act = act_live, .prepare = plug_in, .made = is_closed, .path = "/dev/video0"},
        {.name = "a camera of JPEGs",
         .act = act_live,
         .prepare = plug_in,
         .made = is_closed,
         .path = "v4l2:0",
         .given = &jpeg},
        {.name = "a sensor", .act = act_live, .prepare = plug_in, .made = is_closed, .path = "0", .given = &mosaic},
        {.name = "libcamera's", .act = act_live, .prepare = plug_in, .made = is_closed, .path = "libcamera:"},
        {.name = "all cameras", .act = act_list, .prepare = plug_in, .made = is_closed},
        {.name = "offers", .act = act_offers, .prepare = plug_in, .made = is_closed, .path = "0", .given = &mosaic},
        {.name = "libcamera's offers", .act = act_offers, .prepare = plug_in, .made = is_closed, .path = "libcamera:0"},
        {.name = "an output", .act = act_output, .prepare = plug_in, .made = is_closed, .path = "/dev/video2"},
        {.name = "a scene",
         .act = act_synth,
         .prepare = plug_in,
         .made = is_closed,
         .path = "room",
         .most = 12}, /* the rest are the recipe's */
    };
    static const char *const counted[] = {"malloc",
                                          "calloc",
                                          "realloc",
                                          "strdup",
                                          "strndup",
                                          "asprintf",
                                          "pthread_create",
                                          "av_packet_alloc",
                                          "av_frame_alloc",
                                          "avcodec_alloc_context3",
                                          "avcodec_open2",
                                          "av_buffer_alloc",
                                          "avcodec_send_packet",
                                          "avcodec_receive_frame",
                                          NULL};
    check_begin(argc, argv);
    scratch_begin();
    nth_only(counted); /* the fakes' memory is in files */
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (argc < 3 || strcmp(argv[2], all[i].name) == 0)
            each_call_sweep(&all[i]);
    fake_v4l2_free(fake);
    fake_libcamera_free(other);
    scratch_clear(scratch_folder);
    return check_end();
}
