/* The frequency of the mains, from the bands that lamps leave in frames of a rolling shutter.
 *
 * A row is exposed at the frame's time and its own share of the readout. Light of F Hz is therefore a wave over the
 * rows, cos(2 pi (F t + k row)) with k = F x readout turns over the frame. From frame to frame it moves on by F dt
 * turns: at 30 frames a second by a third of a turn at 100 Hz, and not at all at 120 Hz.
 *
 * Differences between frames hold nothing of a still scene, and without their mean over the rows no change of all
 * light. Waves are fitted to them by least squares, for both F and every k up to a readout of a whole frame. Each
 * frame's energy is first scaled to 1, so that a cut counts no more than any other frame.
 *
 * A wave is accepted if it leaves less energy than it explains beyond its rivals. These are the other F and the wave
 * that goes up instead of down: a blinking light, shade and a shaken camera fit both directions equally well. */
#include "mains.h"

#include "base/numeric.h"

#define FORGET     0.875 /* eight frames: half of those within which flicker has to be found */
#define ENOUGH     5.2   /* energy: of eight frames that fade by FORGET: 8 x (1 - 0.875^8) */
#define MUCH       6.0   /* times the usual energy: another scene */
#define LEAST_EV   5e-4  /* noise of a band of some hundred pixels: differences below it count less */
#define LEAST_LOG  0.007 /* log2: half a percent of modulation; nobody sees less */
#define STANDING   0.969 /* cosine of 0.04 turns: a wave that moves less a frame may belong to the scene */
#define MOST_TURNS 10.5  /* over 21 groups: with more turns up and down look the same (Nyquist) */
#define LN2        0.6931471805599453

static const double light_hz[2] = {100.0, 120.0};

static pupil_wave turn(double x)
{
    double at[2];
    pupil_turn(x, at);
    return (pupil_wave){at[0], at[1]};
}

static pupil_wave times(pupil_wave a, pupil_wave b)
{
    return (pupil_wave){a.c * b.c - a.s * b.s, a.c * b.s + a.s * b.c};
}

static void add(pupil_wave *sum, double factor, pupil_wave a)
{
    sum->c += factor * a.c;
    sum->s += factor * a.s;
}

/* How much of the energy a wave of so many turns over the frame explains, and the square of its amplitude. It is
 * c' G^-1 c, where c is the sum of the differences times the wave's own, and G the wave's Gram matrix. */
static double explained(const pupil_mains *m, int h, double turns, double *amplitude2)
{
    const pupil_wave step = turn(turns * 3.0 / PUPIL_BANDS);
    const double n = PUPIL_MAINS_GROUPS;
    pupil_wave at = {1.0, 0.0};
    pupil_wave c = {0.0, 0.0};
    pupil_wave one = {0.0, 0.0}; /* the sum of the wave over the rows */
    pupil_wave two = {0.0, 0.0}; /* ... and of its square: G's part that turns twice as far */
    pupil_wave z = {0.0, 0.0};   /* G^-1 c */
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        add(&c, 1.0, times(at, (pupil_wave){(double)m->sum[h][g][0], (double)m->sum[h][g][1]}));
        add(&one, 1.0, at);
        add(&two, 1.0, times(at, at));
        at = times(at, step);
    }
    add(&two, -1.0 / n, times(one, one)); /* the wave, too, loses its mean over the rows */
    const double half = m->half[h] * (n - (one.c * one.c + one.s * one.s) / n);
    const pupil_wave g = times(m->gram[h], two);
    const double det = half * half - g.c * g.c - g.s * g.s;
    if (!(det > 1e-4 * m->half[h] * m->half[h]))
        return 0.0;
    add(&z, half / det, c);
    add(&z, -1.0 / det, times(g, (pupil_wave){c.c, -c.s}));
    *amplitude2 = z.c * z.c + z.s * z.s;
    return z.c * c.c + z.s * c.s;
}

typedef struct fit {
    double explained;
    double turns; /* over the frame */
    double amplitude2;
} fit;

/* The wave of 100 (h = 0) or 120 Hz that explains most. A readout of up to a whole frame and half a turn is tried; long
 * waves in finer steps, because a quarter of a turn makes more of a difference to them. */
static fit best_fit(const pupil_mains *m, int h, double dt_s)
{
    fit best = {0.0, 0.0, 0.0};
    for (double k = 0.25; k < light_hz[h] * dt_s + 0.5 && k < MOST_TURNS; k += k < 1.5 ? 0.25 : 0.5) {
        fit one = {0.0, k, 0.0};
        one.explained = explained(m, h, k, &one.amplitude2);
        if (one.explained > best.explained)
            best = one;
    }
    return best;
}

/* Decides for one of the two frequencies if the sums are clear enough. */
static void decide(pupil_mains *m, double dt_s)
{
    const fit best[2] = {best_fit(m, 0, dt_s), best_fit(m, 1, dt_s)};
    const int h = best[1].explained > best[0].explained;
    const fit *found = &best[h];
    const double other = best[!h].explained;
    const pupil_wave u = m->gram[h];
    /* A wave that moves by half a turn a frame fits both directions. Then it must have some length and leave little. */
    const int flips = u.c * u.c + u.s * u.s > 0.9 * m->half[h] * m->half[h] && found->turns > 1.4;
    double amplitude2;
    const double up = flips ? 0.0 : explained(m, h, -found->turns, &amplitude2);
    const double rival = up > other ? up : other;
    const double left = m->energy - found->explained;
    if (!(found->explained - rival > (flips ? 4.0 : 1.0) * left) || found->amplitude2 < LEAST_LOG * LEAST_LOG)
        return;
    /* it, or its difference from the other one (20 Hz), hardly moves from frame to frame */
    if (turn(light_hz[h] * dt_s).c > STANDING || turn(20.0 * dt_s).c > STANDING)
        return;
    m->hz = h ? 60 : 50;
    const double modulation = LN2 * pupil_exp2(0.5 * pupil_log2(found->amplitude2));
    m->modulation = modulation < 1.0 ? modulation : 1.0; /* towards dark, log2 falls further than light does */
}

/* Replaces the last frame's levels of the groups. Returns the sum of the squares of their changes. */
static double take(pupil_mains *m, const pupil_stats *stats, double move[PUPIL_MAINS_GROUPS])
{
    double mean = 0.0, energy = 0.0;
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        const uint32_t *n = &stats->band_pixels[3 * g];
        const int64_t *sum = &stats->band_log2_sum[3 * g];
        const double pixels = (double)n[0] + (double)n[1] + (double)n[2];
        move[g] = pixels > 0.0 ? (double)(sum[0] + sum[1] + sum[2]) * 0x1p-24 / pixels : 0.0;
        mean += move[g] / PUPIL_MAINS_GROUPS;
    }
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        const double before = (double)m->before[g];
        m->before[g] = (float)(move[g] - mean);
        move[g] -= mean + before;
        energy += move[g] * move[g];
    }
    return energy;
}

void pupil_mains_frame(pupil_mains *m, const pupil_stats *stats, double exposure_s, double dt_s)
{
    double move[PUPIL_MAINS_GROUPS];
    const double energy = take(m, stats, move);
    const double noise = PUPIL_MAINS_GROUPS * LEAST_EV * LEAST_EV;
    const double longer = (exposure_s - m->exposure_s) * 110.0; /* in periods of light between 100 and 120 Hz */
    /* Lamps that are switched on must not be compared with the dark before. */
    const int is_new = !(dt_s > 0.0 && dt_s < 1.0) || (m->usual >= 0.0 && energy > MUCH * m->usual + noise);
    /* Another exposure time has another wave. If it differs by little, the sums stay, but this difference of frames
     * does not count. */
    const int goes_on = longer < 0.1 && longer > -0.1 && !is_new;
    const int counts = goes_on && longer < 0.01 && longer > -0.01;
    const double keep = goes_on ? FORGET : 0.0;
    const double weight = counts / (energy + noise);
    if (is_new)
        m->usual = -1.0;
    else if (m->usual < 0.0)
        m->usual = energy;
    else
        m->usual += (1.0 - FORGET) * (energy - m->usual);
    m->exposure_s = exposure_s;
    m->energy = keep * m->energy + weight * energy;
    /* the phases of 100 and 120 Hz are five and six times that of 20 Hz */
    const double before = m->phase;
    const double now = before + 20.0 * dt_s;
    m->phase = now - (double)(int64_t)now;
    for (int h = 0; h < 2; h++) {
        pupil_wave x = turn((5.0 + h) * m->phase);
        add(&x, -1.0, turn((5.0 + h) * before));
        m->half[h] = keep * m->half[h] + 0.5 * weight * (x.c * x.c + x.s * x.s);
        m->gram[h] = (pupil_wave){keep * m->gram[h].c, keep * m->gram[h].s};
        add(&m->gram[h], 0.5 * weight, times(x, x));
        for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
            m->sum[h][g][0] = (float)(keep * (double)m->sum[h][g][0] + weight * move[g] * x.c);
            m->sum[h][g][1] = (float)(keep * (double)m->sum[h][g][1] + weight * move[g] * x.s);
        }
    }
    if (counts && m->energy > ENOUGH)
        decide(m, dt_s);
}
