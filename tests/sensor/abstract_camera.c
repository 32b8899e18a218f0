#include "abstract_camera.h"

#include <math.h>
#include <string.h>

/* The key is pupil's default. */
#define KEY     0.18
#define LINE_S  20e-6
#define STEP    (1.0 / 16.0)
#define FRAME_S (1.0 / 30.0)
#define TOP     4095    /* 12 bits */
#define FLOOR   0x1p-14 /* the default floor of pupil_config, as which black counts */
/* Half the scene's range, from its mean to its ends: at the key the brightest sample is 0.57 stops below the top
 * code. */
#define SPREAD_EV 1.9
#define NOISE     0x1p-13 /* standard deviation of a sample at gain 1: half a code */

enum { SAMPLES = 16, PIXELS = PUPIL_BANDS * SAMPLES };

/* Noise only; too dark for the camera; four that it sees at once; two that saturate every sample at the usual setting;
 * and two on the bright side, the last of which is too bright for the camera. */
const double abstract_light_ev[ABSTRACT_LEVELS] = {-20.0, -7.5, -4.0, -1.5, 0.0, 1.2, 3.0, 5.0, 8.0, 11.0};

/* The setting of the camera's own automatic. */
static const double own_auto[2] = {200 * LINE_S, 2.0};

/* Quantiles of a normal distribution, in any order: the noise of the samples, the same in each frame. */
static const double noise_of[SAMPLES] = {0.40,  -1.23, 1.86,  -0.08, -0.58, 0.99,  -1.86, 0.24,
                                         -0.40, 0.58,  -0.77, 1.23,  0.08,  -0.99, 0.77,  -0.24};

void abstract_camera_config(pupil_sensor_config *config, uint32_t delay_frames)
{
    pupil_sensor_config_default(config);
    config->delay_frames = delay_frames;
    config->frame_s = FRAME_S;
    config->exposure_min_s = LINE_S;
    config->exposure_step_s = LINE_S;
    config->exposure_max_s = FRAME_S;
    config->gain_law = PUPIL_GAIN_LINEAR;
    config->gain_step = STEP;
    config->gain_max = 16.0;
}

abstract_camera abstract_camera_open(uint32_t delay, double saturation, double exposure_s, double gain)
{
    abstract_camera camera;
    memset(&camera, 0, sizeof camera); /* copies are compared byte by byte */
    camera.delay = delay;
    camera.level = ABSTRACT_USUAL_LEVEL;
    camera.saturation = saturation;
    for (int i = 0; i < ABSTRACT_MOST_DELAY; i++) {
        camera.written[i][0] = exposure_s;
        camera.written[i][1] = gain;
    }
    memcpy(camera.in_force, camera.written[0], sizeof camera.in_force);
    return camera;
}

void abstract_camera_set_faults(abstract_camera *camera, uint32_t faults)
{
    const uint32_t begun = faults & ~camera->faults;
    for (int c = 0; c < 2; c++) {
        const uint32_t dead = c ? ABSTRACT_GAIN_DEAD : ABSTRACT_EXPOSURE_DEAD;
        if (begun & dead || !(faults & dead))
            camera->dead[c] = faults & dead ? camera->in_force[c] : 0.0;
        if (begun & ABSTRACT_INFO_CONSTANT || !(faults & ABSTRACT_INFO_CONSTANT))
            camera->constant[c] = faults & ABSTRACT_INFO_CONSTANT ? camera->in_force[c] : 0.0;
    }
    camera->faults = faults;
}

/* What a sample of one code adds to the statistics, in all frames. */
typedef struct code_row {
    double log2;
    uint16_t bin, peak_bin;
} code_row;

static const code_row *code_rows(void)
{
    static code_row rows[TOP + 1];
    if (rows[0].bin)
        return rows;
    for (int code = 0; code <= TOP; code++) {
        const double light = fmax((double)code / TOP, FLOOR);
        int stop;
        const double part = 2.0 * frexp(light, &stop) - 1.0; /* 0..1 within its stop */
        stop -= 1 + PUPIL_HISTOGRAM_MIN_EV;
        rows[code].log2 = log2(light);
        rows[code].bin = (uint16_t)(PUPIL_HISTOGRAM_BINS_PER_STOP * stop + (int)(PUPIL_HISTOGRAM_BINS_PER_STOP * part));
        rows[code].peak_bin = (uint16_t)(PUPIL_PEAK_BINS_PER_STOP * stop + (int)(PUPIL_PEAK_BINS_PER_STOP * part));
    }
    return rows;
}

static const pupil_stats *stats_of(const int codes[SAMPLES])
{
    static pupil_stats stats;
    const code_row *rows = code_rows();
    double sum = 0.0;
    int most = 0;
    pupil_stats_clear(&stats);
    stats.pixels = stats.weight = PIXELS;
    stats.rows = stats.frame_height = PUPIL_BANDS;
    stats.has_histogram = 1;
    for (int i = 0; i < SAMPLES; i++) {
        const code_row *row = &rows[codes[i]];
        stats.bin[row->bin] += PUPIL_BANDS;
        stats.peak_bin[row->peak_bin] += PUPIL_BANDS;
        stats.black += codes[i] == 0 ? PUPIL_BANDS : 0;
        stats.clipped += codes[i] == TOP ? PUPIL_BANDS : 0;
        most = codes[i] > most ? codes[i] : most;
        sum += row->log2;
    }
    stats.peak = (float)fmax((double)most / TOP, FLOOR);
    const double whole = floor(PUPIL_BANDS * sum);
    stats.log2_sum = (int64_t)whole;
    stats.log2_frac = (uint64_t)((PUPIL_BANDS * sum - whole) * 0x1p40);
    for (int band = 0; band < PUPIL_BANDS; band++) { /* each has every sample */
        stats.band_log2_sum[band] = (int64_t)(sum * 0x1p24);
        stats.band_pixels[band] = SAMPLES;
    }
    return &stats;
}

static int code_of(const abstract_camera *camera, abstract_frame fault, double value)
{
    if (fault == ABSTRACT_FRAME_WHITE || value >= camera->saturation)
        value = camera->saturation;
    if (fault == ABSTRACT_FRAME_BLACK || value < 0.0)
        value = 0.0;
    const double code = TOP * value + 0.5;
    return (int)(code < TOP ? code : TOP);
}

int abstract_camera_frame(abstract_camera *camera, abstract_frame fault, const pupil_stats **stats,
                          pupil_frame_info *info)
{
    const double *asked = camera->written[camera->delay - 1];
    static double scene[SAMPLES];
    int codes[SAMPLES];
    for (int i = 0; i < SAMPLES && scene[SAMPLES - 1] == 0.0; i++)
        scene[i] = exp2(SPREAD_EV * (2.0 * i / (SAMPLES - 1) - 1.0));
    camera->in_force[0] = camera->faults & ABSTRACT_EXPOSURE_DEAD ? camera->dead[0] : asked[0];
    camera->in_force[1] = camera->faults & ABSTRACT_GAIN_DEAD ? camera->dead[1] : asked[1];
    if (camera->faults & ABSTRACT_OWN_AUTO)
        memcpy(camera->in_force, own_auto, sizeof own_auto);
    camera->frame++;
    if (fault == ABSTRACT_FRAME_LOST)
        return 0;
    const double light = KEY * exp2(abstract_camera_off_ev(camera)), noise = NOISE * camera->in_force[1];
    for (int i = 0; i < SAMPLES; i++)
        codes[i] = code_of(camera, fault, light * scene[i] + noise * noise_of[i]);
    *stats = stats_of(codes);
    memset(info, 0, sizeof *info);
    info->sequence = camera->frame;
    info->timestamp_ns = 1000000000 + (int64_t)(camera->frame * (FRAME_S * 1e9));
    const double *told = camera->faults & ABSTRACT_INFO_CONSTANT ? camera->constant
                         : camera->faults & ABSTRACT_INFO_ASKED  ? camera->written[0]
                                                                 : camera->in_force;
    info->exposure_s = camera->faults & ABSTRACT_INFO_MISSING ? 0.0 : told[0];
    info->gain = camera->faults & ABSTRACT_INFO_MISSING ? 0.0 : told[1];
    return 1;
}

void abstract_camera_write(abstract_camera *camera, double exposure_s, double gain)
{
    memmove(camera->written[1], camera->written[0], (ABSTRACT_MOST_DELAY - 1) * sizeof camera->written[0]);
    camera->written[0][0] = exposure_s;
    camera->written[0][1] = gain;
}

static int is_multiple(double x, double step, double least, double most)
{
    const double n = x / step;
    return fabs(n - floor(n + 0.5)) < 1e-6 && x > least * (1.0 - 1e-9) && x < most * (1.0 + 1e-9);
}

int abstract_camera_has(const pupil_sensor_config *config, double exposure_s, double gain)
{
    return is_multiple(exposure_s, LINE_S, LINE_S, config->exposure_max_s) && is_multiple(gain, STEP, 1.0, 16.0);
}

double abstract_camera_off_ev(const abstract_camera *camera)
{
    return abstract_light_ev[camera->level] + log2(camera->in_force[0] * camera->in_force[1] / ABSTRACT_REST_S);
}

static void look_at(abstract_reach *reach, double off_ev)
{
    if (off_ev >= 0.0 && !(off_ev >= reach->above_ev))
        reach->above_ev = off_ev;
    if (off_ev <= 0.0 && !(off_ev <= reach->below_ev))
        reach->below_ev = off_ev;
}

abstract_reach abstract_camera_reach(const abstract_camera *camera, const pupil_sensor_config *config)
{
    const double right_s = ABSTRACT_REST_S * exp2(-abstract_light_ev[camera->level]);
    const int most = (int)(config->exposure_max_s / LINE_S + 1e-6);
    abstract_reach reach = {NAN, NAN};
    for (int n = 16; n <= 256; n++) {
        const double gain = camera->faults & ABSTRACT_GAIN_DEAD ? camera->dead[1] : n * STEP;
        if (camera->faults & ABSTRACT_EXPOSURE_DEAD) {
            look_at(&reach, log2(camera->dead[0] * gain / right_s));
        } else {
            /* more lines are never darker, so only the last one below the key and the first one above it count */
            const int lines = (int)fmin(fmax(floor(right_s / gain / LINE_S), 1.0), most);
            look_at(&reach, log2(lines * LINE_S * gain / right_s));
            if (lines < most)
                look_at(&reach, log2((lines + 1) * LINE_S * gain / right_s));
        }
    }
    return reach;
}
