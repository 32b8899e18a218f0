/* The rows of test_hostile.c in which real code was ahead of the loop of 2026-11. */
#include <math.h>

#include "hostile_rows.h"

/* a: a saturated pixel's value, as a share of the top code; b: the light, from the start or from rest at 0. Returns the
 * worse of both. */
static double saturation_codes(const hostile_row *row, uint32_t bits, double noise)
{
    double worst = 0.0;
    for (int rests = 0; rests < 2; rests++) {
        hostile_prepare(row, 1);
        hostile.camera.bits = bits;
        hostile.camera.saturation = row->a;
        hostile.camera.saturation_noise = noise;
        hostile.camera.light_ev = rests ? 0.0 : row->b;
        hostile_begin(0.0);
        hostile_frames(rests ? REST : 0);
        hostile.camera.light_ev = row->b;
        worst = fmax(worst, hostile_worst_wrong());
    }
    return worst;
}

double hostile_saturation(const hostile_row *row)
{
    return saturation_codes(row, 12, 0.0);
}

double hostile_saturation_8_bits(const hostile_row *row)
{
    return saturation_codes(row, 8, 0.0);
}

double hostile_saturation_noise(const hostile_row *row)
{
    return saturation_codes(row, 12, 1.0 - row->a);
}

/* Noise alone for 10 s, after light of a; then light of b and of more. Returns the worst of several delays. */
static double lens_cap_of(const hostile_row *row, double well_e, double read_e, uint32_t bits)
{
    static const double more_ev[] = {0.0, 1.4, 2.0};
    double worst = 0.0;
    for (uint32_t i = 0; i < 9; i++) {
        hostile_prepare(row, 2 + i);
        hostile.camera.delay = 2 + i / 3;
        hostile.camera.well_e = well_e;
        hostile.camera.read_e = read_e;
        hostile.camera.bits = bits;
        hostile.camera.light_ev = row->a;
        hostile_begin(0.0);
        hostile_frames(REST);
        hostile.camera.light_ev = -20.0;
        hostile.is_judged = 0; /* dark is all that there is */
        hostile_frames(300);
        hostile.is_judged = 1;
        hostile.camera.light_ev = row->b + more_ev[i % 3];
        worst = fmax(worst, hostile_worst_wrong());
    }
    return worst;
}

double hostile_lens_cap_first(const hostile_row *row)
{
    return lens_cap_of(row, 5000.0, 5.0, 10);
}

double hostile_lens_cap_later(const hostile_row *row)
{
    return lens_cap_of(row, 3000.0, 8.0, 12);
}

/* Wrong frames after street lamps end, in still light of b; a: delay. */
double hostile_street_lamps(const hostile_row *row)
{
    int most = 0;
    for (int phase = 0; phase < 7; phase++) {
        hostile_prepare(row, 3);
        hostile.camera.delay = (uint32_t)row->a;
        hostile_begin(0.0);
        hostile_frames(REST);
        for (int i = 0; i < 600 + 3 * phase; i++) {
            hostile.camera.light_ev = fmod(i / 30.0, 0.7) < 0.28 ? 3.0 : 0.0;
            hostile_frame();
        }
        hostile.camera.light_ev = row->b;
        int wrong = 0;
        for (int i = 0; i < 600; i++) {
            hostile_frame();
            wrong = hostile_wrong_ev() > 0.1 ? i + 1 : wrong;
        }
        most = wrong > most ? wrong : most;
    }
    return most;
}

/* Mean error of what is shown; a new level every half second, a: its deviation. */
double hostile_pan(const hostile_row *row)
{
    double sum = 0.0;
    int count = 0;
    for (uint64_t seed = 10; seed < 15; seed++) {
        hostile_prepare(row, seed);
        hostile_begin(0.0);
        hostile_frames(REST);
        for (int i = 0; i < 900; i++) {
            if (i % 15 == 0) {
                hostile_camera_turn(&hostile.camera);
                hostile.camera.light_ev = row->a * hostile_normal(&hostile.camera);
            }
            hostile_frame();
            sum += fabs(hostile.shown_ev);
            count++;
        }
    }
    return sum / count;
}

/* The largest move of the total in a frame; a: share of the picture that has b stops more for 2 s of 4. */
double hostile_part_of_picture(const hostile_row *row)
{
    double most = 0.0;
    hostile_prepare(row, 4);
    hostile.is_judged = 0; /* the highlights move the aim */
    hostile.camera.part_share = row->a;
    hostile_begin(0.0);
    hostile_frames(REST);
    for (int i = 0; i < 600; i++) {
        const double before = log2(hostile.setting.total_s);
        hostile.camera.part_ev = i / 60 % 2 ? row->b : 0.0;
        hostile_frame();
        most = fmax(most, fabs(log2(hostile.setting.total_s) - before));
    }
    return most;
}

/* A ramp of a EV a second from still light, over 6 stops or b seconds, whichever is less. */
static void ramp(const hostile_row *row, double *jump_ev, double *mean_ev)
{
    const double seconds = fmin(row->b, 6.0 / fabs(row->a)), from = -0.5 * row->a * seconds;
    const int count = (int)(30.0 * seconds), skipped = fabs(row->a) > 0.5 ? 30 : 0;
    double sum = 0.0;
    hostile_prepare(row, 5);
    hostile.camera.light_ev = from;
    hostile_begin(0.0);
    hostile_frames(REST);
    *jump_ev = 0.0;
    for (int i = 0; i < count; i++) {
        const double before = hostile.shown_ev;
        hostile.camera.light_ev = from + row->a * (i + 1) / 30.0;
        hostile_frame();
        sum += fabs(hostile.shown_ev);
        if (i >= skipped) /* the first frames of a fast ramp differ as much as the light does */
            *jump_ev = fmax(*jump_ev, fabs(hostile.shown_ev - before));
    }
    *mean_ev = sum / count;
}

double hostile_ramp_jump(const hostile_row *row)
{
    double jump_ev, mean_ev;
    ramp(row, &jump_ev, &mean_ev);
    return jump_ev;
}

double hostile_ramp_mean(const hostile_row *row)
{
    double jump_ev, mean_ev;
    ramp(row, &jump_ev, &mean_ev);
    return mean_ev;
}

/* a: a hostile_clock; b: the step of the light. */
double hostile_timestamps(const hostile_row *row)
{
    hostile_prepare(row, 6);
    hostile.camera.clock = (hostile_clock)row->a;
    hostile_begin(0.0);
    hostile_frames(REST);
    hostile.camera.light_ev = row->b;
    return hostile_worst_wrong();
}

/* The bands that lamps of 50 Hz leave at rest at 25 frames a second, where 10 ms are possible. */
double hostile_bands(const hostile_row *row)
{
    static const double totals_s[] = {0.0105, 0.013, 0.016, 0.0195, 0.025, 0.06};
    double most = 0.0;
    for (int i = 0; i < 6; i++) {
        hostile_prepare(row, 7);
        hostile.camera.frame_s = 0.04;
        hostile.camera.lamp_hz = 100.0;
        hostile.camera.lamp_modulation = row->a;
        hostile.camera.light_ev = log2(HOSTILE_REST_S / totals_s[i]);
        hostile.config.frame_s = 0.04;
        hostile.config.exposure_max_s = 0.04;
        hostile.config.mains_hz = PUPIL_SENSOR_MAINS_AUTO;
        hostile_begin(0.0);
        hostile_frames(PROMISED);
        for (int j = 0; j < WATCHED; j++) {
            hostile_frame();
            most = fmax(most, hostile.camera.bands_ev);
        }
    }
    return most;
}

/* b: whether the gain continues from where it did nothing, or jumps there. */
static void dead_gain(const hostile_row *row, double *swing_ev, double *wrong)
{
    double low = 99.0, high = -99.0;
    hostile_prepare(row, 8);
    hostile.camera.dead_gain = 2.0;
    hostile.camera.dead_gain_continues = row->b > 0.0;
    hostile_begin(0.0);
    hostile_frames(REST);
    hostile.camera.light_ev = row->a;
    hostile_frames(PROMISED);
    *wrong = 0.0;
    for (int i = 0; i < 600; i++) {
        hostile_frame();
        low = fmin(low, hostile.shown_ev);
        high = fmax(high, hostile.shown_ev);
        *wrong = fmax(*wrong, fabs(hostile.shown_ev));
    }
    *swing_ev = high - low;
}

double hostile_dead_gain_swing(const hostile_row *row)
{
    double swing_ev, wrong;
    dead_gain(row, &swing_ev, &wrong);
    return swing_ev;
}

double hostile_dead_gain_wrong(const hostile_row *row)
{
    double swing_ev, wrong;
    dead_gain(row, &swing_ev, &wrong);
    return wrong;
}

static void black_level_run(const hostile_row *row)
{
    hostile_prepare(row, 9);
    hostile.is_judged = 0; /* the picture is at the key, grey where it should be black */
    hostile.camera.pedestal = row->a;
    hostile_begin(0.0);
    hostile_frames(600);
}

double hostile_black_level(const hostile_row *row)
{
    black_level_run(row);
    return fabs(hostile.sensor_ev);
}

double hostile_black_level_unnamed(const hostile_row *row)
{
    black_level_run(row);
    return hostile.setting.reason == PUPIL_SENSOR_NO_REASON || hostile.setting.reason == PUPIL_SENSOR_WAITING;
}

/* Exposures of 100 us * 2^n; the light from a to b. */
static void powers_of_two(const hostile_row *row, double *shown, double *sensor_worst)
{
    *shown = *sensor_worst = 0.0;
    for (double ev = row->a; ev <= row->b; ev += 0.25) {
        hostile_prepare(row, 10);
        hostile.camera.powers_of_two = 1;
        hostile_begin(0.0);
        hostile_frames(REST);
        hostile.camera.light_ev = ev;
        hostile_frames(PROMISED);
        for (int i = 0; i < WATCHED; i++) {
            hostile_frame();
            *shown = fmax(*shown, fabs(hostile.shown_ev));
            *sensor_worst = fmax(*sensor_worst, fabs(hostile.sensor_ev));
        }
    }
}

double hostile_powers_of_two_shown(const hostile_row *row)
{
    double shown, sensor_worst;
    powers_of_two(row, &shown, &sensor_worst);
    return shown;
}

double hostile_powers_of_two_sensor(const hostile_row *row)
{
    double shown, sensor_worst;
    powers_of_two(row, &shown, &sensor_worst);
    return sensor_worst;
}
