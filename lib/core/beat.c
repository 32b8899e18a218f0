/* The wave of a lamp is fitted to what the light moves by from one frame to the next, so that a scene that stands,
 * drifts or steps says nothing about it: least mean squares, normalised (Widrow, Hoff: Adaptive switching circuits,
 * 1960), and a phase-locked loop of the second order for the mains' own frequency. It is the light that is a sine, not
 * its log2. What the wave leaves unexplained decides whether it is told at all. */
#include "beat.h"

#include "numeric.h"

#define LN2 0.6931471805599453

#define PAUSE_S      1.0      /* nothing is known after it */
#define CLOCK_FRAMES 128.0    /* timestamps are late by chance: a line through so many */
#define RATE         0.0625   /* most that is learned of a frame; of slow beats a whole beat's share */
#define SLOWEST      0.015625 /* turns a frame: a beat of 64 frames; what is slower, the level's filter has to do with */
#define MOST_OFF_HZ  0.5      /* of 100 and 120: far more than grids are off by */
#define MOST_WAVE    0.45     /* lamps are at 0.3; more is a strobe */
#define CUT_EV       1.0      /* from one frame to the next no lamp moves that much */
#define SEEN_EV2     2.5e-5   /* 0.005 EV from frame to frame: less may be seen, and does not count as wrong */
#define OLD          4.0      /* ages after which a wave is believed */
#define OPEN         8.0      /* ... where it explains all but this part of the power; until it is all but a third */
#define CLOSE        3.0

static double whole(double x)
{
    return (double)(int64_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

/* How far from a whole number. */
static double beyond(double x)
{
    x -= whole(x);
    return x < 0.0 ? -x : x;
}

/* Seconds since the frame before, as they would be without jitter: frames' ends are a period apart, or some. The line
 * through all ends so far, then through the last ones (alpha-beta filter with the gains of least squares). */
static double tick(pupil_beat *b, double dt_s)
{
    const double gap = b->period_s > 0.0 ? whole(dt_s / b->period_s) : 0.0,
                 late_s = b->late_s + dt_s - gap * b->period_s;
    if (gap < 1.0 || late_s > 0.25 * b->period_s || late_s < -0.25 * b->period_s) {
        const double step_s = b->late_s + dt_s;
        b->period_s = dt_s, b->late_s = 0.0, b->frames = 2.0;
        return step_s;
    }
    b->frames += b->frames < CLOCK_FRAMES;
    const double n = b->frames, share = 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0));
    const double step_s = gap * b->period_s + share * late_s;
    b->period_s += 6.0 / (n * (n + 1.0)) * late_s / gap;
    b->late_s = (1.0 - share) * late_s;
    return step_s;
}

/* log2 of the lamp's light over its mean; the cosine and sine of each harmonic. */
static double wave_at(const pupil_beat_lamp *l, double turn, double at[PUPIL_BEAT_HARMONICS][2])
{
    double light = 1.0;
    for (int k = 0; k < PUPIL_BEAT_HARMONICS; k++) {
        pupil_turn(turn * (k + 1), at[k]);
        light += l->wave[k][0] * at[k][0] + l->wave[k][1] * at[k][1];
    }
    return pupil_log2(light > 0.0625 ? light : 0.0625);
}

/* One step of the fit by what is left; and of the frequency by how far that turned the wave. */
static void learn(pupil_beat_lamp *l, double left, double rate, double alias, double period_s, double was[][2],
                  double is[][2])
{
    /* seen at these times, twice the frequency may be the same: then one does for both */
    const int harmonics = beyond(3.0 * alias) < rate ? 1 : PUPIL_BEAT_HARMONICS;
    for (int k = harmonics; k < PUPIL_BEAT_HARMONICS; k++)
        l->wave[k][0] = l->wave[k][1] = 0.0;
    for (int k = 0; k < harmonics; k++) {
        double *w = l->wave[k];
        const double c = is[k][0] - was[k][0], s = is[k][1] - was[k][1], size = c * c + s * s;
        const double step = size > 0.01 ? 2.0 * LN2 * rate * left / size : 0.0, power = w[0] * w[0] + w[1] * w[1];
        if (k == 0 && power > 1e-5)
            l->off_hz -= rate / 4.0 * step * (w[0] * s - w[1] * c) / (6.283185307179586 * power * period_s);
        w[0] += step * c, w[1] += step * s;
    }
    l->off_hz = l->off_hz < -MOST_OFF_HZ ? -MOST_OFF_HZ : l->off_hz > MOST_OFF_HZ ? MOST_OFF_HZ : l->off_hz;
}

static void lamp_frame(pupil_beat_lamp *l, double hz, double period_s, double step_s, double moved, int alone)
{
    double was[PUPIL_BEAT_HARMONICS][2], is[PUPIL_BEAT_HARMONICS][2];
    const double alias = beyond((hz + l->off_hz) * period_s);
    const double turn = l->turn + (hz + l->off_hz) * step_s, before = wave_at(l, l->turn, was);
    double left = moved - (wave_at(l, turn, is) - before);
    const double most = CLOSE * CLOSE * l->left + SEEN_EV2, size = left * left;
    l->turn = turn - whole(turn);
    if (l->gate > 0.0 && size > most && moved * moved < 0.25 * size) /* it would have been right without the lamp */
        l->gone++;
    else if (size < 0.25 * moved * moved)
        l->gone = 0;
    if (l->gone > 1 || alias < SLOWEST) {
        *l = (pupil_beat_lamp){.turn = l->turn};
        return;
    }
    const double rate = alias < RATE ? alias : RATE;
    const int odd = l->gate > 0.0 ? size > most : moved > CUT_EV || moved < -CUT_EV;
    if (odd && !(l->gate > 0.0))
        return;
    l->left += 0.5 * rate * ((odd ? most : size) - l->left);
    if (odd)
        left *= most / size;
    else
        l->moved += 0.5 * rate * (moved * moved - l->moved);
    learn(l, left, rate, alias, period_s, was, is);
    const double power = l->wave[0][0] * l->wave[0][0] + l->wave[0][1] * l->wave[0][1] + l->wave[1][0] * l->wave[1][0] +
                         l->wave[1][1] * l->wave[1][1];
    l->age += l->age < OLD ? rate : 0.0;
    const int believed = l->age >= OLD && alone && l->moved > SEEN_EV2 && power < MOST_WAVE * MOST_WAVE &&
                         l->left * (l->gate > 0.0 ? CLOSE : OPEN) < l->moved;
    l->gate += believed ? 0.5 * rate : -rate;
    l->gate = l->gate < 0.0 ? 0.0 : l->gate > 1.0 ? 1.0 : l->gate;
    if (power > 1.0) /* nothing like a lamp: from the beginning */
        *l = (pupil_beat_lamp){.turn = l->turn};
}

void pupil_beat_frame(pupil_beat *b, double light, double exposure_s, int64_t timestamp_ns)
{
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    if (timestamp_ns && timestamp_ns == b->timestamp_ns) /* the same frame again */
        return;
    if (!timestamp_ns || !b->timestamp_ns || !(since_s > 0.0 && since_s < PAUSE_S)) {
        *b = (pupil_beat){.timestamp_ns = timestamp_ns, .light = light, .exposure_s = exposure_s};
        return;
    }
    /* timestamps are of the exposure's middle; it is its end that comes regularly */
    const double shorter_s = exposure_s > 0.0 && b->exposure_s > 0.0 ? 0.5 * (b->exposure_s - exposure_s) : 0.0;
    if (!(since_s - shorter_s > 0.0))
        return;
    const double step_s = tick(b, since_s - shorter_s) + shorter_s;
    for (int i = 0; i < PUPIL_BEAT_LAMPS; i++)
        lamp_frame(&b->lamp[i], 100.0 + 20.0 * i, b->period_s, step_s, light - b->light,
                   !(b->lamp[PUPIL_BEAT_LAMPS - 1 - i].gate > 0.0));
    b->timestamp_ns = timestamp_ns;
    b->light = light;
    b->exposure_s = exposure_s;
}

double pupil_beat_at(const pupil_beat *b, int64_t timestamp_ns)
{
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    double at[PUPIL_BEAT_HARMONICS][2], beat = 0.0;
    if (!timestamp_ns || !b->timestamp_ns || !(since_s > -PAUSE_S && since_s < PAUSE_S))
        return 0.0;
    const double step_s = b->period_s > 0.0 ? whole(since_s / b->period_s) * b->period_s : 0.0;
    for (int i = 0; i < PUPIL_BEAT_LAMPS; i++) {
        const pupil_beat_lamp *l = &b->lamp[i];
        if (l->gate > 0.0)
            beat += l->gate * wave_at(l, l->turn + (100.0 + 20.0 * i + l->off_hz) * step_s, at);
    }
    return beat;
}
