/* own_camera: exposure control of a camera without V4L2.
 *     cc own_camera.c $(pkg-config --cflags --libs pupil) -lm -o own_camera
 * The sensor is a toy: 12 bits, exposures in lines, gains n/16, in force two frames after they are written, which is a
 * delay of 3 as sensor.h counts. Settings are written in each frame; a real sensor needs it if setting.changed. */
#include <math.h>
#include <pupil/pupil.h>
#include <pupil/sensor.h>
#include <stdio.h>

enum { WIDTH = 64, HEIGHT = 48, DELAY = 2, FRAMES = 120 };
static const double line_s = 20e-6;
static long lines[FRAMES + DELAY], gain_code[FRAMES + DELAY]; /* registers, for each frame that they apply to */
static uint16_t pixels[WIDTH * HEIGHT];

static void read_frame(int i)
{
    const double light = i < FRAMES / 2 ? 400.0 : 3.0; /* multiples of full range, in 1 s at gain 1 */
    const double exposed = light * (double)lines[i] * line_s * (double)gain_code[i] / 16.0;
    for (int x = 0; x < WIDTH * HEIGHT; x++) /* columns from 1/4 to 4 times `exposed` */
        pixels[x] = (uint16_t)lround(fmin(4095.0 * exposed * exp2(4.0 * (x % WIDTH) / WIDTH - 2.0), 4095.0));
}

int main(void)
{
    const pupil_image_const image = pupil_image_const_of(pixels, WIDTH, HEIGHT, PUPIL_PIXEL_GREY12);
    pupil_t pupil;
    pupil_config metering;
    pupil_stats stats;
    pupil_sensor sensor;
    pupil_sensor_config config;
    pupil_sensor_setting setting;
    pupil_config_default(&metering);
    metering.histogram = 1; /* without it the sensor does not see highlights */
    pupil_sensor_config_default(&config);
    config.exposure_min_s = config.exposure_step_s = line_s;
    config.gain_law = PUPIL_GAIN_LINEAR; /* n * gain_step up to gain_max */
    if (pupil_init(&pupil, &metering) || pupil_sensor_init(&sensor, &config))
        return 2;
    for (int i = 0; i < FRAMES; i++) {
        pupil_sensor_get(&sensor, &setting);
        for (int j = i ? i + DELAY : 0; j <= i + DELAY; j++) { /* write; the first one is in force at once */
            lines[j] = lround(setting.exposure_s / line_s);
            gain_code[j] = lround(setting.gain * 16.0);
        }
        read_frame(i);
        pupil_frame_info info = {sizeof info, 0, INT64_C(33333333) * (i + 1), (uint64_t)i + 1, 0.0, 0.0};
        info.exposure_s = (double)lines[i] * line_s; /* of this frame, not what is requested now */
        info.gain = (double)gain_code[i] / 16.0;
        pupil_stats_clear(&stats);
        if (pupil_meter_rows(&pupil, &image, 0, HEIGHT, &stats) || pupil_sensor_frame(&sensor, &stats, &info))
            return 2;
    }
    double mean_log2 = 0.0;
    pupil_sensor_get(&sensor, &setting); /* frame_digital is the last frame's */
    pupil_stats_mean(&stats, 0.0, 1.0, &mean_log2);
    const double error_ev = mean_log2 + log2(setting.frame_digital) - log2(config.key);
    printf("%.3f ms, gain %.3f: %+.3f EV from the key\n", 1e3 * setting.exposure_s, setting.gain, error_ev);
    return fabs(error_ev) >= 0.1; /* 1: the picture misses the key */
}
