/* The rows of test_hostile.c in which the loop of 2026-11 was ahead of real code. */
#include <math.h>

#include "hostile_rows.h"

/* The middle of the camera's range, so that no step meets a limit. */
static double middle_light_ev(void)
{
    const double longest_s = hostile.config.exposure_max_s * hostile.config.gain_max;
    return log2(HOSTILE_REST_S) - 0.5 * (log2(HOSTILE_LINE_S) + log2(longest_s));
}

/* Frames until the last wrong one, from the first one with the new light. */
static int settle(void)
{
    int wrong = 0;
    for (int i = 0; i < 120; i++) {
        hostile_frame();
        if (hostile_wrong_ev() > 0.1)
            wrong = i + 1;
    }
    return wrong;
}

/* a: the light's step. */
double hostile_step(const hostile_row *row)
{
    hostile_prepare(row, 20);
    hostile.camera.light_ev = middle_light_ev() - 0.5 * row->a;
    hostile_begin(0.0);
    hostile_frames(REST);
    hostile.camera.light_ev += row->a;
    return settle();
}

/* a: stops by which the first setting is too bright. What is shown: the first levels are a few codes, so the first
 * setting is a tenth of a stop off, which the digital factor makes up for. */
double hostile_start(const hostile_row *row)
{
    int wrong = 0;
    hostile_prepare(row, 21);
    hostile.camera.light_ev = middle_light_ev() + 0.5 * row->a;
    hostile_begin(row->a);
    for (int i = 0; i < 120; i++) {
        hostile_frame();
        if (fabs(hostile.shown_ev) > 0.1)
            wrong = i + 1;
    }
    return wrong;
}

/* How far the total wanders in 300 frames, as the mean of 8 seeds; a: noise of the light from frame to frame. */
double hostile_rest(const hostile_row *row)
{
    double sum = 0.0;
    for (uint64_t seed = 30; seed < 38; seed++) {
        double low = 99.0, high = -99.0;
        hostile_prepare(row, seed);
        hostile.is_judged = 0; /* shown_ev is without the noise that the loop has to live with */
        hostile_begin(0.0);
        hostile.camera.frame_noise_ev = row->a;
        hostile_frames(300);
        for (int i = 0; i < 300; i++) {
            hostile_frame();
            low = fmin(low, log2(hostile.setting.total_s));
            high = fmax(high, log2(hostile.setting.total_s));
        }
        sum += high - low;
    }
    return sum / 8.0;
}

/* The share a of the picture has b stops more in every other half second: RMS of the frame-to-frame change of the total
 * gain. */
double hostile_blink(const hostile_row *row)
{
    double sum = 0.0;
    hostile_prepare(row, 22);
    hostile.camera.part_share = row->a;
    hostile_begin(0.0);
    hostile_frames(300);
    for (int i = 0; i < 600; i++) {
        const double before = hostile.seen_gain_ev;
        hostile.camera.part_ev = i / 15 % 2 ? row->b : 0.0;
        hostile_frame();
        sum += (hostile.seen_gain_ev - before) * (hostile.seen_gain_ev - before);
    }
    return sqrt(sum / 600.0);
}

/* All light swings by a stops at b Hz: RMS of the frame-to-frame change of the shown level. */
double hostile_beat(const hostile_row *row)
{
    const double turn = 2.0 * 3.14159265358979323846 * row->b / 30.0;
    double sum = 0.0, before = 0.0;
    hostile_prepare(row, 23);
    hostile.is_judged = 0; /* until the beat is found */
    hostile_begin(0.0);
    for (int i = 0; i < 900; i++) {
        hostile.camera.light_ev = row->a * sin(turn * i);
        hostile_frame();
        if (i >= 300)
            sum += (hostile.shown_ev - before) * (hostile.shown_ev - before);
        before = hostile.shown_ev;
    }
    return sqrt(sum / 600.0);
}

/* The total's range, with flashes of a frames and b stops every two seconds. */
double hostile_strobe(const hostile_row *row)
{
    double low = 99.0, high = -99.0;
    hostile_prepare(row, 24);
    hostile_begin(0.0);
    hostile_frames(300);
    for (int i = 0; i < 600; i++) {
        hostile.camera.light_ev = i % 60 < (int)row->a ? row->b : 0.0;
        hostile_frame();
        low = fmin(low, log2(hostile.setting.total_s));
        high = fmax(high, log2(hostile.setting.total_s));
    }
    return high - low;
}
