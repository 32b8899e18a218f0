#include "hostile_camera.h"

#include <math.h>
#include <string.h>

#define PI         3.14159265358979323846
#define KEY        0.18
#define SPREAD_EV  1.3
#define UVC_UNIT_S 1e-4

/* Xorshift64* (Vigna 2016). */
static uint64_t next_random(hostile_camera *camera)
{
    camera->random ^= camera->random >> 12;
    camera->random ^= camera->random << 25;
    camera->random ^= camera->random >> 27;
    return camera->random * UINT64_C(0x2545f4914f6cdd1d);
}

double hostile_uniform(hostile_camera *camera)
{
    return (double)(next_random(camera) >> 11) * 0x1p-53;
}

/* The polar method (Marsaglia, Bray 1964). */
double hostile_normal(hostile_camera *camera)
{
    for (;;) {
        const double x = 2.0 * hostile_uniform(camera) - 1.0, y = 2.0 * hostile_uniform(camera) - 1.0;
        const double r2 = x * x + y * y;
        if (r2 > 0.0 && r2 < 1.0)
            return x * sqrt(-2.0 * log(r2) / r2);
    }
}

/* The value below which the share p of a normal distribution is, by bisection. */
static double normal_quantile(double p)
{
    double low = -9.0, high = 9.0;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (0.5 * erfc(-middle / sqrt(2.0)) < p)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

void hostile_camera_turn(hostile_camera *camera)
{
    for (uint32_t i = HOSTILE_PIXELS - 1; i > 0; i--) {
        const uint32_t j = (uint32_t)(next_random(camera) % (i + 1));
        const float moved = camera->scene[i];
        camera->scene[i] = camera->scene[j];
        camera->scene[j] = moved;
    }
}

static void make_scene(hostile_camera *camera)
{
    static double scene_ev[HOSTILE_PIXELS]; /* the same for all cameras: every quantile once */
    if (scene_ev[0] == 0.0)
        for (int i = 0; i < HOSTILE_PIXELS; i++)
            scene_ev[i] = SPREAD_EV * normal_quantile((i + 0.5) / HOSTILE_PIXELS);
    for (int i = 0; i < HOSTILE_PIXELS; i++)
        camera->scene[i] = (float)exp2(scene_ev[i]);
    hostile_camera_turn(camera);
}

int hostile_camera_open(hostile_camera *camera, uint64_t seed)
{
    pupil_config config;
    memset(camera, 0, sizeof *camera);
    camera->bits = 12;
    camera->delay = 3;
    camera->frame_s = 1.0 / 30.0;
    camera->readout_s = 0.028;
    camera->saturation = 1.0;
    camera->random = seed * 2 + 1; /* 0 would give nothing but zeros */
    for (int i = 0; i < 8; i++)
        next_random(camera);
    make_scene(camera);
    pupil_config_default(&config);
    config.histogram = 1;
    return pupil_init(&camera->meter, &config) == PUPIL_OK;
}

void hostile_camera_config(pupil_sensor_config *config)
{
    pupil_sensor_config_default(config);
    config->exposure_min_s = HOSTILE_LINE_S;
    config->exposure_step_s = HOSTILE_LINE_S;
    config->gain_law = PUPIL_GAIN_LINEAR;
    config->gain_step = 1.0 / 16.0;
    config->gain_max = 16.0;
}

void hostile_camera_write_first(hostile_camera *camera, double exposure_s, double gain)
{
    for (int i = 0; i < HOSTILE_HISTORY; i++) {
        camera->written[i][0] = exposure_s;
        camera->written[i][1] = gain;
    }
}

void hostile_camera_write(hostile_camera *camera, double exposure_s, double gain)
{
    double *written = camera->written[camera->frame % HOSTILE_HISTORY];
    written[0] = exposure_s;
    written[1] = gain;
    camera->frame++;
}

double hostile_camera_highlight_ev(const hostile_camera *camera)
{
    /* sensor.h: highlight_share 0.05 at most, a fifth of a stop below the saturated value */
    const double held = log2(camera->saturation) - 0.2 - SPREAD_EV * normal_quantile(0.95);
    return fmin(0.0, held - log2(KEY));
}

/* What the registers ask for, and the exposure time and gain that the sensor really has. */
static void control_camera(hostile_camera *camera, double registers[2])
{
    const double *written = camera->written[(camera->frame + HOSTILE_HISTORY - camera->delay) % HOSTILE_HISTORY];
    registers[0] = written[0];
    registers[1] = written[1];
    if (camera->powers_of_two)
        registers[0] = UVC_UNIT_S * exp2(floor(log2(registers[0] / UVC_UNIT_S) + 1e-9));
    camera->exposure_s = registers[0];
    camera->gain = registers[1];
    if (camera->gain < camera->dead_gain)
        camera->gain = 1.0;
    else if (camera->dead_gain > 0.0 && camera->dead_gain_continues)
        camera->gain /= camera->dead_gain;
}

/* Each row's light: the lamps' mean over its exposure, and the part of the picture that is brighter. */
static void light_rows(hostile_camera *camera)
{
    const double turns = camera->lamp_hz * camera->exposure_s;
    const double left = turns > 0.0 ? sin(PI * turns) / (PI * turns) : 1.0;
    double least = 2.0, most = 0.0;
    for (int y = 0; y < HOSTILE_SIDE; y++) {
        const double t = (double)camera->frame * camera->frame_s + camera->readout_s * y / HOSTILE_SIDE;
        double light = 1.0;
        if (camera->lamp_hz > 0.0)
            light += camera->lamp_modulation * left * sin(2.0 * PI * camera->lamp_hz * t);
        /* no fmin and fmax: gcc 12 for AArch64 fails at -O3 with an internal error on their reduction */
        if (light < least)
            least = light;
        if (light > most)
            most = light;
        camera->row_light[y] = (float)light;
    }
    camera->bands_ev = log2(most / least);
}

/* A pixel of this light, where 1 is saturated, with the noise of its electrons. */
static double noisy(hostile_camera *camera, double light)
{
    const double electrons = light / camera->gain * camera->well_e;
    const double deviation = sqrt(camera->read_e * camera->read_e + electrons);
    return (electrons + deviation * hostile_normal(camera)) * camera->gain / camera->well_e;
}

static void expose(hostile_camera *camera, double all)
{
    const double top = (double)((1u << camera->bits) - 1);
    const int bright_pixels = (int)(camera->part_share * HOSTILE_PIXELS + 0.5);
    const double part = exp2(camera->part_ev);
    uint8_t *bytes = (uint8_t *)(void *)camera->codes;
    for (int i = 0; i < HOSTILE_PIXELS; i++) {
        double v = all * (double)camera->scene[i] * (double)camera->row_light[i / HOSTILE_SIDE];
        v *= i < bright_pixels ? part : 1.0;
        v = camera->well_e > 0.0 ? noisy(camera, v) : v;
        v += camera->pedestal;
        if (v >= camera->saturation)
            v = camera->saturation +
                (camera->saturation_noise > 0.0 ? camera->saturation_noise * hostile_uniform(camera) : 0.0);
        v = v > 0.0 ? v * top + 0.5 : 0.0;
        const uint16_t code = (uint16_t)(v < top ? v : top);
        if (camera->bits == 8)
            bytes[i] = (uint8_t)code;
        else
            camera->codes[i] = code;
    }
}

static int64_t stamp(hostile_camera *camera)
{
    const int64_t now_ns = 1000000000 + (int64_t)((double)camera->frame * camera->frame_s * 1e9);
    switch (camera->clock) {
    case HOSTILE_CLOCK_CONSTANT:
        return 123456789;
    case HOSTILE_CLOCK_ZERO:
        return 0;
    case HOSTILE_CLOCK_JUMPING:
        return now_ns + INT64_C(20000000000) + (int64_t)(20e9 * (hostile_uniform(camera) - 0.5));
    case HOSTILE_CLOCK_STOPPED:
        return now_ns < INT64_C(3000000000) ? now_ns : INT64_C(3000000000);
    case HOSTILE_CLOCK_BACK:
        return INT64_C(1000000000000) - now_ns;
    default:
        return now_ns;
    }
}

int hostile_camera_frame(hostile_camera *camera, pupil_stats *stats, pupil_frame_info *info)
{
    double registers[2];
    control_camera(camera, registers);
    const double setting_ev = log2(camera->exposure_s * camera->gain / HOSTILE_REST_S);
    const double noise_ev = camera->frame_noise_ev > 0.0 ? camera->frame_noise_ev * hostile_normal(camera) : 0.0;
    light_rows(camera);
    expose(camera, KEY * exp2(camera->light_ev + setting_ev + noise_ev));
    camera->level_ev = camera->light_ev + setting_ev + camera->part_share * camera->part_ev;
    const int bytes = camera->bits == 8 ? 1 : 2;
    const uint32_t grey = camera->bits == 8    ? PUPIL_PIXEL_GREY8
                          : camera->bits == 10 ? PUPIL_PIXEL_GREY10
                                               : PUPIL_PIXEL_GREY12;
    const pupil_image_const image = {.data = camera->codes,
                                     .stride_bytes = HOSTILE_SIDE * bytes,
                                     .width = HOSTILE_SIDE,
                                     .height = HOSTILE_SIDE,
                                     .pixel = grey};
    memset(info, 0, sizeof *info);
    info->timestamp_ns = stamp(camera);
    info->sequence = camera->frame + 1;
    info->exposure_s = camera->info_missing ? 0.0 : registers[0];
    info->gain = camera->info_missing ? 0.0 : registers[1];
    pupil_stats_clear(stats);
    return pupil_meter_rows(&camera->meter, &image, 0, HOSTILE_SIDE, stats) == PUPIL_OK;
}
