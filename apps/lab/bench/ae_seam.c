/* Whether a step of the sensor's setting can be seen. */
#include <math.h>
#include <stdlib.h>

#include "ae.h"
#include "lab/sim/sim.h"
#include "pupil/pupil.h"
#include "refuse.h"

#define SEAM_EV 0.005

enum { FRAMES = 1400, FIRST = 90 };

/* The level of each picture as shown, and what measures it. */
typedef struct mapped {
    pupil_t mapper;
    double linear_log2[256]; /* of the display's codes */
    unsigned char *rgba;
    double level[FRAMES];
    int failed;
} mapped;

/* How much more the level moves on a frame with a new sensor setting than on its neighbours. */
static double seam_of(const fixture_loop_frame *f, const double *level)
{
    double squares = 0.0, count = 0.0;
    for (size_t i = FIRST; i + 1 < FRAMES; i++) {
        if (f[i].truth.exposure_s == f[i - 1].truth.exposure_s && f[i].truth.gain == f[i - 1].truth.gain)
            continue;
        const double here = level[i] - level[i - 1];
        const double beside = 0.5 * (level[i + 1] - level[i] + level[i - 1] - level[i - 2]);
        squares += (here - beside) * (here - beside);
        count += 1.0;
    }
    return count > 0.0 ? sqrt(squares / count) : 0.0;
}

static void see_level(void *context, size_t index, const pupil_image_const *image, const fixture_loop_frame *frame)
{
    mapped *m = context;
    (void)image;
    m->level[index] = frame->shown_ev;
}

/* Mapped for a display; black counts as half a code. */
static void see_picture(void *context, size_t index, const pupil_image_const *image, const fixture_loop_frame *frame)
{
    mapped *m = context;
    const double digital = frame->setting.frame_digital > 0.0 ? frame->setting.frame_digital : frame->truth.digital;
    const pupil_curve curve = {.scale = (float)digital};
    const pupil_image out = {.data = m->rgba,
                             .stride_bytes = (ptrdiff_t)image->width * 4,
                             .width = image->width,
                             .height = image->height,
                             .pixel = PUPIL_PIXEL_RGBA8};
    const size_t pixels = (size_t)image->width * image->height;
    double sum = 0.0;
    m->failed |= pupil_map_rows(&m->mapper, &curve, image, &out) != PUPIL_OK;
    for (size_t i = 0; i < pixels; i++)
        sum += m->linear_log2[m->rgba[4 * i]];
    m->level[index] = sum / (double)pixels;
}

static int begin(mapped *m, size_t pixels)
{
    pupil_config config;
    pupil_config_default(&config);
    for (int code = 0; code < 256; code++) { /* IEC 61966-2-1 */
        const double v = (code ? code : 0.5) / 255.0;
        m->linear_log2[code] = log2(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
    }
    m->rgba = malloc(4 * pixels);
    return m->rgba ? pupil_init(&m->mapper, &config) : -1;
}

/* Light that changes so slowly that far_ev is never reached, through many settings; all pairs of delays of the two
 * controls. */
static int pairs(bench_ae *b, const fixture_controller *law, mapped *m, const float *room)
{
    static const fixture_gain_law gains[] = {FIXTURE_GAIN_RECIPROCAL, FIXTURE_GAIN_THIRD};
    fixture_loop loop;
    for (size_t g = 0; g < sizeof gains / sizeof gains[0]; g++) {
        for (uint32_t pair = 0; pair < 16; pair += room ? 3 : 1) { /* the room: 1/1 1/4 2/3 3/2 4/1 4/4 */
            bench_ae_begin(&loop, law, 1 + pair / 4, gains[g]);
            const uint32_t believed = loop.sensor.delay_frames;
            loop.plant.delay[FIXTURE_GAIN] = 1 + pair % 4;
            loop.plant.light_ev = 3.0; /* 2^-5.5 s are right, at the end 2^-2.8: first exposures, then gains */
            loop.plant.luminance = room;
            fixture_loop_fit(&loop);
            if (!law->total)
                loop.sensor.delay_frames = believed;
            loop.see = room ? see_picture : see_level;
            loop.context = m;
            if (bench_ae_loop(b, &loop, FRAMES, "2s ramp -0.06ev/s 45s"))
                return -1;
            bench_ae_show(b, &loop, "seam", room ? "the room, mapped" : "", NAN, seam_of(b->frame, m->level), SEAM_EV);
        }
    }
    return 0;
}

int bench_ae_seam(bench_ae *b, const fixture_controller *law)
{
    fixture_plant_config usual;
    mapped *m = calloc(1, sizeof *m);
    float *room = NULL;
    fixture_plant_default(&usual);
    int failed = !m || begin(m, (size_t)usual.width * usual.height);
    if (failed)
        pupil_refuse(&b->why, "not enough memory");
    failed = failed || sim_luminance("room", usual.width, usual.height, &room, &b->why) || pairs(b, law, m, NULL) ||
             pairs(b, law, m, room);
    if (!failed && m->failed) {
        pupil_refuse(&b->why, "a picture of the simulated camera cannot be mapped");
        failed = 1;
    }
    free(room);
    if (m)
        free(m->rgba);
    free(m);
    return failed ? -1 : 0;
}
