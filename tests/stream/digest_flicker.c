/* Flicker, in the bands of a sensor's frames and in the light of whole frames: random cameras and lamps, and some with
 * numbers exactly at a bound. The light is computed in integers. A lamp's wave consists of parabolas: a sine to within
 * 6 %.
 */
#include "digest.h"

#include "pupil/sensor.h"

#define MS INT64_C(1000000)

static uint64_t digest, noise;

static void add_u64(uint64_t value)
{
    for (int i = 0; i < 8; i++, value >>= 8)
        digest = (digest ^ (value & 255)) * UINT64_C(0x100000001b3); /* FNV-1a, as digest.c has it */
}

static void add_int(int value)
{
    add_u64((uint64_t)(int64_t)value);
}

static void add_double(double value)
{
    uint64_t bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    add_u64(bits);
}

/* 0 to n - 1, as digest.c makes its random bits. */
static int64_t below(int64_t n)
{
    noise = noise * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (int64_t)(noise >> 33) % n;
}

static int64_t any(int64_t most)
{
    return below(2 * most + 1) - most;
}

static int one_in(int64_t n)
{
    return below(n) == 0;
}

/* In fixed point: 2^16 is 1. */
static int64_t wave(int64_t t_ns, int64_t period_ns)
{
    const int64_t x = t_ns % period_ns * 65536 / period_ns, half = x & 32767, w = half * (32768 - half) >> 12;
    return x < 32768 ? w : -w;
}

/* Frame times: usual ones; those in which 100 or 120 Hz have a whole number of turns plus a half, a sixteenth, or
 * nothing; and those at which both move alike. */
static const int64_t frame_times[] = {33366667, 40 * MS,  33333333, 20 * MS,  16666667, 8333333,
                                      24 * MS,  41666667, 15 * MS,  20833333, 50 * MS,  31818182,
                                      40625000, 39375000, 93457944, 29 * MS,  36 * MS,  45454545};
enum { FRAME_TIMES = sizeof frame_times / sizeof frame_times[0] };

static int64_t some_period(void)
{
    const int64_t period_ns = one_in(2) ? 10 * MS : 8333333;
    return one_in(3) ? period_ns : period_ns + any(30000);
}

/* --- bands --- */

enum { ROW_CASES = 48, ROW_FRAMES = 36 };

typedef struct rows {
    int64_t frame_ns, readout_ns, period_ns; /* of the lamp's light */
    int64_t exposure_us, wave, noise;        /* of a band: 2^-24 of a stop */
    int64_t drops, pans, switched, longer;   /* one in so many; eighths of a band a frame; from that frame on */
    int has_empty;                           /* per group of bands */
} rows;

/* One after the other, because the order of evaluation in an initialiser is not defined. */
static rows some_rows(int number)
{
    const int64_t frame_ns = frame_times[number % FRAME_TIMES];
    rows r;
    r.frame_ns = frame_ns;
    r.readout_ns = one_in(6) ? frame_ns * 5 / 4 : frame_ns / 100 * (30 + below(70));
    r.period_ns = some_period();
    r.exposure_us = 500 * (1 + below(10));
    r.wave = below(3) ? (INT64_C(1) << 24) * (1 + below(12)) / 20 : (INT64_C(1) << 24) * below(25) / 1000;
    r.noise = one_in(4) ? 0 : one_in(3) ? 400000 : 30000;
    r.drops = one_in(3) ? 6 : 1000;
    r.pans = one_in(4) ? below(4) : 0;
    r.switched = one_in(3) ? 2 + below(12) : 0;
    r.longer = one_in(3) ? 8 + below(8) : ROW_FRAMES;
    r.has_empty = one_in(4);
    return r;
}

static void put_bands(const rows *r, int64_t t_ns, int64_t frame, pupil_stats *s)
{
    int64_t sum = 0;
    pupil_stats_clear(s);
    for (int64_t b = 0; b < PUPIL_BANDS; b++) {
        const int64_t at_ns = t_ns + r->readout_ns * (2 * b + 1) / (2 * PUPIL_BANDS);
        const int64_t place = 8 * b + frame * r->pans, shade = (place * place * 37 + place * 1511) % 60000 * 40;
        const int64_t lamp = frame < r->switched ? 0 : wave(at_ns, r->period_ns) * (r->wave >> 8) / 256;
        const uint32_t pixels = b / 3 == 5 && r->has_empty ? 0 : 900 + (uint32_t)b;
        s->band_pixels[b] = pixels;
        s->band_log2_sum[b] = (lamp + shade + any(r->noise) - (INT64_C(5) << 23)) * pixels;
        s->pixels += pixels;
        sum += s->band_log2_sum[b];
    }
    s->weight = s->pixels;
    s->rows = s->frame_height = 4 * PUPIL_BANDS;
    s->log2_sum = sum >> 24;
    s->log2_frac = (uint64_t)(sum & 0xffffff) << 16;
}

static void add_rows(const rows *r)
{
    static pupil_sensor sensor;
    static pupil_stats stats;
    pupil_sensor_config config;
    pupil_sensor_setting s;
    pupil_sensor_config_default(&config);
    config.frame_s = (double)r->frame_ns * 1e-9;
    config.exposure_mode = config.gain_mode = PUPIL_SENSOR_MANUAL;
    config.exposure_min_s = 1e-4;
    config.exposure_max_s = 0.125;
    config.manual_exposure_s = (double)r->exposure_us * 1e-6;
    config.manual_gain = 1.0;
    add_int(pupil_sensor_init(&sensor, &config));
    for (int64_t n = 0; n < ROW_FRAMES; n++) {
        const double longer_s = n >= r->longer ? (double)((n - r->longer) % 8) * (one_in(9) ? 2e-3 : 4e-5) : 0.0;
        const pupil_frame_info info = {.timestamp_ns = 1000 * MS + n * r->frame_ns + (n == 30 ? 960 * MS : 0),
                                       .sequence = (uint64_t)n,
                                       .exposure_s = config.manual_exposure_s + longer_s,
                                       .gain = 1.0};
        if (one_in(r->drops))
            continue;
        put_bands(r, info.timestamp_ns, n, &stats);
        add_int(pupil_sensor_frame(&sensor, &stats, &info));
        add_int(pupil_sensor_get(&sensor, &s));
        add_u64(s.mains_hz);
        add_u64(s.mains);
        add_double(s.mains_modulation);
    }
}

uint64_t digest_mains(void)
{
    digest = UINT64_C(0xcbf29ce484222325);
    noise = 1;
    for (int i = 0; i < ROW_CASES; i++) {
        const rows r = some_rows(i);
        add_rows(&r);
    }
    return digest;
}

/* --- the light of whole frames --- */

enum { LAMP_CASES = 72, LAMP_FRAMES = 176 };

typedef struct lamp {
    int64_t frame_ns, period_ns, wave, noise, jitter_ns, exposure_us;
    int64_t drops, steps, shocks, odd; /* one frame in so many; a shock changes only one frame's light */
    int64_t off, on, slower;           /* from that frame on */
    int longer;                        /* exposures vary */
} lamp;

static lamp some_lamp(int number)
{
    const int64_t off = one_in(2) ? 60 + below(60) : LAMP_FRAMES;
    lamp l;
    l.frame_ns = frame_times[number % FRAME_TIMES];
    l.period_ns = number < 2 * FRAME_TIMES ? some_period() : 10 * MS;
    l.wave = (INT64_C(1) << 24) * (1 + below(one_in(5) ? 60 : 20)) / 100;
    l.noise = one_in(3) ? 0 : one_in(3) ? 200000 : 3000;
    l.jitter_ns = one_in(3) ? 200000 : 0;
    l.exposure_us = one_in(3) ? 0 : 500 * below(8);
    l.drops = one_in(3) ? 12 : 1000;
    l.steps = one_in(3) ? 30 : 1000;
    l.shocks = one_in(2) ? 15 : 1000;
    l.odd = one_in(3) ? 40 : 1000;
    l.off = off;
    l.on = off + 3 + below(20);
    l.slower = one_in(4) ? 90 + below(30) : LAMP_FRAMES;
    l.longer = one_in(3);
    return l;
}

/* Occasional events: no time, the same frame again, an earlier one, a pause of about or exactly a second. */
static int64_t odd_time(int64_t t_ns, int64_t before_ns)
{
    static const int64_t later_ns[] = {-50 * MS, 990 * MS, 1010 * MS};
    const int64_t kind = below(6);
    return kind == 0 ? 0 : kind == 1 ? before_ns : kind == 2 ? before_ns + 1000 * MS : t_ns + later_ns[kind - 3];
}

static void put_light(int64_t light, pupil_stats *s)
{
    pupil_stats_clear(s);
    s->pixels = s->weight = s->rows = s->frame_height = s->band_pixels[0] = 1;
    s->band_log2_sum[0] = light;
    s->log2_sum = light >> 24;
    s->log2_frac = (uint64_t)(light & 0xffffff) << 16;
}

/* For the frame, and for others near it. */
static void add_frame(const pupil_t *pupil, int64_t t_ns)
{
    static const int64_t from_ns[] = {33 * MS, -17 * MS, 999 * MS, -999 * MS, 1000 * MS, -1000 * MS, 1001 * MS};
    pupil_exposure e;
    pupil_curve curve;
    add_int(pupil_get_exposure(pupil, &e));
    add_double(e.flicker_ev);
    for (size_t i = 0; i < sizeof from_ns / sizeof from_ns[0]; i++) {
        const pupil_frame_info info = {.timestamp_ns = t_ns ? t_ns + from_ns[i] : 0};
        add_int(pupil_get_curve(pupil, &info, &curve));
        add_double((double)curve.scale);
    }
}

static void add_light(pupil_t *pupil, int64_t light, int64_t time_ns, double exposure_s)
{
    static pupil_stats stats;
    const pupil_frame_info info = {.timestamp_ns = time_ns, .exposure_s = exposure_s};
    put_light(light, &stats);
    add_int(pupil_adapt(pupil, &stats, &info));
    add_frame(pupil, time_ns);
}

static void add_lamp(pupil_t *pupil, const lamp *l)
{
    int64_t before_ns = 0, level = 0, t_ns = 1000 * MS;
    for (int64_t n = 0; n < LAMP_FRAMES; n++) {
        const int64_t longer_us = l->longer ? n / 16 % 4 * 150 : 0;
        t_ns += n < l->slower ? l->frame_ns : l->frame_ns * 7 / 5;
        const int64_t taken_ns = t_ns + any(l->jitter_ns);
        const int64_t time_ns = one_in(l->odd) ? odd_time(taken_ns, before_ns) : taken_ns;
        const int64_t lit = n < l->off || n >= l->on ? wave(taken_ns, l->period_ns) * (l->wave >> 8) / 256 : 0;
        level += one_in(l->steps) ? any(INT64_C(1) << 25) : 0;
        const int64_t shock = one_in(l->shocks) ? any(INT64_C(1) << 23) : 0;
        if (one_in(l->drops))
            continue;
        add_light(pupil, level + any(l->noise) + lit + shock, time_ns, (double)(l->exposure_us + longer_us) * 1e-6);
        before_ns = time_ns;
    }
}

/* Pairs of exposures: by the info, the second ends exactly a second after the first. */
static void add_pauses(pupil_t *pupil)
{
    static const struct {
        int64_t later_ms;
        double exposure_s[2];
    } pair[] = {{1000, {0.0, 0.0}}, {750, {0.5, 1.0}}, {1000, {1.0, 0.5}}, {500, {1.0, 0.0}}, {250, {0.5, 1.0}}};
    int64_t t_ns = INT64_C(1) << 40;
    for (size_t i = 0; i < sizeof pair / sizeof pair[0]; i++) {
        for (int64_t n = 0; n < 90; n++, t_ns += 31250000)
            add_light(pupil, wave(t_ns, 10 * MS) * 40, t_ns, pair[i].exposure_s[0]);
        t_ns += pair[i].later_ms * MS - 31250000;
        add_light(pupil, wave(t_ns, 10 * MS) * 40, t_ns, pair[i].exposure_s[1]);
        for (int64_t n = 0; n < 8; n++) {
            t_ns += 31250000;
            add_light(pupil, wave(t_ns, 10 * MS) * 40, t_ns, pair[i].exposure_s[1]);
        }
        t_ns += 3000 * MS;
    }
}

uint64_t digest_flicker(void)
{
    static pupil_t pupil;
    pupil_config config;
    digest = UINT64_C(0xcbf29ce484222325);
    noise = 2;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE; /* no histogram */
    for (int i = 0; i < LAMP_CASES; i++) {
        const lamp l = some_lamp(i);
        add_int(pupil_init(&pupil, &config));
        add_lamp(&pupil, &l);
    }
    add_int(pupil_init(&pupil, &config));
    add_pauses(&pupil);
    return digest;
}
