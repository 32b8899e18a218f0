#include "eye.h"

#include "base/numeric.h"

#define EXPONENT 0.73 /* of the response L^n / (L^n + sigma^n): Pattanaik et al., after Hunt */

/* Seconds: the time constants of the neural filters, and of the pigments in the dark. */
#define CONE_NEURAL_S  0.08
#define ROD_NEURAL_S   0.15
#define CONE_PIGMENT_S 110.0
#define ROD_PIGMENT_S  400.0
/* cd/m2 at which half of a pigment is bleached */
#define CONE_HALF_CD_M2 2e6
#define ROD_HALF_CD_M2  0.04

#define LOG2_E 1.4426950408889634

/* --- the filters --- */

/* target + (value - target) exp(-x): as exact where little is left of a large value as where x is tiny. It moves by at
 * least a unit in the last place, so that it ends. */
static double decay(double value, double target, double x)
{
    if (!(x > 0.0) || value == target)
        return value;
    const double next = target + (value - target) * (x < 700.0 ? pupil_exp2(-x * LOG2_E) : 0.0);
    if (next != value)
        return next;
    const uint64_t bits = pupil_bits_of_double(value); /* positive, so bits sort as values do */
    return pupil_double_of_bits(value < target ? bits + 1 : bits - 1);
}

static double unbleached(double cd_m2, double half)
{
    return half / (half + cd_m2);
}

/* dB/dt = (1 - B) / t - B L / (t half): bleached by light, restored with the time constant t. In constant light it
 * approaches half / (half + L), faster in brighter light. */
static double pigment(double value, double cd_m2, double half, double restored_s, double dt_s)
{
    return decay(value, unbleached(cd_m2, half), dt_s / restored_s * (1.0 + cd_m2 / half));
}

void pupil_eye_begin(pupil_eye *eye, double cd_m2)
{
    const double light = clamp(cd_m2, PUPIL_EYE_LEAST_CD_M2, PUPIL_EYE_MOST_CD_M2);
    *eye = (pupil_eye){light, light, unbleached(light, CONE_HALF_CD_M2), unbleached(light, ROD_HALF_CD_M2)};
}

void pupil_eye_move(pupil_eye *eye, double cd_m2, double dt_s)
{
    const double light = clamp(cd_m2, PUPIL_EYE_LEAST_CD_M2, PUPIL_EYE_MOST_CD_M2);
    eye->cone_cd_m2 = decay(eye->cone_cd_m2, light, dt_s / CONE_NEURAL_S);
    eye->rod_cd_m2 = decay(eye->rod_cd_m2, light, dt_s / ROD_NEURAL_S);
    eye->cone_pigment = pigment(eye->cone_pigment, light, CONE_HALF_CD_M2, CONE_PIGMENT_S, dt_s);
    eye->rod_pigment = pigment(eye->rod_pigment, light, ROD_HALF_CD_M2, ROD_PIGMENT_S, dt_s);
}

/* --- the responses --- */

static double fourth(double x)
{
    return x * x * (x * x);
}

/* The light at which cones and rods that are adapted to `light` give half of their response. */
static double cone_half(double light, double sixth_root)
{
    const double k4 = fourth(1.0 / (5.0 * light + 1.0)), rest = 1.0 - k4;
    return 12.9223 * light / (k4 * light + 0.171 * (rest * rest) * (sixth_root * sixth_root));
}

static double rod_half(double light, double sixth_root)
{
    const double j = 1.0 / (5e5 * light + 1.0), j2 = j * j;
    return 2.5874 * light / (19000.0 * j2 * light + 0.2615 * fourth(1.0 - j2) * sixth_root);
}

static double sixth_root(double x)
{
    return pupil_exp2(pupil_log2(x) / 6.0);
}

static double cone_half_log2(double light)
{
    return pupil_log2(cone_half(light, sixth_root(light)));
}

static double rod_half_log2(double light)
{
    return pupil_log2(rod_half(light, sixth_root(light)));
}

/* To faint light a response is B (L / sigma)^n. The sum of both equals one response (L / s)^n: log2 of s. */
static double faintest_log2(const pupil_eye *eye)
{
    const double cones = eye->cone_pigment * pupil_exp2(-EXPONENT * cone_half_log2(eye->cone_cd_m2));
    const double rods = eye->rod_pigment * pupil_exp2(-EXPONENT * rod_half_log2(eye->rod_cd_m2));
    return pupil_log2(cones + rods) * (-1.0 / EXPONENT);
}

static double faintest_at_rest_log2(double light_log2)
{
    pupil_eye eye;
    pupil_eye_begin(&eye, pupil_exp2(light_log2));
    return faintest_log2(&eye);
}

/* faintest_at_rest_log2 only rises (tests/stream/test_eye.c), so it has an inverse: by regula falsi, in the form that
 * is called Illinois (Dowell and Jarratt 1971). */
static double at_rest_with(double faintest)
{
    double low = pupil_log2(PUPIL_EYE_LEAST_CD_M2), high = pupil_log2(PUPIL_EYE_MOST_CD_M2);
    double below = faintest_at_rest_log2(low) - faintest, above = faintest_at_rest_log2(high) - faintest;
    int last = 0;
    if (!(below < 0.0))
        return low;
    if (!(above > 0.0))
        return high;
    for (int i = 0; i < 100 && high - low > 1e-12; i++) {
        const double middle = low - below * (high - low) / (above - below);
        const double there = faintest_at_rest_log2(middle) - faintest;
        if (there == 0.0 || !(middle > low && middle < high))
            return middle;
        if (there < 0.0) {
            low = middle;
            below = there;
            above *= last < 0 ? 0.5 : 1.0;
            last = -1;
        } else {
            high = middle;
            above = there;
            below *= last > 0 ? 0.5 : 1.0;
            last = 1;
        }
    }
    return low + 0.5 * (high - low);
}

double pupil_eye_level_log2(const pupil_eye *eye, double cd_m2)
{
    pupil_eye rest;
    pupil_eye_begin(&rest, cd_m2);
    if (eye->cone_cd_m2 == rest.cone_cd_m2 && eye->rod_cd_m2 == rest.rod_cd_m2 &&
        eye->cone_pigment == rest.cone_pigment && eye->rod_pigment == rest.rod_pigment)
        return pupil_log2(rest.cone_cd_m2);
    return at_rest_with(faintest_log2(eye));
}

double pupil_eye_rods(const pupil_eye *eye, double cd_m2)
{
    const double light = clamp(cd_m2, PUPIL_EYE_LEAST_CD_M2, PUPIL_EYE_MOST_CD_M2);
    const double light_log2 = pupil_log2(light);
    /* L^n / (L^n + s^n) = 1 / (1 + (s / L)^n) */
    const double cones =
        eye->cone_pigment / (1.0 + pupil_exp2(EXPONENT * (cone_half_log2(eye->cone_cd_m2) - light_log2)));
    const double rods = eye->rod_pigment / (1.0 + pupil_exp2(EXPONENT * (rod_half_log2(eye->rod_cd_m2) - light_log2)));
    return rods / (rods + cones);
}
