/* What light a frame had that is partly clipped. */
#include "sensor_private.h"

#include "base/numeric.h"

/* x that a share p of a normal distribution lies above (Abramowitz, Stegun: Handbook of Mathematical Functions, 1964,
 * 26.2.23; error below 4.5e-4). */
static double normal_quantile(double p)
{
    const double tail = p < 0.5 ? p : 1.0 - p;
    const double t = pupil_exp2(0.5 * pupil_log2(-2.0 * 0.6931471805599453 * pupil_log2(tail))); /* sqrt(-2 ln tail) */
    const double x =
        t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    return p < 0.5 ? x : -x;
}

static double density(double z)
{
    /* beyond 37 below 2^-980; room grows without bound where sigma is small */
    return z > 37.0 ? 0.0 : 0.3989422804014327 * pupil_exp2(-0.5 * 1.4426950408889634 * z * z);
}

/* The share of it above z >= 0 (the same, 26.2.17; error below 7.5e-8). */
static double above(double z)
{
    const double t = 1.0 / (1.0 + 0.2316419 * z);
    return density(z) * t *
           (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
}

/* Of a normal distribution (mu, sigma) cut at C, what lies above counting as C, the share above C is c and the mean m:
 *     z = (C - mu) / sigma,   c = 1 - Phi(z),   m = C - sigma (z Phi(z) + phi(z))
 * which is solved for sigma, then mu. */
void pupil_sensor_guess(const pupil_sensor_config *config, const pupil_sensor_light *light, double wanted, double *mean,
                        double *highlight, double *lost)
{
    const double clip = pupil_log2(config->clip), c = light->clipped_share < 0.99 ? light->clipped_share : 0.99;
    *mean = light->mean;
    *highlight = clip;
    *lost = 0.0;
    if (!(c > 1e-6))
        return;
    const double z = normal_quantile(c), phi = density(z);
    double sigma = (clip - light->mean) / (z * (1.0 - c) + phi);
    sigma = sigma < 0.0 ? 0.0 : sigma > 3.0 ? 3.0 : sigma; /* pictures of ordinary scenes have 1 to 2 stops */
    *mean = clip - z * sigma > *mean ? clip - z * sigma : *mean;
    if (c > config->highlight_share)
        *highlight += (normal_quantile(config->highlight_share) - z) * sigma;
    /* where the mean of the whole has to be, so that the mean of what clip leaves of it is where it should */
    for (int i = 0; i < 4 && sigma > 0.0; i++) {
        const double room = (clip - wanted - *lost) / sigma;
        *lost = room > 0.0 ? sigma * (density(room) - room * above(room)) : 0.0;
    }
}
