#include "gamut.h"

#include <math.h>

#include "pupil/pupil.h"

/* Responses of Oklab's cones, 1 for white: M1 of Ottosson 2020 times the matrices of SMPTE RP 177-1993; and back. */
static const double cones_of_rgb[2][9] = {{0.412221471395, 0.536332538703, 0.0514459899022, 0.211903496323,
                                           0.680699550329, 0.107396953348, 0.0883024601529, 0.281718837793,
                                           0.629978702054},
                                          {0.616755787942, 0.360198402067, 0.023045809991, 0.265133060273,
                                           0.635839371433, 0.0990275682941, 0.100102631279, 0.203906520491,
                                           0.69599084823}},
                    rgb_of_cones[2][9] = {{4.07674161833, -3.3077115445, 0.230969926171, -1.26843797014, 2.60975735278,
                                           -0.341319382641, -0.00419608399253, -0.703418607717, 1.70761469171},
                                          {2.13990672, -1.24638949546, 0.106482775461, -0.884735834173, 2.16323094132,
                                           -0.278495107146, -0.0485737534485, -0.45450314034, 1.50307689379}};

static void times(const double m[9], const double v[3], double product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

static double largest_of(const double v[3])
{
    return fmax(v[0], fmax(v[1], v[2]));
}

void gamut_fit(int is_bt2020, double gamut, double grey, double light[3])
{
    const double knee = gamut > 0.0 ? (double)PUPIL_GAMUT_KNEE : 1.0, room = 1.0 - grey;
    const double largest = largest_of(light), limit = knee + (1.0 - knee) * grey;
    if (!(largest > limit))
        return;
    if (grey >= 1.0) {
        light[0] = light[1] = light[2] = 1.0;
        return;
    }
    const double most = fmin(1.0, limit + (largest - limit) * room / (room + gamut * (largest - knee * room)));
    const double part = fmin(1.0, grey * grey * grey * (largest - most) / (most * (largest - grey)));
    double cone[3];
    times(cones_of_rgb[is_bt2020], light, cone);
    const double middle = cbrt(cone[1]);
    for (int i = 0; i < 3; i++) {
        const double root = cbrt(cone[i]) * (1.0 - part) + middle * part;
        cone[i] = root * root * root;
    }
    times(rgb_of_cones[is_bt2020], cone, light);
    const double scale = most / largest_of(light);
    for (int i = 0; i < 3; i++)
        light[i] = fmax(0.0, light[i] * scale);
}
