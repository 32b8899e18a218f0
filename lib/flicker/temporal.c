/* The flicker of mains light, seen once a frame, is an alias: 100 Hz at 30 frames a second goes up and down at 10 Hz,
 * all of the picture at once. A sine is fitted to it, for 100 and for 120 Hz each.
 *
 * The fit is made to how far the light moves from one frame to the next. A scene that is still, drifts or steps then
 * contributes nothing but the one frame of its step. It is the light that is a sine, not its log2.
 * The amplitude and phase follow by normalised least mean squares (Widrow, Hoff: Adaptive switching circuits, 1960),
 * the mains' own frequency by a phase-locked loop of the second order.
 * How much of the movement the sine leaves unexplained decides whether it is used at all. */
#include "temporal.h"

#include "base/numeric.h"

#define PAUSE_S      1.0   /* after a longer pause nothing is known */
#define CLOCK_FRAMES 128.0 /* timestamps jitter: a line is fitted to about this many */
#define RATE                                                                                                           \
    0.0625               /* share that a frame has in the fit; flicker of fewer turns a frame is left alone, because   \
                          * the level's own filter follows it */
#define MOST_OFF_HZ  0.5 /* from 100 and 120 Hz: far more than grids deviate */
#define MOST_POWER   0.2 /* of the sine, amplitude squared: lamps reach 0.3 of the mean light; more is a strobe */
#define CUT_EV2      1.0 /* no lamp moves the light by a stop from one frame to the next: that is another scene */
#define SEEN_EV2     2.5e-5 /* 0.005 EV from frame to frame: less cannot be seen, and does not count as a miss */
#define OPEN         8.0    /* the sine is used once it explains all but an eighth of the power ... */
#define CLOSE        3.0    /* ... until it explains no more than all but a third */
#define MISS2        9.0    /* a frame that is three standard deviations off is no measurement of the sine */
#define LN2          0.6931 /* a stop as a share of the light; the length of a step needs no more digits */
#define TWO_PI       6.2832
#define LEAST_CHANGE 0.01 /* keeps the step finite where the sine hardly moves between two frames */
#define LEAST_POWER  1e-5 /* a sine of 0.3 %: below, its phase is noise */

/* The difference from the nearest whole number, -0.5 to 0.5; 0 for numbers that are too large to have a fraction. */
static double part(double x)
{
    return x > -1e15 && x < 1e15 ? x - (double)(int64_t)(x < 0.0 ? x - 0.5 : x + 0.5) : 0.0;
}

/* Seconds since the frame before, without the timestamps' jitter. An alpha-beta filter: its gains are those of the line
 * of least squares through all n frames so far. From CLOCK_FRAMES on they are constant, so that the oldest frames
 * fade. */
static double tick(pupil_flicker *b, double dt_s)
{
    const double frames = b->period_s > 0.0 ? dt_s / b->period_s : 0.0; /* above 1.5 where some were dropped */
    const double even_s = (frames - part(frames)) * b->period_s;
    const double late_s = b->late_s + dt_s - even_s;
    const double n = b->frames < CLOCK_FRAMES ? b->frames + 1.0 : CLOCK_FRAMES;
    const double position_gain = 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0));
    const double period_gain = 6.0 / (n * (n + 1.0));
    if (!(even_s > 0.0) || late_s > 0.25 * b->period_s || late_s < -0.25 * b->period_s) { /* another frame rate */
        b->period_s = dt_s;
        b->late_s = 0.0;
        b->frames = 2.0;
        return even_s + late_s;
    }
    b->period_s += period_gain * late_s * b->period_s / even_s;
    b->late_s = (1.0 - position_gain) * late_s;
    b->frames = n;
    return even_s + position_gain * late_s;
}

/* By how many stops the lamp is above its mean at a point of its wave; the cosine and sine there. */
static double stops(const pupil_flicker_light *l, double turn, double at[2])
{
    pupil_turn(turn, at);
    return pupil_log2(clamp(1.0 + l->wave[0] * at[0] + l->wave[1] * at[1], 0.0625, 16.0));
}

/* Updates the model of one lamp by a frame: in step_s seconds since the last one the light changed by `moved` stops. */
static void lamp_frame(pupil_flicker_light *l, double hz, double period_s, double step_s, double moved)
{
    double was[2];
    double is[2];
    const double turn = l->turn + (hz + l->off_hz) * step_s;
    const double before = stops(l, l->turn, was);
    const double left = moved - (stops(l, turn, is) - before);
    const double left2 = left * left;
    const double c = is[0] - was[0];
    const double s = is[1] - was[1];
    const double power = l->wave[0] * l->wave[0] + l->wave[1] * l->wave[1];
    const double alias = part((hz + l->off_hz) * period_s);
    const int is_slow = alias < RATE && alias > -RATE;
    const double most = l->gate > 0.0 ? MISS2 * l->left + SEEN_EV2 : CUT_EV2;
    const int is_miss = left2 > most;
    /* the larger a miss, the smaller its step */
    const double step = 2.0 * LN2 * RATE * left * (is_miss ? most / left2 : 1.0) / (c * c + s * s + LEAST_CHANGE);

    l->turn = part(turn);
    if (is_miss && moved * moved < 0.25 * left2) /* the prediction without the lamp would have been right */
        l->gone++;
    else if (left2 < 0.25 * moved * moved)
        l->gone = 0;
    if (l->gone > 1 || is_slow)
        *l = (pupil_flicker_light){.turn = l->turn, .gate = -1.0};
    if (is_miss && !(l->gate > 0.0)) /* also one that has just ended it */
        return;

    l->left += 0.5 * RATE * ((left2 < most ? left2 : most) - l->left);
    l->moved += is_miss ? 0.0 : 0.5 * RATE * (moved * moved - l->moved);
    if (power > LEAST_POWER) /* a step across the wave turns it: a wave that keeps turning has another frequency */
        l->off_hz -= RATE / 4.0 * step * (l->wave[0] * s - l->wave[1] * c) / (TWO_PI * power * period_s);
    l->off_hz = clamp(l->off_hz, -MOST_OFF_HZ, MOST_OFF_HZ);
    l->wave[0] += step * c;
    l->wave[1] += step * s;

    /* It fades in over some 32 clear frames after as many before it is seen, and out twice as fast. */
    const double need = l->gate > 0.0 ? CLOSE : OPEN;
    const int is_clear = l->moved > SEEN_EV2 && l->left * need < l->moved && power < MOST_POWER;
    l->gate = clamp(l->gate + (is_clear ? 0.5 * RATE : -RATE), -1.0, 1.0);
}

void pupil_flicker_frame(pupil_flicker *b, double light, double exposure_s, int64_t timestamp_ns)
{
    if (timestamp_ns && timestamp_ns == b->timestamp_ns) /* the same frame again */
        return;
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    /* Timestamps are of the exposure's middle, and it is its end that comes regularly. The time from end to end can be
     * any number where the exposures in the info are wrong. */
    const double shorter_s = exposure_s > 0.0 && b->exposure_s > 0.0 ? 0.5 * (b->exposure_s - exposure_s) : 0.0;
    const double end_s = since_s - shorter_s;
    const int is_next = timestamp_ns && b->timestamp_ns && since_s > 0.0 && since_s < PAUSE_S;
    if (is_next && end_s > 0.0 && end_s < PAUSE_S) {
        b->step_s = tick(b, end_s) + shorter_s;
        for (int i = 0; i < 2; i++)
            lamp_frame(&b->lamp[i], 100.0 + 20.0 * i, b->period_s, b->step_s, light - b->light);
    } else {
        *b = (pupil_flicker){.lamp = {{.gate = -1.0}, {.gate = -1.0}}};
    }
    b->timestamp_ns = timestamp_ns;
    b->light = light;
    b->exposure_s = exposure_s;
}

double pupil_flicker_at(const pupil_flicker *b, int64_t timestamp_ns)
{
    const double since_s = ((double)timestamp_ns - (double)b->timestamp_ns) * 1e-9;
    /* one of the two: at some frame rates both explain the same movement */
    const int i = b->lamp[1].gate > b->lamp[0].gate;
    const pupil_flicker_light *l = &b->lamp[i];
    double at[2];
    if (!(l->gate > 0.0 && timestamp_ns && since_s > -PAUSE_S && since_s < PAUSE_S))
        return 0.0;
    const double frames = since_s / b->period_s;
    const double turns = (100.0 + 20.0 * i + l->off_hz) * b->period_s;
    return l->gate * stops(l, l->turn + (frames - part(frames)) * turns, at);
}
