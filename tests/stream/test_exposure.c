/* The values of pupil_exposure and pupil_curve: key, compensation, limits, states and reasons, lock, a frame's own
 * exposure and gain divided out and multiplied back, and the following white point.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

static int64_t now;

static pupil_exposure adapt_stats(pupil_t *pupil, const pupil_stats *stats, double exposure_s, double gain)
{
    pupil_exposure e = {0};
    const pupil_frame_info info = {.timestamp_ns = now += 40000000, .exposure_s = exposure_s, .gain = gain};
    CHECK(pupil_adapt(pupil, stats, &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(pupil, &e) == PUPIL_OK);
    return e;
}

static pupil_exposure adapt(pupil_t *pupil, double ev, double exposure_s, double gain)
{
    pupil_stats stats;
    ref_stats_at(ev, 1, &stats);
    return adapt_stats(pupil, &stats, exposure_s, gain);
}

static pupil_curve curve_of(const pupil_t *pupil, double exposure_s, double gain)
{
    const pupil_frame_info info = {.timestamp_ns = now, .exposure_s = exposure_s, .gain = gain};
    pupil_curve curve = {0};
    CHECK(pupil_get_curve(pupil, exposure_s > 0 ? &info : NULL, &curve) == PUPIL_OK);
    return curve;
}

static void check_first(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_exposure e = {.frames = 9};
    pupil_curve curve = {.scale = 7, .inverse_white_squared = 8, .gamut = 9};
    pupil_stats stats, none;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK && e.state == PUPIL_STATE_EMPTY && e.frames == 0);
    CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_ERR_NO_EXPOSURE && curve.scale == 7);
    pupil_stats_clear(&none);
    CHECK(pupil_get_stats(&pupil, &stats) == PUPIL_OK && memcmp(&stats, &none, sizeof none) == 0);
    e = adapt(&pupil, 3.5, 0, 0);
    CHECK(e.state == PUPIL_STATE_SETTLED && e.reason == PUPIL_REASON_NONE && e.frames == 1);
    CHECK(e.metered_ev == 3.5 && e.adapted_ev == 3.5);
    CHECK(pupil_reset(&pupil) == PUPIL_OK);
    CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK && e.state == PUPIL_STATE_EMPTY && e.frames == 0);
    CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_ERR_NO_EXPOSURE);
}

static void check_scale(void)
{
    for (int i = 0; i < 300; i++) {
        pupil_config config;
        pupil_t pupil;
        pupil_config_default(&config);
        config.key = exp2(-10 * check_uniform());
        config.ev_compensation = 32 * check_uniform() - 16;
        config.calibration = exp2(20 * check_uniform() - 10);
        config.white_mode = i % 3 ? PUPIL_WHITE_FIXED : PUPIL_WHITE_NONE;
        config.white = exp2(12 * check_uniform() - 4);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        const double exposure_s = i & 1 ? exp2(-12 * check_uniform()) : 0, gain = i & 1 ? exp2(4 * check_uniform()) : 0;
        const pupil_exposure e = adapt(&pupil, 20 * check_uniform() - 10, exposure_s, gain);
        const double wanted = config.key * exp2(config.ev_compensation - e.adapted_ev);
        CHECK_MSG(fabs(e.scale / wanted - 1) <= 1e-12, "scale %.17g, wanted %.17g", e.scale, wanted);
        const pupil_curve curve = curve_of(&pupil, exposure_s, gain);
        const double of_frame = i & 1 ? wanted * config.calibration / (exposure_s * gain) : wanted;
        CHECK_MSG(fabs(curve.scale / of_frame - 1) <= 1e-7, "curve scale %.9g, wanted %.9g", curve.scale, of_frame);
        const double k = (double)PUPIL_GAMUT_KNEE, room = i % 3 ? 1 / (config.white - k) : 0;
        const double gamut = i % 3 && config.white <= 1 ? 0 : 1 / (1 - k) - room;
        CHECK_MSG(fabs(curve.gamut - gamut) <= 1e-6, "gamut %g, wanted %g", curve.gamut, gamut);
        const double square = i % 3 ? 1 / (config.white * config.white) : 0;
        CHECK_MSG(fabs(curve.inverse_white_squared - square) <= 1e-7 * square, "1/W^2 %g, wanted %g",
                  curve.inverse_white_squared, square);
    }
}

/* Half the exposure in twice the light is the same frame, of a scene twice as bright; the level is the scene's. */
static void check_divided_out(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_exposure e;
    pupil_config_default(&config);
    config.calibration = 4;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    e = adapt(&pupil, -2, 1.0 / 64, 2);
    CHECK_MSG(fabs(e.metered_ev - (-2 + 2 + 6 - 1)) < 1e-12, "scene %g", e.metered_ev);
    const double level = e.adapted_ev;
    const pupil_curve before = curve_of(&pupil, 1.0 / 64, 2);
    e = adapt(&pupil, -3, 1.0 / 128, 2); /* the same scene, exposed half as long */
    CHECK_MSG(fabs(e.adapted_ev - level) <= 1e-12 && fabs(e.metered_ev - level) <= 1e-12, "level %g, was %g",
              e.adapted_ev, level);
    e = adapt(&pupil, -1, 1.0 / 128, 8);
    CHECK(fabs(e.adapted_ev - level) <= 1e-12);
    const pupil_curve brighter = curve_of(&pupil, 1.0 / 128, 8);
    CHECK(fabs(brighter.scale / before.scale - 0.5) < 1e-6);
    /* A frame without an exposure is taken as exposed like the last one that had it. */
    e = adapt(&pupil, -1, 0, 0);
    CHECK_MSG(fabs(e.adapted_ev - level) <= 1e-12 && fabs(e.metered_ev - level) <= 1e-12, "without metadata: %g",
              e.metered_ev);
    CHECK(curve_of(&pupil, 0, 0).scale == brighter.scale);
    e = adapt(&pupil, -2, 1.0 / 64, 2);
    CHECK(fabs(e.adapted_ev - level) <= 1e-12 && curve_of(&pupil, 0, 0).scale == before.scale);
    /* Twice the light at the same exposure is one stop higher. */
    e = adapt(&pupil, -1, 1.0 / 64, 2);
    CHECK(fabs(e.metered_ev - level - 1) < 1e-12 && e.adapted_ev > level);
}

static void check_limits(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_exposure e;
    for (uint32_t law = 0; law < PUPIL_LAW_EYE; law++) { /* the eye takes hours: test_eye.c */
        pupil_config_default(&config);
        config.law = law;
        config.frame_weight = 0.2;
        config.ev_min = -4;
        config.ev_max = 6;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        e = adapt(&pupil, -9, 0, 0);
        CHECK_MSG(e.adapted_ev == -4 && e.metered_ev == -9 && e.state == PUPIL_STATE_LIMITED &&
                      e.reason == PUPIL_REASON_EV_MIN,
                  "law %u: first below ev_min: %g, state %u, reason %u", law, e.adapted_ev, e.state, e.reason);
        e = adapt(&pupil, 2, 0, 0);
        CHECK(e.state == PUPIL_STATE_ADAPTING && e.reason == PUPIL_REASON_NONE && e.adapted_ev > -4 &&
              e.adapted_ev < 2);
        e = adapt(&pupil, 25, 0, 0);
        CHECK(e.state == PUPIL_STATE_ADAPTING && e.reason == PUPIL_REASON_EV_MAX && e.adapted_ev < 6);
        for (int n = 0; n < 1500; n++)
            e = adapt(&pupil, 25, 0, 0);
        CHECK_MSG(e.adapted_ev == 6 && e.metered_ev == 25 && e.state == PUPIL_STATE_LIMITED &&
                      e.reason == PUPIL_REASON_EV_MAX,
                  "law %u: above ev_max: %.17g, state %u, reason %u", law, e.adapted_ev, e.state, e.reason);
        for (int n = 0; n < 1500; n++)
            e = adapt(&pupil, -30, 0, 0);
        CHECK(e.adapted_ev == -4 && e.state == PUPIL_STATE_LIMITED && e.reason == PUPIL_REASON_EV_MIN);
        config.ev_min = -2; /* tighter limits during the run */
        CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
        for (int n = 0; n < 1500; n++)
            e = adapt(&pupil, -30, 0, 0);
        CHECK_MSG(e.adapted_ev == -2, "law %u: retuned limit: %.17g", law, e.adapted_ev);
        config.ev_min = config.ev_max = 1.5; /* no room at all */
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        e = adapt(&pupil, 1.5, 0, 0);
        CHECK(e.adapted_ev == 1.5 && e.state == PUPIL_STATE_SETTLED && e.reason == PUPIL_REASON_NONE);
        CHECK(adapt(&pupil, -20, 0, 0).adapted_ev == 1.5 && adapt(&pupil, 20, 0, 0).adapted_ev == 1.5);
    }
}

static void check_settled(void)
{
    pupil_config config;
    pupil_t pupil;
    unsigned seen = 0;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    adapt(&pupil, 0, 0, 0);
    for (int n = 0; n < 100; n++) {
        const pupil_exposure e = adapt(&pupil, 3, 0, 0);
        const double distance = fabs(e.adapted_ev - 3);
        CHECK_MSG(e.state == (distance <= 0.05 ? PUPIL_STATE_SETTLED : PUPIL_STATE_ADAPTING),
                  "%g from its target: state %u", distance, e.state);
        seen |= 1u << e.state;
        CHECK(e.frames == (uint64_t)n + 2);
    }
    CHECK(seen == (1u << PUPIL_STATE_SETTLED | 1u << PUPIL_STATE_ADAPTING));
}

static void check_lock(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_exposure e;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    adapt(&pupil, 1, 0, 0);
    const pupil_exposure before = adapt(&pupil, 5, 0, 0);
    config.lock = 1;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n < 20; n++) {
        e = adapt(&pupil, -8 + n, 0, 0);
        CHECK(e.adapted_ev == before.adapted_ev && e.white_ev == before.white_ev && e.metered_ev == -8 + n);
        CHECK(e.state == PUPIL_STATE_LOCKED && e.reason == PUPIL_REASON_LOCK);
    }
    config.lock = 0;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    e = adapt(&pupil, 9, 0, 0);
    CHECK(e.adapted_ev > before.adapted_ev && e.state == PUPIL_STATE_ADAPTING);
    /* One frame of 40 ms, not the whole time under lock. */
    CHECK_MSG(fabs((e.adapted_ev - 9) / (before.adapted_ev - 9) - exp(-0.04 / 0.3)) < 1e-6, "after the lock: %g",
              e.adapted_ev);
}

/* Frames without weight hold the level; before the first valid one they are mapped at the key itself. */
/* A caller that meters and maps on its own threads gets the picture of pupil_process before the first light, too. */
static void check_curve_before_light(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_curve curve;
    const float colour[3] = {0.05f, 0.4f, 1.7f};
    const pupil_image_const in = {
        .data = colour, .stride_bytes = sizeof colour, .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_config_default(&config);
    CHECK(pupil_metering_roi(&config, 0, 0, 0.1, 0.1) == PUPIL_OK); /* a frame of one pixel is in cell 8, 8 */
    config.white = 3.0;
    for (config.white_mode = 0; config.white_mode <= PUPIL_WHITE_NONE; config.white_mode++) {
        unsigned char whole[3] = {0}, parts[3] = {1, 1, 1};
        pupil_image out = {.data = whole, .stride_bytes = 3, .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_process(&pupil, &in, NULL, &out) == PUPIL_OK);
        CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_ERR_NO_EXPOSURE);
        CHECK(pupil_curve_before_light(&pupil, &curve) == PUPIL_OK && curve.scale == 1.0f);
        out.data = parts;
        CHECK(pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
        CHECK_MSG(memcmp(whole, parts, sizeof whole) == 0, "white mode %u: %u %u %u, of pupil_process %u %u %u",
                  config.white_mode, parts[0], parts[1], parts[2], whole[0], whole[1], whole[2]);
    }
}

static void check_no_light(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_exposure e;
    unsigned char code[3] = {1, 2, 3};
    const float grey[3] = {0.18f, 0.18f, 0.18f};
    const pupil_image_const in = {
        .data = grey, .stride_bytes = sizeof grey, .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image out = {.data = code, .stride_bytes = 3, .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
    pupil_frame_info info = {.timestamp_ns = 1};
    pupil_config_default(&config);
    CHECK(pupil_metering_roi(&config, 0, 0, 0.1, 0.1) == PUPIL_OK); /* a frame of one pixel is in cell 8, 8 */
    config.white_mode = PUPIL_WHITE_FIXED;
    config.transfer = PUPIL_TRANSFER_LINEAR;
    for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++) {
        config.order = order;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_process(&pupil, &in, &info, &out) == PUPIL_OK);
        CHECK_MSG(code[0] == 46 && code[1] == 46 && code[2] == 46, "0.18 at scale 1 and white 1: %u", code[0]);
        CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK);
        CHECK(e.state == PUPIL_STATE_EMPTY && e.reason == PUPIL_REASON_NO_LIGHT);
        adapt(&pupil, -5, 0, 0);
        info.timestamp_ns = now += 1000;
        CHECK(pupil_process(&pupil, &in, &info, &out) == PUPIL_OK);
        CHECK(pupil_get_exposure(&pupil, &e) == PUPIL_OK);
        CHECK_MSG(e.adapted_ev == -5 && e.reason == PUPIL_REASON_NO_LIGHT, "held at %g, reason %u", e.adapted_ev,
                  e.reason);
    }
}

static void check_white_follows(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    double quantile = 0, before = 0;
    frame f = frame_make(160, 90, PUPIL_PIXEL_RGB32F, 0, 0);
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n < 120; n++) {
        frame_lognormal(&f, n < 60 ? 0.1 : 3, n < 60 ? 2.5 : 0.2, check_uniform);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 90, &stats) == PUPIL_OK);
        CHECK(pupil_stats_peak_quantile(&stats, config.white_quantile, &quantile) == PUPIL_OK);
        const pupil_exposure e = adapt_stats(&pupil, &stats, 0.25, 1);
        const pupil_curve curve = curve_of(&pupil, 0.25, 1);
        const double white = fmax(1, e.scale * exp2(e.white_ev));
        quantile += 2; /* scene light: divided by the exposure */
        if (n == 0)
            CHECK_MSG(fabs(e.white_ev - quantile) < 1e-9, "first white %g, quantile %g", e.white_ev, quantile);
        else /* between the last one and the quantile */
            CHECK(fmin(before, quantile) - 1e-9 <= e.white_ev && e.white_ev <= fmax(before, quantile) + 1e-9);
        CHECK_MSG(fabs(curve.inverse_white_squared * white * white - 1) < 1e-6, "frame %d: W %g, 1/W^2 %g", n, white,
                  curve.inverse_white_squared);
        before = e.white_ev;
    }
    CHECK(fabs(before - quantile) < 0.1);
    CHECK(curve_of(&pupil, 0.25, 1).inverse_white_squared == 1); /* little contrast: the white point is 1 */
    frame_free(&f);
}

/* An impossible setting counts as unknown, whether it is too large or too small. */
static void check_unknown_settings(void)
{
    static const double wrong[][2] = {{0.25, 0x1.1p64}, {0.25, 0x1p-65}, {0x1.1p64, 2},
                                      {0x1p-65, 2},     {0, 2},          {0.25, 0}};
    for (unsigned i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        pupil_config config;
        pupil_t pupil;
        pupil_config_default(&config);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK_MSG(adapt(&pupil, 3, wrong[i][0], wrong[i][1]).metered_ev == adapt(&pupil, 3, 0, 0).metered_ev,
                  "%g s, gain %g", wrong[i][0], wrong[i][1]);
        CHECK(fabs(adapt(&pupil, 3, 0.25, 0x1p64).metered_ev - (3.0 + 2.0 - 64.0)) < 1e-9);
    }
}

/* A white point that begins to follow has no past: none before the first frame, then at once that frame's. */
static void check_white_begins(void)
{
    pupil_config config;
    pupil_t pupil, other;
    pupil_config_default(&config);
    CHECK(pupil_init(&other, &config) == PUPIL_OK);
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    (void)adapt(&pupil, -3, 0, 0);
    config.white_mode = PUPIL_WHITE_FOLLOW;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    CHECK(curve_of(&pupil, 0, 0).inverse_white_squared == 0.0f);
    CHECK(adapt(&pupil, 4, 0, 0).white_ev == adapt(&other, 4, 0, 0).white_ev);
    CHECK(curve_of(&pupil, 0, 0).inverse_white_squared > 0.0f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_first();
    check_scale();
    check_divided_out();
    check_limits();
    check_settled();
    check_lock();
    check_no_light();
    check_curve_before_light();
    check_white_follows();
    check_unknown_settings();
    check_white_begins();
    return check_end();
}
