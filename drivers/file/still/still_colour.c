/* From a file's own primaries and white to Rec.709 and D65. */
#include <math.h>
#include <string.h>

#include "still_private.h"

/* Rec. ITU-R BT.709-6, item 1.3. */
static const pupil_chromaticities rec709 = {{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}};

/* Bradford cone responses (ICC.1:2010, annex E). */
static const double bradford[9] = {0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296};

/* Files of Rec.709 pixels give their chromaticities with three or four digits; a matrix within this of the identity
 * counts as the identity, so that such pixels do not change by a bit. */
#define IDENTITY_TOLERANCE 4e-3

static void multiply(const double a[9], const double b[9], double product[9])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            product[3 * r + c] = a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
}

static void transform(const double m[9], const double v[3], double out[3])
{
    for (int r = 0; r < 3; r++)
        out[r] = m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2];
}

/* 0 where the matrix has no usable inverse. */
static int invert(const double m[9], double inverse[9])
{
    double determinant;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, e = (c + 2) % 3;
            inverse[3 * c + i] = m[3 * j + d] * m[3 * k + e] - m[3 * j + e] * m[3 * k + d];
        }
    }
    determinant = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
    if (!(fabs(determinant) > 1e-3)) /* Rec.709's is 0.07, XYZ's 1; the triangle's area is half of it */
        return 0;
    for (int i = 0; i < 9; i++)
        inverse[i] /= determinant;
    return 1;
}

static void xyz_of(const double xy[2], double xyz[3])
{
    xyz[0] = xy[0] / xy[1];
    xyz[1] = 1;
    xyz[2] = (1 - xy[0] - xy[1]) / xy[1];
}

/* RGB to XYZ with white at Y = 1 (SMPTE RP 177-1993); 0 where the chromaticities are not sane: not finite, far outside
 * the diagram, no triangle, or a white outside it. Primaries may be outside the spectral locus (ACES, XYZ). */
static int rgb_to_xyz(const pupil_chromaticities *given, double matrix[9])
{
    double columns[9], inverse[9], white[3], scale[3];
    for (int i = 0; i < 8; i++)
        if (!(fabs(given->xy[i]) <= 2))
            return 0;
    if (!(given->xy[6] > 0.05 && given->xy[7] > 0.05 && given->xy[6] + given->xy[7] < 0.95))
        return 0;
    for (int c = 0; c < 3; c++) {
        columns[c] = given->xy[2 * c];
        columns[3 + c] = given->xy[2 * c + 1];
        columns[6 + c] = 1 - given->xy[2 * c] - given->xy[2 * c + 1];
    }
    if (!invert(columns, inverse))
        return 0;
    xyz_of(given->xy + 6, white);
    transform(inverse, white, scale);
    for (int c = 0; c < 3; c++) {
        if (!(scale[c] > 0))
            return 0;
        for (int r = 0; r < 3; r++)
            matrix[3 * r + c] = columns[3 * r + c] * scale[c];
    }
    return 1;
}

/* XYZ under one white to XYZ under D65. */
static void adapt_white(const double from_xy[2], double matrix[9])
{
    double from[3], to[3], from_cone[3], to_cone[3], scaled[9], back[9];
    xyz_of(from_xy, from);
    xyz_of(rec709.xy + 6, to);
    transform(bradford, from, from_cone);
    transform(bradford, to, to_cone);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            scaled[3 * r + c] = bradford[3 * r + c] * to_cone[r] / from_cone[r];
    invert(bradford, back);
    multiply(back, scaled, matrix);
}

void pupil_still_colour_from(const pupil_chromaticities *given, pupil_still_colour *colour)
{
    double to_xyz[9], standard[9], from_xyz[9], adapt[9], step[9], matrix[9];
    rgb_to_xyz(&rec709, standard);
    memset(colour, 0, sizeof *colour);
    if (!given || !rgb_to_xyz(given, to_xyz)) {
        memcpy(colour->luminance, standard + 3, sizeof colour->luminance);
        return;
    }
    invert(standard, from_xyz);
    adapt_white(given->xy + 6, adapt);
    multiply(adapt, to_xyz, step);
    multiply(from_xyz, step, matrix);
    memcpy(colour->luminance, to_xyz + 3, sizeof colour->luminance);
    for (int i = 0; i < 9; i++) {
        colour->to_709[i] = (float)matrix[i];
        if (fabs(matrix[i] - (i % 4 == 0)) > IDENTITY_TOLERANCE)
            colour->convert = 1;
    }
}

int pupil_still_colour_from_icc(const double to_xyz[9], pupil_still_colour *colour)
{
    static const double d50[2] = {0.34570, 0.35854}; /* ICC.1:2010, 7.2.16 */
    double standard[9], from_xyz[9], adapt[9], step[9], matrix[9];
    rgb_to_xyz(&rec709, standard);
    invert(standard, from_xyz);
    adapt_white(d50, adapt);
    multiply(adapt, to_xyz, step);
    multiply(from_xyz, step, matrix);
    memset(colour, 0, sizeof *colour);
    memcpy(colour->luminance, to_xyz + 3, sizeof colour->luminance);
    for (int r = 0; r < 3; r++) {
        const double white = matrix[3 * r] + matrix[3 * r + 1] + matrix[3 * r + 2];
        if (!(fabs(white - 1) < 0.05))
            return 0;
        for (int i = 3 * r; i < 3 * r + 3; i++) { /* scaled so that white stays white: the profile's numbers are
                                                   * rounded */
            colour->to_709[i] = (float)(matrix[i] / white);
            if (fabs(matrix[i] / white - (i % 4 == 0)) > IDENTITY_TOLERANCE)
                colour->convert = 1;
        }
    }
    return 1;
}

void pupil_still_colour_from_xyz(pupil_still_colour *colour)
{
    double standard[9], from_xyz[9];
    rgb_to_xyz(&rec709, standard);
    invert(standard, from_xyz);
    *colour = (pupil_still_colour){.luminance = {0, 1, 0}, .convert = 1};
    for (int i = 0; i < 9; i++)
        colour->to_709[i] = (float)from_xyz[i];
}

static void matrix_of(const pupil_still_colour *colour, double matrix[9])
{
    for (int i = 0; i < 9; i++)
        matrix[i] = colour->convert ? (double)colour->to_709[i] : i % 4 == 0;
}

/* A matrix without an inverse, of primaries nearly in a line, leaves the pixels as they are. */
void pupil_still_colour_between(const pupil_still_colour *from, const pupil_still_colour *to,
                                pupil_still_colour *between)
{
    double forth[9], back[9], inverse[9], step[9];
    matrix_of(from, forth);
    matrix_of(to, back);
    *between = (pupil_still_colour){.convert = 0};
    if (!invert(back, inverse))
        return;
    multiply(inverse, forth, step);
    for (int i = 0; i < 9; i++) {
        between->to_709[i] = (float)step[i];
        if (fabs(step[i] - (i % 4 == 0)) > IDENTITY_TOLERANCE)
            between->convert = 1;
    }
}

void pupil_still_colour_apply(const pupil_still_colour *colour, float *rgb, uint64_t pixels)
{
    const float *m = colour->to_709;
    if (!colour->convert)
        return;
    for (; pixels; pixels--, rgb += 3) {
        float r = rgb[0], g = rgb[1], b = rgb[2];
        rgb[0] = m[0] * r + m[1] * g + m[2] * b;
        rgb[1] = m[3] * r + m[4] * g + m[5] * b;
        rgb[2] = m[6] * r + m[7] * g + m[8] * b;
    }
}
