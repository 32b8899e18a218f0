/* pupilsrc at its start and end: impossible caps, latency before a camera is open, a downstream pool, a stream that
 * ends by itself, controls that hang or cannot be restored. */
#include <errno.h>
#include <linux/videodev2.h>

#include "check.h"
#include "element.h"
#include "gstreamer/elements.h"
#include "refusing_camera.h"

GST_PLUGIN_STATIC_DECLARE(pupil);

static GstBus *bus;

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.real_time = 1;
    config.fps = 60;
    return config;
}

/* `element`: pupilsrc, or a bin that begins with it. */
static GstHarness *plug(const fake_v4l2_config *config, const char *element, const char *caps)
{
    plug_camera(config);
    pupilsrc_system = &rig.system;
    GstHarness *h = gst_harness_new_parse(element);
    gst_harness_use_systemclock(h);
    bus = gst_bus_new();
    gst_element_set_bus(h->element, bus);
    gst_harness_set_sink_caps_str(h, caps);
    return h;
}

static void unplug(GstHarness *h)
{
    gst_element_set_state(h->element, GST_STATE_NULL);
    gst_element_set_bus(h->element, NULL);
    gst_object_unref(bus);
    gst_harness_teardown(h);
    while (fake_v4l2_holds(rig.fake).files) /* until a hanging write ends; the test has a time limit */
        g_usleep(10000);
    fake_v4l2_free(rig.fake);
    pupilsrc_system = NULL;
}

/* The next message of this type has these words. */
static void check_said(GstMessageType type, const char *words)
{
    GstMessage *message = gst_bus_timed_pop_filtered(bus, 10 * GST_SECOND, type);
    GError *error = NULL;
    if (message && type == GST_MESSAGE_WARNING)
        gst_message_parse_warning(message, &error, NULL);
    else if (message)
        gst_message_parse_error(message, &error, NULL);
    CHECK_MSG(error && strstr(error->message, words), "%s", error ? error->message : "no message");
    g_clear_error(&error);
    if (message)
        gst_message_unref(message);
}

static void test_latency(void)
{
    const fake_v4l2_config config = usual();
    GstHarness *h = plug(&config, "pupilsrc", "video/x-raw, format=NV12, width=32, height=24");
    GstElement *source = gst_harness_find_element(h, "pupilsrc");
    GstQuery *query = gst_query_new_latency();
    CHECK(!gst_element_query(source, query)); /* unknown before there is a rate */
    gst_harness_play(h);
    gst_buffer_unref(gst_harness_pull(h));
    CHECK(gst_element_query(source, query));
    gst_element_set_state(h->element, GST_STATE_READY);
    CHECK(!gst_element_query(source, query));
    gst_query_unref(query);
    gst_object_unref(source);
    unplug(h);
}

static void test_no_caps(void)
{
    const fake_v4l2_config config = usual();
    GstHarness *h = plug(&config, "pupilsrc", "audio/x-raw");
    gst_element_set_state(h->element, GST_STATE_PLAYING);
    check_said(GST_MESSAGE_ERROR, "stream");
    unplug(h);
}

/* If caps are requested again unchanged, the camera stays open, and its frames continue. */
static void test_same_caps(void)
{
    const fake_v4l2_config config = usual();
    GstHarness *h = plug(&config, "pupilsrc", "video/x-raw, format=NV12, width=32, height=24");
    gst_harness_play(h);
    guint64 last = 0;
    for (int i = 0; i < 6; i++) {
        gst_harness_push_upstream_event(h, gst_event_new_reconfigure());
        GstBuffer *got = gst_harness_pull(h);
        CHECK(GST_BUFFER_OFFSET(got) >= last);
        last = GST_BUFFER_OFFSET(got);
        gst_buffer_unref(got);
    }
    CHECK_MSG(last >= 5, "frame %u", (unsigned)last); /* a reopened one counts from 0 */
    unplug(h);
}

/* Downstream brings a pool, so none is created here. */
static void test_pool(void)
{
    const fake_v4l2_config config = usual();
    GstHarness *h = plug(&config, "pupilsrc ! pupilae", "video/x-raw, format=NV12, width=32, height=24");
    gst_harness_play(h);
    for (int i = 0; i < 3; i++) {
        GstBuffer *got = gst_harness_pull(h);
        CHECK(got && gst_buffer_get_size(got) == 32 * 24 * 3 / 2);
        gst_buffer_unref(got);
    }
    unplug(h);
}

static void test_end(void)
{
    fake_v4l2_config config = usual();
    config.end_at = 5;
    GstHarness *h = plug(&config, "pupilsrc", "video/x-raw, format=NV12, width=32, height=24");
    gst_harness_play(h);
    GstEvent *event = NULL;
    for (int ended = 0; !ended && (event = gst_harness_pull_event(h));) {
        ended = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
        gst_event_unref(event);
    }
    CHECK(event != NULL && gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR) == NULL);
    unplug(h);
}

/* A stop must not wait forever: a warning each, in words. */
static void test_not_given_back(void)
{
    fake_v4l2_config config = usual();
    GstHarness *h = plug(&config, "pupilsrc", "video/x-raw, format=NV12, width=32, height=24");
    gst_harness_play(h);
    for (int i = 0; i < 5; i++)
        gst_buffer_unref(gst_harness_pull(h));
    rig.refuses = 1;
    gst_element_set_state(h->element, GST_STATE_READY);
    check_said(GST_MESSAGE_WARNING, "/dev/video0");
    unplug(h);

    h = plug(&config, "pupilsrc", "video/x-raw, format=NV12, width=32, height=24");
    gst_harness_play(h);
    gst_buffer_unref(gst_harness_pull(h));
    config.sleep_s = 4.0;
    config.sleep_at = 1;
    fake_v4l2_reconfigure(rig.fake, &config);
    fake_v4l2_light(rig.fake, 20.0); /* so that a setting is written */
    for (int i = 0; i < 20; i++)
        gst_buffer_unref(gst_harness_pull(h));
    gst_element_set_state(h->element, GST_STATE_READY);
    check_said(GST_MESSAGE_WARNING, "a control's write hangs");
    unplug(h);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    GST_PLUGIN_STATIC_REGISTER(pupil);
    test_latency();
    test_no_caps();
    test_same_caps();
    test_pool();
    test_end();
    test_not_given_back();
    return check_end();
}
