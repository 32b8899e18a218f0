/* The mains frequency, found from the bands of frames: random cameras with rolling shutters, and scenes without lamps,
 * in which nothing may be found. Prints the figures of docs/mains.md. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "pupil/sensor.h"

#define PI 3.14159265358979323846

enum { ROWS = 4, PIXELS = 1000, TEXTURE = 128, FRAMES = 15 };

/* The light on the rows of frames, and how the frames are taken. */
typedef struct camera {
    double frame_s, readout_s, exposure_s, gain;
    double hz, modulation, phase; /* of lamps; 0: none */
    double noise_ev;              /* of a band's mean */
    double texture[TEXTURE];      /* log2, by bands; repeats */
    double place, pan;            /* the picture's position in it, in bands; movement per frame */
    double drops;                 /* share of the frames */
    double jitter_s;              /* of timestamps, standard deviation */
    double t;
    uint64_t n;
    double shade[PUPIL_BANDS]; /* other things in the scene, log2 */
    pupil_sensor sensor;
    pupil_sensor_setting setting;
} camera;

static double normal(void)
{
    return sqrt(-2.0 * log(1.0 - check_uniform())) * cos(2.0 * PI * check_uniform());
}

/* The share of a modulation that is left after an exposure. */
static double left_of(double hz, double exposure_s)
{
    const double x = PI * hz * exposure_s;
    return x > 0.0 ? sin(x) / x : 1.0;
}

/* A random camera with manual exposure and gain, so that the wave stays the same. */
static void begin(camera *c, double exposure_s)
{
    static const double usual[] = {24.0, 25.0, 29.97, 30.0, 50.0, 60.0};
    const double contrast = 0.4 * check_uniform(), at_random = 10.0 * pow(12.0, check_uniform());
    double level = 0.0;
    pupil_sensor_config config;
    memset(c, 0, sizeof *c);
    c->frame_s = 1.0 / (check_uniform() < 0.4 ? usual[check_random() % 6] : at_random);
    c->readout_s = (0.3 + 0.7 * check_uniform()) * c->frame_s;
    c->exposure_s = fmin(exposure_s, c->frame_s);
    c->noise_ev = 0.002;
    c->phase = check_uniform();
    c->gain = 1.0;
    for (int i = 0; i < TEXTURE; i++)
        c->texture[i] = level = 0.9 * level + contrast * normal();
    pupil_sensor_config_default(&config);
    CHECK(config.mains_hz == PUPIL_SENSOR_MAINS_AUTO);
    config.frame_s = c->frame_s;
    config.exposure_mode = config.gain_mode = PUPIL_SENSOR_MANUAL;
    config.manual_exposure_s = c->exposure_s;
    config.manual_gain = 1.0;
    config.exposure_min_s = fmin(1e-4, c->exposure_s);
    config.exposure_max_s = fmax(c->frame_s, config.exposure_max_s);
    CHECK(pupil_sensor_init(&c->sensor, &config) == PUPIL_OK);
}

/* Takes the next frame, in which all light is `ev` above the usual. */
static void frame(camera *c, double ev)
{
    pupil_stats s;
    pupil_stats_clear(&s);
    const pupil_frame_info info = {.timestamp_ns = (int64_t)floor((1.0 + c->t + c->jitter_s * normal()) * 1e9 + 0.5),
                                   .sequence = c->n,
                                   .exposure_s = c->exposure_s,
                                   .gain = c->gain};
    const double most = c->modulation * left_of(c->hz, c->exposure_s);
    double all = 0.0;
    for (int b = 0; b < PUPIL_BANDS; b++) {
        double sum = 0.0;
        for (int y = 0; y < ROWS; y++) {
            const double row = (b + (y + 0.5) / ROWS), at = row + c->place;
            const double turns = c->hz * (c->t + row / PUPIL_BANDS * c->readout_s - 0.5 * c->exposure_s) + c->phase;
            const double lamp = most != 0.0 ? log2(1.0 + most * cos(2.0 * PI * turns)) : 0.0;
            const int i = (int)floor(at);
            sum += lamp + c->texture[i & (TEXTURE - 1)] +
                   (at - i) * (c->texture[(i + 1) & (TEXTURE - 1)] - c->texture[i & (TEXTURE - 1)]);
        }
        const double level = sum / ROWS + c->noise_ev * normal() + c->shade[b] + ev - 2.5;
        s.band_pixels[b] = PIXELS;
        s.band_log2_sum[b] = (int64_t)floor(level * PIXELS * 0x1p24);
        all += level * PIXELS;
    }
    s.pixels = s.weight = PUPIL_BANDS * PIXELS;
    s.rows = s.frame_height = PUPIL_BANDS * ROWS;
    s.log2_sum = (int64_t)floor(all);
    s.log2_frac = (uint64_t)((all - floor(all)) * 0x1p40);
    CHECK(pupil_sensor_frame(&c->sensor, &s, &info) == PUPIL_OK);
    CHECK(pupil_sensor_get(&c->sensor, &c->setting) == PUPIL_OK);
    do {
        c->t += c->frame_s;
        c->place += c->pan;
        c->n++;
    } while (check_uniform() < c->drops);
}

static double from_whole(double x)
{
    return fabs(x - floor(x + 0.5));
}

/* A lamp must be found if 2 % of it are left, it moves by at least a twentieth of a turn from frame to frame, and the
 * other frequency's movement differs by as much. The wrong one must never be found. */
static void check_lamps(const char *what, int cases, double drops, double pan, double noise_ev, double jitter_s)
{
    static camera c;
    const int trials = check_some(cases);
    int seen = 0, right = 0, late = 0, wrong = 0, unseen = 0;
    double off = 0.0;
    for (int i = 0; i < trials; i++) {
        const uint32_t hz = check_uniform() < 0.5 ? 50 : 60;
        begin(&c, 3e-4 * pow(1.5 / (2.0 * hz) / 3e-4, check_uniform()));
        c.hz = 2.0 * hz * (1.0 + 0.002 * (check_uniform() - 0.5));
        c.modulation = 0.02 * pow(25.0, check_uniform());
        c.drops = drops;
        c.pan = pan * (2.0 * check_uniform() - 1.0);
        c.noise_ev = noise_ev;
        c.jitter_s = jitter_s;
        const double left = c.modulation * fabs(left_of(c.hz, c.exposure_s));
        const int counts = left >= 0.02 && from_whole(c.hz * c.frame_s) >= 0.05 && from_whole(20.0 * c.frame_s) >= 0.05;
        uint32_t found = 0, after = 0;
        const double modulation = c.modulation;
        c.modulation = 0.0;
        for (int n = 0; n < 20 * (i % 2); n++) /* every other one is switched on */
            frame(&c, 0.0);
        c.modulation = modulation;
        for (uint32_t n = 1; n <= 2 * FRAMES; n++) {
            frame(&c, 0.0);
            after = c.setting.mains_hz == hz && found != hz ? n : after;
            found = c.setting.mains_hz;
            wrong += found && found != hz;
            CHECK(c.setting.mains == (found ? PUPIL_SENSOR_MAINS_FOUND : PUPIL_SENSOR_MAINS_UNDETERMINED));
        }
        unseen += !counts;
        seen += counts;
        right += counts && found == hz && after <= FRAMES;
        late += counts && found == hz && after > FRAMES;
        if (counts && found == hz && drops + pan + jitter_s == 0.0)
            off = fmax(off, fabs(log2(c.setting.mains_modulation / left)));
    }
    printf("%s: %d with a trace, %d right within %d frames (%.2f %%), %d later, %d not; %d without; %d wrong\n", what,
           seen, right, FRAMES, 100.0 * right / seen, late, seen - right - late, unseen, wrong);
    if (off > 0.0)
        printf("  modulation told to within %.1f stops\n", off);
    CHECK(seen > trials / 3 && right >= 0.99 * seen && wrong == 0 && off < 2.0);
}

/* --- without lamps --- */

enum scene { STEADY, DRIFT, STEPS, PAN, SHAKE, STROBE, BLINK, ALL_BLINKS, PASSING, SCENES };
static const char *const scene_name[SCENES] = {
    "steady light",    "light and shade that drift",      "steps of the light", "pans",
    "a shaken camera", "strobes, whole frames and parts", "a lamp at 10 Hz",    "all light at 10 Hz",
    "things that pass"};

/* Changes the scene before the next frame; returns by how much all light is above the usual. */
static double happen(camera *c, enum scene scene, int n, const double chance[4])
{
    const int first = (int)(chance[0] * 50.0), size = 2 + (int)(chance[1] * 30.0);
    double ev = 0.0;
    if (scene == DRIFT)
        c->shade[check_random() % PUPIL_BANDS] += 0.01 * normal();
    if (scene == DRIFT || scene == STEPS)
        ev = scene == DRIFT ? 0.5 * sin(0.01 * n) : (double)(n / (3 + size) % 4);
    if (scene == PAN)
        c->pan = 4.0 * chance[2] * (2.0 * chance[3] - 1.0);
    if (scene == SHAKE)
        c->pan = check_uniform() * sin(2.0 * PI * 8.0 * c->t);
    if (scene == STROBE)
        ev = n % 7 ? 0.0 : 3.0;
    if (scene == ALL_BLINKS)
        ev = log2(1.0 + 0.3 * sin(2.0 * PI * 10.0 * c->t));
    for (int b = 0; b < PUPIL_BANDS && scene >= STROBE && scene != ALL_BLINKS; b++) {
        const int from = scene == PASSING ? (int)(n * 6.0 * chance[2]) % 100 - 20 : first;
        const int on = scene == STROBE ? n % 5 == 0 : scene == PASSING || fmod(10.0 * c->t + chance[3], 1.0) < 0.5;
        c->shade[b] = on && b >= from && b < from + size ? 3.0 * chance[2] : 0.0;
    }
    return ev;
}

static void check_no_lamps(enum scene scene, int cameras, int frames)
{
    static camera c;
    int alarms = 0;
    for (int i = 0; i < cameras; i++) {
        const double chance[4] = {check_uniform(), check_uniform(), check_uniform(), check_uniform()};
        begin(&c, 0.005);
        c.noise_ev = 0.006 * check_uniform();
        for (int n = 0; n < frames; n++)
            frame(&c, happen(&c, scene, n, chance));
        alarms += c.setting.mains_hz != 0;
    }
    printf("%s: %d x %d frames, %d false alarms\n", scene_name[scene], cameras, frames, alarms);
    CHECK(alarms == 0);
}

/* Lamps that leave no distinguishable bands. */
static void check_undetermined(void)
{
    static const struct {
        double hz, fps, readout; /* readout: of the frame */
        double modulation, exposure_s;
    } of[] = {{120, 30, 0.7, 0.5, 0.004}, {100, 25, 0.7, 0.5, 0.004}, {100, 50, 0.7, 0.5, 0.004},
              {120, 60, 0.7, 0.5, 0.004}, {100, 20, 0.7, 0.5, 0.004}, {100, 30, 0.0, 0.5, 0.004},
              {120, 25, 0.0, 0.5, 0.004}, {100, 30, 0.7, 0.5, 0.010}, {100, 30, 0.7, 0.001, 0.004}};
    static camera c;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        begin(&c, of[i].exposure_s);
        c.frame_s = 1.0 / of[i].fps;
        c.readout_s = of[i].readout * c.frame_s;
        c.hz = of[i].hz;
        c.modulation = of[i].modulation;
        c.exposure_s = of[i].exposure_s;
        for (int n = 0; n < 300; n++)
            frame(&c, 0.0);
        CHECK_MSG(!c.setting.mains_hz && c.setting.mains == PUPIL_SENSOR_MAINS_UNDETERMINED, "%g Hz, %g fps: %u Hz",
                  of[i].hz, of[i].fps, c.setting.mains_hz);
    }
}

/* --- in a loop --- */

enum { DELAY = 2 };

/* Settings are in force some frames later; the light is 2^light_ev for a frame of 1 s. Returns by how many stops the
 * shown frame is above the key, without the lamps. */
static double turn(camera *c, double light_ev, double asked[DELAY][2])
{
    const double exposure_s = asked[c->n % DELAY][0], gain = asked[c->n % DELAY][1];
    const double ev = light_ev + log2(exposure_s * gain);
    double *next = asked[c->n % DELAY];
    c->exposure_s = exposure_s;
    c->gain = gain;
    frame(c, ev + 2.5);
    next[0] = c->setting.exposure_s;
    next[1] = c->setting.gain;
    return ev + log2(c->setting.frame_digital) - log2(0.18);
}

/* A camera of `fps` under lamps, at rest at the exposure for light_ev. */
static void begin_loop(camera *c, const pupil_sensor_config *config, double fps, double light_ev,
                       double asked[DELAY][2])
{
    begin(c, 0.01);
    memset(c->texture, 0, sizeof c->texture);
    c->frame_s = 1.0 / fps;
    c->readout_s = 0.02;
    c->noise_ev = 0.001;
    CHECK(pupil_sensor_init(&c->sensor, config) == PUPIL_OK);
    CHECK(pupil_sensor_start(&c->sensor, 0.18 * exp2(-light_ev), 1.0) == PUPIL_OK);
    CHECK(pupil_sensor_get(&c->sensor, &c->setting) == PUPIL_OK);
    for (int i = 0; i < DELAY; i++)
        asked[i][0] = c->setting.exposure_s, asked[i][1] = c->setting.gain;
}

static int is_multiple(double exposure_s, uint32_t hz)
{
    return from_whole(exposure_s * 2.0 * hz) < 1e-6;
}

static void check_loop(void)
{
    static camera c;
    double asked[DELAY][2], worst = 0.0;
    const double dark_ev = log2(0.18 / 0.013), bright_ev = log2(0.18 / 0.0013); /* 13 ms would be right; 1.3 */
    pupil_sensor_config config;
    pupil_sensor_config_default(&config);
    config.frame_s = 1.0 / 25.5;
    config.exposure_max_s = config.frame_s;
    begin_loop(&c, &config, 25.5, dark_ev, asked);
    for (int n = 0; n < 300; n++) { /* nothing yet */
        turn(&c, dark_ev, asked);
        CHECK(c.setting.state == PUPIL_SENSOR_CONVERGED && !c.setting.mains_hz);
        CHECK(c.setting.mains == PUPIL_SENSOR_MAINS_UNDETERMINED && c.setting.mains_modulation == 0.0);
    }
    c.readout_s = 0.03;
    c.modulation = 0.3;
    c.hz = 120.0;
    for (int n = 0; n < 60; n++) {
        worst = fmax(worst, fabs(turn(&c, dark_ev, asked)));
        CHECK_MSG(n < FRAMES || (c.setting.mains_hz == 60 && c.setting.mains == PUPIL_SENSOR_MAINS_FOUND), "frame %d",
                  n);
        CHECK_MSG(n < FRAMES || is_multiple(c.setting.exposure_s, 60), "%g s", c.setting.exposure_s);
        CHECK(n < FRAMES || c.setting.mains_modulation > 0.01);
    }
    printf("60 Hz found: the level, lamps apart, is at most %.4f EV off\n", worst);
    CHECK(worst <= 0.01);
    for (int n = 0; n < 300; n++) { /* no lamps: the found frequency is kept */
        c.modulation = 0.0;
        turn(&c, dark_ev, asked);
        CHECK(c.setting.mains_hz == 60);
    }
    for (int n = 0; n < 60; n++) { /* others */
        c.modulation = 0.5;
        c.hz = 100.0;
        c.frame_s = 1.0 / 30.0;
        turn(&c, dark_ev, asked);
        CHECK_MSG(n < FRAMES + DELAY || (c.setting.mains_hz == 50 && is_multiple(c.setting.exposure_s, 50)), "%g s",
                  c.setting.exposure_s);
    }
    for (int n = 0; n < 60; n++)
        turn(&c, bright_ev, asked);
    CHECK(c.setting.state == PUPIL_SENSOR_FLICKER && c.setting.reason == PUPIL_SENSOR_BELOW_MAINS);
    CHECK(pupil_sensor_retune(&c.sensor, &config) == PUPIL_OK && pupil_sensor_get(&c.sensor, &c.setting) == PUPIL_OK);
    CHECK(c.setting.mains_hz == 50 && c.setting.mains == PUPIL_SENSOR_MAINS_FOUND);
}

/* A configured frequency is not questioned; a lock keeps the setting until it ends. Then the frequency must be found:
 * until then 50 Hz is assumed, so 50 Hz lamps leave no bands in exposures of 10 ms and more. Shorter exposures have
 * bands, which show the frequency. */
static void check_told(void)
{
    static camera c;
    double asked[DELAY][2];
    const double dark_ev = log2(0.18 / 0.013), middle_ev = log2(0.18 / 0.004); /* 13 ms would be right; 4 */
    for (int i = 0; i < 4; i++) {
        pupil_sensor_config config;
        pupil_sensor_config_default(&config);
        config.mains_hz = i < 3 ? (uint32_t[]){0, 50, 60}[i] : PUPIL_SENSOR_MAINS_AUTO;
        config.lock = i == 3;
        begin_loop(&c, &config, 30.0, dark_ev, asked);
        const double before_s = c.setting.exposure_s;
        c.modulation = 0.3;
        c.hz = 100.0;
        for (int n = 0; n < 60; n++)
            turn(&c, dark_ev, asked);
        CHECK(c.setting.mains == (i < 3 ? PUPIL_SENSOR_MAINS_CONFIGURED : PUPIL_SENSOR_MAINS_UNDETERMINED));
        CHECK(c.setting.mains_hz == (i < 3 ? config.mains_hz : 0) && (i < 3 || c.setting.exposure_s == before_s));
        config.mains_hz = PUPIL_SENSOR_MAINS_AUTO;
        config.lock = 0;
        CHECK(pupil_sensor_retune(&c.sensor, &config) == PUPIL_OK);
        for (int n = 0; n < FRAMES + DELAY; n++) {
            turn(&c, dark_ev, asked);
            CHECK_MSG(c.setting.mains_hz != 60 || i == 2, "case %d: 60 Hz", i);
        }
        CHECK_MSG(is_multiple(c.setting.exposure_s, 50), "case %d: %g s", i, c.setting.exposure_s);
        for (int n = 0; n < 4 + 2 * DELAY + FRAMES; n++) /* flash_frames, the step, and the frames with a trace */
            turn(&c, middle_ev, asked);
        CHECK_MSG(c.setting.mains_hz == 50 && c.setting.mains == PUPIL_SENSOR_MAINS_FOUND, "case %d: %u Hz at %g s", i,
                  c.setting.mains_hz, c.setting.exposure_s);
        for (int n = 0; n < 60; n++)
            turn(&c, dark_ev, asked);
        CHECK_MSG(is_multiple(c.setting.exposure_s, 50), "case %d: %g s", i, c.setting.exposure_s);
    }
    CHECK(pupil_sensor_scene(&c.sensor, -2.0, 0.0, NULL) == PUPIL_OK); /* no bands: the found frequency is kept */
    CHECK(pupil_sensor_get(&c.sensor, &c.setting) == PUPIL_OK && c.setting.mains_hz == 50);
}

/* Lamps that almost go out are found, and their modulation is at most all of the light. */
static void check_strong(void)
{
    camera c;
    begin(&c, 5e-4);
    c.frame_s = 1.0 / 30.0, c.readout_s = 0.025;
    c.hz = 100.0, c.modulation = 0.999;
    for (int n = 0; n < FRAMES; n++)
        frame(&c, 0.0);
    CHECK_MSG(c.setting.mains_hz == 50 && c.setting.mains_modulation > 0.9 && c.setting.mains_modulation <= 1.0,
              "%u Hz, modulation %g", c.setting.mains_hz, c.setting.mains_modulation);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_lamps("lamps", 2000, 0.0, 0.0, 0.002, 0.0);
    check_lamps("a tenth of the frames dropped", 1000, 0.1, 0.0, 0.002, 0.0);
    check_lamps("slow pans", 1000, 0.0, 0.05, 0.002, 0.0);
    check_lamps("noise of 0.006 EV", 1000, 0.0, 0.0, 0.006, 0.0);
    check_lamps("timestamps that jitter by 0.3 ms", 1000, 0.0, 0.0, 0.002, 3e-4);
    check_no_lamps(STEADY, 1, 10000);
    check_no_lamps(DRIFT, 1, 10000);
    for (int scene = STEADY; scene < SCENES; scene++)
        check_no_lamps((enum scene)scene, 40, 200);
    check_undetermined();
    check_loop();
    check_told();
    check_strong();
    return check_end();
}
