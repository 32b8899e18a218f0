/* pupilsrc with a camera in this process: caps, timestamps, numbers, exposure, restored controls, an unplugged camera,
 * properties from another thread, changes of state. The elements are linked to this program. */
#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "element.h"
#include "fake_v4l2/fake_v4l2.h"
#include "gstreamer/elements.h"

GST_PLUGIN_STATIC_DECLARE(pupil);

enum { FPS = 60 };

typedef struct camera {
    fake_v4l2 *fake;
    pupil_live_system system;
    GstHarness *h;
    GstBus *bus;
} camera;

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.real_time = 1;
    config.fps = FPS;
    config.flat = 60;
    return config;
}

static void plug(camera *c, const fake_v4l2_config *config)
{
    c->fake = fake_v4l2_new(config);
    c->system.v4l2 = fake_v4l2_system(c->fake);
    pupilsrc_system = &c->system;
    c->h = gst_harness_new("pupilsrc");
    gst_harness_use_systemclock(c->h);
    c->bus = gst_bus_new();
    gst_element_set_bus(c->h->element, c->bus);
}

/* Nothing of the camera stays open. */
static void unplug(camera *c)
{
    gst_element_set_state(c->h->element, GST_STATE_NULL);
    gst_element_set_bus(c->h->element, NULL);
    gst_object_unref(c->bus);
    gst_harness_teardown(c->h);
    const fake_v4l2_held held = fake_v4l2_holds(c->fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(c->fake);
    pupilsrc_system = NULL;
}

static int control(const camera *c, uint32_t id, int set, int value)
{
    const pupil_v4l2_system *system = c->system.v4l2;
    struct v4l2_control asked = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    CHECK(system->ioctl(system->context, fd, set ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &asked) == 0);
    system->close(system->context, fd);
    return asked.value;
}

/* log2 of the light that an NV12 picture shows. */
static double shown_ev(GstBuffer *buffer, uint32_t width, uint32_t height)
{
    const pupil_coding coding = {.matrix = PUPIL_MATRIX_BT709};
    pupil_t pupil;
    pupil_config config;
    pupil_exposure exposure;
    GstMapInfo map;
    pupil_config_default(&config);
    pupil_init(&pupil, &config);
    CHECK(gst_buffer_map(buffer, &map, GST_MAP_READ));
    pupil_image_const image = pupil_image_const_of(map.data, width, height, PUPIL_PIXEL_NV12);
    image.coding = &coding;
    CHECK(pupil_meter(&pupil, &image, NULL) == PUPIL_OK);
    gst_buffer_unmap(buffer, &map);
    pupil_get_exposure(&pupil, &exposure);
    return exposure.metered_ev;
}

static void test_stream(void)
{
    camera c;
    const fake_v4l2_config config = usual();
    plug(&c, &config);
    control(&c, V4L2_CID_EXPOSURE_AUTO, 1, V4L2_EXPOSURE_MANUAL);
    control(&c, V4L2_CID_EXPOSURE_ABSOLUTE, 1, 77);
    control(&c, V4L2_CID_GAIN, 1, 40);
    control(&c, V4L2_CID_EXPOSURE_AUTO, 1, V4L2_EXPOSURE_APERTURE_PRIORITY);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=320, height=240");
    gst_harness_play(c.h);
    GstClockTime last = 0;
    guint64 sequence = 0;
    double ev = 0.0;
    char state[32] = "";
    unsigned apart = 0; /* frames whose times match their numbers; on a busy machine a few do not */
    for (int i = 0; i < 90 || (i < 400 && strcmp(state, "converged") != 0); i++) { /* a busy machine loses frames */
        GstBuffer *got = gst_harness_pull(c.h);
        CHECK(GST_BUFFER_PTS_IS_VALID(got) && (i == 0 || GST_BUFFER_PTS(got) > last));
        CHECK(i == 0 || GST_BUFFER_OFFSET(got) > sequence);
        const double frames = (double)(GST_BUFFER_OFFSET(got) - sequence);
        apart += fabs((double)(GST_BUFFER_PTS(got) - last) * 1e-9 * FPS - frames) < 0.1;
        last = GST_BUFFER_PTS(got);
        sequence = GST_BUFFER_OFFSET(got);
        ev = shown_ev(got, 320, 240);
        const GstStructure *numbers = gst_custom_meta_get_structure(gst_buffer_get_custom_meta(got, "PupilFrame"));
        guint64 number;
        snprintf(state, sizeof state, "%s", gst_structure_get_string(numbers, "state"));
        CHECK(gst_structure_get_uint64(numbers, "sequence", &number) && number == sequence);
        gst_buffer_unref(got);
    }
    CHECK_MSG(apart > 80, "%u", apart);
    CHECK_MSG(strcmp(state, "converged") == 0, "%s", state);
    CHECK_MSG(fabs(ev - log2(0.18)) < 0.1, "shown at %.3f", exp2(ev));
    double exposure_us, gain;
    gchar *text;
    g_object_get(c.h->element, "exposure-time", &exposure_us, "gain", &gain, "state", &text, NULL);
    CHECK_MSG(exposure_us > 0.0 && gain >= 1.0 && *text, "%g us, %g, %s", exposure_us, gain, text);
    g_free(text);
    GstQuery *query = gst_query_new_latency();
    GstClockTime least = 0, most = 0;
    gboolean is_live = FALSE;
    CHECK(gst_element_query(c.h->element, query));
    gst_query_parse_latency(query, &is_live, &least, &most);
    CHECK(is_live && least == GST_SECOND / FPS && most == 4 * least);
    gst_query_unref(query);
    gst_element_set_state(c.h->element, GST_STATE_NULL);
    CHECK(control(&c, V4L2_CID_EXPOSURE_AUTO, 0, 0) == V4L2_EXPOSURE_APERTURE_PRIORITY);
    CHECK(control(&c, V4L2_CID_EXPOSURE_ABSOLUTE, 0, 0) == 77 && control(&c, V4L2_CID_GAIN, 0, 0) == 40);
    unsigned messages = 0;
    *state = 0;
    for (GstStructure *m = next_message(c.bus); m; m = next_message(c.bus), messages++) {
        CHECK(gst_structure_has_name(m, "pupilsrc") && gst_structure_has_field(m, "exposure-time"));
        CHECK(strcmp(state, gst_structure_get_string(m, "state")) != 0); /* one for each change */
        snprintf(state, sizeof state, "%s", gst_structure_get_string(m, "state"));
        gst_structure_free(m);
    }
    CHECK_MSG(messages >= 2, "%u messages", messages); /* searching, converged */
    unplug(&c);
}

/* One error, in words, and the end. */
static void test_errors(void)
{
    static const struct {
        const char *caps, *words;
        uint64_t unplug_at;
        int absent, exposure;
    } cases[] = {{"video/x-raw, format=NV12", "the camera was unplugged", 12, 0, 0},
                 {"video/x-raw, format=NV12", "is not there", 0, 1, 0},
                 {"video/x-raw, format=NV12, width=322, height=242", "322x242", 0, 0, 0},
                 {"video/x-raw, format=NV12, width=[9000,9999]", "no mode", 0, 0, 0},
                 {"video/x-raw, format=NV12, colorimetry=bt2100-pq", "the picture is SDR", 0, 0, 0}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        camera c;
        fake_v4l2_config config = usual();
        config.unplug_at = cases[i].unplug_at;
        config.absent = cases[i].absent;
        plug(&c, &config);
        gst_harness_set_sink_caps_str(c.h, cases[i].caps);
        gst_element_set_state(c.h->element, GST_STATE_PLAYING);
        GstMessage *message = gst_bus_timed_pop_filtered(c.bus, 20 * GST_SECOND, GST_MESSAGE_ERROR);
        GError *error = NULL;
        if (message)
            gst_message_parse_error(message, &error, NULL);
        CHECK_MSG(error && strstr(error->message, cases[i].words), "%s: %s", cases[i].caps,
                  error ? error->message : "no message");
        if (message)
            gst_message_unref(message);
        g_clear_error(&error);
        if (cases[i].unplug_at) {
            g_usleep(200000);
            CHECK((message = gst_bus_pop_filtered(c.bus, GST_MESSAGE_ERROR)) == NULL);
        }
        unplug(&c);
    }
}

static void test_sizes(void)
{
    static const struct {
        const char *caps;
        gint width, height;
    } cases[] = {{"video/x-raw, format=RGB", 0, 0},
                 {"video/x-raw, format=I420, width=[200,700], height=[1,600]", 320, 240},
                 {"video/x-raw, format=BGRx, width=32, height=24, framerate=60/1", 32, 24},
                 {"video/x-raw, format={NV12,RGBA}, width=[1,100]", 64, 48}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        camera c;
        const fake_v4l2_config config = usual();
        plug(&c, &config);
        gst_harness_set_sink_caps_str(c.h, cases[i].caps);
        gst_harness_play(c.h);
        GstBuffer *got = gst_harness_pull(c.h);
        GstCaps *caps = gst_pad_get_current_caps(c.h->sinkpad);
        GstVideoInfo info;
        CHECK(got && gst_video_info_from_caps(&info, caps) && gst_buffer_get_size(got) >= info.size);
        CHECK_MSG(!cases[i].width || (info.width == cases[i].width && info.height == cases[i].height), "%dx%d",
                  info.width, info.height);
        gst_caps_unref(caps);
        gst_buffer_unref(got);
        unplug(&c);
    }
}

/* --- threads and states --- */

static gint is_over;

static gpointer turn(gpointer element)
{
    for (int i = 0; !g_atomic_int_get(&is_over); i++) {
        double gain;
        gchar *text, *range;
        g_object_set(element, "exposure-value", i % 5 - 2.0, "ae-lock", i % 2, "ae-metering", i % 3,
                     "exposure-time-range", i % 2 ? "200 5000" : "", "gain-range", i % 3 ? "1 4" : "", "ae-antibanding",
                     i % 4, NULL);
        g_object_get(element, "gain", &gain, "state", &text, "exposure-time-range", &range, NULL);
        g_free(text);
        g_free(range);
        g_usleep(100);
    }
    return NULL;
}

static void test_threads(void)
{
    camera c;
    const fake_v4l2_config config = usual();
    plug(&c, &config);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=320, height=240");
    gst_harness_play(c.h);
    GThread *thread = g_thread_new("turn", turn, c.h->element);
    for (int i = 0; i < 60; i++)
        gst_buffer_unref(gst_harness_pull(c.h));
    g_atomic_int_set(&is_over, 1);
    g_thread_join(thread);
    unplug(&c);
}

static void test_range(void)
{
    camera c;
    const fake_v4l2_config config = usual();
    double exposure_us = 0.0;
    plug(&c, &config);
    g_object_set(c.h->element, "exposure-time-range", "200 2000", "ae-antibanding", 0, NULL);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=320, height=240");
    gst_harness_play(c.h);
    for (int i = 0; i < 40; i++)
        gst_buffer_unref(gst_harness_pull(c.h));
    g_object_get(c.h->element, "exposure-time", &exposure_us, NULL);
    CHECK_MSG(exposure_us >= 199.0 && exposure_us <= 2001.0, "%g us", exposure_us);
    unplug(&c);
}

static void test_states(void)
{
    static const GstState states[] = {GST_STATE_PLAYING, GST_STATE_PAUSED, GST_STATE_PLAYING,
                                      GST_STATE_READY,   GST_STATE_PAUSED, GST_STATE_NULL};
    camera c;
    const fake_v4l2_config config = usual();
    plug(&c, &config);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=320, height=240");
    gst_harness_play(c.h);
    for (int i = 0; i < 20; i++) {
        for (size_t k = 0; k < G_N_ELEMENTS(states); k++)
            CHECK(gst_element_set_state(c.h->element, states[k]) != GST_STATE_CHANGE_FAILURE);
    }
    gst_element_set_state(c.h->element, GST_STATE_PLAYING);
    GstBuffer *got = gst_harness_pull(c.h);
    CHECK(got != NULL);
    gst_buffer_unref(got);
    unplug(&c);
}

/* Downstream wants another size while it plays: the camera is opened again. */
static void test_another_size(void)
{
    static const gint widths[] = {320, 64, 32, 320};
    camera c;
    const fake_v4l2_config config = usual();
    plug(&c, &config);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=64, height=48");
    gst_harness_play(c.h);
    gst_buffer_unref(gst_harness_pull(c.h));
    for (size_t i = 0; i < G_N_ELEMENTS(widths); i++) {
        gchar *wanted = g_strdup_printf("video/x-raw, format=I420, width=%d", widths[i]);
        gst_harness_set_sink_caps_str(c.h, wanted);
        gint width = 0;
        for (int frames = 0; width != widths[i] && frames < 60; frames++) {
            gst_buffer_unref(gst_harness_pull(c.h));
            GstCaps *caps = gst_pad_get_current_caps(c.h->sinkpad);
            gst_structure_get_int(gst_caps_get_structure(caps, 0), "width", &width);
            gst_caps_unref(caps);
        }
        CHECK_MSG(width == widths[i], "%d in place of %d", width, widths[i]);
        g_free(wanted);
    }
    unplug(&c);
}

/* Without a clock there are no timestamps, and a stopped clock stops nothing. */
static void test_clocks(void)
{
    camera c;
    const fake_v4l2_config config = usual();
    for (int still = 0; still < 2; still++) {
        GstClockTime last = GST_CLOCK_TIME_NONE;
        plug(&c, &config);
        gst_element_set_clock(c.h->element, NULL);
        if (still)
            gst_harness_use_testclock(c.h);
        gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=32, height=24");
        gst_harness_play(c.h);
        for (int i = 0; i < 5; i++) {
            GstBuffer *got = gst_harness_pull(c.h);
            CHECK(still == GST_BUFFER_PTS_IS_VALID(got));
            CHECK(!still || !GST_CLOCK_TIME_IS_VALID(last) || GST_BUFFER_PTS(got) > last);
            last = GST_BUFFER_PTS(got);
            gst_buffer_unref(got);
        }
        unplug(&c);
    }
}

/* In hands-off mode controls are not touched. Of two elements on one camera the second is refused. */
static void test_hands_off(void)
{
    camera c;
    const fake_v4l2_config config = usual();
    plug(&c, &config);
    control(&c, V4L2_CID_EXPOSURE_AUTO, 1, V4L2_EXPOSURE_APERTURE_PRIORITY);
    g_object_set(c.h->element, "ae-enable", FALSE, NULL);
    gst_harness_set_sink_caps_str(c.h, "video/x-raw, format=NV12, width=320, height=240");
    gst_harness_play(c.h);
    gchar *state = NULL;
    for (int i = 0; i < 10; i++)
        gst_buffer_unref(gst_harness_pull(c.h));
    CHECK(control(&c, V4L2_CID_EXPOSURE_AUTO, 0, 0) == V4L2_EXPOSURE_APERTURE_PRIORITY);
    g_object_get(c.h->element, "state", &state, NULL);
    CHECK_MSG(strcmp(state, "settled") == 0 || strcmp(state, "adapting") == 0, "%s", state);
    g_free(state);
    GstHarness *second = gst_harness_new("pupilsrc");
    GstBus *bus = gst_bus_new();
    gst_element_set_bus(second->element, bus);
    gst_harness_set_sink_caps_str(second, "video/x-raw, format=NV12");
    gst_element_set_state(second->element, GST_STATE_PLAYING);
    GstMessage *message = gst_bus_timed_pop_filtered(bus, 20 * GST_SECOND, GST_MESSAGE_ERROR);
    GError *error = NULL;
    if (message)
        gst_message_parse_error(message, &error, NULL);
    CHECK_MSG(error && strstr(error->message, "another program is using the camera"), "%s",
              error ? error->message : "no message");
    g_clear_error(&error);
    if (message)
        gst_message_unref(message);
    gst_element_set_state(second->element, GST_STATE_NULL);
    gst_element_set_bus(second->element, NULL);
    gst_object_unref(bus);
    gst_harness_teardown(second);
    gst_buffer_unref(gst_harness_pull(c.h));
    unplug(&c);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    GST_PLUGIN_STATIC_REGISTER(pupil);
    test_stream();
    test_errors();
    test_sizes();
    test_range();
    test_threads();
    test_states();
    test_another_size();
    test_clocks();
    test_hands_off();
    return check_end();
}
