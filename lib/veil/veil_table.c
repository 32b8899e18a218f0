/* Tables of Fourier coefficients: of all wide lobes together, and of one bell.
 *
 * With a period of X and Y a bell at (x0, y0) is the sum over m and n of table[m][n] cos(2 pi m (y - y0) / Y) cos(2 pi
 * n (x - x0) / X). Bells that are a product of one in x and one in y, as Gaussians are, have the product of their
 * coefficients. These are integrals over no more than a period, so that nothing wraps around: by Simpson's rule, which
 * needs no error function. */
#include "veil_private.h"

#include "base/numeric.h"

enum { STEPS = 256 };

/* What is integrated: profiles of x, of height 1 at 0. */
typedef enum profile_kind { PROFILE_GAUSSIAN, PROFILE_QUADRATIC, PROFILE_COSINE } profile_kind;

typedef struct profile {
    profile_kind kind;
    double reach, sigma; /* pixels; sigma of Gaussians */
} profile;

static double profile_at(const profile *p, double x)
{
    const double part = x / p->reach;
    double cosine, sine;
    if (p->kind == PROFILE_GAUSSIAN)
        return pupil_decay(x / p->sigma * (x / p->sigma) * 0.5);
    if (p->kind == PROFILE_QUADRATIC)
        return 1.0 - part * part;
    pupil_circle(part * 0.25, &cosine, &sine);
    return cosine * cosine;
}

/* Coefficients of the profile in a period, for `waves` cosines: of n they are (n ? 2 : 1) / period times the integral
 * of profile(x) cos(2 pi n x / period). Cosines of multiples by Chebyshev's recursion. */
static void waves_of(const profile *p, double period_px, uint32_t waves, double wave[VEIL_WAVES])
{
    for (uint32_t n = 0; n < waves; n++)
        wave[n] = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        const double x = p->reach * i / STEPS, simpson = i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0;
        const double light = simpson * profile_at(p, x);
        double cosine, sine, before, now = 1.0;
        pupil_circle(x / period_px, &cosine, &sine);
        before = cosine;
        for (uint32_t n = 0; n < waves; n++) {
            wave[n] += light * now;
            const double next = 2.0 * cosine * now - before;
            before = now;
            now = next;
        }
    }
    for (uint32_t n = 0; n < waves; n++)
        wave[n] *= p->reach / STEPS / 3.0 * 2.0 * (n ? 2.0 : 1.0) / period_px;
}

static void clear(veil_table table)
{
    for (uint32_t m = 0; m < VEIL_WAVES; m++)
        for (uint32_t n = 0; n < VEIL_WAVES; n++)
            table[m][n] = 0.0f;
}

void pupil_veil_fill_psf(veil_object *o, const veil_lobe *lobe, uint32_t lobes)
{
    const pupil_veil_config *c = &o->config;
    const uint32_t waves = c->harmonics + 1;
    const double period_x = c->period * c->width, period_y = c->period * c->height;
    double x[VEIL_WAVES], y[VEIL_WAVES];
    clear(o->psf_table);
    for (uint32_t i = 0; i < lobes; i++) {
        const profile along_x = {PROFILE_GAUSSIAN, period_x * 0.5, lobe[i].sigma_px};
        const profile along_y = {PROFILE_GAUSSIAN, period_y * 0.5, lobe[i].sigma_px};
        waves_of(&along_x, period_x, waves, x);
        waves_of(&along_y, period_y, waves, y);
        for (uint32_t m = 0; m < waves; m++)
            for (uint32_t n = 0; n < waves; n++)
                o->psf_table[m][n] += (float)(lobe[i].height * x[n] * y[m]);
    }
}

/* J2(z) / z^2: Poisson's integral, 1 / (3 pi) times that of cos(t)^4 cos(z sin t) over half a turn. It has that as its
 * period, so the trapezoidal rule is exact up to a term of J_k(z) with k = 4 * QUARTER, for z up to about 150. */
static double bessel_2_over_square(double z)
{
    enum { QUARTER = 56 };
    double sum = 0.0;
    for (int i = 0; i < QUARTER; i++) { /* at a quarter turn cos(t) is 0 */
        double cosine, sine, wave, unused;
        pupil_circle(0.25 * i / QUARTER, &cosine, &sine);
        pupil_circle(z * sine / (2.0 * VEIL_PI), &wave, &unused);
        const double square = cosine * cosine;
        sum += (i ? 2.0 : 1.0) * square * square * wave;
    }
    return sum * (0.5 * VEIL_PI / QUARTER) / (3.0 * VEIL_PI);
}

static void fill_disc(veil_object *o, double radius_px)
{
    const pupil_veil_config *c = &o->config;
    const uint32_t waves = c->harmonics + 1;
    const double period_x = c->period * c->width, period_y = c->period * c->height;
    const double whole = 4.0 * VEIL_PI * radius_px * radius_px / (period_x * period_y);
    for (uint32_t m = 0; m < waves; m++)
        for (uint32_t n = 0; n < waves; n++) {
            const double fx = n / period_x, fy = m / period_y;
            const double z = 2.0 * VEIL_PI * radius_px * pupil_root(fx * fx + fy * fy);
            o->bell_table[m][n] = (float)(whole * (m ? 2.0 : 1.0) * (n ? 2.0 : 1.0) * bessel_2_over_square(z));
        }
}

/* Bells that are a product. */
static void fill_product(veil_object *o, uint32_t bell, double radius_px)
{
    const pupil_veil_config *c = &o->config;
    const uint32_t waves = c->harmonics + 1;
    const profile p = {bell == PUPIL_VEIL_GAUSSIAN ? PROFILE_GAUSSIAN
                       : bell == PUPIL_VEIL_COSINE ? PROFILE_COSINE
                                                   : PROFILE_QUADRATIC,
                       radius_px, radius_px * 0.25};
    double x[VEIL_WAVES], y[VEIL_WAVES] = {1.0}; /* a band is the same in every row */
    waves_of(&p, c->period * c->width, waves, x);
    if (bell != PUPIL_VEIL_BAND)
        waves_of(&p, c->period * c->height, waves, y);
    for (uint32_t m = 0; m < waves; m++)
        for (uint32_t n = 0; n < waves; n++)
            o->bell_table[m][n] = (float)(x[n] * y[m]);
}

void pupil_veil_fill_bell(veil_object *o, uint32_t bell, double radius_px)
{
    if (o->bell == bell && o->bell_radius_px == radius_px)
        return;
    clear(o->bell_table);
    if (bell == PUPIL_VEIL_DISC)
        fill_disc(o, radius_px);
    else
        fill_product(o, bell, radius_px);
    o->bell = bell;
    o->bell_radius_px = radius_px;
}
