/* Estimates the light of a partly clipped frame. */
#include "sensor_private.h"

#include "base/numeric.h"

/* The x above which a normal distribution has the share p. */
static double normal_quantile(double p)
{
    static const double up[] = SENSOR_QUANTILE_UP, down[] = SENSOR_QUANTILE_DOWN;
    const double tail = p < 0.5 ? p : 1.0 - p;
    const double t = pupil_exp2(0.5 * pupil_log2(-2.0 * SENSOR_LN2 * pupil_log2(tail))); /* sqrt(-2 ln tail) */
    const double x = t - (up[0] + t * (up[1] + t * up[2])) / (1.0 + t * (down[0] + t * (down[1] + t * down[2])));
    return p < 0.5 ? x : -x;
}

static double density(double z)
{
    /* z has no upper bound where the spread is small */
    return z > SENSOR_NORMAL_END ? 0.0 : SENSOR_NORMAL_DENSITY * pupil_exp2(-0.5 * SENSOR_LOG2_E * z * z);
}

/* The share of a normal distribution above z >= 0. */
static double share_above(double z)
{
    static const double k[] = SENSOR_ABOVE;
    const double t = 1.0 / (1.0 + SENSOR_ABOVE_SCALE * z);
    double sum = 0.0;
    for (int i = (int)(sizeof k / sizeof k[0]) - 1; i >= 0; i--)
        sum = t * (k[i] + sum);
    return density(z) * sum;
}

/* Of a normal distribution (mu, sigma) cut at C, what is above counting as C, the share above C is c and the mean m:
 *     z = (C - mu) / sigma,   c = 1 - Phi(z),   m = C - sigma (z Phi(z) + phi(z))
 * which is solved for sigma, then mu. */
void pupil_sensor_guess(const pupil_sensor_config *config, const sensor_evidence *v, double wanted, double *mean,
                        double *highlight, double *lost)
{
    const double c = smaller(v->clipped_share, SENSOR_CLIPPED_MOST);
    *mean = v->mean;
    *highlight = v->white;
    *lost = 0.0;
    if (!(c > SENSOR_CLIPPED_LEAST))
        return;
    const double z = normal_quantile(c);
    const double sigma = clamp((v->white - v->mean) / (z * (1.0 - c) + density(z)), 0.0, SENSOR_SPREAD_MOST_EV);
    *mean = v->white - z * sigma > *mean ? v->white - z * sigma : *mean;
    if (c > config->highlight_share)
        *highlight += (normal_quantile(config->highlight_share) - z) * sigma;
    /* finds where the true mean has to be, so that the mean after clipping is as wanted */
    for (int i = 0; i < SENSOR_LOST_ROUNDS && sigma > 0.0; i++) {
        const double room = (v->white - wanted - *lost) / sigma;
        *lost = room > 0.0 ? sigma * (density(room) - room * share_above(room)) : 0.0;
    }
}
