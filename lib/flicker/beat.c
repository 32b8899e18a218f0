/* A sine is fitted to what the light (not its log2) moves by from one frame to the next, so that a scene that stands,
 * drifts or steps says nothing about it: normalised least mean squares (Widrow, Hoff: Adaptive switching circuits,
 * 1960) and a phase-locked loop of the second order. What it leaves unexplained decides whether it is told at all. */
#include "beat.h"

#include "base/numeric.h"

#define PAUSE_S      1.0    /* nothing is known after it */
#define CLOCK_FRAMES 128.0  /* timestamps are late by chance: a line through so many */
#define RATE         0.0625 /* at which it is learned anew, a frame; beats of fewer turns a frame are left alone */
#define MOST_OFF_HZ  0.5    /* of 100 and 120: far more than grids are off by */
#define MOST_POWER   0.2    /* of the wave, amplitude squared: lamps are at 0.3 of the mean light; more is a strobe */
#define CUT_EV2      1.0    /* from one frame to the next no lamp moves a stop */
#define SEEN_EV2     2.5e-5 /* 0.005 EV from frame to frame: less may be seen, and does not count as wrong */
#define OPEN         8.0    /* told where it explains all but this part of the power, until it is all but a third */
#define CLOSE        3.0

/* What is beyond the nearest whole number. */
static double part(double x)
{
    return x > -1e15 && x < 1e15 ? x - (double)(int64_t)(x < 0.0 ? x - 0.5 : x + 0.5) : 0.0;
}

/* Seconds since the frame before, without jitter: a line through all times, then the last ones (alpha-beta filter). */
static double tick(pupil_beat *b, double dt_s)
{
    const double frames = b->period_s > 0.0 ? dt_s / b->period_s : 0.0, even_s = (frames - part(frames)) * b->period_s;
    const double late_s = b->late_s + dt_s - even_s, n = b->frames < CLOCK_FRAMES ? b->frames + 1.0 : CLOCK_FRAMES;
    const double share = 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0));
    if (!(even_s > 0.0) || late_s > 0.25 * b->period_s || late_s < -0.25 * b->period_s) {
        b->period_s = dt_s, b->late_s = 0.0, b->frames = 2.0;
        return even_s + late_s;
    }
    b->period_s += 6.0 / (n * (n + 1.0)) * late_s * b->period_s / even_s;
    b->late_s = (1.0 - share) * late_s;
    b->frames = n;
    return even_s + share * late_s;
}

static double stops(const pupil_beat_lamp *l, double turn, double at[2])
{
    pupil_turn(turn, at);
    return pupil_log2(clamp(1.0 + l->wave[0] * at[0] + l->wave[1] * at[1], 0.0625, 16.0));
}

static void lamp_frame(pupil_beat_lamp *l, double hz, double period_s, double step_s, double moved)
{
    double was[2], is[2];
    const double before = stops(l, l->turn, was), turn = l->turn + (hz + l->off_hz) * step_s;
    const double left = moved - (stops(l, turn, is) - before), size = left * left;
    const double alias = part((hz + l->off_hz) * period_s), most = l->gate > 0.0 ? 9.0 * l->left + SEEN_EV2 : CUT_EV2;
    const double c = is[0] - was[0], s = is[1] - was[1], power = l->wave[0] * l->wave[0] + l->wave[1] * l->wave[1];
    /* what is far off teaches the less, the further */
    const double step = 2.0 * 0.6931 * RATE * left * (size > most ? most / size : 1.0) / (c * c + s * s + 0.01);
    l->turn = part(turn);
    if (size > most && moved * moved < 0.25 * size) /* it would have been right without the lamp */
        l->gone++;
    else if (size < 0.25 * moved * moved)
        l->gone = 0;
    if (l->gone > 1 || (alias < RATE && alias > -RATE))
        *l = (pupil_beat_lamp){.turn = l->turn, .gate = -1.0};
    if (l->gone > 1 || (size > most && !(l->gate > 0.0)))
        return;
    l->left += 0.5 * RATE * ((size < most ? size : most) - l->left);
    l->moved += size > most ? 0.0 : 0.5 * RATE * (moved * moved - l->moved);
    if (power > 1e-5) /* a wave that keeps turning has another frequency */
        l->off_hz -= RATE / 4.0 * step * (l->wave[0] * s - l->wave[1] * c) / (6.2832 * power * period_s);
    l->off_hz = clamp(l->off_hz, -MOST_OFF_HZ, MOST_OFF_HZ);
    l->wave[0] += step * c, l->wave[1] += step * s;
    const double need = l->gate > 0.0 ? CLOSE : OPEN;
    const int is_clear = l->moved > SEEN_EV2 && l->left * need < l->moved && power < MOST_POWER;
    l->gate = clamp(l->gate + (is_clear ? 0.5 * RATE : -RATE), -1.0, 1.0);
}

void pupil_beat_frame(pupil_beat *b, double light, double exposure_s, int64_t timestamp_ns)
{
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    /* timestamps are of the exposure's middle; it is its end that comes regularly */
    const double shorter_s = exposure_s > 0.0 && b->exposure_s > 0.0 ? 0.5 * (b->exposure_s - exposure_s) : 0.0;
    if (timestamp_ns && timestamp_ns == b->timestamp_ns) /* the same frame again */
        return;
    const double end_s = since_s - shorter_s; /* from end to end; any number where info's exposures are none */
    if (timestamp_ns && b->timestamp_ns && since_s > 0.0 && since_s < PAUSE_S && end_s > 0.0 && end_s < PAUSE_S) {
        b->step_s = tick(b, end_s) + shorter_s;
        for (int i = 0; i < 2; i++)
            lamp_frame(&b->lamp[i], 100.0 + 20.0 * i, b->period_s, b->step_s, light - b->light);
    } else {
        *b = (pupil_beat){.lamp = {{.gate = -1.0}, {.gate = -1.0}}};
    }
    b->timestamp_ns = timestamp_ns, b->light = light, b->exposure_s = exposure_s;
}

double pupil_beat_at(const pupil_beat *b, int64_t timestamp_ns)
{
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    const int i = b->lamp[1].gate > b->lamp[0].gate; /* at some frame rates both lamps have the same beat */
    const pupil_beat_lamp *l = &b->lamp[i];
    double at[2];
    if (!(l->gate > 0.0 && timestamp_ns && since_s > -PAUSE_S && since_s < PAUSE_S))
        return 0.0;
    const double frames = since_s / b->period_s, turns = (100.0 + 20.0 * i + l->off_hz) * b->period_s;
    return l->gate * stops(l, l->turn + (frames - part(frames)) * turns, at);
}
