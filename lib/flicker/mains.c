/* A lamp's wave, cos(2 pi (F t + k row)), k = F x readout turns, is fitted to what the rows move by from frame to frame
 * less their mean, by least squares, each frame's energy brought to 1. It is believed where it leaves less than it
 * explains beyond its rivals: the other F, and a wave that goes up, as which blinking lights and shade look just as
 * well (docs/sensor.md, Mains light). */
#include "mains.h"

#include "base/numeric.h"

#define FORGET     0.875 /* eight frames: half of those within which lamps are to be found */
#define ENOUGH     5.2   /* of energy: that of eight frames */
#define MUCH       6.0   /* times the energy that was usual: another scene */
#define LEAST_EV   5e-4  /* noise of a band of some hundred pixels: differences below it count less */
#define LEAST_LOG  0.007 /* log2: half a percent; nobody sees less */
#define STANDING   0.969 /* cosine of 0.04 turns: a wave that is so slow is taken for the scene's */
#define MOST_TURNS 10.5  /* over 21 groups: beyond, up looks like down */

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

/* What a wave of so many turns over the frame explains of the energy, c' G^-1 c, and its amplitude's square. */
static double explained(const pupil_mains *m, int h, double turns, double *amplitude2)
{
    const pupil_wave step = turn(turns * 3.0 / PUPIL_BANDS);
    const double n = PUPIL_MAINS_GROUPS;
    pupil_wave at = {1.0, 0.0}, c = {0.0, 0.0}, one = c, two = c, z = c;
    for (int g = 0; g < PUPIL_MAINS_GROUPS; g++) {
        add(&c, 1.0, times(at, (pupil_wave){(double)m->sum[h][g][0], (double)m->sum[h][g][1]}));
        add(&one, 1.0, at);
        add(&two, 1.0, times(at, at));
        at = times(at, step);
    }
    add(&two, -1.0 / n, times(one, one)); /* the mean over the rows goes from the wave, too */
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

/* Whether the sums speak of one of the two mains. */
static void listen(pupil_mains *m, double dt_s)
{
    double best[2] = {0.0, 0.0}, at[2] = {0.0, 0.0}, size[2] = {0.0, 0.0}, other = 0.0;
    for (int h = 0; h < 2; h++)
        for (double k = 0.25; k < light_hz[h] * dt_s + 0.5 && k < MOST_TURNS; k += k < 1.5 ? 0.25 : 0.5) {
            const double is = explained(m, h, k, &other);
            if (is > best[h])
                best[h] = is, at[h] = k, size[h] = other;
        }
    const int h = best[1] > best[0];
    const pupil_wave u = m->gram[h];
    /* half a turn a frame goes up as well as down; then it has to be a wave of some length, and little else */
    const int flips = u.c * u.c + u.s * u.s > 0.9 * m->half[h] * m->half[h] && at[h] > 1.4;
    const double up = flips ? 0.0 : explained(m, h, -at[h], &other), rival = up > best[!h] ? up : best[!h];
    if (!(best[h] - rival > (flips ? 4.0 : 1.0) * (m->energy - best[h])) || size[h] < LEAST_LOG * LEAST_LOG ||
        turn(light_hz[h] * dt_s).c > STANDING || turn(20.0 * dt_s).c > STANDING)
        return;
    m->hz = h ? 60 : 50;
    const double modulation = 0.6931471805599453 * pupil_exp2(0.5 * pupil_log2(size[h]));
    m->modulation = modulation < 1.0 ? modulation : 1.0; /* light that goes out has a longer way in log2 */
}

/* The groups' levels take the place of the last frame's; how they moved, and the squares' sum. */
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
    const double energy = take(m, stats, move), longer = (exposure_s - m->exposure_s) * 110.0; /* periods */
    const double noise = PUPIL_MAINS_GROUPS * LEAST_EV * LEAST_EV;
    /* lamps that go on are not to be weighed against the dark; and another exposure has another wave, which, where it
     * is a little longer, can be put together with those before */
    const int is_new = !(dt_s > 0.0 && dt_s < 1.0) || (m->usual >= 0.0 && energy > MUCH * m->usual + noise);
    const int goes_on = longer < 0.1 && longer > -0.1 && !is_new;
    const int counts = goes_on && longer < 0.01 && longer > -0.01;
    const double keep = goes_on ? FORGET : 0.0, weight = counts / (energy + noise);
    m->usual = is_new ? -1.0 : m->usual < 0.0 ? energy : m->usual + (1.0 - FORGET) * (energy - m->usual);
    m->exposure_s = exposure_s;
    m->energy = keep * m->energy + weight * energy;
    const double before = m->phase, now = before + 20.0 * dt_s;
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
        listen(m, dt_s);
}
