/* Weights of luminance, the matrix from the input's primaries to the picture's, and the cones of the picture's. */
#include "object.h"

/* Linear RGB to CIE XYZ and back, white D65 (0.3127, 0.3290): SMPTE RP 177-1993 from the chromaticities of
 * Rec. ITU-R BT.709-6, item 1.3, and BT.2020-2, table 3. */
static const double xyz_of_bt709[9] = {0.412390799266,  0.357584339384,  0.180480788402, 0.212639005872, 0.715168678768,
                                       0.0721923153607, 0.0193308187156, 0.119194779795, 0.95053215225};
static const double xyz_of_bt2020[9] = {
    0.636958048301,  0.144616903586, 0.168880975164, 0.262700212011, 0.677998071519, 0.0593017164699, 0.0,
    0.0280726930491, 1.06098505771};
static const double bt709_of_xyz[9] = {3.2409699419,    -1.53738317757, -0.498610760293, -0.969243636281, 1.87596750151,
                                       0.0415550574072, 0.055630079697, -0.203976958889, 1.05697151424};
static const double bt2020_of_xyz[9] = {1.71665118797,   -0.355670783776,  -0.253366281374,
                                        -0.666684351832, 1.61648123663,    0.0157685458139,
                                        0.0176398574453, -0.0427706132578, 0.942103121235};

/* BT.709-6, item 3.2. Those of BT.2020 are the same weights of the same light: luma_of_bt709 times the matrix from
 * BT.2020 to BT.709. So a frame has one level in either primaries, and a pixel the luminance in the picture that was
 * metered. The four digits of BT.2020-2, table 4, differ by up to 7e-5 from them. */
static const float luma_of_bt709[3] = {0.2126f, 0.7152f, 0.0722f},
                   luma_of_bt2020[3] = {0.262631403f, 0.678055704f, 0.0593128936f};

/* CIE XYZ to the responses of Oklab's cones, M1 of Ottosson 2020 (bottosson.github.io, "A perceptual color space for
 * image processing"). */
static const double cones_of_xyz[9] = {0.8189330101, 0.3618667424, -0.1288597137, 0.0329845436, 0.9293118715,
                                       0.0361456387, 0.0482003018, 0.2643662691,  0.6338517070};

/* Of the configuration's own matrix: scaled, so that RGB of 1 has the luminance 1. */
static double own_luminance(const pupil_config *c)
{
    return (double)c->rgb_to_xyz[3] + (double)c->rgb_to_xyz[4] + (double)c->rgb_to_xyz[5];
}

static void derive_luma(pupil_object *object)
{
    const pupil_config *c = &object->config;
    const double sum = own_luminance(c);
    for (int i = 0; i < 3; i++) {
        object->luma[i] = c->primaries == PUPIL_PRIMARIES_BT709    ? luma_of_bt709[i]
                          : c->primaries == PUPIL_PRIMARIES_BT2020 ? luma_of_bt2020[i]
                                                                   : (float)((double)c->rgb_to_xyz[3 + i] / sum);
        object->picture_luma[i] = c->output_primaries == PUPIL_OUTPUT_BT709    ? luma_of_bt709[i]
                                  : c->output_primaries == PUPIL_OUTPUT_BT2020 ? luma_of_bt2020[i]
                                                                               : object->luma[i];
    }
}

/* Whether m has an inverse that binary32 can use. */
static int invert(const double m[9], double inverse[9])
{
    for (int i = 0; i < 9; i++) { /* the cofactor of the element across the diagonal */
        const int row = i % 3, column = i / 3, a = (row + 1) % 3 * 3, b = (row + 2) % 3 * 3;
        const int x = (column + 1) % 3, y = (column + 2) % 3;
        inverse[i] = m[a + x] * m[b + y] - m[a + y] * m[b + x];
    }
    const double determinant = (m[0] * inverse[0] + m[1] * inverse[3]) + m[2] * inverse[6];
    if (!(determinant > 1e-3 || determinant < -1e-3))
        return 0;
    for (int i = 0; i < 9; i++)
        inverse[i] /= determinant;
    return 1;
}

/* 0: not every cone responds to every primary. */
static int derive_cones(const double xyz[9], pupil_cones *cones)
{
    double from[9], to[9];
    for (int i = 0; i < 9; i += 3) {
        double white = 0.0;
        for (int j = 0; j < 3; j++) {
            const double *row = cones_of_xyz + i;
            from[i + j] = (row[0] * xyz[j] + row[1] * xyz[3 + j]) + row[2] * xyz[6 + j];
            white += from[i + j];
        }
        if (!(white > 1e-3 && white < 1e3))
            return 0;
        for (int j = 0; j < 3; j++) {
            from[i + j] /= white;
            if (!(from[i + j] >= 1.0 / 256.0)) /* so that no light is too little to divide by */
                return 0;
        }
    }
    if (!invert(from, to))
        return 0;
    for (int i = 0; i < 9; i++) {
        cones->from_rgb[i] = (float)from[i];
        cones->to_rgb[i] = (float)to[i];
    }
    return 1;
}

/* The rods' response to a light, from CIE XYZ: Pattanaik, Ferwerda, Fairchild, Greenberg, A Multiscale Model of
 * Adaptation and Spatial Vision for Realistic Image Display, 1998. And the blue that it is shown in, as XYZ of the
 * luminance 1: the chromaticity (0.25, 0.25) of Jensen et al., Night Rendering, 2000. */
static const double rods_of_xyz[3] = {-0.702, 1.039, 0.433};
static const double blue[3] = {1.0, 1.0, 2.0};

/* The rods' light, scaled so that white remains as bright, in the blue. Red, which rods hardly see, would count a
 * little below 0, and counts as 0. */
static void derive_rods(pupil_object *object, const double xyz[9], const double picture_xyz[9])
{
    double see[3], sum = 0.0, of_xyz[9];
    const double *seen = xyz;
    if (!invert(picture_xyz, of_xyz)) { /* only the luminance row is given */
        seen = xyz_of_bt709;
        (void)invert(seen, of_xyz);
    }
    for (int i = 0; i < 3; i++) {
        see[i] = (rods_of_xyz[0] * seen[i] + rods_of_xyz[1] * seen[3 + i]) + rods_of_xyz[2] * seen[6 + i];
        see[i] = see[i] > 0.0 ? see[i] : 0.0;
        sum += see[i];
    }
    if (!(sum > 1e-3)) { /* of odd primaries: as their luminance */
        for (int i = 0; i < 3; i++)
            see[i] = xyz[3 + i];
        sum = 1.0;
    }
    for (int i = 0; i < 9; i++) {
        const double *row = of_xyz + i / 3 * 3;
        const double in_blue = (row[0] * blue[0] + row[1] * blue[1]) + row[2] * blue[2];
        object->rods_to_picture[i] = (float)((in_blue > 0.0 ? in_blue : 0.0) * (see[i % 3] / sum));
    }
}

void pupil_mix_rods(const float *to_picture, const float rods_to_picture[9], float rods, float mixed[9])
{
    const float cones = 1.0f - rods;
    for (int i = 0; i < 9; i++) {
        const float plain = to_picture ? to_picture[i] : i % 4 == 0 ? 1.0f : 0.0f;
        mixed[i] = cones * plain + rods * rods_to_picture[i];
    }
}

void pupil_primaries_derive(pupil_object *object)
{
    const pupil_config *c = &object->config;
    const int same = (c->primaries == PUPIL_PRIMARIES_BT709 && c->output_primaries == PUPIL_OUTPUT_BT709) ||
                     (c->primaries == PUPIL_PRIMARIES_BT2020 && c->output_primaries == PUPIL_OUTPUT_BT2020);
    const double *to = c->output_primaries == PUPIL_OUTPUT_BT709 ? bt709_of_xyz : bt2020_of_xyz;
    double from[9];
    derive_luma(object);
    object->has_to_picture = c->output_primaries != PUPIL_OUTPUT_AS_INPUT && !same;
    for (int i = 0; i < 9; i++)
        from[i] = c->primaries == PUPIL_PRIMARIES_BT709    ? xyz_of_bt709[i]
                  : c->primaries == PUPIL_PRIMARIES_BT2020 ? xyz_of_bt2020[i]
                                                           : (double)c->rgb_to_xyz[i] / own_luminance(c);
    const double *picture = c->output_primaries == PUPIL_OUTPUT_BT709    ? xyz_of_bt709
                            : c->output_primaries == PUPIL_OUTPUT_BT2020 ? xyz_of_bt2020
                                                                         : from;
    if (!derive_cones(picture, &object->cones)) /* or only the luminance row is given */
        (void)derive_cones(xyz_of_bt709, &object->cones);
    object->has_rods = c->law == PUPIL_LAW_EYE;
    if (object->has_rods)
        derive_rods(object, from, picture);
    for (int i = 0; i < 9 && object->has_to_picture; i++) {
        const double *row = to + i / 3 * 3, *column = from + i % 3;
        object->to_picture[i] = (float)((row[0] * column[0] + row[1] * column[3]) + row[2] * column[6]);
    }
}
