/* The sensor's state machine: every limit by its name, locks and manual modes, odd frames, and random calls. */
#include "sensor_plant.h"

static plant p;
static pupil_sensor sensor;
static pupil_sensor_setting s;

static void run(const pupil_sensor_config *c, double light_ev, int frames)
{
    CHECK(pupil_sensor_init(&sensor, c) == PUPIL_OK);
    plant_open(&p, &sensor, light_ev, 2);
    for (int i = 0; i < frames; i++)
        plant_turn(&p, &sensor, &s, NULL);
}

static void check_limit(const pupil_sensor_config *c, double light_ev, uint32_t reason, uint32_t limits)
{
    run(c, light_ev, 120);
    CHECK_MSG(s.state == PUPIL_SENSOR_LIMITED && s.reason == reason, "state %u, reason %u, wanted %u", s.state,
              s.reason, reason);
    CHECK_MSG(s.limits == limits, "limits %#x, wanted %#x", s.limits, limits);
    CHECK(fabs(s.digital - 1) < 1e-12);
}

#define AT(name) (1u << PUPIL_SENSOR_AT_##name)

static void check_limits(void)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    check_limit(&c, 20, PUPIL_SENSOR_AT_EXPOSURE_MIN, AT(EXPOSURE_MIN) | AT(GAIN_MIN));
    check_limit(&c, -12, PUPIL_SENSOR_AT_GAIN_MAX, AT(EXPOSURE_MAX) | AT(GAIN_MAX));
    c.exposure_max_s = 0.1;
    check_limit(&c, -12, PUPIL_SENSOR_AT_GAIN_MAX, AT(FRAME_PERIOD) | AT(GAIN_MAX));
    CHECK(s.exposure_s <= c.frame_s && s.exposure_s > c.frame_s - PLANT_LINE_S);
    c.frame_rate_priority = 0;
    check_limit(&c, -12, PUPIL_SENSOR_AT_GAIN_MAX, AT(EXPOSURE_MAX) | AT(GAIN_MAX));
    CHECK(s.exposure_s > 0.0999);
    c.frame_rate_priority = 1;
    c.gain_mode = PUPIL_SENSOR_MANUAL;
    c.manual_gain = 2;
    check_limit(&c, -12, PUPIL_SENSOR_AT_FRAME_PERIOD, AT(FRAME_PERIOD));
    CHECK(s.gain == 2);
    c.exposure_max_s = c.frame_s;
    check_limit(&c, -12, PUPIL_SENSOR_AT_EXPOSURE_MAX, AT(EXPOSURE_MAX));
    check_limit(&c, 20, PUPIL_SENSOR_AT_EXPOSURE_MIN, AT(EXPOSURE_MIN));
    c.gain_mode = PUPIL_SENSOR_AUTO;
    c.exposure_mode = PUPIL_SENSOR_MANUAL;
    c.manual_exposure_s = 0.01;
    check_limit(&c, 12, PUPIL_SENSOR_AT_GAIN_MIN, AT(GAIN_MIN));
    check_limit(&c, -12, PUPIL_SENSOR_AT_GAIN_MAX, AT(GAIN_MAX));
    CHECK(fabs(s.exposure_s - 0.01) <= PLANT_LINE_S);
}

static void check_states(void)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.state == PUPIL_SENSOR_EMPTY && fabs(s.total_s - 0.01) < 1e-15);
    plant_open(&p, &sensor, log2(18) + 3, 4);
    plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.state == PUPIL_SENSOR_CLIPPED && s.changed && fabs(s.error_ev + 3) < 0.2);
    for (int i = 1; i < 4; i++) {
        plant_turn(&p, &sensor, &s, NULL);
        CHECK(s.reason == PUPIL_SENSOR_WAITING && !s.changed);
    }
    for (int i = 0; i < 8; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.state == PUPIL_SENSOR_CONVERGED && s.reason == PUPIL_SENSOR_NO_REASON);
    c.mains_hz = 50; /* 10 ms / 8 shows bands */
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
    plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.state == PUPIL_SENSOR_FLICKER && s.reason == PUPIL_SENSOR_BELOW_MAINS);
    for (int dark = 0; dark < 40; dark++) { /* from 10 ms on, only multiples */
        p.light_ev -= 0.2;
        for (int i = 0; i < 6; i++)
            plant_turn(&p, &sensor, &s, NULL);
        double periods = s.exposure_s * 100;
        CHECK_MSG(periods < 1 || fabs(periods - floor(periods + 0.5)) * 0.01 <= PLANT_LINE_S, "%g ms",
                  1e3 * s.exposure_s);
    }
    c = plant_config(LAW_FINE); /* 10 % of the scene is a lamp: the key would clip it */
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, log2(18), 2);
    for (int i = 0; i < PLANT_PIXELS / 10; i++)
        p.scene[i] = 3.2;
    for (int i = 0; i < 100; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK_MSG(s.state == PUPIL_SENSOR_CONVERGED && s.reason == PUPIL_SENSOR_HIGHLIGHTS,
              "state %u, reason %u, %g EV off", s.state, s.reason, s.error_ev);
    CHECK_MSG(p.light_ev + log2(s.exposure_s * s.gain) + 3.2 < 0.05, "the lamp is %g stops above white",
              p.light_ev + log2(s.exposure_s * s.gain) + 3.2);
}

/* The level does not move when a control changes from auto to manual and back, or is held, or the profile changes. */
static void check_bumpless(void)
{
    for (int law = 0; law < LAWS; law++) {
        pupil_sensor_config c = plant_config(law);
        double before, shown = 0;
        run(&c, log2(0.18 * 20), 60);
        plant_turn(&p, &sensor, &s, &before);
        for (int change = 0; change < 8; change++) {
            c = plant_config(law);
            c.gain_mode = change == 0 ? PUPIL_SENSOR_MANUAL : change == 1 ? PUPIL_SENSOR_HELD : PUPIL_SENSOR_AUTO;
            c.manual_gain = 2;
            c.exposure_mode = change == 2 ? PUPIL_SENSOR_MANUAL : change == 3 ? PUPIL_SENSOR_HELD : PUPIL_SENSOR_AUTO;
            c.manual_exposure_s = 0.0111;
            c.lock = change == 4;
            c.stages = change == 5;
            c.stage[0] = (pupil_sensor_stage){0.008, 4};
            c.mains_hz = change == 6 ? 60 : 0;
            CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK);
            for (int i = 0; i < 12; i++) {
                plant_turn(&p, &sensor, &s, &shown);
                CHECK_MSG(fabs(shown - before) <= 0.006, "%s, change %d, frame %d: %g EV", law_name[law], change, i,
                          shown - before);
            }
            CHECK(s.state == (change == 4 ? PUPIL_SENSOR_LOCKED : PUPIL_SENSOR_CONVERGED));
            CHECK(change != 0 || s.gain == (law == LAW_THIRD ? exp2(1.0) : s.gain));
            CHECK(change != 5 || (s.exposure_s < 0.0141 && s.gain > 3.5)); /* 1/20 s at a gain of 1 before */
        }
    }
    pupil_sensor_config c = plant_config(LAW_FINE); /* both manual, then auto again */
    run(&c, log2(0.18 * 20), 60);
    c.exposure_mode = c.gain_mode = PUPIL_SENSOR_MANUAL;
    c.manual_exposure_s = PLANT_LINE_S * 100;
    c.manual_gain = 1;
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.changed && fabs(s.exposure_s - PLANT_LINE_S * 100) < 1e-12 && s.gain == 1 && fabs(s.digital - 1) < 1e-12);
    for (int i = 0; i < 20; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.state == PUPIL_SENSOR_LOCKED && s.reason == PUPIL_SENSOR_ALL_MANUAL && !s.changed);
    c = plant_config(LAW_FINE);
    CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(fabs(s.total_s - PLANT_LINE_S * 100) < 1e-12); /* continues from the manual setting */
    for (int i = 0; i < 12; i++)
        plant_turn(&p, &sensor, &s, NULL);
    CHECK(s.state == PUPIL_SENSOR_CONVERGED && fabs(s.total_s * 20 - 1) < 0.05);
}

/* A saved setting starts the next session: right from the first frame. */
static void check_warm_start(void)
{
    pupil_sensor_config c = plant_config(LAW_THIRD);
    run(&c, log2(0.18 * 300), 60);
    const double saved = s.total_s;
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK && pupil_sensor_start(&sensor, saved, 1) == PUPIL_OK);
    plant_open(&p, &sensor, log2(0.18 * 300), 4);
    for (int i = 0; i < 10; i++) {
        double shown;
        plant_turn(&p, &sensor, &s, &shown);
        CHECK(fabs(shown) < 0.1 && s.state == PUPIL_SENSOR_CONVERGED);
    }
    CHECK(pupil_sensor_start(&sensor, 0, 1) == PUPIL_ERR_VALUE &&
          pupil_sensor_start(&sensor, 1, NAN) == PUPIL_ERR_VALUE);
    CHECK(pupil_sensor_start(&sensor, INFINITY, 1) == PUPIL_ERR_VALUE);
}

/* Frames without information move nothing. */
static void check_odd_frames(void)
{
    static pupil_stats none, stats;
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1e9};
    pupil_sensor_config c = plant_config(LAW_FINE);
    run(&c, 3, 60);
    const pupil_sensor_setting before = s;
    pupil_frame_info info = plant_next(&p, &stats);
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK);
    for (int i = 0; i < 5; i++) { /* the same frame again and again, however wrong */
        CHECK(pupil_sensor_scene(&sensor, -5, 0, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK(s.reason == PUPIL_SENSOR_REPEATED_FRAME && fabs(s.total_s / before.total_s - 1) < 1e-3);
    }
    for (int i = 0; i < 8; i++) { /* new frames without a number */
        const double level = i % 2 == 0 ? odd[i / 2] : 3, share = i % 2 == 0 ? 0 : i == 7 ? -1 : odd[i / 2];
        info.timestamp_ns += 33333333;
        info.sequence++;
        CHECK(pupil_sensor_scene(&sensor, level, share, &info) == PUPIL_OK &&
              pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK(s.reason == PUPIL_SENSOR_INVALID_FRAME && s.state == PUPIL_SENSOR_CONVERGED && !s.changed);
    }
    pupil_stats_clear(&none);
    info.sequence++; /* a new frame, whatever its clock says */
    CHECK(pupil_sensor_frame(&sensor, &none, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.reason == PUPIL_SENSOR_INVALID_FRAME && fabs(s.total_s / before.total_s - 1) < 1e-3);
    info.sequence++;
    info.timestamp_ns = -5;
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.reason == PUPIL_SENSOR_CLOCK_BACK && s.state == PUPIL_SENSOR_CONVERGED);
    CHECK(s.dt_s == c.frame_s); /* the sequence says that it is the next frame */
    info.timestamp_ns = -50;
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(s.reason == PUPIL_SENSOR_CLOCK_BACK && s.dt_s == 0);
    stats.bin[3]++; /* impossible statistics are refused, and nothing moves */
    pupil_sensor copy = sensor;
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_ERR_STATS);
    CHECK(memcmp(&copy, &sensor, sizeof copy) == 0);
    CHECK(pupil_sensor_frame(NULL, &stats, &info) == PUPIL_ERR_NULL && pupil_sensor_frame(&sensor, NULL, &info) < 0);
    memset(&copy, 0, sizeof copy);
    CHECK(pupil_sensor_frame(&copy, &stats, &info) == PUPIL_ERR_OBJECT &&
          pupil_sensor_get(&copy, &s) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_retune(&copy, &c) == PUPIL_ERR_OBJECT && pupil_sensor_start(&copy, 1, 1) == PUPIL_ERR_OBJECT);
    CHECK(pupil_sensor_scene(&copy, 0, 0, NULL) == PUPIL_ERR_OBJECT && pupil_sensor_init(NULL, &c) == PUPIL_ERR_NULL);
    CHECK(pupil_sensor_init(&copy, NULL) == PUPIL_ERR_NULL && pupil_sensor_get(&sensor, NULL) == PUPIL_ERR_NULL);
}

static double between(double low, double high)
{
    return low * pow(high / low, check_uniform());
}

static pupil_sensor_config random_config(void)
{
    pupil_sensor_config c = plant_config((int)(check_random() % LAWS));
    c.delay_frames = 1 + (uint32_t)(check_random() % 16);
    c.frame_s = between(1e-3, 1);
    c.exposure_min_s = between(1e-6, c.frame_s);
    c.exposure_max_s = between(c.exposure_min_s, 10);
    c.exposure_step_s = check_random() % 2 ? between(1e-6, 1e-3) : 0;
    c.gain_min = between(0.25, 2);
    c.gain_max = between(c.gain_min, 64);
    c.mains_hz = (uint32_t[]){0, 50, 60}[check_random() % 3];
    c.frame_rate_priority = check_random() % 2;
    c.exposure_mode = check_random() % 4 ? PUPIL_SENSOR_AUTO : (uint32_t)(check_random() % 3);
    c.gain_mode = check_random() % 4 ? PUPIL_SENSOR_AUTO : (uint32_t)(check_random() % 3);
    c.manual_exposure_s = between(1e-9, 1e4);
    c.manual_gain = between(0x1p-10, 65536);
    c.lock = check_random() % 8 == 0;
    c.tau_s = check_random() % 4 ? between(0.01, 10) : 0;
    c.stages = (uint32_t)(check_random() % 4);
    for (uint32_t i = 0; i < c.stages; i++)
        c.stage[i] = (pupil_sensor_stage){i ? c.stage[i - 1].exposure_s * between(1, 4) : between(1e-5, 0.01),
                                          i ? c.stage[i - 1].gain * between(1, 4) : between(0.5, 2)};
    return c;
}

/* What always holds. */
static void check_setting(const pupil_sensor_config *c)
{
    const double longest = c->frame_rate_priority && c->frame_s < c->exposure_max_s ? c->frame_s : c->exposure_max_s;
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    CHECK(fabs(s.exposure_s * s.gain * s.digital / s.total_s - 1) < 1e-12);
    CHECK_MSG(s.exposure_s >= c->exposure_min_s && s.exposure_s <= fmax(c->exposure_max_s, c->exposure_min_s),
              "%g s, %g to %g", s.exposure_s, c->exposure_min_s, c->exposure_max_s);
    CHECK(c->exposure_mode != PUPIL_SENSOR_AUTO || s.exposure_s <= longest * (1 + 1e-9));
    CHECK(s.gain >= c->gain_min && s.gain <= c->gain_max * (1 + 1e-9));
    CHECK(s.frame_digital >= exp2(-c->digital_ev) * 0.999 && s.frame_digital <= exp2(c->digital_ev) * 1.001);
    CHECK(s.state <= PUPIL_SENSOR_LOCKED && s.reason <= PUPIL_SENSOR_HUNTING && isfinite(s.scene_ev));
    CHECK((s.state == PUPIL_SENSOR_LIMITED) ==
              ((s.reason >= PUPIL_SENSOR_AT_EXPOSURE_MIN && s.reason <= PUPIL_SENSOR_AT_GAIN_MAX) ||
               s.reason == PUPIL_SENSOR_HUNTING || s.reason == PUPIL_SENSOR_IGNORED) ||
          (s.reason >= PUPIL_SENSOR_INVALID_FRAME && s.reason <= PUPIL_SENSOR_FLASH));
    CHECK(s.state == PUPIL_SENSOR_LOCKED || !c->lock || s.reason >= PUPIL_SENSOR_INVALID_FRAME || !s.frames ||
          s.reason == PUPIL_SENSOR_NO_REASON || s.state != PUPIL_SENSOR_EMPTY);
}

/* Two objects, initialised in memory with different bytes, get the same random calls: they have the same bits. */
static void check_random_calls(void)
{
    static pupil_sensor other, copy;
    for (int round = 0; round < 400; round++) {
        pupil_sensor_config c = random_config(), bad;
        const char *why = "?";
        pupil_frame_info info = {0};
        memset(&sensor, 0xa5, sizeof sensor);
        memset(&other, 0x3c, sizeof other);
        CHECK_MSG(pupil_sensor_init(&sensor, &c) == PUPIL_OK, "%s", (pupil_sensor_config_check(&c, &why), why));
        CHECK(pupil_sensor_init(&other, &c) == PUPIL_OK);
        for (int i = 0; i < 200; i++) {
            double total = 0, ev = 40 * check_uniform() - 20, share = check_random() % 4 ? 0 : check_uniform();
            info.exposure_s = check_random() % 4 ? between(1e-6, 1) : check_random() % 2 ? 0 : NAN;
            info.gain = check_random() % 4 ? between(0.1, 100) : 0;
            info.timestamp_ns +=
                check_random() % 8 ? (int64_t)(1e9 * between(1e-4, 1)) : -(int64_t)(check_random() >> 34);
            switch (check_random() % 16) {
            case 0:
                CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
                total = s.total_s;
                c = random_config();
                CHECK(pupil_sensor_retune(&sensor, &c) == PUPIL_OK && pupil_sensor_retune(&other, &c) == PUPIL_OK);
                CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK); /* moved only where the new limits require it */
                CHECK(fabs(s.total_s / total - 1) < 1e-9 || fabs(s.digital - 1) < 1e-9);
                break;
            case 1:
                ev = between(1e-6, 10);
                CHECK(pupil_sensor_start(&sensor, ev, 1) == PUPIL_OK && pupil_sensor_start(&other, ev, 1) == PUPIL_OK);
                break;
            case 2:
                bad = c;
                bad.gain_max = NAN;
                CHECK(pupil_sensor_retune(&sensor, &bad) == PUPIL_ERR_CONFIG);
                break;
            default:
                ev = check_random() % 16 ? ev : NAN;
                CHECK(pupil_sensor_scene(&sensor, ev, share, &info) == PUPIL_OK);
                CHECK(pupil_sensor_scene(&other, ev, share, &info) == PUPIL_OK);
            }
            check_setting(&c);
            CHECK(memcmp(&sensor, &other, sizeof sensor) == 0);
            if (check_random() % 16 == 0) { /* moved in memory, the object still works */
                copy = sensor;
                memset(&sensor, 0, sizeof sensor);
                sensor = copy;
            }
        }
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_limits();
    check_states();
    check_bumpless();
    check_warm_start();
    check_odd_frames();
    check_random_calls();
    return check_end();
}
