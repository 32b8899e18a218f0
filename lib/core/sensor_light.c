/* What light a frame had that is partly clipped. */
#include "sensor_object.h"

#include "numeric.h"

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

/* Of a normal distribution (mu, sigma) cut at C, what lies above counting as C, the share above C is c and the mean m:
 *     z = (C - mu) / sigma,   c = 1 - Phi(z),   m = C - sigma (z Phi(z) + phi(z))
 * which is solved for sigma, then mu. */
void pupil_sensor_guess(const pupil_sensor_config *config, const pupil_sensor_light *light, double *mean,
                        double *highlight)
{
    const double clip = pupil_log2(config->clip), c = light->clipped_share < 0.99 ? light->clipped_share : 0.99;
    *mean = light->mean;
    *highlight = clip;
    if (!(c > 1e-6))
        return;
    const double z = normal_quantile(c);
    const double phi = 0.3989422804014327 * pupil_exp2(-0.5 * 1.4426950408889634 * z * z);
    double sigma = (clip - light->mean) / (z * (1.0 - c) + phi);
    sigma = sigma < 0.0 ? 0.0 : sigma > 3.0 ? 3.0 : sigma; /* pictures of ordinary scenes have 1 to 2 stops */
    *mean = clip - z * sigma > *mean ? clip - z * sigma : *mean;
    if (c > config->highlight_share)
        *highlight += (normal_quantile(config->highlight_share) - z) * sigma;
}
