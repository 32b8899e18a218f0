/* What pupil_sensor's functions refuse, value by value, and that a refusal changes nothing: every end of every range of
 * sensor.h, and invalid objects, structs and pointers. */
#include <stddef.h>

#include "sensor_plant.h"

static pupil_sensor sensor;

typedef struct field {
    const char *name;
    size_t at;
    int is_double; /* else uint32_t */
    double least, most;
} field;

#define NUMBER(name, least, most)                                                                                      \
    {                                                                                                                  \
#name, offsetof(pupil_sensor_config, name), 1, least, most                                                     \
    }
#define COUNT(name, least, most)                                                                                       \
    {                                                                                                                  \
#name, offsetof(pupil_sensor_config, name), 0, least, most                                                     \
    }

/* With other fields that allow the whole range. */
static const field fields[] = {
    COUNT(delay_frames, 1, 16),
    NUMBER(key, 0x1p-10, 1),
    NUMBER(ev_compensation, -16, 16),
    NUMBER(clip, 0x1p-16, 0x1p16),
    NUMBER(highlight_share, 0.001, 1),
    NUMBER(highlight_ev, 0, 8),
    NUMBER(far_ev, 0.02, 2),
    NUMBER(tau_s, 0, 1e6),
    NUMBER(hold_ev, 0, 0.5),
    NUMBER(digital_ev, 0, 8),
    NUMBER(frame_s, 1e-6, 1e6),
    NUMBER(exposure_step_s, 0, 1),
    COUNT(frame_rate_priority, 0, 1),
    COUNT(exposure_mode, 0, 2),
    COUNT(gain_mode, 0, 2),
    NUMBER(manual_exposure_s, 1e-9, 1e4),
    NUMBER(manual_gain, 0x1p-10, 0x1p16),
    NUMBER(gain_step, 1e-6, 64),
    COUNT(stages, 0, 8),
    COUNT(lock, 0, 1),
    COUNT(flash_frames, 0, 8),
    COUNT(linear, 0, 1),
    COUNT(key_points, 0, 8),
    COUNT(reserved, 0, 0),
    COUNT(reserved_too, 0, 0),
    COUNT(exposure_count, 0, 64),
    COUNT(gain_law, 0, PUPIL_GAIN_LAW_COUNT - 1),
};

static pupil_sensor_config wide_config(void)
{
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    c.frame_rate_priority = 0;
    c.exposure_min_s = 1e-7;
    c.exposure_max_s = 1e4;
    c.exposure_mode = c.gain_mode = PUPIL_SENSOR_MANUAL;
    c.manual_exposure_s = 0.01;
    c.manual_gain = 1;
    c.gain_law = PUPIL_GAIN_LINEAR;
    c.gain_count = 1;
    c.gain_table[0] = 1;
    for (int i = 0; i < PUPIL_SENSOR_STAGES; i++)
        c.stage[i] = (pupil_sensor_stage){0.01, 2};
    for (int i = 0; i < PUPIL_KEY_POINTS; i++)
        c.key_at[i] = (pupil_key_point){i, 0.18};
    for (int i = 0; i < PUPIL_SENSOR_EXPOSURE_TABLE; i++)
        c.exposure_table[i] = 1e-3 * (i + 1);
    return c;
}

static void set(pupil_sensor_config *c, const field *f, double value)
{
    void *to = (char *)c + f->at;
    if (f->is_double) {
        memcpy(to, &value, sizeof value);
    } else {
        const uint32_t count = (uint32_t)value;
        memcpy(to, &count, sizeof count);
    }
}

static void refused(const pupil_sensor_config *c, const char *name, double value)
{
    static pupil_sensor before;
    const char *why = "";
    before = sensor;
    CHECK_MSG(pupil_sensor_config_check(c, &why) == PUPIL_ERR_CONFIG, "%s %g is not refused", name, value);
    CHECK_MSG(strstr(why, name), "%s %g: %s", name, value, why);
    CHECK(pupil_sensor_config_check(c, NULL) == PUPIL_ERR_CONFIG);
    CHECK(pupil_sensor_retune(&sensor, c) == PUPIL_ERR_CONFIG && memcmp(&sensor, &before, sizeof sensor) == 0);
}

static void check_ranges(void)
{
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const field *f = &fields[i];
        pupil_sensor_config c = wide_config();
        const char *why = "";
        for (int end = 0; end < 2; end++) {
            set(&c, f, end ? f->most : f->least);
            CHECK_MSG(pupil_sensor_config_check(&c, &why) == PUPIL_OK, "%s %g: %s", f->name, end ? f->most : f->least,
                      why);
        }
        if (f->is_double) {
            const double wrong[] = {nextafter(f->least, -INFINITY), nextafter(f->most, INFINITY), NAN, INFINITY,
                                    -INFINITY};
            for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
                set(&c, f, wrong[k]);
                refused(&c, f->name, wrong[k]);
            }
            continue;
        }
        set(&c, f, f->most + 1);
        refused(&c, f->name, f->most + 1);
        if (f->least > 0) {
            set(&c, f, f->least - 1);
            refused(&c, f->name, f->least - 1);
        }
    }
}

/* Ends that depend on another field. */
static void check_pairs(void)
{
    static const double steps[][3] = {/* law, step, is right */ {PUPIL_GAIN_DB, 1e-6, 1},
                                      {PUPIL_GAIN_DB, 64.5, 0},
                                      {PUPIL_GAIN_DB, 9e-7, 0},
                                      {PUPIL_GAIN_RECIPROCAL, 2, 1},
                                      {PUPIL_GAIN_RECIPROCAL, 1.99, 0},
                                      {PUPIL_GAIN_RECIPROCAL, 65536, 1},
                                      {PUPIL_GAIN_RECIPROCAL, 65537, 0},
                                      {PUPIL_GAIN_ANY, NAN, 1}};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        pupil_sensor_config c = wide_config();
        c.gain_law = (uint32_t)steps[i][0];
        c.gain_step = steps[i][1];
        if (steps[i][2] != 0)
            CHECK_MSG(pupil_sensor_config_check(&c, NULL) == PUPIL_OK, "law %u, step %g", c.gain_law, c.gain_step);
        else
            refused(&c, "gain_step", c.gain_step);
    }
    pupil_sensor_config c = wide_config();
    c.gain_law = PUPIL_GAIN_TABLE;
    for (double gain = 65537; gain > 0; gain = gain > 1e-4 ? 1e-4 : 0) {
        c.gain_table[0] = gain;
        refused(&c, "gain_table", gain);
    }
    static const pupil_sensor_stage wrong[] = {{1.1e4, 1}, {9e-10, 1}, {0.01, 65537}, {0.01, 0.75 * 0x1p-10},
                                               {NAN, 1},   {1, NAN}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        c = wide_config();
        c.stages = 1;
        c.stage[0] = wrong[i];
        refused(&c, "stage", (double)i);
    }
    static const double ends[][2] = {{0.5, 0.5}, {0.5, 0.4}, {0, 1.1}, {NAN, 1}, {-0.1, 1}, {0, NAN}};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        c = wide_config();
        c.trim_low = ends[i][0];
        c.trim_high = ends[i][1];
        refused(&c, "trim_", (double)i);
    }
    c = wide_config();
    for (double gain_min = 9e-4; gain_min < 20; gain_min += 16) {
        c.gain_min = gain_min;
        refused(&c, "gain_min", gain_min);
    }
    c = wide_config();
    for (double exposure_min_s = 9e-10; exposure_min_s < 2e4; exposure_min_s += 1.1e4) {
        c.exposure_min_s = exposure_min_s;
        refused(&c, "exposure_min_s", exposure_min_s);
    }
    c = wide_config();
    for (uint32_t hz = 2; hz < 62; hz++) {
        c.mains_hz = hz;
        if (hz == 50 || hz == 60)
            CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
        else
            refused(&c, "mains_hz", hz);
    }
    c = wide_config();
    static const double night_ev[] = {-256.1, 1e3, NAN};
    for (int i = 0; i < 3; i++) {
        c.night_ev = night_ev[i];
        refused(&c, "night_ev", c.night_ev);
    }
    c = wide_config();
    c.exposure_count = 2;
    c.exposure_table[0] = 0.01;
    for (int i = 0; i < 3; i++) {
        c.exposure_table[1] = i == 0 ? 0.009 : i == 1 ? 1.1e4 : NAN;
        refused(&c, "exposure_table", c.exposure_table[1]);
    }
    c = wide_config(); /* fields that are not read are not checked */
    c.exposure_mode = c.gain_mode = PUPIL_SENSOR_HELD;
    c.manual_exposure_s = c.manual_gain = NAN;
    CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
}

/* The ends of the ranges of tables, and entries equal to the one before. */
static void check_tables(void)
{
    pupil_sensor_config c = wide_config();
    c.gain_law = PUPIL_GAIN_TABLE;
    c.exposure_count = c.gain_count = c.stages = 3;
    for (int i = 0; i < 3; i++) {
        c.exposure_table[i] = c.stage[i].exposure_s = i < 2 ? 1e-9 : 1e4;
        c.gain_table[i] = c.stage[i].gain = i < 2 ? 0x1p-10 : 65536.0;
    }
    CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
    c.gain_count = 1;
    CHECK(pupil_sensor_config_check(&c, NULL) == PUPIL_OK);
}

static void check_pointers(void)
{
    static pupil_sensor other, before;
    static pupil_stats stats;
    pupil_sensor_setting s;
    pupil_sensor_config c = wide_config();
    pupil_frame_info info = {.size_bytes = 1};
    const pupil_sensor_config *none = NULL;
    pupil_stats_clear(&stats);
    before = sensor;
    CHECK(pupil_sensor_config_check(NULL, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_init(NULL, &c) == PUPIL_ERR_NULL && pupil_sensor_init(&other, none) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_retune(NULL, &c) == PUPIL_ERR_NULL && pupil_sensor_retune(&sensor, none) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_start(NULL, 1, 1) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_frame(NULL, &stats, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_frame(&sensor, NULL, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_scene(NULL, 0, 0, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_announce(NULL, 1, 1, 0) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_get(NULL, &s) == PUPIL_ERR_NULL && pupil_sensor_get(&sensor, NULL) == PUPIL_ERR_NULL);
    memset(&other, 0x5a, sizeof other);
    CHECK(pupil_sensor_retune(&other, &c) == PUPIL_ERR_OBJECT && pupil_sensor_start(&other, 1, 1) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_frame(&other, &stats, NULL) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_scene(&other, 0, 0, NULL) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_get(&other, &s) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_ERR_SIZE_BYTES);
    CHECK(pupil_sensor_scene(&sensor, 0, 0, &info) == PUPIL_ERR_SIZE_BYTES);
    stats.size_bytes = 1;
    CHECK(pupil_sensor_frame(&sensor, &stats, NULL) == PUPIL_ERR_SIZE_BYTES);
    static const double wrong[] = {0, -1, NAN, INFINITY, 0x1p-65, 0x1p65};
    for (int i = 0; i < 6; i++)
        CHECK_MSG(pupil_sensor_start(&sensor, wrong[i], 1) == PUPIL_ERR_VALUE &&
                      pupil_sensor_start(&sensor, 1, wrong[i]) == PUPIL_ERR_VALUE,
                  "start with %g", wrong[i]);
    CHECK(memcmp(&sensor, &before, sizeof sensor) == 0);
    pupil_sensor_config_default_sized(NULL, sizeof c); /* no effect, and no crash */
}

/* The calls accept the ends of their ranges. */
static void check_ends(void)
{
    static const double ends[][2] = {{0x1p-64, 0x1p64}, {0x1p64, 0x1p-64}};
    pupil_sensor_setting s;
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.frame_digital == 1.0 && s.slope == 1.0);
    for (int i = 0; i < 2; i++)
        CHECK(pupil_sensor_start(&sensor, ends[i][0], ends[i][1]) == PUPIL_OK);
    for (int high = 0; high < 2; high++) {
        CHECK(pupil_sensor_scene(&sensor, high ? 256.0 : -256.0, high, NULL) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK && s.reason != PUPIL_SENSOR_INVALID_FRAME);
        CHECK(pupil_sensor_announce(&sensor, high ? 32.0 : -32.0, high ? 1000 : 1, PUPIL_SENSOR_CHANGE_FILTER) ==
              PUPIL_OK);
        for (int wrong = 0; wrong < 2; wrong++)
            CHECK(pupil_sensor_scene(&sensor,
                                     wrong  ? 0.0
                                     : high ? 256.1
                                            : -256.1,
                                     wrong ? high ? 1.01 : -0.01 : 0.0, NULL) == PUPIL_OK &&
                  pupil_sensor_get(&sensor, &s) == PUPIL_OK && s.reason == PUPIL_SENSOR_INVALID_FRAME);
    }
    CHECK(pupil_sensor_announce(&sensor, 1.0, 0, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 1.0, 1001, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 32.1, 1, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, -32.1, 1, 0) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_announce(&sensor, 1.0, 1, PUPIL_SENSOR_CHANGE_COUNT) == PUPIL_ERR_VALUE);
}

/* scene_ev is reported as given, whatever the setting was. A frame without a timestamp is one period after the last. */
static void check_scene(void)
{
    const pupil_frame_info first = {.sequence = 1, .exposure_s = 0.002, .gain = 4.0};
    pupil_sensor_setting s;
    pupil_sensor_config c;
    pupil_sensor_config_default(&c);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_start(&sensor, 0.01, 3.0) == PUPIL_OK);
    for (int i = 0; i < 2; i++) {
        CHECK(pupil_sensor_scene(&sensor, 3.5, 0.0, i ? NULL : &first) == PUPIL_OK);
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK && fabs(s.scene_ev - 3.5) < 1e-9);
        CHECK(s.dt_s == (i ? c.frame_s : 0.0));
    }
    const pupil_frame_info timed = {.timestamp_ns = 1000};
    CHECK(pupil_sensor_scene(&sensor, 3.5, 0.0, &timed) == PUPIL_OK);
    CHECK(pupil_sensor_scene(&sensor, 3.5, 0.0, NULL) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.reason == PUPIL_SENSOR_CLOCK_BACK && s.dt_s == 0.0);
}

/* An impossible setting in the metadata counts as none, above the range as below it. */
static void check_metadata(void)
{
    static const double wrong[][2] = {{0x1p65, 2}, {0x1p-65, 2}, {0.01, 0x1p65}, {0.01, 0x1p-65}};
    for (int i = 0; i < 4; i++) {
        static pupil_sensor sensors[2];
        pupil_sensor_setting s[2];
        for (int k = 0; k < 2; k++) {
            const double exposure_s = k && i < 2 ? 0 : wrong[i][0], gain = k && i > 1 ? 0 : wrong[i][1];
            const pupil_frame_info info = {.timestamp_ns = 1000, .exposure_s = exposure_s, .gain = gain};
            pupil_sensor_config c;
            pupil_sensor_config_default(&c);
            CHECK(pupil_sensor_init(&sensors[k], &c) == PUPIL_OK &&
                  pupil_sensor_start(&sensors[k], 0.01, 1) == PUPIL_OK);
            CHECK(pupil_sensor_scene(&sensors[k], 9.0, 0.0, &info) == PUPIL_OK);
            CHECK(pupil_sensor_get(&sensors[k], &s[k]) == PUPIL_OK);
        }
        CHECK_MSG(s[0].exposure_s == s[1].exposure_s && s[0].gain == s[1].gain && s[0].digital == s[1].digital,
                  "metadata %g s, gain %g", wrong[i][0], wrong[i][1]);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const pupil_sensor_config c = wide_config();
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    check_ranges();
    check_pairs();
    check_tables();
    check_pointers();
    check_metadata();
    check_ends();
    check_scene();
    return check_end();
}
