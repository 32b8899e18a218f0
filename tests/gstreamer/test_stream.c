/* pupilae in a stream: caps that it accepts and refuses, caps that change, flush, seek, discontinuities and end,
 * messages and metas, properties from another thread. */
#include <math.h>

#include "check.h"
#include "element.h"

enum { WIDTH = 32, HEIGHT = 16 };

typedef struct stream {
    GstHarness *h;
    GstBus *bus;
    double adapted_ev, dt; /* of the last frame */
    gchar *state;
} stream;

static stream stream_open(void)
{
    stream s = {.h = gst_harness_new("pupilae"), .bus = gst_bus_new()};
    gst_element_set_bus(s.h->element, s.bus);
    gst_harness_set_src_caps_str(s.h, "video/x-raw, format=GRAY8, width=32, height=16, framerate=30/1, "
                                      "colorimetry=1:4:1:1");
    return s;
}

static void stream_close(stream *s)
{
    gst_element_set_bus(s->h->element, NULL);
    gst_object_unref(s->bus);
    gst_harness_teardown(s->h);
    g_free(s->state);
}

/* Pushes a frame of one grey, in linear light; its numbers go into the stream. 0: it did not come out. */
static int show(stream *s, unsigned code, GstClockTime pts, GstBufferFlags flags)
{
    pupil_image in = picture_make(PUPIL_PIXEL_GREY8, WIDTH, HEIGHT, 0);
    memset(in.data, (int)code, WIDTH * HEIGHT);
    GstBuffer *buffer = buffer_of("GRAY8", &in, 0, pts);
    GST_BUFFER_FLAG_SET(buffer, flags);
    free(in.data);
    GstBuffer *got = gst_harness_push_and_pull(s->h, buffer);
    GstCustomMeta *meta = got ? gst_buffer_get_custom_meta(got, "PupilFrame") : NULL;
    CHECK(meta != NULL);
    if (meta) {
        const GstStructure *numbers = gst_custom_meta_get_structure(meta);
        g_free(s->state);
        s->state = g_strdup(gst_structure_get_string(numbers, "state"));
        CHECK(gst_structure_get_double(numbers, "adapted-ev", &s->adapted_ev));
        CHECK(gst_structure_get_double(numbers, "dt", &s->dt));
    }
    if (got)
        gst_buffer_unref(got);
    return meta != NULL;
}

static int is_at(const stream *s, unsigned code)
{
    return fabs(s->adapted_ev - log2(code / 255.0)) < 0.01;
}

/* Frames of 1/30 s, at whose end the level is that of `code`. */
static GstClockTime settle(stream *s, unsigned code, GstClockTime pts)
{
    for (int i = 0; i < 300; i++, pts += GST_SECOND / 30)
        show(s, code, pts, 0);
    CHECK(is_at(s, code) && strcmp(s->state, "settled") == 0);
    return pts;
}

static void test_forgets(void)
{
    stream s = stream_open();
    GstClockTime pts = settle(&s, 200, 0);
    /* frames that a leaky queue dropped */
    pts += GST_SECOND / 2;
    show(&s, 40, pts, GST_BUFFER_FLAG_DISCONT);
    CHECK(!is_at(&s, 40) && !is_at(&s, 200) && fabs(s.dt - 0.5333) < 0.001);
    /* another time */
    pts += 2 * GST_SECOND;
    show(&s, 20, pts, GST_BUFFER_FLAG_DISCONT);
    CHECK(is_at(&s, 20) && s.dt == 0.0);
    show(&s, 200, pts + GST_SECOND / 30, 0);
    CHECK(!is_at(&s, 200));
    show(&s, 30, 0, GST_BUFFER_FLAG_DISCONT); /* back */
    CHECK(is_at(&s, 30));
    /* a pause without a discontinuity: dt */
    show(&s, 200, GST_SECOND, 0);
    CHECK(!is_at(&s, 200) && fabs(s.dt - 1.0) < 0.001);
    /* a seek: flush, another segment */
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.start = segment.time = 30 * GST_SECOND;
    gst_harness_push_event(s.h, gst_event_new_flush_start());
    gst_harness_push_event(s.h, gst_event_new_flush_stop(TRUE));
    gst_harness_push_event(s.h, gst_event_new_segment(&segment));
    show(&s, 60, 31 * GST_SECOND, 0);
    CHECK(is_at(&s, 60));
    /* played backwards: running time continues */
    segment.rate = -1.0;
    segment.start = 0;
    segment.stop = 31 * GST_SECOND;
    segment.base = 2 * GST_SECOND;
    gst_harness_push_event(s.h, gst_event_new_segment(&segment));
    show(&s, 60, 30 * GST_SECOND + GST_SECOND / 2, 0);
    show(&s, 60, 30 * GST_SECOND, 0);
    CHECK(fabs(s.dt - 0.5) < 0.001);
    stream_close(&s);
}

/* Frames without timestamps, and timestamps outside the segment, are a frame's period apart. */
static void test_no_time(void)
{
    stream s = stream_open();
    for (int i = 0; i < 3; i++)
        show(&s, 50, GST_CLOCK_TIME_NONE, 0);
    CHECK(fabs(s.dt - 1.0 / 30.0) < 1e-6);
    stream_close(&s);
}

/* appsrc's segment is in bytes unless configured otherwise. */
static void test_bytes(void)
{
    stream s = stream_open();
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_BYTES);
    gst_harness_push_event(s.h, gst_event_new_segment(&segment));
    show(&s, 50, GST_SECOND, 0);
    show(&s, 50, GST_SECOND + GST_SECOND / 10, 0);
    CHECK(fabs(s.dt - 0.1) < 1e-6);
    stream_close(&s);
}

static void test_messages(void)
{
    stream s = stream_open();
    static const char *const states[] = {"settled", "adapting", "settled", "locked"};
    GstClockTime pts = settle(&s, 200, 0);
    pts = settle(&s, 60, pts);
    g_object_set(s.h->element, "ae-lock", TRUE, NULL);
    show(&s, 60, pts, 0);
    for (size_t i = 0; i < G_N_ELEMENTS(states); i++) {
        GstStructure *message = next_message(s.bus);
        CHECK_MSG(message && strcmp(gst_structure_get_string(message, "state"), states[i]) == 0, "message %zu: %s", i,
                  message ? gst_structure_get_string(message, "state") : "none");
        CHECK(message && gst_structure_has_name(message, "pupilae") && gst_structure_has_field(message, "adapted-ev") &&
              gst_structure_has_field(message, "running-time"));
        if (message)
            gst_structure_free(message);
    }
    CHECK(next_message(s.bus) == NULL);
    stream_close(&s);
}

static void test_properties(void)
{
    stream s = stream_open();
    static const char *const given[][2] = {
        {"exposure-value", "1"}, {"roi", "0.5,0.5,0.25,0.25"}, {"ae-metering", "spot"}, {"tau-dark", "0"}};
    for (size_t i = 0; i < G_N_ELEMENTS(given); i++)
        gst_util_set_object_arg(G_OBJECT(s.h->element), given[i][0], given[i][1]);
    double ev, tau;
    gchar *roi;
    gint state;
    gboolean locked;
    show(&s, 200, 0, 0);
    show(&s, 20, GST_SECOND / 30, 0);
    CHECK(is_at(&s, 20)); /* tau-dark */
    g_object_get(s.h->element, "exposure-value", &ev, "roi", &roi, "tau-dark", &tau, "state", &state, "ae-lock",
                 &locked, NULL);
    CHECK(ev == 1.0 && tau == 0.0 && strcmp(roi, "0.5,0.5,0.25,0.25") == 0 && state == PUPIL_STATE_SETTLED && !locked);
    g_free(roi);
    g_object_set(s.h->element, "roi", "", NULL);
    g_object_get(s.h->element, "roi", &roi, NULL);
    CHECK(strcmp(roi, "") == 0);
    g_free(roi);
    stream_close(&s);
}

/* --- caps --- */

static void test_colorimetry_of_src(void)
{
    static const struct {
        const char *format, *colorimetry;
    } cases[] = {{"NV12", "2:3:7:1"}, {"I420", "2:3:7:1"}, {"RGBA", "sRGB"}, {"BGR", "sRGB"}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        stream s = {.h = gst_harness_new("pupilae"), .bus = gst_bus_new()};
        gchar *wanted = g_strdup_printf("video/x-raw, format=%s", cases[i].format);
        gst_harness_set_sink_caps_str(s.h, wanted);
        gst_harness_set_src_caps_str(s.h,
                                     "video/x-raw, format=P010_10LE, width=32, height=16, framerate=30/1, "
                                     "colorimetry=bt2100-pq, chroma-site=mpeg2, content-light-level=(string)1000:100");
        pupil_image in = picture_make(PUPIL_PIXEL_P010, WIDTH, HEIGHT, 1);
        gst_buffer_unref(gst_harness_push_and_pull(s.h, buffer_of("P010_10LE", &in, 0, 0)));
        free(in.data);
        GstCaps *caps = gst_pad_get_current_caps(s.h->sinkpad);
        const GstStructure *structure = gst_caps_get_structure(caps, 0);
        CHECK_MSG(strcmp(gst_structure_get_string(structure, "colorimetry"), cases[i].colorimetry) == 0, "%s",
                  gst_structure_get_string(structure, "colorimetry"));
        CHECK(!gst_structure_has_field(structure, "content-light-level"));
        gst_caps_unref(caps);
        g_free(wanted);
        stream_close(&s);
    }
}

/* If downstream has no preference: the input's own format, or RGBA for RGB, or NV12. */
static void test_format_of_src(void)
{
    static const struct {
        const char *in, *out;
        uint32_t pixel;
    } cases[] = {{"I420", "I420", PUPIL_PIXEL_I420},
                 {"BGR", "BGR", PUPIL_PIXEL_BGR8},
                 {"RGB10A2_LE", "RGBA", PUPIL_PIXEL_RGB10A2},
                 {"GRAY8", "NV12", PUPIL_PIXEL_GREY8},
                 {"P010_10LE", "NV12", PUPIL_PIXEL_P010}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        GstHarness *h = gst_harness_new("pupilae");
        gchar *in = caps_text(cases[i].in, WIDTH, HEIGHT, NULL);
        gst_harness_set_src_caps_str(h, in);
        pupil_image picture = picture_make(cases[i].pixel, WIDTH, HEIGHT, 1);
        gst_buffer_unref(gst_harness_push_and_pull(h, buffer_of(cases[i].in, &picture, 0, 0)));
        free(picture.data);
        GstCaps *caps = gst_pad_get_current_caps(h->sinkpad);
        const gchar *format = gst_structure_get_string(gst_caps_get_structure(caps, 0), "format");
        CHECK_MSG(strcmp(format, cases[i].out) == 0, "%s becomes %s", cases[i].in, format);
        gst_caps_unref(caps);
        g_free(in);
        gst_harness_teardown(h);
    }
}

/* A sentence on the bus for what cannot be read or made. */
static void test_refused(void)
{
    static const struct {
        const char *in, *out, *words;
    } cases[] = {{"format=RGBA, colorimetry=1:1:14:7", "format=NV12", "8-bit RGB is read as sRGB"},
                 {"format=RGB, colorimetry=2:1:7:1", "format=NV12", "RGB of limited range"},
                 {"format=NV12, colorimetry=2:3:9:1", "format=NV12", "a transfer of sRGB"},
                 {"format=NV12, colorimetry=smpte240m", "format=NV12", "a matrix of BT.601"},
                 {"format=NV12, colorimetry=bt709", "format=NV12, colorimetry=bt2100-pq", "the picture is SDR"},
                 {"format=NV12, colorimetry=bt709", "format=NV12, colorimetry=bt601", "the picture is SDR"}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        stream s = {.h = gst_harness_new("pupilae"), .bus = gst_bus_new()};
        gst_element_set_bus(s.h->element, s.bus);
        gchar *in = g_strdup_printf("video/x-raw, width=32, height=16, framerate=30/1, %s", cases[i].in);
        gchar *out = g_strdup_printf("video/x-raw, %s", cases[i].out);
        gst_harness_set_sink_caps_str(s.h, out);
        gst_harness_set_src_caps_str(s.h, in);
        CHECK_MSG(gst_harness_push(s.h, gst_buffer_new_allocate(NULL, 4 * WIDTH * HEIGHT, NULL)) ==
                      GST_FLOW_NOT_NEGOTIATED,
                  "%s", cases[i].in);
        GstMessage *message = gst_bus_pop_filtered(s.bus, GST_MESSAGE_ERROR);
        GError *error = NULL;
        if (message)
            gst_message_parse_error(message, &error, NULL);
        CHECK_MSG(error && strstr(error->message, cases[i].words), "%s", error ? error->message : "no message");
        g_clear_error(&error);
        if (message)
            gst_message_unref(message);
        g_free(in);
        g_free(out);
        stream_close(&s);
    }
}

/* Frames without timestamps: an unknown rate counts as 30 a second, and the slowest is a picture in eleven days.
 */
static void test_rates(void)
{
    static const struct {
        const char *rate;
        double dt;
    } cases[] = {{"0/1", 1.0 / 30.0}, {"5/1", 0.2}, {"1/2147483647", 1e6}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        stream s = stream_open();
        gchar *caps = g_strdup_printf("video/x-raw, format=GRAY8, width=32, height=16, framerate=%s", cases[i].rate);
        gst_harness_set_src_caps_str(s.h, caps);
        show(&s, 50, GST_CLOCK_TIME_NONE, 0);
        show(&s, 50, GST_CLOCK_TIME_NONE, 0);
        CHECK_MSG(fabs(s.dt / cases[i].dt - 1.0) < 1e-6, "%s: %g s", cases[i].rate, s.dt);
        g_free(caps);
        stream_close(&s);
    }
}

/* A new size keeps the level; a new transfer function or new primaries reset it. */
static void test_caps_change(void)
{
    stream s = stream_open();
    settle(&s, 200, 0);
    gst_harness_set_src_caps_str(s.h, "video/x-raw, format=GRAY8, width=16, height=32, framerate=30/1, "
                                      "colorimetry=1:4:1:1");
    show(&s, 20, 11 * GST_SECOND, 0);
    CHECK(!is_at(&s, 20));
    gst_harness_set_src_caps_str(s.h, "video/x-raw, format=GRAY8, width=16, height=32, framerate=30/1, "
                                      "colorimetry=1:4:7:1");
    show(&s, 255, 12 * GST_SECOND, 0);
    CHECK(is_at(&s, 255));
    gst_harness_set_src_caps_str(s.h, "video/x-raw, format=GRAY8, width=16, height=32, framerate=30/1, "
                                      "colorimetry=1:4:1:1");
    show(&s, 20, 13 * GST_SECOND, 0);
    gst_harness_set_src_caps_str(s.h, "video/x-raw, format=GRAY8, width=16, height=32, framerate=30/1, "
                                      "colorimetry=1:4:1:7");
    show(&s, 200, 14 * GST_SECOND, 0);
    CHECK(is_at(&s, 200));
    CHECK(gst_harness_push_event(s.h, gst_event_new_eos()));
    GstEvent *event;
    int ended = 0;
    while ((event = gst_harness_try_pull_event(s.h))) {
        ended |= GST_EVENT_TYPE(event) == GST_EVENT_EOS;
        gst_event_unref(event);
    }
    CHECK(ended);
    stream_close(&s);
}

/* Frames that do not match their caps are an error; one that is too short causes GstVideoFilter's own warning. Nothing
 * outside the buffer is touched. */
static void test_wrong_buffers(void)
{
    static const gint strides[] = {65, 63, 1, 0};
    for (size_t i = 0; i < G_N_ELEMENTS(strides); i++) {
        GstHarness *h = gst_harness_new("pupilae");
        gst_harness_set_src_caps_str(h, "video/x-raw, format=P010_10LE, width=32, height=16, framerate=30/1");
        GstBuffer *buffer = gst_buffer_new_allocate(NULL, (gsize)MAX(strides[i] * 24, 8), NULL);
        gst_buffer_memset(buffer, 0, 7, gst_buffer_get_size(buffer));
        gsize offset[GST_VIDEO_MAX_PLANES] = {0, (gsize)strides[i] * 16};
        gint stride[GST_VIDEO_MAX_PLANES] = {strides[i], strides[i]};
        if (strides[i])
            gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_P010_10LE, 32, 16, 2,
                                           offset, stride);
        CHECK_MSG((gst_harness_push(h, buffer) != GST_FLOW_OK) == (strides[i] != 0), "a stride of %d", strides[i]);
        gst_harness_teardown(h);
    }
}

/* From state to state, with many seeks, forwards and backwards. */
static void test_storms(void)
{
    GstElement *pipeline = gst_pipeline_new(NULL);
    gst_bin_add(GST_BIN(pipeline), gst_element_factory_make("pupilae", NULL));
    for (int i = 0; i < 100; i++) {
        CHECK(gst_element_set_state(pipeline, GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE);
        CHECK(gst_element_set_state(pipeline, i % 2 ? GST_STATE_READY : GST_STATE_NULL) != GST_STATE_CHANGE_FAILURE);
    }
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
    stream s = stream_open();
    for (int i = 0; i < 200; i++) {
        const GstClockTime at = check_random() % (100 * GST_SECOND);
        GstSegment segment;
        gst_segment_init(&segment, GST_FORMAT_TIME);
        segment.rate = i % 3 ? 1.0 : -2.0;
        segment.start = i % 3 ? at : 0;
        segment.stop = i % 3 ? GST_CLOCK_TIME_NONE : at + GST_SECOND;
        segment.time = segment.start;
        gst_harness_push_event(s.h, gst_event_new_flush_start());
        gst_harness_push_event(s.h, gst_event_new_flush_stop(TRUE));
        gst_harness_push_event(s.h, gst_event_new_segment(&segment));
        const unsigned code = 20 + (unsigned)i;
        CHECK(show(&s, code, at, GST_BUFFER_FLAG_DISCONT) && is_at(&s, code));
    }
    stream_close(&s);
}

/* --- threads --- */

static gint is_over;

static gpointer turn(gpointer element)
{
    for (int i = 0; !g_atomic_int_get(&is_over); i++) {
        double ev;
        gchar *roi;
        g_object_set(element, "exposure-value", i % 5 - 2.0, "ae-lock", i % 2, "ae-metering", i % 3, "roi",
                     i % 7 ? "" : "0.25,0.25,0.5,0.5", "dither", i % 2, "tone", i % 5, "accuracy", i % 2, NULL);
        g_object_get(element, "adapted-ev", &ev, "roi", &roi, NULL);
        g_free(roi);
    }
    return NULL;
}

static void test_threads(void)
{
    stream s = stream_open();
    GThread *threads[2];
    for (int i = 0; i < 2; i++)
        threads[i] = g_thread_new("turn", turn, s.h->element);
    for (int i = 0; i < 300; i++)
        CHECK(show(&s, 10 + i % 200, (GstClockTime)i * GST_SECOND / 30, 0));
    g_atomic_int_set(&is_over, 1);
    for (int i = 0; i < 2; i++)
        g_thread_join(threads[i]);
    stream_close(&s);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    test_forgets();
    test_no_time();
    test_bytes();
    test_messages();
    test_properties();
    test_colorimetry_of_src();
    test_format_of_src();
    test_rates();
    test_refused();
    test_caps_change();
    test_wrong_buffers();
    test_storms();
    test_threads();
    return check_end();
}
