/* tests/veil/eye.h: the published point spread functions as printed, by libm, and their light in pixels. */
#ifndef PUPIL_TESTS_VEIL_EYE_H
#define PUPIL_TESTS_VEIL_EYE_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "pupil/veil.h"

#define EYE_PI 3.14159265358979323846

typedef struct eye {
    uint32_t psf;
    double age, pigment, total;
} eye;

/* In 1/sr, of an angle in degrees (pupil/veil.h). */
static inline double eye_formula(const eye *e, double t)
{
    const double near = t + 0.02, a = pow(e->age / 70, 4), p = e->pigment;
    if (e->psf == PUPIL_VEIL_SPENCER)
        return 0.384 * 2.61e6 * exp(-pow(t / 0.02, 2)) + 0.478 * 20.91 * pow(near, -3) + 0.138 * 72.37 * pow(near, -2);
    return (1 - 0.08 * a) * (9.2e6 * pow(1 + pow(t / 0.0046, 2), -1.5) + 1.5e5 * pow(1 + pow(t / 0.045, 2), -1.5)) +
           (1 + 1.6 * a) * (400 / (1 + pow(t / 0.1, 2)) + 3e-8 * t * t +
                            p * (1300 * pow(1 + pow(t / 0.1, 2), -1.5) + 0.8 * pow(1 + pow(t / 0.1, 2), -0.5))) +
           2.5e-3 * p;
}

/* Over the hemisphere, by steps of 1/1000 in ln t. */
static inline eye eye_of(uint32_t psf, double age, double pigment)
{
    eye e = {psf, age, pigment, 1};
    double total = 0;
    for (double u = log(1e-7); u < log(90.0); u += 1e-3) {
        const double t = exp(u + 0.5e-3);
        total += eye_formula(&e, t) * 2 * EYE_PI * sin(t * EYE_PI / 180) * t * (EYE_PI / 180) * 1e-3;
    }
    e.total = total;
    return e;
}

/* The share of a lamp's light that a pixel at the offset (x, y) gets. */
static inline double eye_pixel(const eye *e, double degrees_per_px, int x, int y)
{
    const double steradians = pow(degrees_per_px * EYE_PI / 180, 2);
    double sum = 0;
    if (!x && !y) { /* by rays from the middle to the pixel's edge, in steps of ln r */
        for (int i = 0; i < 64; i++) {
            const double edge = 0.5 / cos((i + 0.5) / 64 * EYE_PI / 4);
            for (double u = log(1e-6); u < 0; u += 2e-3) {
                const double r = edge * exp(u + 1e-3);
                sum += eye_formula(e, r * degrees_per_px) * r * r * 2e-3 * (2 * EYE_PI / 64);
            }
        }
        return sum * steradians / e->total;
    }
    const int parts = abs(x) + abs(y) < 12 ? 16 : 1;
    for (int i = 0; i < parts * parts; i++) {
        const double u = x + (i % parts + 0.5) / parts - 0.5, v = y + (i / parts + 0.5) / parts - 0.5;
        sum += eye_formula(e, hypot(u, v) * degrees_per_px);
    }
    return sum * steradians / e->total / (parts * parts);
}

/* The same for a Gaussian of weight 1. */
static inline double eye_gaussian(double sigma, int x, int y)
{
    const double root = sigma * sqrt(2);
    return 0.25 * (erf((x + 0.5) / root) - erf((x - 0.5) / root)) * (erf((y + 0.5) / root) - erf((y - 0.5) / root));
}

#endif
