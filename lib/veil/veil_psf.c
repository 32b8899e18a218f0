/* Point spread functions as sums of Gaussians, in closed form.
 *
 * Each term is an integral over Gaussians exp(-v t^2) of all widths, v = 1 / (2 sigma^2):
 *     (1 + (t/a)^2)^-k = integral of u^k exp(-u) exp(-u (t/a)^2) du/u / Gamma(k),                    u = a^2 v
 *     (t + c)^-n = integral of v^(n/2) 2^n I(2 c sqrt v) exp(-v t^2) dv/v / (Gamma(n) sqrt pi)
 *     with I(b) = integral of s^n exp(-b s - s^2) ds from 0 on
 * the second because (t + c)^-n is a mixture of exp(-l t) and each of those one of Gaussians (Schoenberg 1938). By the
 * trapezoidal rule in log v they become sums, and since the integrands are smooth in log v the error falls
 * exponentially with the step: 2 |Gamma(k + 2 pi i / h)| / Gamma(k), h = 2 ln 1.6, which is 0.2 % and less.
 */
#include "veil_private.h"

#include "base/numeric.h"

#define RATIO      1.6                  /* of one lobe's sigma to the next one's */
#define STEP       0x1.e148a1a2726cfp-1 /* 2 ln RATIO: of log v */
#define ROOT_PI    0x1.c5bf891b4ef6ap+0
#define LEAST_PX   0.12 /* what is narrower stays within its pixel */
#define LEAST_WIDE 2.0  /* pixels: a narrower lobe's height at a pixel's middle is not the pixel's light */
#define LEAST_DEG  1e-6 /* no published term has light in lobes below this */
#define FLAT_DEG   1e6  /* nor above */
#define HEMISPHERE 90.0

/* 3e-8 t^2 is no mixture; up to 80 degrees it is K (1 - exp(-t^2 / (2 S^2))) within 5 %, which is 0.5 % of the CIE's
 * function there. */
#define HOLLOW_DEG  180.0
#define HOLLOW_RISE (3e-8 * 2.0 * HOLLOW_DEG * HOLLOW_DEG)

/* --- the terms, in 1/sr and degrees --- */

static double age_of(const pupil_veil_config *c)
{
    const double a = c->age_years / 70.0;
    return a * a * a * a;
}

/* 1 / (1 + (t/a)^2)^(halves / 2) */
static double peak(double t, double a, int halves)
{
    const double q = 1.0 + t / a * (t / a), root = pupil_root(q);
    return halves == 1 ? 1.0 / root : halves == 2 ? 1.0 / q : 1.0 / (q * root);
}

static double spencer_at(double t)
{
    const double near = t + 0.02;
    return 0.384 * 2.61e6 * pupil_decay(t / 0.02 * (t / 0.02)) + 0.478 * 20.91 / (near * near * near) +
           0.138 * 72.37 / (near * near);
}

static double cie_at(const pupil_veil_config *c, double t)
{
    const double a = age_of(c), p = c->pigment;
    const double core = 9.2e6 * peak(t, 0.0046, 3) + 1.5e5 * peak(t, 0.045, 3);
    const double lens = 400.0 * peak(t, 0.1, 2) + 3e-8 * t * t;
    const double wall = 1300.0 * peak(t, 0.1, 3) + 0.8 * peak(t, 0.1, 1);
    return (1.0 - 0.08 * a) * core + (1.0 + 1.6 * a) * (lens + p * wall) + 2.5e-3 * p;
}

/* The integral over the hemisphere, by Simpson's rule in log t. */
static double total_of(const pupil_veil_config *c)
{
    enum { STEPS = 800 };
    const double least = pupil_log2(LEAST_DEG), span = pupil_log2(HEMISPHERE) - least, ln2 = 0x1.62e42fefa39efp-1;
    double total = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        const double t = pupil_exp2(least + span * i / STEPS);
        double cosine, sine;
        pupil_circle(t / 360.0, &cosine, &sine);
        const double weight = i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0;
        total += weight * t * sine * (c->psf == PUPIL_VEIL_CIE ? cie_at(c, t) : spencer_at(t));
    }
    return total * (span * ln2 / STEPS / 3.0) * 2.0 * VEIL_PI * (VEIL_PI / 180.0);
}

/* --- their lobes: heights in 1/sr for a sigma in degrees --- */

/* Of (1 + (t/a)^2)^(-halves / 2). */
static double lobe_of_peak(double sigma, double a, int halves)
{
    const double root = a / sigma * 0x1.6a09e667f3bcdp-1, u = root * root; /* sqrt(1/2) */
    const double shape = halves == 1 ? root / ROOT_PI : halves == 2 ? u : u * root * (2.0 / ROOT_PI);
    return STEP * shape * pupil_decay(u);
}

/* Of (t + c)^-n, n 2 or 3. */
static double lobe_of_power(double sigma, double c, int n)
{
    enum { STEPS = 120 };
    const double root_v = 0x1.6a09e667f3bcdp-1 / sigma, b = 2.0 * c * root_v;
    /* The integrand is negligible at 8 standard deviations of s^2, or where exp(-b s) is. */
    const double end = b > 5.0 ? 40.0 / b : 8.0, step = end / STEPS;
    double sum = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        const double s = i * step, weight = i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight * s * s * (n == 3 ? s : 1.0) * pupil_decay(s * (b + s));
    }
    const double integral = sum * step / 3.0; /* where s is 0 the integrand is 0 */
    const double v_power = root_v * root_v * (n == 3 ? root_v : 1.0);
    return STEP * v_power * (n == 3 ? 8.0 / 2.0 : 4.0) * integral / ROOT_PI;
}

static double lobe_of(const pupil_veil_config *c, double sigma)
{
    if (c->psf == PUPIL_VEIL_SPENCER)
        return 0.478 * 20.91 * lobe_of_power(sigma, 0.02, 3) + 0.138 * 72.37 * lobe_of_power(sigma, 0.02, 2);
    const double a = age_of(c);
    return (1.0 - 0.08 * a) * (9.2e6 * lobe_of_peak(sigma, 0.0046, 3) + 1.5e5 * lobe_of_peak(sigma, 0.045, 3)) +
           (1.0 + 1.6 * a) * (400.0 * lobe_of_peak(sigma, 0.1, 2) +
                              c->pigment * (1300.0 * lobe_of_peak(sigma, 0.1, 3) + 0.8 * lobe_of_peak(sigma, 0.1, 1)));
}

/* --- which of them are the veil --- */

typedef struct sorting {
    pupil_veil_result *result;
    veil_lobe *wide;
    uint32_t count;
} sorting;

/* height: share of the light per square degree. */
static void add_wide(sorting *s, double sigma_deg, double height)
{
    const double px = s->result->degrees_per_px;
    s->wide[s->count].sigma_px = sigma_deg / px;
    s->wide[s->count].height = height * px * px;
    s->count++;
}

static void add_narrow(sorting *s, double sigma_deg, double weight)
{
    pupil_veil_result *r = s->result;
    const double sigma_px = sigma_deg / r->degrees_per_px;
    if (sigma_px < LEAST_PX || r->lobes == PUPIL_VEIL_MOST_LOBES)
        return;
    uint32_t i = r->lobes++;
    for (; i > 0 && r->lobe[i - 1].sigma < sigma_px; i--)
        r->lobe[i] = r->lobe[i - 1];
    r->lobe[i].sigma = sigma_px;
    r->lobe[i].weight = weight;
}

static double area(double sigma_deg)
{
    return 2.0 * VEIL_PI * sigma_deg * sigma_deg;
}

static void sort_gaussians(sorting *s, const pupil_veil_config *c)
{
    const double narrowest_deg = s->result->narrowest_px * s->result->degrees_per_px;
    s->result->direct = 1.0;
    for (uint32_t i = 0; i < c->gaussians; i++) {
        const pupil_veil_gaussian g = c->gaussian[i];
        if (g.sigma < narrowest_deg) {
            add_narrow(s, g.sigma, g.weight);
            continue;
        }
        add_wide(s, g.sigma, g.weight / area(g.sigma));
        s->result->direct -= g.weight;
    }
}

/* The lobes that are wider than anything in the picture become one, with the same height and curvature. */
static void add_widest(sorting *s, const pupil_veil_config *c, double sigma, double unit)
{
    double height = 0.0, curvature = 0.0;
    for (; sigma < FLAT_DEG; sigma *= RATIO) {
        const double h = unit * lobe_of(c, sigma);
        height += h;
        curvature += h / (sigma * sigma);
    }
    if (c->psf == PUPIL_VEIL_CIE) {
        const double hollow = unit * (1.0 + 1.6 * age_of(c)) * HOLLOW_RISE;
        height += unit * 2.5e-3 * c->pigment + hollow;
        add_wide(s, HOLLOW_DEG, -hollow);
    }
    add_wide(s, pupil_root(height / curvature), height);
}

/* A Gaussian of height 1 summed along a side of the picture, from the side's end or its middle. */
static double sum_along(double side_px, double sigma_px, int from_middle)
{
    enum { STEPS = 64 };
    const double reach = from_middle ? 0.5 * side_px : side_px;
    double sum = 0.0;
    for (int i = 0; i <= STEPS; i++) { /* Simpson's rule */
        const double x = reach * i / STEPS / sigma_px;
        sum += (i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0) * pupil_decay(0.5 * x * x);
    }
    return sum * reach / STEPS / 3.0 * (from_middle ? 2.0 : 1.0);
}

/* The light of a picture of even light 1 at one of its corners, edges, or in its middle. */
static double even_light(const sorting *s, const pupil_veil_config *c, int middle_x, int middle_y)
{
    double sum = s->result->direct;
    for (uint32_t i = 0; i < s->count; i++) {
        const double sigma = s->wide[i].sigma_px;
        sum += s->wide[i].height * sum_along(c->width, sigma, middle_x) * sum_along(c->height, sigma, middle_y);
    }
    return sum;
}

/* Angles are flat here, as the picture is. A picture of over a hundred degrees has more area than there is around the
 * eye, so the formulas would add light. */
static void make_no_light(sorting *s, const pupil_veil_config *c)
{
    pupil_veil_result *r = s->result;
    double most = 1.0;
    for (int at = 0; at < 4; at++) {
        const double sum = even_light(s, c, at & 1, at >> 1);
        most = sum > most ? sum : most;
    }
    r->direct /= most;
    for (uint32_t i = 0; i < r->lobes; i++)
        r->lobe[i].weight /= most;
    for (uint32_t i = 0; i < s->count; i++)
        s->wide[i].height /= most;
}

static void sort_published(sorting *s, const pupil_veil_config *c)
{
    pupil_veil_result *r = s->result;
    const double unit = VEIL_STERADIANS / total_of(c), width = c->width, height = c->height; /* shares per square deg */
    const double picture_deg = pupil_root(width * width + height * height) * r->degrees_per_px;
    const double narrowest_deg = r->narrowest_px * r->degrees_per_px;
    double sigma = narrowest_deg / RATIO, in_place = 0.0;
    for (; sigma > LEAST_DEG; sigma /= RATIO) {
        const double weight = unit * lobe_of(c, sigma) * area(sigma);
        in_place += weight;
        add_narrow(s, sigma, weight);
    }
    if (c->psf == PUPIL_VEIL_SPENCER) { /* the first term is a Gaussian already */
        const double core = 0.02 * 0x1.6a09e667f3bcdp-1, core_height = unit * 0.384 * 2.61e6;
        if (core < narrowest_deg) {
            in_place += core_height * area(core);
            add_narrow(s, core, core_height * area(core));
        } else {
            add_wide(s, core, core_height);
        }
    }
    r->direct = in_place;
    for (sigma = narrowest_deg; sigma < 2.0 * picture_deg; sigma *= RATIO)
        add_wide(s, sigma, unit * lobe_of(c, sigma));
    add_widest(s, c, sigma, unit);
    make_no_light(s, c);
}

uint32_t pupil_veil_lobes(const pupil_veil_config *config, pupil_veil_result *result, veil_lobe lobe[VEIL_MOST_WIDE])
{
    const double side = config->width > config->height ? config->width : config->height;
    double cosine, sine;
    sorting s = {.result = result, .wide = lobe};
    pupil_circle(config->fov_deg / 720.0, &cosine, &sine);
    result->size_bytes = sizeof *result;
    result->degrees_per_px = 2.0 * sine / cosine / config->width * (180.0 / VEIL_PI);
    /* A series of N harmonics has a Gaussian to 0.03 % of its height where N >= 3.8 T / (2 pi sigma); cells and nodes
     * need a sigma of 5.8 of their distances: a lamp that moves then flickers by 2 % at most. */
    const double by_series = 3.8 * config->period / (2.0 * VEIL_PI * config->harmonics);
    const double narrowest_px = side * (by_series > 0.09 ? by_series : 0.09);
    result->narrowest_px = narrowest_px > LEAST_WIDE ? narrowest_px : LEAST_WIDE;
    if (config->psf == PUPIL_VEIL_GAUSSIANS)
        sort_gaussians(&s, config);
    else
        sort_published(&s, config);
    return s.count;
}
