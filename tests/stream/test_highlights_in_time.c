/* Highlights over time: a lamp is switched on and off, and the camera pans across a window. The level takes only the
 * law's steps, the same at any frame rate, and the constraint adds no step. */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>

#define SECOND    INT64_C(1000000000)
#define WIDTH     1200
#define ROOM_EV   (-5.0)
#define BRIGHT_EV 3.0 /* 8 stops above the room: 4 too many, and 2 are held */
#define TAU_LIGHT 0.3
#define TAU_DARK  0.9
#define LENGTH_S  6
#define AT_S      6 /* so many moments a second at which all rates have a frame */

static const int rates[] = {24, 30, 60, 240};

/* The share of a column that is bright at a moment. */
typedef double scene(double time_s, int column);

/* A lamp on a sixth of the frame, on after 1 s, off after 3 s: at any rate, in the first frame after that. */
static double lamp(double time_s, int column)
{
    return time_s > 1.000001 && time_s < 3.000001 && column < WIDTH / 6;
}

/* A window of 40 % of the frame's width comes in from the right at 1 s, and has left on the left at 4.5 s. */
static double window(double time_s, int column)
{
    const double left = WIDTH * (1.0 - 0.4 * (time_s - 1.0)), right = left + 0.4 * WIDTH;
    return fmax(0.0, fmin(column + 1.0, right) - fmax(column, left));
}

typedef struct run {
    double level[LENGTH_S * AT_S + 1]; /* at the moments of all rates */
    double most, held_most, held; /* largest step, EV; largest step of the held part of the target; the most held */
    double most_rate;             /* EV a second */
} run;

static run play(scene *light, int fps, double highlight_ev)
{
    run r = {.most = 0.0};
    pupil_t pupil;
    pupil_config config;
    double before = 0.0, held_before = 0.0;
    static float rgb[WIDTH * 3];
    const pupil_image_const in = {
        .data = rgb, .stride_bytes = sizeof rgb, .width = WIDTH, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_config_default(&config);
    config.highlight_ev = highlight_ev;
    config.flicker = 0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n <= LENGTH_S * fps; n++) {
        const pupil_frame_info info = {.timestamp_ns = SECOND + n * SECOND / fps};
        pupil_exposure e = {0};
        for (int i = 0; i < 3 * WIDTH; i++) {
            const double share = light((double)n / fps, i / 3);
            rgb[i] = (float)(exp2(ROOM_EV) + share * (exp2(BRIGHT_EV) - exp2(ROOM_EV)));
        }
        CHECK(pupil_meter(&pupil, &in, &info) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
        const double target = e.metered_ev + e.held_back_ev, step = e.adapted_ev - before;
        if (n) {
            const double share = 1.0 - exp(-e.dt_s / (target > before ? TAU_LIGHT : TAU_DARK));
            CHECK_MSG(fabs(step - share * (target - before)) < 1e-9, "%d fps, frame %d: a step of %g", fps, n, step);
            r.most = fmax(r.most, fabs(step));
            r.most_rate = fmax(r.most_rate, fabs(step) / e.dt_s);
            r.held_most = fmax(r.held_most, fabs(e.held_back_ev - held_before));
        }
        r.held = fmax(r.held, e.held_back_ev);
        before = e.adapted_ev;
        held_before = e.held_back_ev;
        if (n % (fps / AT_S) == 0)
            r.level[n / (fps / AT_S)] = e.adapted_ev;
    }
    return r;
}

/* `jumps`: the light jumps, so the held part of the target may, too; else it changes little in each frame. */
static void check(const char *name, scene *light, int jumps)
{
    run first = {.most = 0.0};
    for (int i = 0; i < 4; i++) {
        const run with = play(light, rates[i], 2.0), without = play(light, rates[i], 0.0);
        const double share = 1.0 - exp(-1.0 / (rates[i] * TAU_LIGHT));
        double apart = 0.0;
        if (i == 0)
            first = with;
        for (int k = 0; k <= LENGTH_S * AT_S; k++)
            apart = fmax(apart, fabs(with.level[k] - first.level[k]));
        printf("%s, %3d fps: largest step %.4f EV, without highlights %.4f; held up to %.2f EV, which changes by up to "
               "%.3f a frame; %.4f EV from 24 fps\n",
               name, rates[i], with.most, without.most, with.held, with.held_most, apart);
        CHECK(with.held == 2.0 && without.held == 0.0);
        CHECK_MSG(with.most <= without.most + 2.0 * share + 1e-9, "a step of %g, without highlights %g", with.most,
                  without.most);
        CHECK_MSG(jumps ? apart < 1e-6 : apart <= first.most_rate / 24.0, "%d fps: %g EV from 24 fps", rates[i], apart);
        /* 2 stops while 4 % of the width come in, at 40 % a second; and a bin's edge, as in stream.highlights
         */
        CHECK_MSG(jumps || with.held_most <= 20.0 / rates[i] + 0.17, "%g a frame", with.held_most);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check("lamp on and off", lamp, 1);
    check("pan across a window", window, 0);
    return check_end();
}
