/* The lamps' wave as a sum of terms: what they are in a frame, and their coefficients from the normal equations. */
#include "row_gain_private.h"

#include "base/numeric.h"

enum { HARMONICS = PUPIL_ROW_GAIN_HARMONICS, TERMS = PUPIL_ROW_GAIN_TERMS, BANDS = PUPIL_BANDS };

#define PI 0x1.921fb54442d18p+1

double pupil_row_gain_averaged(double light_hz, int h, double seconds)
{
    double cosine, sine;
    const double turns = 0.5 * light_hz * h * seconds;
    pupil_circle(turns, &cosine, &sine);
    return turns > 1e-6 ? sine / (2.0 * PI * turns) : 1.0;
}

void pupil_row_gain_expose(pupil_row_gain_object *o, double exposure_s)
{
    const double *k = o->coefficient;
    const double per_band_s = o->result.readout_s / BANDS;
    const double hz = o->result.light_hz;
    o->exposure_s = exposure_s;
    for (int h = 0; h < HARMONICS; h++) {
        const double left =
            pupil_row_gain_averaged(hz, h + 1, exposure_s) * pupil_row_gain_averaged(hz, h + 1, per_band_s);
        const double more = left - o->left[h];
        o->left[h] = left;
        for (int b = 0; b < BANDS; b++) {
            const double *mean = o->term_mean[b] + 2 * h;
            const double wave = more * (k[2 * h] * mean[0] + k[2 * h + 1] * mean[1]);
            for (int g = 0; g < PUPIL_ROW_GAIN_GROUPS; g++)
                o->light_mean[g][b] += wave;
        }
    }
}

void pupil_row_gain_fill_terms(pupil_row_gain_object *o)
{
    double cosine, sine;
    for (int b = 0; b < BANDS; b++) {
        pupil_circle(o->turn + o->result.light_hz * o->result.readout_s * o->place[b], &cosine, &sine);
        double c = cosine, s = sine;
        for (int h = 0; h < HARMONICS; h++) {
            o->term[b][2 * h] = c;
            o->term[b][2 * h + 1] = s;
            const double next = c * cosine - s * sine;
            s = s * cosine + c * sine;
            c = next;
        }
    }
}

/* What the harmonics are if the lamps' light is a sine: log2(1 + m cos p) is the sum of
 * 2 r^h cos(h p) (-1)^(h+1) / (h ln 2) and a constant, r = (1 - sqrt(1 - m^2)) / m. */
static void of_sine(const double k[2], double usual[TERMS])
{
    const double ln2 = 0x1.62e42fefa39efp-1, c = 0.5 * ln2 * k[0], s = 0.5 * ln2 * k[1]; /* r and the phase */
    double power_c = c, power_s = s;
    usual[0] = usual[1] = 0.0; /* nothing is expected of the fundamental */
    for (int h = 1; h < HARMONICS; h++) {
        const double next = power_c * c - power_s * s;
        const double sign = h % 2 ? -2.0 : 2.0;
        power_s = power_s * c + power_c * s;
        power_c = next;
        usual[2 * h] = sign * power_c / ((h + 1) * ln2);
        usual[2 * h + 1] = sign * power_s / ((h + 1) * ln2);
    }
}

/* coefficient = (matrix + prior)^-1 (side + prior x usual), by elimination: the matrix is symmetric and, with the
 * prior, positive. A harmonic that does not move (the third of 100 Hz at 30 frames a second) looks like the scene. It
 * is used if it moves a tenth as much as the fundamental; else that of a sine is. */
void pupil_row_gain_solve(pupil_row_gain_object *o)
{
    const double harmonic = PUPIL_ROW_GAIN_PRIOR + 0.01 * (o->matrix[0][0] + o->matrix[1][1]);
    double a[TERMS][TERMS], x[TERMS], usual[TERMS];
    of_sine(o->coefficient, usual);
    for (int i = 0; i < TERMS; i++) {
        x[i] = o->side[i] + (i < 2 ? 0.0 : harmonic * usual[i]);
        for (int j = 0; j < TERMS; j++)
            a[i][j] = o->matrix[i][j] + (i != j ? 0.0 : i < 2 ? PUPIL_ROW_GAIN_PRIOR : harmonic);
    }
    for (int i = 0; i < TERMS; i++)
        for (int j = i + 1; j < TERMS; j++) {
            const double factor = a[j][i] / a[i][i];
            for (int k = i; k < TERMS; k++)
                a[j][k] -= factor * a[i][k];
            x[j] -= factor * x[i];
        }
    for (int i = TERMS; i-- > 0;) {
        for (int k = i + 1; k < TERMS; k++)
            x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
    for (int i = 0; i < TERMS; i++)
        o->coefficient[i] = x[i];
}
