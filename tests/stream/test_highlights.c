/* How much highlights hold the level back, and that no light makes the level jump. */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>

#define SECOND INT64_C(1000000000)
#define SIDE   100

static float frame[SIDE * SIDE];

static void start(pupil_t *pupil, double highlight_ev, uint32_t white_mode)
{
    pupil_config config;
    pupil_config_default(&config);
    config.highlight_ev = highlight_ev;
    config.white_mode = white_mode;
    config.flicker = 0;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

/* A frame of `dark_ev` with a lamp of `lamp_ev` on so many of its 10,000 pixels. */
static pupil_exposure look(pupil_t *pupil, double dark_ev, double lamp_ev, int lamp_pixels, int64_t timestamp_ns)
{
    static float rgb[SIDE * SIDE * 3];
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    pupil_exposure e = {0};
    pupil_stats stats;
    pupil_stats_clear(&stats);
    for (int i = 0; i < SIDE * SIDE; i++)
        frame[i] = (float)exp2(i < lamp_pixels ? lamp_ev : dark_ev);
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        rgb[i] = frame[i / 3];
    const pupil_image_const in = {
        .data = rgb, .stride_bytes = SIDE * 12, .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGB32F};
    CHECK(pupil_meter_rows(pupil, &in, 0, SIDE, &stats) == PUPIL_OK);
    CHECK(pupil_adapt(pupil, &stats, &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(pupil, &e) == PUPIL_OK);
    return e;
}

static pupil_exposure first(double highlight_ev, double dark_ev, double lamp_ev, int lamp_pixels)
{
    pupil_t pupil;
    start(&pupil, highlight_ev, PUPIL_WHITE_FOLLOW);
    return look(&pupil, dark_ev, lamp_ev, lamp_pixels, SECOND);
}

/* For a lamp on at least 8 % of the frame: how far it is over 4 stops above the log-average, within a bin, an eighth of
 * a stop. */
static void check_amount(void)
{
    for (double above = 3.0; above < 9.0; above += 0.25) {
        const pupil_exposure e = first(2.0, -5.0, -5.0 + above, 1000);
        const double mean = -5.0 + 0.1 * above, missing = fmin(fmax(0.9 * above - 4.0, 0.0), 2.0);
        CHECK_MSG(fabs(e.metered_ev - mean) < 1e-6 && fabs(e.held_back_ev - missing) < 0.17,
                  "a lamp %g stops above: held back %g, and %g is missing", above, e.held_back_ev, missing);
        CHECK(fabs(e.adapted_ev - e.metered_ev - e.held_back_ev) < 1e-12 && e.state == PUPIL_STATE_SETTLED);
        CHECK(e.reason == (e.held_back_ev > 0.05 ? PUPIL_REASON_HIGHLIGHTS : PUPIL_REASON_NONE));
    }
    CHECK(first(8.0, -5.0, 15.0, 1000).held_back_ev == 8.0 && first(0.0, -5.0, 15.0, 1000).held_back_ev == 0.0);
    CHECK(first(2.0, -5.0, 5.0, 400).held_back_ev == 0.0); /* 4 % of the frame are ignored */
}

/* For a window of 1 to 4 % of the frame: how far it is over 10.275 stops above the log-average, where the curve reaches
 * white. The brightest 0.5 % are ignored. */
static void check_white(void)
{
    for (double above = 9.0; above < 16.0; above += 0.25) {
        const pupil_exposure e = first(2.0, -5.0, -5.0 + above, 200);
        const double missing = fmin(fmax(0.98 * above - 10.275, 0.0), 2.0);
        CHECK_MSG(fabs(e.held_back_ev - missing) < 0.17, "a window %g stops above: held back %g, and %g is missing",
                  above, e.held_back_ev, missing);
        CHECK(first(2.0, -5.0, -5.0 + above, 50).held_back_ev == 0.0);
    }
    double before = 0.0;
    for (int pixels = 40; pixels <= 110; pixels++) {
        const double held = first(2.0, -5.0, 15.0, pixels).held_back_ev;
        CHECK(held >= before && held <= before + 2.0 / 50 + 1e-9);
        before = held;
    }
    CHECK(before == 2.0);
}

/* The same light at any scale is held back by the same amount. */
static void check_scale(void)
{
    const double usual = first(2.0, -5.0, -0.1, 700).held_back_ev;
    CHECK_MSG(usual > 0.2 && usual < 1.8, "held back %g", usual);
    for (int shift = -8; shift <= 20; shift++)
        CHECK(fabs(first(2.0, -5.0 + shift, -0.1 + shift, 700).held_back_ev - usual) < 1e-9);
}

/* One more pixel of lamp, or a hundredth of a stop: the target never jumps. A pixel in 10,000 is a 400th of the way
 * from 0.8 to 1.6 shares of 5 %, and the whole way is two stops; a lamp may pass a bin's edge, an eighth of a stop.
 */
static void check_no_jump(void)
{
    double before = 0.0, most = 0.0;
    for (int pixels = 0; pixels <= 1000; pixels++) {
        const double held = first(2.0, -5.0, 3.0, pixels).held_back_ev;
        most = fmax(most, fabs(held - before));
        CHECK(held >= before); /* and it only grows */
        before = held;
    }
    CHECK_MSG(before == 2.0 && most <= 2.0 / 400 + 1e-9, "a pixel more: up to %g stops", most);
    double worst = 0.0;
    before = 0.0;
    for (double lamp = -5.0; lamp < 5.0; lamp += 0.01) {
        const double held = first(2.0, -5.0, lamp, 700).held_back_ev;
        worst = fmax(worst, fabs(held - before));
        before = held;
    }
    printf("highlights: a pixel of 10,000 more moves the target by up to %.4f stops, 0.01 stops of light by %.3f\n",
           most, worst);
    CHECK(worst <= 0.17);
}

/* A lamp is switched on, and off: the level moves by its law to the new target, the same at any frame rate. */
static void check_in_time(void)
{
    static const int rates[] = {24, 30, 60, 240};
    double half[4];
    for (int r = 0; r < 4; r++) {
        const int fps = rates[r];
        pupil_t pupil;
        start(&pupil, 2.0, PUPIL_WHITE_FOLLOW);
        look(&pupil, -5.0, -5.0, 0, SECOND);
        double before = -5.0, most = 0.0;
        for (int n = 1; n <= fps; n++) {
            const pupil_exposure e = look(&pupil, -5.0, 3.0, 1000, SECOND + n * SECOND / fps);
            const double target = e.metered_ev + e.held_back_ev, share = 1.0 - exp(-e.dt_s / 0.3);
            CHECK_MSG(fabs(e.adapted_ev - before - share * (target - before)) < 1e-9, "%d fps, frame %d: %g", fps, n,
                      e.adapted_ev);
            most = fmax(most, e.adapted_ev - before);
            before = e.adapted_ev;
            if (n == fps / 2)
                half[r] = e.adapted_ev;
        }
        for (int n = 1; n <= 4 * fps; n++) {
            const pupil_exposure e = look(&pupil, -5.0, -5.0, 0, 2 * SECOND + n * SECOND / fps);
            const double share = 1.0 - exp(-e.dt_s / 0.9);
            CHECK(fabs(e.adapted_ev - before - share * (-5.0 - before)) < 1e-9 && e.held_back_ev == 0.0);
            before = e.adapted_ev;
        }
        CHECK_MSG(fabs(half[r] - half[0]) < 1e-6, "after half a second at %d fps %g, at 24 %g", fps, half[r], half[0]);
    }
}

/* Without a histogram, with a lock, and at the limits of the level. */
static void check_reasons(void)
{
    pupil_t pupil;
    pupil_config config;
    start(&pupil, 2.0, PUPIL_WHITE_NONE);
    pupil_exposure e = look(&pupil, -5.0, 3.0, 1000, SECOND);
    CHECK(e.held_back_ev == 0.0 && e.reason == PUPIL_REASON_NO_HISTOGRAM && e.state == PUPIL_STATE_SETTLED);
    start(&pupil, 0.0, PUPIL_WHITE_NONE);
    CHECK(look(&pupil, -5.0, 3.0, 1000, SECOND).reason == PUPIL_REASON_NONE);

    pupil_config_default(&config);
    config.ev_max = -4.0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    e = look(&pupil, -5.0, 3.0, 1000, SECOND);
    CHECK(e.adapted_ev == -4.0 && e.reason == PUPIL_REASON_EV_MAX && e.held_back_ev == 2.0);
    config.ev_max = 32.0;
    config.lock = 1;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    e = look(&pupil, -5.0, 3.0, 1000, 2 * SECOND);
    CHECK(e.adapted_ev == -4.0 && e.reason == PUPIL_REASON_LOCK);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_amount();
    check_white();
    check_scale();
    check_no_jump();
    check_in_time();
    check_reasons();
    return check_end();
}
