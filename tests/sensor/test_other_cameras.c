/* Cameras that the fixtures cannot simulate, through the public API as a user calls it: a grey ramp of 12 bits without
 * noise. After the promised frames the shown level is within 0.1 EV of the key, and the sensor within half the camera's
 * own step of it. */
#include <math.h>

#include "check.h"
#include "pupil/pupil.h"
#include "pupil/sensor.h"

enum { WIDTH = 64, FRAMES = 200, PROMISED = 60, ASKS = FRAMES + 8 };

typedef struct camera {
    pupil_sensor_config config;
    uint32_t delay_frames;
    double light_ev[2];     /* from the first frame on, and from frame FRAMES / 4 on */
    double jump_gain, jump; /* from this gain on the gain has this many times the effect */
    double knee, slope;     /* values above the knee rise with this slope */
    int has_powers_of_two;  /* exposures are rounded to them */
    double black;           /* added to all values without being reported */
    int clock;              /* timestamps: 0 right, 1 stopped, 2 in whole seconds; without a sequence */
    double step_ev;         /* between settings */
} camera;

typedef struct off {
    double shown_ev, sensor_ev; /* the worst after the promised frames */
} off;

static camera camera_of(double light_ev)
{
    camera c = {.delay_frames = 2, .light_ev = {light_ev - 3.0, light_ev}, .jump_gain = INFINITY, .knee = 1.0};
    pupil_sensor_config_default(&c.config);
    c.config.exposure_min_s = 100e-6;
    c.config.exposure_step_s = 20e-6;
    c.config.gain_law = PUPIL_GAIN_LINEAR;
    c.config.highlight_ev = 0.0;
    return c;
}

static double value_of(const camera *c, double light, double exposure_s, double gain)
{
    const double x = light * exposure_s * gain * (gain >= c->jump_gain ? c->jump : 1.0);
    return fmin((x > c->knee ? c->knee + (x - c->knee) * c->slope : x) + c->black, 1.0);
}

static void read_frame(const camera *c, uint16_t *pixels, double light, double exposure_s, double gain)
{
    for (int x = 0; x < WIDTH; x++) /* from a quarter to four times the light */
        pixels[x] =
            (uint16_t)lround(4095.0 * value_of(c, light * exp2(4.0 * (x + 0.5) / WIDTH - 2.0), exposure_s, gain));
}

static pupil_frame_info info_of(const camera *c, int i, double exposure_s, double gain)
{
    const int64_t now = (int64_t)(1e9 * c->config.frame_s * (i + 1)), second = INT64_C(1000000000);
    pupil_frame_info info = {sizeof info, 0, now, (uint64_t)i + 1, exposure_s, gain};
    if (c->clock) {
        info.sequence = 0;
        info.timestamp_ns = c->clock == 1 ? second : (now / second + 1) * second;
    }
    return info;
}

static off run(const camera *c)
{
    static double asked_s[ASKS], asked_gain[ASKS];
    static uint16_t pixels[WIDTH];
    const pupil_image_const image = pupil_image_const_of(pixels, WIDTH, 1, PUPIL_PIXEL_GREY12);
    pupil_t pupil;
    pupil_config metering;
    pupil_sensor sensor;
    pupil_sensor_setting s;
    off worst = {0.0, 0.0};
    const char *why = "";
    pupil_config_default(&metering);
    metering.histogram = 1;
    CHECK_MSG(pupil_sensor_config_check(&c->config, &why) == PUPIL_OK, "%s", why);
    CHECK(pupil_init(&pupil, &metering) == PUPIL_OK && pupil_sensor_init(&sensor, &c->config) == PUPIL_OK);
    for (int i = 0; i < FRAMES; i++) {
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        for (int j = i ? i - 1 + (int)c->delay_frames : 0; j < i + (int)c->delay_frames; j++) {
            asked_s[j] = s.exposure_s;
            asked_gain[j] = s.gain;
        }
        const double e = c->has_powers_of_two ? exp2(round(log2(asked_s[i]))) : asked_s[i], g = asked_gain[i];
        const double light_ev = c->light_ev[i >= FRAMES / 4];
        double mean = 0.0;
        pupil_stats stats;
        const pupil_frame_info info = info_of(c, i, e, g);
        read_frame(c, pixels, exp2(light_ev), e, g);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &image, 0, 1, &stats) == PUPIL_OK);
        CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &mean) == PUPIL_OK);
        if (i < FRAMES / 4 + PROMISED)
            continue;
        const double sensor_ev = mean - log2(c->config.key);
        worst.sensor_ev = fmax(worst.sensor_ev, fabs(sensor_ev));
        worst.shown_ev = fmax(worst.shown_ev, fabs(sensor_ev + log2(s.frame_digital)));
    }
    return worst;
}

static void holds(const char *what, const camera *c)
{
    const off o = run(c);
    CHECK_MSG(o.shown_ev <= 0.1 && o.sensor_ev <= fmax(0.25, 0.5 * c->step_ev) + 0.01,
              "%s, light %g EV: shown %.3f EV off, the sensor %.3f", what, c->light_ev[1], o.shown_ev, o.sensor_ev);
}

static void table_of(camera *c, const double *gain, uint32_t count)
{
    c->config.gain_law = PUPIL_GAIN_TABLE;
    c->config.gain_count = count;
    for (uint32_t i = 0; i < count; i++)
        c->config.gain_table[i] = gain[i];
    c->config.gain_max = gain[count - 1];
}

/* The only fault of these is that their steps are far apart. */
static void coarse(double light_ev)
{
    static const double two[] = {1.0, 8.0}, four[] = {1.0, 2.0, 4.0, 8.0};
    for (uint32_t mains = 0; mains < 3; mains++) {
        camera c = camera_of(light_ev);
        c.config.mains_hz = mains == 0 ? PUPIL_SENSOR_MAINS_AUTO : mains == 1 ? 0 : 50;
        c.step_ev = 1.0;
        table_of(&c, four, 4);
        holds("gains of a stop", &c);
        c.config.gain_max = 1.0;
        holds("no gain", &c);
        table_of(&c, two, 2);
        c.step_ev = 1.6; /* from 10 ms at gain 8 to 30 ms at gain 8 */
        holds("gains 1 and 8", &c);
        c = camera_of(light_ev);
        c.config.mains_hz = mains == 0 ? PUPIL_SENSOR_MAINS_AUTO : mains == 1 ? 0 : 50;
        c.config.exposure_count = 8;
        for (int i = 0; i < 8; i++)
            c.config.exposure_table[i] = exp2(i - 12.0);
        holds("a table without multiples of half a mains period", &c);
    }
}

static void faulty(double light_ev)
{
    camera c = camera_of(light_ev);
    c.has_powers_of_two = 1;
    c.config.gain_max = 1.0;
    c.config.exposure_max_s = 1.0 / 32.0;
    const off o = run(&c); /* not always the nearer of two settings; this may only fall */
    CHECK_MSG(o.shown_ev <= 0.1 && o.sensor_ev <= 0.85, "powers of two, no gain, light %g EV: %.3f EV, the sensor %.3f",
              light_ev, o.shown_ev, o.sensor_ev);
    for (double jump = 1.1; jump < 1.9; jump += 0.1) {
        c = camera_of(light_ev);
        c.jump_gain = 4.0;
        c.jump = jump;
        c.step_ev = log2(jump) + 0.1;
        c.config.mains_hz = 0;
        holds("gain jumps", &c);
    }
    for (double knee = 0.05; knee < 0.3; knee += 0.05) {
        c = camera_of(light_ev);
        c.knee = knee;
        c.slope = 1.0 / 16.0;
        holds("a knee", &c);
    }
    for (int clock = 1; clock < 3; clock++) {
        c = camera_of(light_ev);
        c.clock = clock;
        holds("no sequence, a clock that stops", &c);
    }
}

/* A black level that was not subtracted, in light that changes every 40 frames. Once two steps have shown it, the
 * picture without it is at the key: this checks that after 160 frames. Where the camera's black is right from then on,
 * the loop forgets it again. */
static int black_level(double light_ev)
{
    camera c = camera_of(light_ev);
    pupil_sensor sensor;
    pupil_sensor_setting s;
    pupil_t pupil;
    pupil_config metering;
    double worst_found_ev = 0.0, worst_ev = 0.0;
    int named = 0;
    static uint16_t pixels[WIDTH];
    const pupil_image_const image = pupil_image_const_of(pixels, WIDTH, 1, PUPIL_PIXEL_GREY12);
    c.config.linear = 1;
    c.config.mains_hz = 0;
    pupil_config_default(&metering);
    metering.histogram = 1;
    CHECK(pupil_init(&pupil, &metering) == PUPIL_OK && pupil_sensor_init(&sensor, &c.config) == PUPIL_OK);
    double e[3] = {0.01, 0.01, 0.01}, g[3] = {1.0, 1.0, 1.0};
    for (int i = 0; i < 480; i++) {
        const double ev = light_ev - (i / 40 & 1 ? 1.5 : 0.0);
        pupil_stats stats;
        CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        for (int k = 0; k < 2; k++) {
            e[k] = e[k + 1];
            g[k] = g[k + 1];
        }
        e[2] = s.exposure_s;
        g[2] = s.gain;
        c.black = i < 240 ? 0.07 : 0.0;
        const pupil_frame_info info = info_of(&c, i, e[0], g[0]);
        read_frame(&c, pixels, exp2(ev), e[0], g[0]);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &image, 0, 1, &stats) == PUPIL_OK);
        CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
        const double off_ev = fabs(ev + log2(e[0] * g[0]) - log2(c.config.key));
        if (i < 240)
            named |= s.reason == PUPIL_SENSOR_NONLINEAR;
        if (i % 40 < 30)
            continue;
        worst_ev = i < 240 ? fmax(worst_ev, off_ev) : worst_ev;
        worst_found_ev = i > 160 && i < 240 ? fmax(worst_found_ev, off_ev) : worst_found_ev;
        CHECK_MSG(i < 360 || off_ev < 0.1, "light %g EV, the black level is right, frame %d: %.3f EV off", light_ev, i,
                  off_ev);
    }
    CHECK_MSG(named && worst_ev < 1.3, "light %g EV: named %d, %.3f EV off", light_ev, named, worst_ev);
    return worst_found_ev < 0.15;
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const double step_ev = CHECK_SANITIZED ? 0.7 : 0.1 * check_every(3);
    int lights = 0, found = 0;
    for (double light_ev = 1.0; light_ev < 9.0; light_ev += step_ev)
        coarse(light_ev > 3.5 ? light_ev : light_ev + 2.5);
    for (double light_ev = -0.5; light_ev < 2.0; light_ev += step_ev)
        faulty(light_ev + 3.0);
    for (double light_ev = 2.0; light_ev < 7.0; light_ev += step_ev) {
        lights++;
        found += black_level(light_ev);
    }
    CHECK_MSG(found >= 0.8 * lights, "a black level was found in %d of %d lights", found, lights);
    return check_end();
}
