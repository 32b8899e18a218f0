/* drivers/file/video/video_light.c: transfer curves and primaries of Rec. ITU-T H.273, to linear Rec.709. */
#include "video_light.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "file/common/transfer_curves.h"

static double gamma22_light(double code)
{
    return pow(code, 2.2);
}

static double gamma28_light(double code)
{
    return pow(code, 2.8);
}

static double linear_light(double code)
{
    return code;
}

int pupil_light_table(float table[PUPIL_LIGHT_CODES], enum AVColorTransferCharacteristic transfer)
{
    double (*light)(double code);
    switch ((int)transfer) {
    case AVCOL_TRC_RESERVED0:
    case AVCOL_TRC_BT709:
    case AVCOL_TRC_UNSPECIFIED:
    case AVCOL_TRC_RESERVED:
    case AVCOL_TRC_SMPTE170M:
    case AVCOL_TRC_SMPTE240M:
    case AVCOL_TRC_IEC61966_2_4:
    case AVCOL_TRC_BT1361_ECG:
    case AVCOL_TRC_IEC61966_2_1:
    case AVCOL_TRC_BT2020_10:
    case AVCOL_TRC_BT2020_12:
        light = pupil_srgb_light;
        break;
    case AVCOL_TRC_GAMMA22:
        light = gamma22_light;
        break;
    case AVCOL_TRC_GAMMA28:
        light = gamma28_light;
        break;
    case AVCOL_TRC_LINEAR:
        light = linear_light;
        break;
    case AVCOL_TRC_SMPTE2084:
        light = pupil_pq_light;
        break;
    case AVCOL_TRC_ARIB_STD_B67:
        light = pupil_hlg_light;
        break;
    default:
        return -1;
    }
    for (int i = 0; i < PUPIL_LIGHT_CODES; i++)
        table[i] = (float)light(i / (double)(PUPIL_LIGHT_CODES - 1));
    return 0;
}

/* H.273 table 2: x and y of red, green, blue and white. */
static const struct {
    enum AVColorPrimaries primaries;
    double xy[8];
} chromaticities[] = {
    {AVCOL_PRI_BT709, {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290}},
    {AVCOL_PRI_BT470M, {0.670, 0.330, 0.210, 0.710, 0.140, 0.080, 0.3100, 0.3160}},
    {AVCOL_PRI_BT470BG, {0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.3127, 0.3290}},
    {AVCOL_PRI_SMPTE170M, {0.630, 0.340, 0.310, 0.595, 0.155, 0.070, 0.3127, 0.3290}},
    {AVCOL_PRI_SMPTE240M, {0.630, 0.340, 0.310, 0.595, 0.155, 0.070, 0.3127, 0.3290}},
    {AVCOL_PRI_FILM, {0.681, 0.319, 0.243, 0.692, 0.145, 0.049, 0.3100, 0.3160}},
    {AVCOL_PRI_BT2020, {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}},
    {AVCOL_PRI_SMPTE431, {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3140, 0.3510}},
    {AVCOL_PRI_SMPTE432, {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}},
    {AVCOL_PRI_EBU3213, {0.630, 0.340, 0.295, 0.605, 0.155, 0.077, 0.3127, 0.3290}},
};

static void invert(double out[9], const double m[9])
{
    double c0 = m[4] * m[8] - m[5] * m[7], c1 = m[5] * m[6] - m[3] * m[8], c2 = m[3] * m[7] - m[4] * m[6];
    double d = 1 / (m[0] * c0 + m[1] * c1 + m[2] * c2);
    const double adjugate[9] = {c0, m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                                c1, m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                                c2, m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    for (int i = 0; i < 9; i++)
        out[i] = adjugate[i] * d;
}

/* Linear RGB to XYZ (SMPTE RP 177, section 3.3): the primaries as columns, scaled so that (1, 1, 1) is the white. The
 * white of every set is taken as D65. */
static void rgb_to_xyz(double m[9], const double xy[8])
{
    double columns[9], inverse[9], white[3] = {0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290};
    for (int i = 0; i < 3; i++) {
        columns[i] = xy[2 * i];
        columns[3 + i] = xy[2 * i + 1];
        columns[6 + i] = 1 - xy[2 * i] - xy[2 * i + 1];
    }
    invert(inverse, columns);
    for (int i = 0; i < 3; i++) {
        double scale = inverse[3 * i] * white[0] + inverse[3 * i + 1] * white[1] + inverse[3 * i + 2] * white[2];
        for (int row = 0; row < 3; row++)
            m[3 * row + i] = columns[3 * row + i] * scale;
    }
}

int pupil_light_to_rec709(double matrix[9], enum AVColorPrimaries primaries)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (primaries == AVCOL_PRI_BT709 || primaries == AVCOL_PRI_UNSPECIFIED || primaries == AVCOL_PRI_RESERVED0 ||
        primaries == AVCOL_PRI_RESERVED) {
        memcpy(matrix, identity, sizeof identity);
        return 0;
    }
    for (size_t k = 1; k < sizeof chromaticities / sizeof *chromaticities; k++) {
        double from[9], to[9], inverse[9];
        if (chromaticities[k].primaries != primaries)
            continue;
        rgb_to_xyz(from, chromaticities[k].xy);
        rgb_to_xyz(to, chromaticities[0].xy);
        invert(inverse, to);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                matrix[3 * i + j] =
                    inverse[3 * i] * from[j] + inverse[3 * i + 1] * from[3 + j] + inverse[3 * i + 2] * from[6 + j];
        return 0;
    }
    return -1;
}

/* H.273, equations 41 to 46: luma is the luminance of the primaries. */
static int derived_luma(double *red, double *blue, enum AVColorPrimaries primaries)
{
    for (size_t k = 0; k < sizeof chromaticities / sizeof *chromaticities; k++)
        if (chromaticities[k].primaries == primaries) {
            double xyz[9];
            rgb_to_xyz(xyz, chromaticities[k].xy);
            *red = xyz[3];
            *blue = xyz[5];
            return 0;
        }
    return -1;
}

int pupil_light_luma(double *red, double *blue, enum AVColorSpace space, enum AVColorPrimaries primaries)
{
    switch ((int)space) {
    case AVCOL_SPC_CHROMA_DERIVED_NCL:
        return derived_luma(red, blue, primaries);
    case AVCOL_SPC_BT709:
        *red = 0.2126;
        *blue = 0.0722;
        return 0;
    case AVCOL_SPC_FCC:
        *red = 0.30;
        *blue = 0.11;
        return 0;
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
        *red = 0.299;
        *blue = 0.114;
        return 0;
    case AVCOL_SPC_SMPTE240M:
        *red = 0.212;
        *blue = 0.087;
        return 0;
    case AVCOL_SPC_BT2020_NCL:
        *red = 0.2627;
        *blue = 0.0593;
        return 0;
    default:
        return -1;
    }
}
