/* lib/core/eye.h: an eye's cones and rods, and how they adapt: PUPIL_LAW_EYE.
 *
 * After Pattanaik, Tumblin, Yee, Greenberg: Time-Dependent Visual Adaptation for Realistic Image Display, 2000, with
 * the static responses of Hunt: The Reproduction of Colour, 1995. All light is in cd/m2.
 */
#ifndef PUPIL_CORE_EYE_H
#define PUPIL_CORE_EYE_H

/* The range of light that the eye distinguishes; light beyond it counts as its end. */
#define PUPIL_EYE_LEAST_CD_M2 1e-6
#define PUPIL_EYE_MOST_CD_M2  1e8

typedef struct pupil_eye {
    double cone_cd_m2, rod_cd_m2;     /* neural adaptation: the light that cones and rods are adapted to */
    double cone_pigment, rod_pigment; /* the share that is not bleached, above 0, up to 1 */
} pupil_eye;

/* At rest at this light. */
void pupil_eye_begin(pupil_eye *eye, double cd_m2);

/* Adapts to the same light for a time, 0 or more. Each of the four states is an exact exponential of the time, and ends
 * on its target. */
void pupil_eye_move(pupil_eye *eye, double cd_m2, double dt_s);

/* log2 of the light at which an eye at rest is as sensitive as this one. It is above cd_m2 until dark adaptation is
 * complete. */
double pupil_eye_level_log2(const pupil_eye *eye, double cd_m2);

/* The share of the rods in the response to light: 1 at night, 0 by day. */
double pupil_eye_rods(const pupil_eye *eye, double cd_m2);

#endif
