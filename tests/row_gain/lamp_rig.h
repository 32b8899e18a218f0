/* tests/row_gain/lamp_rig.h: a rolling shutter that sees a textured wall under mains lamps, with daylight on some of
 * its columns or rows, and the gains that pupil_row_gain computes. The remaining bands are measured in the light
 * itself, not in the picture.
 */
#ifndef PUPIL_TESTS_LAMP_RIG_H
#define PUPIL_TESTS_LAMP_RIG_H

#include "check.h"
#include "pupil/row_gain.h"

#include <math.h>

enum { RIG_W = 128, RIG_H = 128, RIG_WALL = 256 };

typedef enum rig_wave { RIG_SINE, RIG_RECTIFIED, RIG_LED, RIG_WAVES } rig_wave;
static const char *const rig_wave_name[RIG_WAVES] = {"sine", "|sine|", "LED"};

typedef struct rig {
    double light_hz, modulation; /* (most - least) / (most + least) */
    rig_wave wave;
    double fps, readout_share, exposure_s;
    uint32_t mains_hz;
    /* light not from the lamps: everywhere, and in a rectangle, as shares of all light; the rectangle in shares of the
     * picture */
    double day, day_inside, x0, x1, y0, y1;
    double texture_ev, noise, pan_px; /* noise: share of the value; pan: pixels a frame */
    double jitter_s;                  /* error of timestamps, RMS */
    double readout_told;              /* config.readout_s over the true one */
    int exposure_unknown;
} rig;

static rig rig_default(void)
{
    return (rig){.light_hz = 100,
                 .modulation = 0.3,
                 .fps = 30,
                 .readout_share = 0.8,
                 .exposure_s = 1e-3,
                 .mains_hz = 50,
                 .texture_ev = 0.8,
                 .noise = 0.02,
                 .readout_told = 1};
}

static float rig_wall[RIG_WALL][RIG_WALL]; /* log2, with deviation 1; wraps around */

/* Noise of several sizes, equally strong in each. */
static void rig_make_wall(void)
{
    double sum = 0, squares = 0;
    for (int step = 64; step >= 2; step /= 2) {
        static float knot[RIG_WALL][RIG_WALL];
        const int n = RIG_WALL / step;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                knot[i][j] = (float)(check_uniform() - 0.5);
        for (int y = 0; y < RIG_WALL; y++)
            for (int x = 0; x < RIG_WALL; x++) {
                const int i = y / step, j = x / step, i1 = (i + 1) % n, j1 = (j + 1) % n;
                const float v = (float)(y % step) / step, u = (float)(x % step) / step;
                rig_wall[y][x] +=
                    (1 - v) * ((1 - u) * knot[i][j] + u * knot[i][j1]) + v * ((1 - u) * knot[i1][j] + u * knot[i1][j1]);
            }
    }
    for (int y = 0; y < RIG_WALL; y++)
        for (int x = 0; x < RIG_WALL; x++) {
            sum += rig_wall[y][x] / (RIG_WALL * RIG_WALL);
            squares += rig_wall[y][x] * rig_wall[y][x] / (RIG_WALL * RIG_WALL);
        }
    const double deviation = sqrt(squares - sum * sum);
    for (int y = 0; y < RIG_WALL; y++)
        for (int x = 0; x < RIG_WALL; x++)
            rig_wall[y][x] = (float)((rig_wall[y][x] - sum) / deviation);
}

/* The lamps' light, 1 on average. */
static double rig_light(const rig *r, double t)
{
    const double a = 2 * 3.14159265358979323846 * r->light_hz * t, m = r->modulation;
    if (r->wave == RIG_SINE || m == 0)
        return 1 + m * cos(a);
    if (r->wave == RIG_LED)
        return 1 + m * tanh(2 * cos(a)) / tanh(2);
    /* |sine| from 0 to 1, mean 2 / pi, on a base that makes the modulation m */
    const double base = (1 - m) / (2 * m);
    return (base + fabs(sin(a / 2))) / (base + 2 / 3.14159265358979323846);
}

static double rig_exposed(const rig *r, double middle)
{
    enum { N = 16 };
    double sum = 0;
    for (int i = 0; i < N; i++)
        sum += rig_light(r, middle + r->exposure_s * ((i + 0.5) / N - 0.5));
    return sum / N;
}

/* Approximately a gaussian of deviation 1. */
static double rig_random(void)
{
    return (check_uniform() + check_uniform() + check_uniform() + check_uniform() - 2) * 1.7320508;
}

typedef struct rig_camera {
    rig r;
    pupil_row_gain lamps;
    pupil_image_const image;
    pupil_frame_info info;
    double t, lamp[RIG_H], scene_x, brightness;
    double flash; /* light added in one frame to all rows from `flash_from` on */
    int flash_from;
    float gain[RIG_H];
    uint16_t pixel[RIG_H][RIG_W];
} rig_camera;

static void rig_open(rig_camera *c, const rig *r)
{
    pupil_row_gain_config config;
    pupil_row_gain_config_default(&config);
    config.mains_hz = r->mains_hz;
    config.readout_s = r->readout_share / r->fps * r->readout_told;
    memset(c, 0, sizeof *c);
    c->r = *r;
    c->t = 1 + check_uniform();
    c->brightness = 1;
    CHECK(pupil_row_gain_init(&c->lamps, &config) == PUPIL_OK);
    c->image = (pupil_image_const){.data = c->pixel, .stride_bytes = 2 * RIG_W, .width = RIG_W, .height = RIG_H};
    c->image.pixel = PUPIL_PIXEL_GREY16;
}

static int rig_is_day(const rig *r, double x, double y)
{
    return r->day_inside > 0 && x >= r->x0 && x < r->x1 && y >= r->y0 && y < r->y1;
}

/* The difference of the brightest and the darkest row, if this share of the light is not from the lamps, without and
 * with gains, in the rows of the rectangle or in all. */
static void rig_bands(const rig_camera *c, double day, int inside, double *before, double *after)
{
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    for (int y = 0; y < RIG_H; y++) {
        const double at = (y + 0.5) / RIG_H;
        if (inside && !(at >= c->r.y0 && at < c->r.y1))
            continue;
        const double ev[2] = {log2(c->lamp[y] * (1 - day) + day),
                              log2((c->lamp[y] * (1 - day) + day) * (double)c->gain[y])};
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], ev[i]);
            high[i] = fmax(high[i], ev[i]);
        }
    }
    *before = high[0] - low[0];
    *after = high[1] - low[1];
}

typedef struct rig_seen {
    double before, after;         /* bands of the frame without and with gains: of all light outside the rectangle, */
    double day_before, day_after; /* and inside */
} rig_seen;

/* The next frame, and its gains. */
static rig_seen rig_next(rig_camera *c)
{
    const rig *r = &c->r;
    c->t += 1 / r->fps;
    c->scene_x += r->pan_px;
    const int shift = (int)floor(c->scene_x);
    const float part = (float)(c->scene_x - shift);
    for (int y = 0; y < RIG_H; y++) {
        c->lamp[y] = rig_exposed(r, c->t + (y + 0.5) / RIG_H * r->readout_share / r->fps);
        for (int x = 0; x < RIG_W; x++) {
            const float *row = rig_wall[y];
            const float ev = (1 - part) * row[(x + shift) % RIG_WALL] + part * row[(x + shift + 1) % RIG_WALL];
            const double day = rig_is_day(r, (x + 0.5) / RIG_W, (y + 0.5) / RIG_H) ? r->day_inside : r->day;
            double value = 0.06 * c->brightness * exp2f(ev * (float)r->texture_ev) * (c->lamp[y] * (1 - day) + day);
            value += y >= c->flash_from ? 0.06 * c->flash : 0;
            value *= 1 + r->noise * (r->noise > 0 ? rig_random() : 0);
            c->pixel[y][x] = (uint16_t)(value < 0 ? 0 : value > 1 ? 65535 : value * 65535 + 0.5);
        }
    }
    c->flash = 0;
    c->info.timestamp_ns = (int64_t)((c->t + r->jitter_s * rig_random()) * 1e9);
    c->info.exposure_s = r->exposure_unknown ? 0 : r->exposure_s;
    c->info.gain = r->exposure_unknown ? 0 : 1;
    CHECK(pupil_row_gain_frame(&c->lamps, &c->image, &c->info) == PUPIL_OK);
    CHECK(pupil_row_gain_of_rows(&c->lamps, &c->info, RIG_H, c->gain) == PUPIL_OK);
    rig_seen seen = {0};
    rig_bands(c, r->day, 0, &seen.before, &seen.after);
    if (r->day_inside > 0)
        rig_bands(c, r->day_inside, 1, &seen.day_before, &seen.day_after);
    return seen;
}

#endif
