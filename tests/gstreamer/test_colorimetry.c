/* Colours of caps as pupil's coding; and the colours of a picture if downstream leaves a choice. */
#include "gstreamer/colorimetry.h"

#include <math.h>

#include "check.h"

/* `given`: range, matrix, transfer, primaries, in GStreamer's numbers. */
static GstVideoInfo coloured(const char *format, int height, const int given[4])
{
    GstVideoInfo info;
    CHECK(gst_video_info_set_format(&info, gst_video_format_from_string(format), 32, (guint)height));
    info.colorimetry = (GstVideoColorimetry){(GstVideoColorRange)given[0], (GstVideoColorMatrix)given[1],
                                             (GstVideoTransferFunction)given[2], (GstVideoColorPrimaries)given[3]};
    return info;
}

enum {
    RANGE_ANY = GST_VIDEO_COLOR_RANGE_UNKNOWN,
    FULL = GST_VIDEO_COLOR_RANGE_0_255,
    LIMITED = GST_VIDEO_COLOR_RANGE_16_235
};

static void test_in(void)
{
    static const struct {
        const char *format;
        int height;
        int given[4];
        uint32_t range, matrix, light, primaries;
        float black, white;
        const char *refused;
    } cases[] = {
        /* range */
        {"NV12", 16, {FULL, 4, 7, 1}, .range = PUPIL_RANGE_FULL, .light = PUPIL_LIGHT_SRGB},
        {"NV12", 16, {RANGE_ANY, 4, 7, 1}, .light = PUPIL_LIGHT_SRGB},
        {"RGBA", 16, {RANGE_ANY, 1, 7, 1}, .range = PUPIL_RANGE_FULL, .light = PUPIL_LIGHT_SRGB},
        {"GRAY8", 16, {RANGE_ANY, 0, 7, 1}, .range = PUPIL_RANGE_FULL, .light = PUPIL_LIGHT_SRGB},
        {"GRAY8", 16, {LIMITED, 0, 7, 1}, .light = PUPIL_LIGHT_SRGB, .black = 16, .white = 235},
        {"GRAY16_LE", 16, {LIMITED, 0, 0, 1}, .light = PUPIL_LIGHT_LINEAR, .black = 4096, .white = 60160},
        {"RGBx", 16, {LIMITED, 1, 7, 1}, .refused = "RGB of limited range"},
        /* matrix */
        {"NV12", 576, {LIMITED, 0, 7, 1}, .light = PUPIL_LIGHT_SRGB},
        {"NV12", 578, {LIMITED, 0, 7, 1}, .matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_SRGB},
        {"NV12", 16, {LIMITED, 6, 7, 1}, .matrix = PUPIL_MATRIX_BT2020, .light = PUPIL_LIGHT_SRGB},
        {"NV12", 16, {LIMITED, GST_VIDEO_COLOR_MATRIX_FCC, 7, 1}, .refused = "a matrix of BT.601"},
        /* light */
        {"NV12", 16, {LIMITED, 3, 0, 1}, .matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_SRGB},
        {"NV12", 16, {LIMITED, 3, 1, 1}, .matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_LINEAR},
        {"NV12",
         16,
         {LIMITED, 3, GST_VIDEO_TRANSFER_BT601, 1},
         .matrix = PUPIL_MATRIX_BT709,
         .light = PUPIL_LIGHT_BT709},
        {"NV12",
         16,
         {LIMITED, 3, GST_VIDEO_TRANSFER_BT2020_10, 1},
         .matrix = PUPIL_MATRIX_BT709,
         .light = PUPIL_LIGHT_BT709},
        {"RGB10A2_LE",
         16,
         {FULL, 1, GST_VIDEO_TRANSFER_SMPTE2084, 7},
         .range = PUPIL_RANGE_FULL,
         .light = PUPIL_LIGHT_PQ,
         .primaries = PUPIL_PRIMARIES_BT2020},
        {"RGBA", 16, {FULL, 1, GST_VIDEO_TRANSFER_BT709, 1}, .range = PUPIL_RANGE_FULL, .light = PUPIL_LIGHT_BT709},
        {"NV12", 16, {LIMITED, 3, GST_VIDEO_TRANSFER_LOG100, 1}, .refused = "a transfer of sRGB"},
        {"BGRx", 16, {FULL, 1, GST_VIDEO_TRANSFER_ARIB_STD_B67, 7}, .refused = "8-bit RGB is read as sRGB"},
        /* primaries */
        {"NV12", 16, {LIMITED, 4, 7, 0}, .light = PUPIL_LIGHT_SRGB},
        {"NV12",
         16,
         {LIMITED, 4, 7, GST_VIDEO_COLOR_PRIMARIES_SMPTE170M},
         .light = PUPIL_LIGHT_SRGB,
         .primaries = PUPIL_PRIMARIES_MATRIX},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        const GstVideoInfo info = coloured(cases[i].format, cases[i].height, cases[i].given);
        pupil_coding c;
        pupil_config config;
        pupil_why why = {""};
        pupil_config_default(&config);
        const int failed = colorimetry_in(&info, &c, &config, &why);
        CHECK_MSG(failed == (cases[i].refused ? -1 : 0), "case %zu: %s", i, why.text);
        if (cases[i].refused)
            CHECK_MSG(strstr(why.text, cases[i].refused) && strstr(why.text, cases[i].format), "case %zu: %s", i,
                      why.text);
        else
            CHECK_MSG(c.range == cases[i].range && c.matrix == cases[i].matrix && c.light == cases[i].light &&
                          config.primaries == cases[i].primaries && c.black == cases[i].black &&
                          c.white == cases[i].white,
                      "case %zu: range %u, matrix %u, light %u, primaries %u, %g to %g", i, c.range, c.matrix, c.light,
                      config.primaries, (double)c.black, (double)c.white);
    }
}

/* SMPTE RP 145's primaries: the middle row is the luminance of each (SMPTE 170M, RP 177), and white is D65's. */
static void test_primaries(void)
{
    static const double luminance[3] = {0.212, 0.701, 0.087}, white[3] = {0.9505, 1.0, 1.0891};
    const GstVideoInfo info =
        coloured("NV12", 16, (const int[4]){LIMITED, 4, GST_VIDEO_TRANSFER_BT601, GST_VIDEO_COLOR_PRIMARIES_SMPTE170M});
    pupil_coding coding;
    pupil_config config;
    pupil_why why;
    pupil_config_default(&config);
    CHECK(colorimetry_in(&info, &coding, &config, &why) == 0);
    const float *m = config.rgb_to_xyz;
    for (int i = 0; i < 3; i++) {
        CHECK_MSG(fabs((double)m[3 + i] - luminance[i]) < 5e-4, "luminance of %d is %g", i, (double)m[3 + i]);
        const double sum = (double)m[3 * i] + (double)m[3 * i + 1] + (double)m[3 * i + 2];
        CHECK_MSG(fabs(sum - white[i]) < 5e-4, "white has %g", sum);
    }
    CHECK(pupil_config_check(&config, NULL) == PUPIL_OK);
}

static void test_out(void)
{
    static const struct {
        const char *format;
        int given[4];
        uint32_t in; /* the input's primaries */
        uint32_t range, matrix, output;
        const char *refused;
    } cases[] = {
        {"NV12", {LIMITED, 3, 5, 1}, PUPIL_PRIMARIES_BT709, .matrix = PUPIL_MATRIX_BT709},
        {"NV12",
         {LIMITED, 3, 0, 0},
         PUPIL_PRIMARIES_BT2020,
         .matrix = PUPIL_MATRIX_BT709,
         .output = PUPIL_OUTPUT_BT709},
        {"NV12",
         {FULL, 6, GST_VIDEO_TRANSFER_BT2020_12, 7},
         PUPIL_PRIMARIES_BT709,
         .range = PUPIL_RANGE_FULL,
         .matrix = PUPIL_MATRIX_BT2020,
         .output = PUPIL_OUTPUT_BT2020},
        {"NV12", {LIMITED, 6, GST_VIDEO_TRANSFER_BT2020_10, 7}, PUPIL_PRIMARIES_BT2020, .matrix = PUPIL_MATRIX_BT2020},
        {"NV12", {LIMITED, 4, GST_VIDEO_TRANSFER_BT601, 1}, PUPIL_PRIMARIES_BT709, .matrix = PUPIL_MATRIX_BT601},
        {"RGB", {FULL, 1, 7, 1}, PUPIL_PRIMARIES_BT709, .range = PUPIL_RANGE_FULL},
        {"RGB", {LIMITED, 1, 7, 1}, PUPIL_PRIMARIES_BT709, .refused = "range is full in RGB"},
        {"NV12",
         {LIMITED, GST_VIDEO_COLOR_MATRIX_SMPTE240M, 7, 1},
         PUPIL_PRIMARIES_BT709,
         .refused = "its matrix that"},
        {"NV12", {LIMITED, 3, 1, 1}, PUPIL_PRIMARIES_BT709, .refused = "the picture is SDR"},
        {"NV12",
         {LIMITED, 3, 7, GST_VIDEO_COLOR_PRIMARIES_SMPTE170M},
         PUPIL_PRIMARIES_BT709,
         .refused = "the picture is SDR"},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        const GstVideoInfo info = coloured(cases[i].format, 16, cases[i].given);
        pupil_coding c;
        pupil_config config;
        pupil_why why = {""};
        pupil_config_default(&config);
        config.primaries = cases[i].in;
        const int failed = colorimetry_out(&info, &c, &config, &why);
        CHECK_MSG(failed == (cases[i].refused ? -1 : 0), "case %zu: %s", i, why.text);
        if (cases[i].refused)
            CHECK_MSG(strstr(why.text, cases[i].refused), "case %zu: %s", i, why.text);
        else
            CHECK_MSG(c.range == cases[i].range && c.matrix == cases[i].matrix &&
                          config.output_primaries == cases[i].output,
                      "case %zu: range %u, matrix %u, primaries %u", i, c.range, c.matrix, config.output_primaries);
    }
}

/* From what downstream accepts: the input's own if it is open, else the first of a list that a picture can have, else
 * as is. */
static void test_fixate(void)
{
    static const struct {
        const char *format, *given, *chosen; /* given NULL: open; chosen NULL: still a list */
    } cases[] = {{"NV12", NULL, "2:3:7:1"},
                 {"RGB", NULL, "sRGB"},
                 {"NV12", "(string){ bt2100-pq, bt709, sRGB }", "bt709"},
                 {"NV12", "(string){ bt2100-pq, nonsense }", NULL},
                 {"NV12", "(int){ 1, 2 }", NULL},
                 {"NV12", "(string)bt2100-hlg", "bt2100-hlg"}};
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        gchar *text = g_strdup_printf("video/x-raw, format=%s%s%s", cases[i].format,
                                      cases[i].given ? ", colorimetry=" : "", cases[i].given ? cases[i].given : "");
        GstStructure *structure = gst_structure_from_string(text, NULL);
        colorimetry_fixate(structure, gst_video_format_from_string(cases[i].format));
        const gchar *chosen = gst_structure_get_string(structure, "colorimetry");
        CHECK_MSG(g_strcmp0(chosen, cases[i].chosen) == 0, "%s: %s", text, chosen ? chosen : "not chosen");
        gst_structure_free(structure);
        g_free(text);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    test_in();
    test_primaries();
    test_out();
    test_fixate();
    return check_end();
}
