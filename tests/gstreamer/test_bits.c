/* pupilae's frames are those of pupil_process, bit for bit: every format in and out, odd and tiny sizes, padded rows,
 * and the colours of the caps. */
#include "check.h"
#include "element.h"

static const struct {
    const char *format;
    uint32_t pixel;
} ins[] = {{"P010_10LE", PUPIL_PIXEL_P010},     {"I420_10LE", PUPIL_PIXEL_I420_10}, {"Y444_16LE", PUPIL_PIXEL_I444_16},
           {"RGB10A2_LE", PUPIL_PIXEL_RGB10A2}, {"NV12", PUPIL_PIXEL_NV12},         {"I420", PUPIL_PIXEL_I420},
           {"YV12", PUPIL_PIXEL_I420},          {"NV21", PUPIL_PIXEL_NV21},         {"NV16", PUPIL_PIXEL_NV16},
           {"YUY2", PUPIL_PIXEL_YUYV},          {"UYVY", PUPIL_PIXEL_UYVY},         {"RGBA", PUPIL_PIXEL_RGBA8},
           {"RGBx", PUPIL_PIXEL_RGBX8},         {"BGRx", PUPIL_PIXEL_BGRX8},        {"RGB", PUPIL_PIXEL_RGB8},
           {"BGR", PUPIL_PIXEL_BGR8},           {"GRAY16_LE", PUPIL_PIXEL_GREY16},  {"GRAY8", PUPIL_PIXEL_GREY8}};
static const struct {
    const char *format;
    uint32_t pixel;
    int is_yuv;
} outs[] = {{"NV12", PUPIL_PIXEL_NV12, 1},  {"I420", PUPIL_PIXEL_I420, 1},  {"YV12", PUPIL_PIXEL_I420, 1},
            {"RGBA", PUPIL_PIXEL_RGBA8, 0}, {"RGBx", PUPIL_PIXEL_RGBA8, 0}, {"BGRx", PUPIL_PIXEL_BGRX8, 0},
            {"RGB", PUPIL_PIXEL_RGB8, 0},   {"BGR", PUPIL_PIXEL_BGR8, 0}};

/* The coding for pupil that corresponds to a colorimetry in caps. */
typedef struct colours {
    const char *in, *out; /* caps; NULL: open */
    pupil_coding in_coding, out_coding;
    uint32_t primaries, output_primaries;
    uint32_t curve, accuracy; /* accuracy luma: without dither */
} colours;

/* 4 frames of random samples through the element and through pupil_process. */
static void compare(const char *in_format, uint32_t in_pixel, const char *out_format, uint32_t out_pixel,
                    uint32_t width, uint32_t height, uint32_t padding, const colours *c)
{
    GstHarness *h = gst_harness_new("pupilae");
    gchar *in_caps = caps_text(in_format, width, height, c->in),
          *out_caps = caps_text(out_format, width, height, c->out);
    pupil_t pupil;
    pupil_config config;
    pupil_config_default(&config);
    config.primaries = c->primaries;
    config.output_primaries = c->output_primaries;
    config.dither = c->accuracy == PUPIL_ACCURACY_EXACT;
    config.curve = c->curve;
    config.accuracy = c->accuracy;
    g_object_set(h->element, "tone", (gint)c->curve, "accuracy", (gint)c->accuracy, "dither", (gboolean)config.dither,
                 NULL);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    gst_harness_set_sink_caps_str(h, out_caps);
    gst_harness_set_src_caps_str(h, in_caps);
    for (int i = 0; i < 4; i++) {
        const GstClockTime pts = (GstClockTime)i * 33333333;
        pupil_image in = picture_make(in_pixel, width, height, 1), out = picture_make(out_pixel, width, height, 0);
        in.coding = &c->in_coding;
        out.coding = &c->out_coding;
        const pupil_image_const read = pupil_image_as_const(in);
        const pupil_frame_info info = {.timestamp_ns = (int64_t)pts};
        CHECK(pupil_process(&pupil, &read, &info, &out) == PUPIL_OK);
        GstBuffer *got = gst_harness_push_and_pull(h, buffer_of(in_format, &in, padding, pts));
        GstCaps *caps = gst_pad_get_current_caps(h->sinkpad);
        CHECK_MSG(got && caps && is_same(got, caps, &out), "%s %s to %s, %ux%u, %u bytes of padding, frame %d",
                  in_format, c->in ? c->in : "", out_format, width, height, padding, i);
        CHECK(got && GST_BUFFER_PTS(got) == pts);
        if (got)
            gst_buffer_unref(got);
        if (caps)
            gst_caps_unref(caps);
        free(in.data);
        free(out.data);
    }
    g_free(in_caps);
    g_free(out_caps);
    gst_harness_teardown(h);
}

static void test_formats(void)
{
    static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {17, 2}, {66, 49}};
    for (size_t i = 0; i < G_N_ELEMENTS(ins); i++) {
        for (size_t o = 0; o < G_N_ELEMENTS(outs); o++) {
            const size_t s = (i + o) % G_N_ELEMENTS(sizes);
            colours c = {.in = "2:4:7:1", .out = outs[o].is_yuv ? "2:3:7:1" : "1:1:7:1"};
            c.in_coding.light = PUPIL_LIGHT_SRGB;
            c.out_coding.matrix = PUPIL_MATRIX_BT709;
            if (ins[i].pixel == PUPIL_PIXEL_GREY8 || ins[i].pixel == PUPIL_PIXEL_GREY16 ||
                strstr(ins[i].format, "RGB") || strstr(ins[i].format, "BGR"))
                c.in = strstr(ins[i].format, "GB") || strstr(ins[i].format, "BG") ? "1:1:7:1" : "1:4:7:1";
            compare(ins[i].format, ins[i].pixel, outs[o].format, outs[o].pixel, sizes[s][0], sizes[s][1],
                    o % 2 ? 64 : 0, &c);
        }
    }
}

static void test_colours(void)
{
    static const struct {
        const char *format;
        uint32_t pixel;
        colours colours;
    } cases[] = {
        {"P010_10LE",
         PUPIL_PIXEL_P010,
         {.in = "bt2100-pq",
          .in_coding = {.matrix = PUPIL_MATRIX_BT2020, .light = PUPIL_LIGHT_PQ},
          .primaries = PUPIL_PRIMARIES_BT2020,
          .output_primaries = PUPIL_OUTPUT_BT709}},
        {"I420_10LE",
         PUPIL_PIXEL_I420_10,
         {.in = "bt2100-hlg",
          .in_coding = {.matrix = PUPIL_MATRIX_BT2020, .light = PUPIL_LIGHT_HLG},
          .primaries = PUPIL_PRIMARIES_BT2020,
          .output_primaries = PUPIL_OUTPUT_BT709}},
        {"I420_10LE",
         PUPIL_PIXEL_I420_10,
         {.in = "bt2100-pq",
          .out = "1:3:5:7", /* full, BT.709's matrix and curve, BT.2020's primaries */
          .in_coding = {.matrix = PUPIL_MATRIX_BT2020, .light = PUPIL_LIGHT_PQ},
          .out_coding = {.matrix = PUPIL_MATRIX_BT709, .range = PUPIL_RANGE_FULL},
          .primaries = PUPIL_PRIMARIES_BT2020}},
        {"NV12",
         PUPIL_PIXEL_NV12,
         {.in = "bt709", .in_coding = {.matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_BT709}}},
        {"YUY2",
         PUPIL_PIXEL_YUYV,
         {.in = "1:4:0:0", /* JPEG: full range, BT.601's matrix, the rest open */
          .in_coding = {.range = PUPIL_RANGE_FULL, .light = PUPIL_LIGHT_SRGB}}},
        {"I420",
         PUPIL_PIXEL_I420,
         {.in = "2:6:11:7", /* BT.2020 SDR */
          .in_coding = {.matrix = PUPIL_MATRIX_BT2020, .light = PUPIL_LIGHT_BT709},
          .primaries = PUPIL_PRIMARIES_BT2020,
          .output_primaries = PUPIL_OUTPUT_BT709}},
        {"GRAY16_LE", PUPIL_PIXEL_GREY16, {.in = "1:4:1:1", .in_coding = {.light = PUPIL_LIGHT_LINEAR}}},
        {"GRAY8",
         PUPIL_PIXEL_GREY8,
         {.in = "2:4:5:1", .in_coding = {.light = PUPIL_LIGHT_BT709, .black = 16, .white = 235}}},
        {"RGB10A2_LE",
         PUPIL_PIXEL_RGB10A2,
         {.in = "1:1:14:7",
          .in_coding = {.light = PUPIL_LIGHT_PQ},
          .primaries = PUPIL_PRIMARIES_BT2020,
          .output_primaries = PUPIL_OUTPUT_BT709}},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        colours c = cases[i].colours;
        if (!c.out) { /* its own: limited, BT.709 */
            c.out_coding.matrix = PUPIL_MATRIX_BT709;
            c.out = NULL;
        }
        compare(cases[i].format, cases[i].pixel, "NV12", PUPIL_PIXEL_NV12, 34, 18, 0, &c);
    }
}

/* tone and accuracy are the configuration's curve and accuracy, and change the picture. */
static void test_choices(void)
{
    for (uint32_t curve = 0; curve < PUPIL_CURVE_COUNT; curve++) {
        for (uint32_t accuracy = 0; accuracy < PUPIL_ACCURACY_COUNT; accuracy++) {
            const colours c = {.in = "bt709",
                               .in_coding = {.matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_BT709},
                               .out_coding = {.matrix = PUPIL_MATRIX_BT709},
                               .curve = curve,
                               .accuracy = accuracy};
            compare("NV12", PUPIL_PIXEL_NV12, "NV12", PUPIL_PIXEL_NV12, 34, 18, 0, &c);
        }
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    test_formats();
    test_colours();
    test_choices();
    return check_end();
}
