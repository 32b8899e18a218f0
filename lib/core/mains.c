/* Mains light: a row of frame n begins to be exposed at t_n + the row's share of the readout, so light of F Hz lies over
 * the rows as a wave
 *     cos(2 pi (F t_n + k row)),   k = F x readout turns over the frame,
 * which stands upon whatever the scene is and goes on from frame to frame by F dt turns: a third for 100 Hz and nothing
 * for 120 Hz at 30 frames a second. The scene goes away with the difference of two frames, and the level of all light
 * with the mean over the rows. What is left is fitted, for both F and all k up to a readout of a whole frame, by least
 * squares: c = sum of the differences times those of the wave's cosine and sine, G = the Gram matrix of these,
 * explained = c' G^-1 c of the energy. Each frame's energy is brought to 1 first, so that a cut or an arm before the
 * lens is but one frame of many.
 *
 * Lamps are found where what is explained is more than what is left, by so much that no other cause can be: blinking
 * light and shade fit a wave that goes up as well as one that goes down. */
#include "mains.h"

#include "numeric.h"

#define FORGET    0.875 /* eight frames: two thirds of those within which lamps are to be found */
#define LEAST_EV  5e-4  /* noise of a band of some hundred pixels; differences below it count less */
#define LEAST_LOG 0.007 /* log2: half a percent; nobody sees less */
#define STANDING  0.969 /* cosine of 0.04 turns, in a frame: slower waves are taken for the scene's */
#define ENOUGH    6     /* frames before anything is said */
#define IN_A_ROW  3     /* frames that have to say the same */

static const double light_hz[2] = {100.0, 120.0};

/* What a wave of so many turns over the frame explains of the energy, and its amplitude. Matrices of two by two that are
 * symmetric are written as half their trace and a complex number, which turning by an angle multiplies by twice it. */
static double explained(const pupil_mains *m, int h, double turns, double *amplitude)
{
    const double *v = m->gram[h];
    double step[2], at[2] = {1.0, 0.0}, c[2] = {0.0, 0.0}, one[2] = {0.0, 0.0}, two[2] = {0.0, 0.0};
    pupil_turn(turns * 3.0 / PUPIL_BANDS, step);
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        const float *s = m->sum[h][g];
        const double next = at[0] * step[0] - at[1] * step[1];
        c[0] += at[0] * (double)s[0] - at[1] * (double)s[1];
        c[1] += at[1] * (double)s[0] + at[0] * (double)s[1];
        one[0] += at[0], one[1] += at[1];
        two[0] += at[0] * at[0] - at[1] * at[1], two[1] += 2.0 * at[0] * at[1];
        at[1] = at[0] * step[1] + at[1] * step[0];
        at[0] = next;
    }
    const double n = PUPIL_MAINS_GROUPS, half = 0.5 * (v[0] + v[2]), u[2] = {0.5 * (v[0] - v[2]), v[1]};
    const double w[2] = {two[0] - (one[0] * one[0] - one[1] * one[1]) / n, two[1] - 2.0 * one[0] * one[1] / n};
    const double g0 = half * (n - (one[0] * one[0] + one[1] * one[1]) / n);
    const double g[2] = {u[0] * w[0] - u[1] * w[1], u[0] * w[1] + u[1] * w[0]};
    const double det = g0 * g0 - g[0] * g[0] - g[1] * g[1];
    if (!(det > 1e-4 * half * half))
        return 0.0;
    const double z[2] = {(g0 * c[0] - g[0] * c[0] - g[1] * c[1]) / det, (g0 * c[1] - g[1] * c[0] + g[0] * c[1]) / det};
    *amplitude = z[0] * z[0] + z[1] * z[1];
    return z[0] * c[0] + z[1] * c[1];
}

/* The modulation of light whose log2, gathered over an exposure, is a wave of that amplitude: the first harmonic of
 * ln(1 + m cos x) is 2 (1 - sqrt(1 - m^2)) / m. */
static double modulation_of(double amplitude, double periods)
{
    double wave[2];
    const double a = amplitude * 0.6931471805599453, pi = 3.141592653589793;
    pupil_turn(0.5 * periods, wave);
    const double left = wave[1] < 0.0 ? -wave[1] : wave[1], m = a / (1.0 + 0.25 * a * a) * pi * periods;
    return m < left ? m / left : 1.0;
}

/* A wave that goes on by so many turns a frame can hardly be told from one that stands. */
static int stands(double turns)
{
    double wave[2];
    pupil_turn(turns, wave);
    return wave[0] > STANDING;
}

/* 0, or the hertz of the mains that the sums speak of. */
static uint32_t spoken_of(const pupil_mains *m, double dt_s, double *modulation)
{
    double best[2] = {0.0, 0.0}, at[2] = {0.0, 0.0}, amplitude[2] = {0.0, 0.0}, other;
    for (int h = 0; h < 2; h++)
        for (double k = 0.25; k <= light_hz[h] * dt_s + 0.25; k += k < 1.5 ? 0.25 : 0.5) {
            double size = 0.0;
            const double is = explained(m, h, k, &size);
            if (is > best[h])
                best[h] = is, at[h] = k, amplitude[h] = size;
        }
    const int h = best[1] > best[0];
    const double *v = m->gram[h], apart = (v[0] - v[2]) * (v[0] - v[2]) + 4.0 * v[1] * v[1];
    const int flips = apart > 0.9 * (v[0] + v[2]) * (v[0] + v[2]) && at[h] > 1.4;
    const double back = flips ? 0.0 : explained(m, h, -at[h], &other), rival = back > best[!h] ? back : best[!h];
    if (!(best[h] - rival > (flips ? 4.0 : 1.0) * (m->energy - best[h])) ||
        amplitude[h] < LEAST_LOG * LEAST_LOG || stands(light_hz[h] * dt_s) || stands(20.0 * dt_s))
        return 0;
    *modulation = modulation_of(pupil_exp2(0.5 * pupil_log2(amplitude[h])), light_hz[h] * m->exposure_s);
    return h ? 60 : 50;
}

/* The groups' levels of this frame, instead of the last one's: how they moved, and the squares' sum. */
static double take(pupil_mains *m, const pupil_stats *stats, double move[PUPIL_MAINS_GROUPS])
{
    double mean = 0.0, count = 0.0, energy = 0.0;
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        const uint32_t *n = &stats->band_pixels[3 * g];
        const int64_t *sum = &stats->band_log2_sum[3 * g];
        const double pixels = (double)n[0] + (double)n[1] + (double)n[2];
        move[g] = pixels > 0.0 ? (double)(sum[0] + sum[1] + sum[2]) * 0x1p-24 / pixels : 1e9;
        mean += pixels > 0.0 ? move[g] : 0.0;
        count += pixels > 0.0;
    }
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        const double level = move[g] < 1e9 ? move[g] - mean / count : 0.0;
        move[g] = level - (double)m->before[g];
        m->before[g] = (float)level;
        energy += move[g] * move[g];
    }
    return energy;
}

void pupil_mains_frame(pupil_mains *m, const pupil_stats *stats, double exposure_s, double dt_s)
{
    double move[PUPIL_MAINS_GROUPS];
    const double energy = take(m, stats, move), weight = 1.0 / (energy + PUPIL_MAINS_GROUPS * LEAST_EV * LEAST_EV);
    const double longer = (exposure_s - m->exposure_s) * 110.0, changed = longer < 0.0 ? -longer : longer;
    m->exposure_s = exposure_s;
    if (!(dt_s > 0.0 && dt_s < 1.0) || changed > 0.1) /* a wave that cannot be put together with those before */
        m->frames = 0;
    if (!m->frames)
        m->energy = 0.0;
    const int counts = m->frames && changed < 0.01;
    const double keep = !m->frames ? 0.0 : counts ? FORGET : 1.0, add = counts ? weight : 0.0;
    m->energy = keep * m->energy + add * energy;
    for (int h = 0; h < 2; h++) {
        double now[2], x[2];
        m->phase[h] += light_hz[h] * dt_s;
        m->phase[h] -= (double)(int64_t)m->phase[h];
        pupil_turn(m->phase[h], now);
        for (int i = 0; i < 2; i++)
            x[i] = now[i] - m->wave[h][i], m->wave[h][i] = now[i];
        for (int i = 0; i < 3; i++)
            m->gram[h][i] = keep * m->gram[h][i] + add * x[i > 1] * x[i > 0];
        for (int g = 0; g < PUPIL_MAINS_GROUPS; g++)
            for (int i = 0; i < 2; i++)
                m->sum[h][g][i] = (float)(keep * (double)m->sum[h][g][i] + add * move[g] * x[i]);
    }
    m->frames += m->frames < 255;
    double modulation = 0.0;
    const uint32_t says = counts && m->frames > ENOUGH ? spoken_of(m, dt_s, &modulation) : 0;
    m->times = says && says == m->likely ? m->times + 1 : 1;
    m->likely = says;
    if (says && m->times >= IN_A_ROW)
        m->hz = says, m->modulation = modulation;
}
