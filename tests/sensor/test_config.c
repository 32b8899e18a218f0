/* The sensor's config, field by field; and how a total is split: laws, profile, mains periods. */
#include <stddef.h>

#include "sensor_plant.h"

static pupil_sensor sensor;
static pupil_sensor_setting s;

static void refused(const pupil_sensor_config *c, const char *name)
{
    const char *why = NULL;
    pupil_sensor before;
    memset(&sensor, 0x3c, sizeof sensor);
    before = sensor;
    CHECK_MSG(pupil_sensor_config_check(c, &why) == PUPIL_ERR_CONFIG && why && !strncmp(why, name, strlen(name)),
              "%s: \"%s\"", name, why ? why : "(null)");
    CHECK(pupil_sensor_config_check(c, NULL) == PUPIL_ERR_CONFIG);
    CHECK(pupil_sensor_init(&sensor, c) == PUPIL_ERR_CONFIG && memcmp(&sensor, &before, sizeof sensor) == 0);
}

#define FIELD(name) #name, offsetof(pupil_sensor_config, name)
static const struct {
    const char *name;
    size_t offset;
    double low, high, bad[2];
} number[] = {
    {FIELD(key), 0x1p-10, 1, {0, 1.01}},
    {FIELD(ev_compensation), -16, 16, {-17, 17}},
    {FIELD(clip), 0x1p-16, 65536, {0, 65537}},
    {FIELD(trim_low), 0, 0.9, {-0.1, 1.1}},
    {FIELD(trim_high), 0.1, 1, {0, 1.1}},
    {FIELD(highlight_share), 0.001, 1, {0, 1.1}},
    {FIELD(highlight_ev), 0, 8, {-1, 9}},
    {FIELD(far_ev), 0.02, 2, {0.01, 3}},
    {FIELD(tau_s), 0, 1e6, {-1, 2e6}},
    {FIELD(hold_ev), 0, 0.5, {-0.1, 0.6}},
    {FIELD(digital_ev), 0, 8, {-1, 9}},
    {FIELD(frame_s), 1e-4, 1e6, {0, 2e6}},
    {FIELD(exposure_min_s), 1e-9, 1 / 30.0, {0, 0.1}},
    {FIELD(exposure_max_s), 1e-4, 1e4, {0, 2e4}},
    {FIELD(exposure_step_s), 0, 1, {-1, 2}},
    {FIELD(gain_min), 0x1p-10, 16, {0, 17}},
    {FIELD(gain_max), 1, 65536, {0, 65537}},
};
static const struct {
    const char *name;
    size_t offset;
    uint32_t good[3], bad[2];
} choice[] = {
    {FIELD(delay_frames), {1, 4, 16}, {0, 17}},
    {FIELD(frame_rate_priority), {0, 1, 1}, {2, ~0u}},
    {FIELD(mains_hz), {PUPIL_SENSOR_MAINS_AUTO, 50, 60}, {2, 100}},
    {FIELD(exposure_mode), {0, 0, 2}, {3, ~0u}},
    {FIELD(gain_mode), {0, 0, 2}, {3, ~0u}},
    {FIELD(gain_law), {0, 1, 3}, {5, ~0u}},
    {FIELD(lock), {0, 1, 1}, {2, ~0u}},
    {FIELD(stages), {0, 0, 0}, {9, ~0u}},
    {FIELD(key_points), {0, 0, 0}, {9, ~0u}},
    {FIELD(size_bytes),
     {sizeof(pupil_sensor_config), sizeof(pupil_sensor_config), sizeof(pupil_sensor_config)},
     {0, 8}},
};

static void check_fields(void)
{
    pupil_sensor_config c;
    const char *why = "";
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        for (int k = 0; k < 5; k++) {
            const double value = k == 0 ? number[i].low : k == 1 ? number[i].high : k == 4 ? NAN : number[i].bad[k - 2];
            pupil_sensor_config_default(&c);
            memcpy((char *)&c + number[i].offset, &value, sizeof value);
            if (k < 2)
                CHECK_MSG(pupil_sensor_config_check(&c, &why) == PUPIL_OK, "%s = %g: %s", number[i].name, value, why);
            else if (strcmp(number[i].name, "exposure_max_s") && strcmp(number[i].name, "gain_max"))
                refused(&c, number[i].name);
            else /* the ends of a range may be blamed for each other */
                CHECK(pupil_sensor_config_check(&c, &why) == PUPIL_ERR_CONFIG);
        }
    for (size_t i = 0; i < sizeof choice / sizeof *choice; i++)
        for (int k = 0; k < 5; k++) {
            const uint32_t value = k < 3 ? choice[i].good[k] : choice[i].bad[k - 3];
            pupil_sensor_config_default(&c);
            c.gain_step = 2;
            memcpy((char *)&c + choice[i].offset, &value, sizeof value);
            if (k < 3)
                CHECK_MSG(pupil_sensor_config_check(&c, &why) == PUPIL_OK, "%s = %u: %s", choice[i].name, value, why);
            else
                refused(&c, choice[i].name);
        }
    pupil_sensor_config_default(NULL);
    CHECK(pupil_sensor_config_check(NULL, &why) == PUPIL_ERR_NULL);
}

static void check_laws(void)
{
    pupil_sensor_config c = plant_config(LAW_SIXTEENTH);
    c.gain_step = 0;
    refused(&c, "gain_step");
    c = plant_config(LAW_DB);
    c.gain_step = NAN;
    refused(&c, "gain_step");
    c = plant_config(LAW_FINE);
    c.gain_step = 1;
    refused(&c, "gain_step");
    c = plant_config(LAW_THIRD);
    c.gain_count = 0;
    refused(&c, "gain_count");
    c.gain_count = PUPIL_SENSOR_GAIN_TABLE + 1;
    refused(&c, "gain_count");
    c.gain_count = 14;
    c.gain_table[3] = NAN;
    refused(&c, "gain_table");
    c.gain_table[3] = 0.5;
    refused(&c, "gain_table");
    c = plant_config(LAW_THIRD); /* the ends, and one gain twice */
    c.gain_table[0] = 0x1p-10;
    c.gain_table[2] = c.gain_table[3];
    c.gain_table[c.gain_count - 1] = 65536.0;
    CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
    c.gain_table[c.gain_count - 1] = 65537.0;
    refused(&c, "gain_table");
    c = plant_config(LAW_THIRD);
    c.gain_table[0] = 0x1.fp-11;
    refused(&c, "gain_table");
    c = plant_config(LAW_FINE);
    c.stages = 2;
    refused(&c, "stage");
    c.stage[0] = (pupil_sensor_stage){0.01, 2};
    c.stage[1] = (pupil_sensor_stage){0.02, 1};
    refused(&c, "stage");
    c = plant_config(LAW_FINE);
    c.gain_mode = PUPIL_SENSOR_MANUAL;
    refused(&c, "manual_gain");
    c.gain_mode = PUPIL_SENSOR_AUTO;
    c.exposure_mode = PUPIL_SENSOR_MANUAL;
    refused(&c, "manual_exposure_s");
    c = plant_config(LAW_FINE);
    c.frame_s = 1e-5;
    refused(&c, "exposure_min_s");
}

static void check_key(void)
{
    static const pupil_key_point bad[][2] = {
        {{0, 0.05}, {0, 0.05}}, {{1, 0.05}, {0, 0.05}},  {{0, 0.1}, {1, 0.09}},       {{0, 0.1}, {1, 0.15}},
        {{0, 0}, {1, 0}},       {{0, 0.5}, {9, 1.1}},    {{-257, 0.1}, {0, 0.1}},     {{0, 0.1}, {257, 0.1}},
        {{NAN, 0.1}, {0, 0.1}}, {{0, 0.1}, {NAN, 0.18}}, {{0, NAN}, {4, 0.1}},        {{0, 0.1}, {4, NAN}},
        {{0, 0.1}, {8, 1.61}},  {{0, -0.1}, {8, 0.1}},   {{-INFINITY, 0.1}, {0, 0.1}}};
    static const pupil_key_point good[][2] = {
        {{0, 0.1}, {2, 0.2}}, {{-256, 0x1p-10}, {256, 1}}, {{0, 0.18}, {1e-300, 0.18}}, {{-3.3, 0.09}, {-1.3, 0.18}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad + sizeof good / sizeof *good; i++) {
        const size_t k = i - sizeof bad / sizeof *bad;
        pupil_sensor_config c;
        pupil_sensor_config_default(&c);
        c.key_points = 2;
        memcpy(c.key_at, i < sizeof bad / sizeof *bad ? bad[i] : good[k], sizeof *bad);
        if (i < sizeof bad / sizeof *bad)
            refused(&c, "key_at");
        else
            CHECK_MSG(pupil_sensor_config_check(&c, NULL) == PUPIL_OK, "good table %zu", k);
    }
}

/* Computes the setting for a total and checks what must always hold. */
static void split(const pupil_sensor_config *c, double total_s)
{
    CHECK(pupil_sensor_init(&sensor, c) == PUPIL_OK && pupil_sensor_start(&sensor, total_s, 1) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(fabs(s.exposure_s * s.gain * s.digital / s.total_s - 1) < 1e-12);
}

/* Both controls are rounded down. Where gains are further apart than 0.2 EV, as thirds of a stop are, the nearest one
 * is taken, so that the digital factor never makes up for more than half a step. */
static void check_rounding(int law)
{
    if (law != LAW_THIRD)
        CHECK_MSG(s.digital > 1 - 1e-5, "%s, %g s: digital %g", law_name[law], s.total_s, s.digital);
    else if (s.gain > 1)
        CHECK_MSG(fabs(log2(s.digital)) <= 0.2, "%s, %g s: digital %g", law_name[law], s.total_s, s.digital);
}

/* Steps too fine for a double count as no steps. */
static void check_fine_lines(void)
{
    static const double step_s[] = {5e-324, 1e-300, 1e-18, 0};
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.mains_hz = 0;
    for (int i = 0; i < 4; i++) {
        c.exposure_step_s = step_s[i];
        split(&c, 0.0123);
        CHECK_MSG(fabs(s.exposure_s - 0.0123) < 1e-12 && s.gain == 1, "lines of %g s: %g s, gain %g", step_s[i],
                  s.exposure_s, s.gain);
    }
}

static int is_multiple(double x, double step)
{
    return fabs(x / step - floor(x / step + 0.5)) < 1e-5;
}

static void check_split(void)
{
    for (int law = 0; law < LAWS; law++) {
        pupil_sensor_config c = plant_config(law);
        double least, last = 0;
        const double largest = law == LAW_THIRD       ? exp2(1 / 3.0)
                               : law == LAW_SIXTEENTH ? 17 / 16.0
                               : law == LAW_DB        ? 1.036
                                                      : 13 / 12.0; /* 256 / 12 after 256 / 13 */
        split(&c, 1e-12);
        least = s.total_s;
        CHECK(s.exposure_s == c.exposure_min_s && s.gain == 1);
        split(&c, 1e12);
        const double most = s.total_s;
        CHECK(s.exposure_s > c.frame_s - PLANT_LINE_S && s.exposure_s <= c.frame_s && s.gain > 20);
        for (double total = least; total < most; total *= 1.003) {
            split(&c, total);
            const double db = 20 * log10(s.gain) / 0.3;
            check_rounding(law);
            CHECK(fabs(s.total_s / total - 1) < 1e-12 && s.exposure_s * s.gain >= last * (1 - 1e-9));
            CHECK(is_multiple(s.exposure_s, PLANT_LINE_S) && s.digital < (s.gain > 1 ? largest : 2));
            CHECK(law == LAW_FINE        ? is_multiple(256 / s.gain, 1)
                  : law == LAW_DB        ? fabs(db - floor(db + 0.5)) < 1e-6
                  : law == LAW_SIXTEENTH ? is_multiple(s.gain, 1 / 16.0)
                                         : is_multiple(3 * log2(s.gain), 1) || s.gain == 1);
            /* the longest exposure first, reduced by a step where the gain was rounded up */
            const double nearly_s = (c.frame_s - PLANT_LINE_S) / (law == LAW_THIRD ? largest : 1) - PLANT_LINE_S;
            if (law !=
                LAW_FINE) /* 0.3 dB are less than a line of 29: there, and with finer laws, gain makes up for lines */
                CHECK(s.gain < 1.001 || s.exposure_s > nearly_s || s.exposure_s < 30 * PLANT_LINE_S);
            /* rounding the gain down may cost what a line added; rounding it either way, half a step */
            last = (law == LAW_THIRD ? 1 / sqrt(largest) : 0.98) * s.exposure_s * s.gain;
        }
    }
}

/* A typical camera profile, and mains periods. */
static void check_profile(void)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.mains_hz = 0;
    c.stages = 2;
    c.stage[0] = (pupil_sensor_stage){0.004, 2};
    c.stage[1] = (pupil_sensor_stage){0.010, 4};
    static const double wanted[][3] = {{0.003, 0.003, 1}, {0.006, 0.004, 1.5}, {0.008, 0.004, 2}, {0.016, 0.008, 2},
                                       {0.03, 0.01, 3},   {0.04, 0.01, 4},     {0.1, 0.025, 4},   {0.2, 1 / 30.0, 6},
                                       {9, 1 / 30.0, 16}, {1e-5, 1e-4, 1},     {0.02, 0.01, 2}};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        split(&c, wanted[i][0]);
        CHECK_MSG(fabs(s.exposure_s / wanted[i][1] - 1) < 1e-9 && fabs(s.gain / wanted[i][2] - 1) < 1e-9,
                  "%g: %g s, gain %g", wanted[i][0], s.exposure_s, s.gain);
    }
    c.frame_rate_priority = 0;
    c.exposure_max_s = 0.5;
    split(&c, 4);
    CHECK(s.digital > 1 - 1e-5);
    CHECK(fabs(s.exposure_s - 0.25) < 1e-9 && fabs(s.gain - 16) < 1e-9);
    for (uint32_t mains = 50; mains <= 60; mains += 10)
        for (double total = 0.001; total < 0.5; total *= 1.01) {
            pupil_sensor_config_default(&c);
            c.mains_hz = mains;
            split(&c, total);
            CHECK_MSG(s.exposure_s < 0.5 / mains ? s.gain == 1 : is_multiple(s.exposure_s, 0.5 / mains), "%u Hz: %g s",
                      mains, s.exposure_s);
            c.exposure_step_s = PLANT_LINE_S; /* rounded down to lines: less than a line off */
            split(&c, total);
            const double periods = (s.exposure_s + PLANT_LINE_S) * 2 * mains;
            CHECK(s.exposure_s < 0.5 / mains - PLANT_LINE_S || periods - floor(periods) < PLANT_LINE_S * 2 * mains);
        }
}

/* While the mains frequency is not known, exposures are as for 50 Hz. But at the dark end, at full gain, the whole
 * frame period is used. */
static void check_unknown_mains(void)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    const double most = c.frame_s * c.gain_max;
    int at_the_end = 0;
    for (double total = 0.001; total < 1.01 * most; total *= 1.003) {
        split(&c, total);
        const int is_end = s.gain >= c.gain_max && total > 0.03 * c.gain_max;
        CHECK_MSG(is_end || (s.exposure_s < 0.01 ? s.gain == 1 : is_multiple(s.exposure_s, 0.01)),
                  "%g s: %g s, gain %g", total, s.exposure_s, s.gain);
        CHECK(total < 0.0101 || s.exposure_s >= 0.01);
        CHECK(fabs(s.exposure_s * s.gain / fmin(total, most) - 1) < 1e-9);
        at_the_end += is_end;
    }
    CHECK(at_the_end > 20 && fabs(s.exposure_s / c.frame_s - 1) < 1e-9);
}

/* Lines longer than the shortest exposure, or than the longest: the exposure is never 0, and all numbers are finite.
 */
static void check_long_lines(void)
{
    static const uint32_t mains[] = {PUPIL_SENSOR_MAINS_AUTO, 0, 50, 60};
    static const double step_s[] = {1.5e-3, 8.8e-4, 0.02, 1}, most_s[] = {1 / 30.0, 3.1e-4, 0.011, 0.5};
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.exposure_min_s = 5e-5;
    for (int i = 0; i < 64; i++) {
        c.mains_hz = mains[i % 4];
        c.exposure_step_s = step_s[i / 4 % 4];
        c.exposure_max_s = most_s[i / 16];
        for (double total = 1e-6; total < 100; total *= 1.3) {
            split(&c, total);
            CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
            CHECK_MSG(s.exposure_s >= c.exposure_min_s && s.exposure_s <= c.exposure_max_s && isfinite(s.digital) &&
                          s.digital > 0 && s.total_s > 0,
                      "%g s in lines of %g s, mains %u: %g s, digital %g", total, c.exposure_step_s, c.mains_hz,
                      s.exposure_s, s.digital);
        }
    }
}

/* A manual exposure is rounded to half a mains period only where the frequency is known. */
static void check_by_hand(void)
{
    static const uint32_t mains[] = {0, PUPIL_SENSOR_MAINS_AUTO, 50, 60};
    static const double wanted_s[] = {0.713, 0.713, 0.71, 85.0 / 120};
    pupil_sensor_config c;
    for (int i = 0; i < 4; i++) {
        pupil_sensor_config_default(&c);
        c.frame_rate_priority = 0;
        c.exposure_max_s = 2;
        c.mains_hz = mains[i];
        c.exposure_mode = PUPIL_SENSOR_MANUAL;
        c.manual_exposure_s = 0.713;
        CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK_MSG(fabs(s.exposure_s - wanted_s[i]) < 1e-9, "mains %u: %g s", mains[i], s.exposure_s);
        c.exposure_mode = PUPIL_SENSOR_HELD;
        CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK_MSG(fabs(s.exposure_s - wanted_s[i]) < 1e-9, "mains %u, held: %g s", mains[i], s.exposure_s);
    }
    /* one line short of half a period: whole lines */
    c.mains_hz = 50;
    c.exposure_mode = PUPIL_SENSOR_MANUAL;
    c.exposure_step_s = 0.001;
    c.manual_exposure_s = 0.0095;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK_MSG(fabs(s.exposure_s - 0.009) < 1e-9, "%g s", s.exposure_s);
}

/* Only exposures of the table, in any light; the gain does the rest. */
static void check_exposure_table(void)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.mains_hz = 0;
    c.exposure_min_s = 1e-4;
    c.exposure_step_s = 0.007; /* not read */
    c.exposure_count = 9;
    for (uint32_t i = 0; i < c.exposure_count; i++)
        c.exposure_table[i] = 1e-4 * (double)(1u << i); /* as UVC cameras have them: 25.6 ms is the longest */
    for (double total = 5e-5; total < 2.0; total *= 1.01) {
        CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_start(&sensor, total, 1.0) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        const double steps = log2(s.exposure_s / 1e-4);
        CHECK_MSG(fabs(steps - round(steps)) < 1e-9 && steps < 8.5, "%g s for %g", s.exposure_s, total);
        const double reached = fmin(fmax(total, 1e-4), 25.6e-3 * c.gain_max);
        CHECK_MSG(fabs(log2(s.exposure_s * s.gain / reached)) < 0.1, "%g s x %g for %g", s.exposure_s, s.gain, total);
    }
    c.exposure_table[4] = c.exposure_table[3]; /* equal ones are allowed */
    CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
    c.exposure_table[4] = 1e-4;
    refused(&c, "exposure_table");
    c.exposure_table[4] = NAN;
    refused(&c, "exposure_table");
    c.exposure_count = 65;
    refused(&c, "exposure_count");
}

/* A gain below 1 is rounded down to a whole step of decibels, as any other. */
static void check_decibels_below_0(void)
{
    pupil_sensor_config c = plant_config(LAW_DB);
    c.gain_min = 0x1p-4;
    c.gain_mode = PUPIL_SENSOR_MANUAL;
    for (c.manual_gain = 0.08; c.manual_gain < 1.5; c.manual_gain *= 1.003) {
        CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        const double steps = 20.0 * log10(s.gain) / c.gain_step, below = 20.0 * log10(c.manual_gain / s.gain);
        CHECK_MSG(fabs(steps - round(steps)) < 1e-6 && below > -1e-5 && below < c.gain_step, "%g for %g", s.gain,
                  c.manual_gain);
    }
}

static void check_names(void)
{
    for (uint32_t i = 0; i <= PUPIL_SENSOR_LOCKED; i++)
        for (uint32_t k = 0; k < i; k++)
            CHECK(strcmp(pupil_sensor_state_name(i), pupil_sensor_state_name(k)) != 0);
    for (uint32_t i = 0; i <= PUPIL_SENSOR_ANNOUNCED; i++)
        for (uint32_t k = 0; k < i; k++)
            CHECK(strcmp(pupil_sensor_reason_name(i), pupil_sensor_reason_name(k)) != 0);
    CHECK(strcmp(pupil_sensor_state_name(PUPIL_SENSOR_CONVERGED), "converged") == 0);
    CHECK(strcmp(pupil_sensor_reason_name(PUPIL_SENSOR_AT_GAIN_MAX), "gain_max") == 0);
    CHECK(strcmp(pupil_sensor_reason_name(PUPIL_SENSOR_IGNORED), "ignored") == 0);
    CHECK(strcmp(pupil_sensor_state_name(PUPIL_SENSOR_LOCKED + 1), "unknown") == 0);
    CHECK(strcmp(pupil_sensor_reason_name(PUPIL_SENSOR_ANNOUNCED + 1), "unknown") == 0);
    CHECK(strcmp(pupil_sensor_day_night_name(PUPIL_SENSOR_NIGHT + 1), "unknown") == 0);
}

/* Locked from the start, with its gain held: 10 ms and a gain of 1. Unlocked, it has no reason until a frame comes. */
static void check_locked_first(void)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.gain_min = 0.25;
    c.gain_mode = PUPIL_SENSOR_HELD;
    c.lock = 1;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK_MSG(s.exposure_s == 0.01 && s.gain == 1.0, "%g s, gain %g", s.exposure_s, s.gain);
    CHECK(pupil_sensor_scene(&sensor, 4.0, 0.0, NULL) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.state == PUPIL_SENSOR_LOCKED && s.reason == PUPIL_SENSOR_LOCK && s.exposure_s == 0.01 && s.gain == 1.0);
    CHECK_MSG(fabs(s.wanted_ev - log2(c.key * c.clip)) < 1e-9, "%g EV", s.wanted_ev);
    c.lock = 0;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.state == PUPIL_SENSOR_SEARCHING && s.reason == PUPIL_SENSOR_NO_REASON);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_exposure_table();
    check_decibels_below_0();
    check_names();
    check_fields();
    check_laws();
    check_key();
    check_split();
    check_fine_lines();
    check_profile();
    check_unknown_mains();
    check_long_lines();
    check_by_hand();
    check_locked_first();
    return check_end();
}
