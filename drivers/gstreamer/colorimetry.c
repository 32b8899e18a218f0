#include "colorimetry.h"

#include <string.h>

#include "refuse.h"

/* Rows from which on video of unknown matrix is HD: Rec. ITU-R BT.601-7 has 480 and 576. */
#define SD_ROWS 576

static int choose_range(const GstVideoInfo *info, uint32_t *range)
{
    const GstVideoColorRange given = info->colorimetry.range;
    const int whole = GST_VIDEO_INFO_IS_RGB(info) || GST_VIDEO_INFO_IS_GRAY(info);
    *range = given == GST_VIDEO_COLOR_RANGE_0_255 || (whole && given == GST_VIDEO_COLOR_RANGE_UNKNOWN)
                 ? PUPIL_RANGE_FULL
                 : PUPIL_RANGE_LIMITED;
    return GST_VIDEO_INFO_IS_RGB(info) && *range == PUPIL_RANGE_LIMITED ? -1 : 0;
}

static int choose_matrix(const GstVideoInfo *info, uint32_t *matrix)
{
    if (!GST_VIDEO_INFO_IS_YUV(info))
        return 0;
    switch (info->colorimetry.matrix) {
    case GST_VIDEO_COLOR_MATRIX_BT601:
        *matrix = PUPIL_MATRIX_BT601;
        return 0;
    case GST_VIDEO_COLOR_MATRIX_BT709:
        *matrix = PUPIL_MATRIX_BT709;
        return 0;
    case GST_VIDEO_COLOR_MATRIX_BT2020:
        *matrix = PUPIL_MATRIX_BT2020;
        return 0;
    case GST_VIDEO_COLOR_MATRIX_UNKNOWN:
        *matrix = GST_VIDEO_INFO_HEIGHT(info) > SD_ROWS ? PUPIL_MATRIX_BT709 : PUPIL_MATRIX_BT601;
        return 0;
    default:
        return -1;
    }
}

static int choose_light(const GstVideoInfo *info, uint32_t *light)
{
    switch (info->colorimetry.transfer) {
    case GST_VIDEO_TRANSFER_UNKNOWN:
        *light = GST_VIDEO_INFO_FORMAT(info) == GST_VIDEO_FORMAT_GRAY16_LE ? PUPIL_LIGHT_LINEAR : PUPIL_LIGHT_SRGB;
        return 0;
    case GST_VIDEO_TRANSFER_SRGB:
        *light = PUPIL_LIGHT_SRGB;
        return 0;
    case GST_VIDEO_TRANSFER_GAMMA10:
        *light = PUPIL_LIGHT_LINEAR;
        return 0;
    case GST_VIDEO_TRANSFER_BT709:
    case GST_VIDEO_TRANSFER_BT601:
    case GST_VIDEO_TRANSFER_BT2020_10:
    case GST_VIDEO_TRANSFER_BT2020_12: /* one curve */
        *light = PUPIL_LIGHT_BT709;
        return 0;
    case GST_VIDEO_TRANSFER_SMPTE2084:
        *light = PUPIL_LIGHT_PQ;
        return 0;
    case GST_VIDEO_TRANSFER_ARIB_STD_B67:
        *light = PUPIL_LIGHT_HLG;
        return 0;
    default:
        return -1;
    }
}

/* 8-bit RGB has no coding: pupil reads it as sRGB. SDR curves are taken for it. */
static int light_suits(const GstVideoInfo *info, uint32_t light)
{
    const int is_sdr = light == PUPIL_LIGHT_SRGB || light == PUPIL_LIGHT_BT709;
    return !GST_VIDEO_INFO_IS_RGB(info) || GST_VIDEO_INFO_FORMAT(info) == GST_VIDEO_FORMAT_RGB10A2_LE || is_sdr;
}

/* From RGB of these primaries to XYZ: SMPTE RP 177-1993, 3.3. The columns are the primaries, scaled so that R = G = B
 * is the white, which has Y = 1. */
static void find_rgb_to_xyz(const GstVideoColorPrimariesInfo *p, float rgb_to_xyz[9])
{
    const double x[3] = {p->Rx, p->Gx, p->Bx}, y[3] = {p->Ry, p->Gy, p->By};
    const double white[3] = {p->Wx / p->Wy, 1.0, (1.0 - p->Wx - p->Wy) / p->Wy};
    double column[3][3], cross[3][3];
    for (int i = 0; i < 3; i++) {
        column[i][0] = x[i];
        column[i][1] = y[i];
        column[i][2] = 1.0 - x[i] - y[i];
    }
    for (int i = 0; i < 3; i++) { /* cross[i] is at right angles to the two other columns (Cramer's rule) */
        const double *a = column[(i + 1) % 3], *b = column[(i + 2) % 3];
        for (int k = 0; k < 3; k++)
            cross[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    for (int i = 0; i < 3; i++) {
        double along = 0.0, whole = 0.0;
        for (int k = 0; k < 3; k++) {
            along += cross[i][k] * white[k];
            whole += cross[i][k] * column[i][k];
        }
        for (int k = 0; k < 3; k++)
            rgb_to_xyz[3 * k + i] = (float)(column[i][k] * along / whole);
    }
}

static void choose_primaries(GstVideoColorPrimaries primaries, pupil_config *config)
{
    if (primaries == GST_VIDEO_COLOR_PRIMARIES_UNKNOWN || primaries == GST_VIDEO_COLOR_PRIMARIES_BT709) {
        config->primaries = PUPIL_PRIMARIES_BT709;
    } else if (primaries == GST_VIDEO_COLOR_PRIMARIES_BT2020) {
        config->primaries = PUPIL_PRIMARIES_BT2020;
    } else {
        config->primaries = PUPIL_PRIMARIES_MATRIX;
        find_rgb_to_xyz(gst_video_color_primaries_get_info(primaries), config->rgb_to_xyz);
    }
}

/* Grey has no range of its own in pupil, but the codes of black and white. */
static void choose_black_and_white(const GstVideoInfo *info, pupil_coding *coding)
{
    if (!GST_VIDEO_INFO_IS_GRAY(info) || coding->range == PUPIL_RANGE_FULL)
        return;
    const float code_1 = GST_VIDEO_INFO_FORMAT(info) == GST_VIDEO_FORMAT_GRAY16_LE ? 256.0f : 1.0f;
    coding->black = 16.0f * code_1; /* Rec. ITU-R BT.709-6, item 5.4 */
    coding->white = 235.0f * code_1;
    coding->range = PUPIL_RANGE_LIMITED;
}

static int refuse(const GstVideoInfo *info, const char *what, const char *right, pupil_why *why)
{
    gchar *text = gst_video_colorimetry_to_string(&info->colorimetry);
    pupil_refuse(why, "%s of colorimetry %s: %s", GST_VIDEO_INFO_NAME(info), text, what);
    pupil_refuse_add(why, "; %s", right);
    g_free(text);
    return -1;
}

int colorimetry_in(const GstVideoInfo *info, pupil_coding *coding, pupil_config *config, pupil_why *why)
{
    static const char convert[] = "convert it before (videoconvert)";
    *coding = (pupil_coding){.size_bytes = sizeof *coding};
    if (choose_range(info, &coding->range))
        return refuse(info, "RGB of limited range is not read", convert, why);
    if (choose_matrix(info, &coding->matrix))
        return refuse(info, "a matrix of BT.601, BT.709 or BT.2020 is read", convert, why);
    if (choose_light(info, &coding->light))
        return refuse(info, "a transfer of sRGB, BT.709, BT.2020, PQ, HLG or linear is read", convert, why);
    if (!light_suits(info, coding->light))
        return refuse(info, "8-bit RGB is read as sRGB", "PQ, HLG and linear light need another format, as P010_10LE",
                      why);
    choose_black_and_white(info, coding);
    choose_primaries(info->colorimetry.primaries, config);
    return 0;
}

/* BT.709's curve is the name of SDR video in most caps; a display shows both the same way. */
static gboolean is_picture(const GstVideoColorimetry *c)
{
    const gboolean is_sdr = c->transfer == GST_VIDEO_TRANSFER_UNKNOWN || c->transfer == GST_VIDEO_TRANSFER_SRGB ||
                            c->transfer == GST_VIDEO_TRANSFER_BT709 || c->transfer == GST_VIDEO_TRANSFER_BT601 ||
                            c->transfer == GST_VIDEO_TRANSFER_BT2020_10 || c->transfer == GST_VIDEO_TRANSFER_BT2020_12;
    const gboolean has_primaries = c->primaries == GST_VIDEO_COLOR_PRIMARIES_UNKNOWN ||
                                   c->primaries == GST_VIDEO_COLOR_PRIMARIES_BT709 ||
                                   c->primaries == GST_VIDEO_COLOR_PRIMARIES_BT2020;
    return is_sdr && has_primaries;
}

int colorimetry_out(const GstVideoInfo *info, pupil_coding *coding, pupil_config *config, pupil_why *why)
{
    const GstVideoColorimetry *c = &info->colorimetry;
    static const char right[] = "leave the colorimetry open, or ask for sRGB or bt709";
    *coding = (pupil_coding){.size_bytes = sizeof *coding};
    if (!is_picture(c))
        return refuse(info, "the picture is SDR, coded as sRGB, with the primaries of BT.709 or BT.2020", right, why);
    if (choose_range(info, &coding->range) || choose_matrix(info, &coding->matrix))
        return refuse(info, "the picture's range is full in RGB, and its matrix that of BT.601, BT.709 or BT.2020",
                      right, why);
    config->output_primaries =
        c->primaries == GST_VIDEO_COLOR_PRIMARIES_BT2020 ? PUPIL_OUTPUT_BT2020 : PUPIL_OUTPUT_BT709;
    const uint32_t as_input =
        config->output_primaries == PUPIL_OUTPUT_BT2020 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
    if (config->primaries == as_input) /* no identity matrix, which would cost as much as any other */
        config->output_primaries = PUPIL_OUTPUT_AS_INPUT;
    return 0;
}

/* The colorimetry of a picture of this format if downstream leaves it open; to be freed. */
static gchar *own_colorimetry(GstVideoFormat format)
{
    const GstVideoFormatInfo *info = gst_video_format_get_info(format);
    const GstVideoColorimetry rgb = {GST_VIDEO_COLOR_RANGE_0_255, GST_VIDEO_COLOR_MATRIX_RGB, GST_VIDEO_TRANSFER_SRGB,
                                     GST_VIDEO_COLOR_PRIMARIES_BT709};
    const GstVideoColorimetry yuv = {GST_VIDEO_COLOR_RANGE_16_235, GST_VIDEO_COLOR_MATRIX_BT709,
                                     GST_VIDEO_TRANSFER_SRGB, GST_VIDEO_COLOR_PRIMARIES_BT709};
    return gst_video_colorimetry_to_string(GST_VIDEO_FORMAT_INFO_IS_RGB(info) ? &rgb : &yuv);
}

void colorimetry_fixate(GstStructure *structure, GstVideoFormat format)
{
    const GValue *list = gst_structure_get_value(structure, "colorimetry");
    if (!list) {
        gchar *own = own_colorimetry(format);
        gst_structure_set(structure, "colorimetry", G_TYPE_STRING, own, NULL);
        g_free(own);
        return;
    }
    for (guint i = 0; GST_VALUE_HOLDS_LIST(list) && i < gst_value_list_get_size(list); i++) {
        const GValue *one = gst_value_list_get_value(list, i);
        GstVideoColorimetry c;
        if (G_VALUE_HOLDS_STRING(one) && gst_video_colorimetry_from_string(&c, g_value_get_string(one)) &&
            is_picture(&c)) {
            gchar *chosen = g_value_dup_string(one);
            gst_structure_set(structure, "colorimetry", G_TYPE_STRING, chosen, NULL);
            g_free(chosen);
            return;
        }
    }
}
