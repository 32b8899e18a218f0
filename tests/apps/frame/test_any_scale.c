/* Light in any unit: the same picture from 1e-8 to 1e8, levels in the frame's own units, ordinary light unchanged, and
 * noise dark.
 */
#include "frame/any_scale.h"

#include <math.h>
#include <string.h>

#include "check.h"
#include "frame/pipeline.h"

enum { WIDTH = 240, HEIGHT = 135 };

static float scene[HEIGHT][WIDTH][4], light[HEIGHT][WIDTH][4];

/* A room of 12 stops with a window, and a lamp 6 stops brighter: log-average near 2^-4. */
static void make_scene(void)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double ev = -4.0 + 3.0 * sin(0.05 * x) * sin(0.07 * y) + 2.0 * check_uniform() - 1.0;
            const double more = x > 180 && y < 60 ? 6.0 : hypot(x - 60, y - 40) < 4.0 ? 12.0 : 0.0;
            for (int c = 0; c < 3; c++)
                scene[y][x][c] = (float)exp2(ev + more + 0.2 * c);
            scene[y][x][3] = 1.0f;
        }
}

static pupil_frame frame_at(double scale)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 4; c++)
                light[y][x][c] = c == 3 ? 1.0f : (float)((double)scene[y][x][c] * scale);
    return (pupil_frame){.image = {.data = light,
                                   .stride_bytes = sizeof light[0],
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .pixel = PUPIL_PIXEL_RGBA32F},
                         .info = {.timestamp_ns = 1},
                         .name = "made"};
}

/* Maps the frame; its picture is in p->display until the pipeline is closed. floor: 0: the default. */
static pupil_exposure map(frame_pipeline *p, any_scale *a, pupil_frame *frame, float floor)
{
    pupil_why why = {""};
    pupil_config config;
    pupil_exposure e = {0};
    pupil_config_default(&config);
    config.floor = floor > 0.0f ? floor : config.floor;
    CHECK(any_scale_take(a, frame, &why) == 0);
    CHECK(frame_pipeline_open(p, &config, 1) == 0);
    CHECK(frame_pipeline_meter(p, frame, &why) == 0 && frame_pipeline_map(p, frame, 1, &why) == 0);
    CHECK(pupil_get_exposure(&p->pupil, &e) == PUPIL_OK);
    return e;
}

static void check_pictures(void)
{
    static uint8_t usual[HEIGHT * WIDTH * 3];
    static const double scales[] = {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8,   0x1p-24, 0x1p-40,
                                    1e1, 1e2,  1e4,  1e5,  1e6,  1e8,  0x1p20, 0x1p27};
    double usual_ev = 0.0;
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        frame_pipeline p;
        any_scale a = {0};
        pupil_frame frame = frame_at(scales[i]);
        const pupil_exposure e = map(&p, &a, &frame, 0.0f);
        const uint8_t *codes = p.display.data;
        int most = 0;
        size_t differ = 0;
        if (i == 0) {
            memcpy(usual, codes, sizeof usual);
            usual_ev = e.adapted_ev;
            CHECK(a.stops == 0);
        }
        for (size_t k = 0; k < sizeof usual; k++) {
            const int off = abs(codes[k] - usual[k]);
            most = off > most ? off : most;
            differ += off > 0;
        }
        const double off_ev = e.adapted_ev - usual_ev - log2(scales[i]);
        printf("light x %-8g times 2^%-3d  level %+.5f EV off, %.3f %% of the codes off, at most %d\n", scales[i],
               a.stops, off_ev, 100.0 * (double)differ / sizeof usual, most);
        const int beyond = usual_ev + log2(scales[i]) < -32.0;
        /* times 0.01, which is not scaled, the darkest pixels are at the floor, and no longer count */
        const int at_floor = !a.stops && scales[i] < 0.05;
        CHECK_MSG(beyond ? e.reason == PUPIL_REASON_EV_MIN : most <= 1 && (at_floor || fabs(off_ev) < 2e-3), "x %g",
                  scales[i]);
        frame_pipeline_close(&p);
        any_scale_close(&a);
    }
}

/* Light that is not scaled, and a floor as much lower: all pixels count. */
static void check_low_floor(void)
{
    double level_ev[2];
    for (int i = 0; i < 2; i++) {
        frame_pipeline p;
        any_scale a = {0};
        pupil_frame frame = frame_at(i ? 0x1p-6 : 1.0);
        level_ev[i] = map(&p, &a, &frame, i ? 0x1p-20f : 0x1p-14f).adapted_ev;
        CHECK(!a.stops);
        frame_pipeline_close(&p);
        any_scale_close(&a);
    }
    CHECK_MSG(fabs(level_ev[0] - 6.0 - level_ev[1]) < 1e-9, "%.12f and %.12f", level_ev[0], level_ev[1]);
}

/* Ordinary light, codes and halves are not scaled or copied; nor is alpha scaled. */
static void check_left_alone(void)
{
    any_scale a = {0};
    pupil_why why = {""};
    pupil_frame frame = frame_at(1.0);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == light && a.known && !a.stops);
    CHECK(frame.info.gain == 0.0 && frame.info.exposure_s == 0.0);
    frame = frame_at(1e-6); /* of the same source: the scale stays that of its first frame */
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == light);
    any_scale_forget(&a);
    frame.image.pixel = PUPIL_PIXEL_RGBA16F;
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == light && !a.known);
    frame = frame_at(1e-6);
    frame.info.exposure_s = 0.5;
    frame.info.gain = 3.0;
    light[7][9][3] = 0.25f;
    light[7][9][0] = NAN;
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == a.memory && a.stops > 10);
    CHECK(frame.info.exposure_s == 0.5 && frame.info.gain == ldexp(3.0, a.stops));
    const float *pixel = a.memory + (size_t)4 * (7 * WIDTH + 9);
    CHECK(isnan(pixel[0]) && pixel[1] == ldexpf(light[7][9][1], a.stops) && pixel[3] == 0.25f);
    any_scale_close(&a);
}

/* Decoded codes have no unit, however dark they are; among scaled frames they have a gain of 1. */
static void check_codes(void)
{
    any_scale a = {0};
    pupil_why why = {""};
    pupil_frame frame = frame_at(1e-6);
    frame.code_light = 0x1p-12f;
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == light && !a.known && frame.info.gain == 0.0);
    frame = frame_at(1e-6);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && a.known && a.stops > 0);
    const int stops = a.stops;
    frame = frame_at(1.0);
    frame.code_light = 0x1p-12f;
    CHECK(any_scale_take(&a, &frame, &why) == 0 && frame.image.data == light && !a.stops);
    CHECK(frame.info.exposure_s == 1.0 && frame.info.gain == 1.0);
    frame = frame_at(0.0);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && a.stops == stops && frame.info.gain == ldexp(1.0, stops));
    any_scale_close(&a);
}

/* Frames without light set no scale; the first one with light does. */
static void check_black(void)
{
    any_scale a = {0};
    pupil_why why = {""};
    pupil_frame frame = frame_at(0.0);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && !a.known && frame.image.data == light);
    frame = frame_at(1e-5);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && a.known && a.stops > 0);
    const int stops = a.stops;
    frame = frame_at(0.0);
    CHECK(any_scale_take(&a, &frame, &why) == 0 && a.stops == stops && frame.image.data == a.memory);
    any_scale_close(&a);
}

/* Normal, as a sum of twelve uniform numbers. */
static double normal(void)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += check_uniform();
    return sum;
}

/* Behind a lens cap: noise around 0, or clamped at 0, and one hot pixel in a thousand. */
static pupil_frame lens_cap(double sigma, int cut, int grey)
{
    pupil_frame frame = frame_at(1.0);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double hot = check_uniform() < 1e-3 ? 1000.0 : 0.0;
            for (int c = 0; c < 3; c++) {
                const double noise = grey && c ? light[y][x][0] : sigma * (hot + normal());
                light[y][x][c] = (float)(cut ? fmax(noise, 0.0) : noise);
            }
        }
    return frame;
}

/* Noise is dark, in any unit: its codes are those of 8-bit noise at the amplification limit, and the reason says that
 * the light is at the floor. */
static void check_noise(void)
{
    static const double sigmas[] = {1e-8, 1e-4, 1.0, 1e5};
    for (int i = 0; i < 12; i++) {
        const int cut = i / 4 == 1, grey = i / 4 == 2;
        frame_pipeline p;
        any_scale a = {0};
        pupil_frame frame = lens_cap(sigmas[i % 4], cut, grey);
        const pupil_exposure e = map(&p, &a, &frame, 0.0f);
        const uint8_t *codes = p.display.data;
        size_t count[256] = {0}, below = 0;
        for (size_t k = 0; k < (size_t)HEIGHT * WIDTH * 3; k++)
            count[codes[k]]++;
        int median = 0, most = 0; /* most: code below which 99 % are */
        for (int code = 0; code < 256; code++) {
            below += count[code];
            median += 2 * below < (size_t)HEIGHT * WIDTH * 3;
            most += (double)below < 0.99 * HEIGHT * WIDTH * 3;
        }
        printf("noise of %g%s%s: times 2^%d, codes of half %d, of 99 %% %d\n", sigmas[i % 4],
               cut ? ", cut off at 0" : "", grey ? ", grey" : "", a.stops, median, most);
        char text[200];
        any_scale_describe(&a, text, sizeof text);
        CHECK(median <= 1 && most <= 40 && e.reason == PUPIL_REASON_RANGE);
        CHECK(strstr(text, "noise") != NULL);
        frame_pipeline_close(&p);
        any_scale_close(&a);
    }
}

/* Light is not taken for noise: colours beyond the gamut, with a negative channel; a black frame around a picture; a
 * pure lamp.
 */
static void check_no_noise(void)
{
    any_scale a = {0};
    pupil_why why = {""};
    for (int kind = 0; kind < 3; kind++) {
        pupil_frame frame = frame_at(1.0);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                if (kind == 0)
                    light[y][x][x % 2] *= -0.1f;
                else if (kind == 1 && y > HEIGHT / 4)
                    memset(light[y][x], 0, 3 * sizeof(float));
                else if (kind == 2)
                    light[y][x][1] = light[y][x][2] = 0.0f;
            }
        CHECK(any_scale_take(&a, &frame, &why) == 0 && a.known && a.stops == 0 && frame.image.data == light);
        char text[200];
        any_scale_describe(&a, text, sizeof text);
        CHECK(!a.noise_frames && *text == 0);
        any_scale_forget(&a);
    }
}

/* The next frame of a source, with a law that adapts at once. */
/* Nor are areas of strong colours, each without one or two channels: bars, a chequerboard, and few pixels. */
static void check_colours(void)
{
    for (int i = 0; i < 4; i++) {
        const int size = i == 1 ? 40 : 12; /* pixels of an area */
        pupil_frame frame = frame_at(1.0);
        any_scale a = {0};
        pupil_why why = {""};
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const int colour = i == 2 ? (x / size + y / size) % 7 + 1 : x / size % 7 + 1;
                for (int c = 0; c < 3; c++)
                    light[y][x][c] = colour >> c & 1 ? 1.0f : i == 1 ? -0.1f : 0.0f;
            }
        if (i == 3) { /* 4x4 pixels of noise: too few to decide */
            frame = lens_cap(1.0, 0, 0);
            frame.image.width = frame.image.height = 4;
        }
        CHECK(any_scale_take(&a, &frame, &why) == 0);
        CHECK_MSG(!a.noise_frames && a.known, "colours %d are taken for noise", i);
        any_scale_close(&a);
    }
}

static pupil_exposure next(frame_pipeline *p, any_scale *a, pupil_frame frame)
{
    static int64_t now_ns;
    pupil_why why = {""};
    pupil_exposure e = {0};
    frame.info.timestamp_ns = now_ns += 1000000000;
    CHECK(any_scale_take(a, &frame, &why) == 0 && frame_pipeline_meter(p, &frame, &why) == 0);
    CHECK(pupil_get_exposure(&p->pupil, &e) == PUPIL_OK);
    return e;
}

/* A cap that comes and goes: noise is always dark, light keeps its own scale, and levels are in the file's units.
 */
static void check_cap_comes(void)
{
    static const double units[] = {1.0, 1e-6};
    for (int i = 0; i < 2; i++) {
        const double sigma = 1e-5 * units[i];
        any_scale a = {0};
        frame_pipeline p;
        pupil_config config;
        pupil_config_default(&config);
        config.tau_light_s = config.tau_dark_s = 0.0;
        CHECK(frame_pipeline_open(&p, &config, 1) == 0);
        const pupil_exposure lit = next(&p, &a, frame_at(units[i]));
        const int stops = a.stops;
        CHECK(i == 0 ? stops == 0 : stops > 0);
        const pupil_exposure dark = next(&p, &a, lens_cap(sigma, 0, 0));
        const double sigmas = exp2(dark.adapted_ev) / sigma;
        CHECK_MSG(sigmas > 31.0 && sigmas < 65.0 && dark.reason == PUPIL_REASON_RANGE, "a level of %g", sigmas);
        const pupil_exposure again = next(&p, &a, frame_at(units[i]));
        CHECK_MSG(a.stops == stops && fabs(again.adapted_ev - lit.adapted_ev) < 1e-9, "%.12f and then %.12f",
                  lit.adapted_ev, again.adapted_ev);
        next(&p, &a, lens_cap(1.5 * sigma, 0, 0)); /* the sensor's noise is known */
        CHECK(a.noise_frames == 2 && a.stops == a.noise_stops);
        frame_pipeline_close(&p);
        any_scale_close(&a);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    make_scene();
    check_pictures();
    check_low_floor();
    check_left_alone();
    check_codes();
    check_black();
    check_noise();
    check_cap_comes();
    check_no_noise();
    check_colours();
    return check_end();
}
