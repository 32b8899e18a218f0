/* What rods see in the picture (PUPIL_LAW_EYE, pupil_curve.rods): against the formulas in double, with the same bits at
 * every CPU level, in parts and fused, without a change of the statistics; and what is refused.
 */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>

enum { WIDTH = 61, HEIGHT = 23, SAMPLES = WIDTH * HEIGHT * 3 };

static const double xyz_of_bt709[9] = {0.412390799266,  0.357584339384,  0.180480788402, 0.212639005872, 0.715168678768,
                                       0.0721923153607, 0.0193308187156, 0.119194779795, 0.95053215225};

static float light[SAMPLES], shown[SAMPLES];

static pupil_config eye(void)
{
    pupil_config config;
    pupil_config_default(&config);
    config.law = PUPIL_LAW_EYE;
    config.eye_unit_cd_m2 = 0.01;
    return config;
}

static pupil_image_const frame(void)
{
    return (pupil_image_const){
        .data = light, .stride_bytes = WIDTH * 12, .width = WIDTH, .height = HEIGHT, .pixel = PUPIL_PIXEL_RGB32F};
}

static pupil_image picture(float *to)
{
    return (pupil_image){
        .data = to, .stride_bytes = WIDTH * 12, .width = WIDTH, .height = HEIGHT, .pixel = PUPIL_PIXEL_RGB32F};
}

static void paint(void)
{
    for (int i = 0; i < SAMPLES; i++)
        light[i] = (float)(check_uniform() * check_uniform());
}

/* The light for rods of BT.709, with white as bright as before, and the blue of chromaticity (0.25, 0.25) in BT.709. */
static double for_rods(const float v[3])
{
    static const double rods_of_xyz[3] = {-0.702, 1.039, 0.433};
    double sum = 0.0, all = 0.0;
    for (int i = 0; i < 3; i++) {
        double weight = 0.0;
        for (int k = 0; k < 3; k++)
            weight += rods_of_xyz[k] * xyz_of_bt709[3 * k + i];
        weight = fmax(weight, 0.0);
        sum += weight * (double)v[i];
        all += weight;
    }
    return sum / all;
}

static void against_the_formula(void)
{
    static const double blue[3] = {3.2409699419 - 1.53738317757 - 2 * 0.498610760293,
                                   -0.969243636281 + 1.87596750151 + 2 * 0.0415550574072,
                                   0.055630079697 - 0.203976958889 + 2 * 1.05697151424};
    static const float shares[] = {0.01f, 0.37f, 1.0f};
    const pupil_config config = eye();
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown);
    pupil_t pupil;
    double worst = 0.0;
    CHECK(fabs(0.2126 * blue[0] + 0.7152 * blue[1] + 0.0722 * blue[2] - 1.0) < 1e-4);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int s = 0; s < 3; s++) {
        const pupil_curve curve = {.size_bytes = sizeof curve, .scale = 0.2f, .rods = shares[s], .gamut = 6.0f};
        CHECK(pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
        for (int i = 0; i < SAMPLES; i += 3) {
            const double m = (double)shares[s], grey = for_rods(light + i);
            double v[3], y;
            for (int k = 0; k < 3; k++)
                v[k] = (1.0 - m) * (double)light[i + k] + m * grey * blue[k];
            y = 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
            for (int k = 0; k < 3; k++) /* far below what gamut handling changes */
                worst = fmax(worst, fabs((double)shown[i + k] - 0.2 * v[k] / (1.0 + 0.2 * y)));
        }
    }
    printf("linear light of 0 to 0.3, by rods of 0.01, 0.37 and 1: within %.1e of the formula\n", worst);
    CHECK_MSG(worst < 1e-6, "%g", worst);
}

/* White keeps its luminance; of red and blue of equal luminance, red is darker at night (Purkinje). */
static void red_is_dark_at_night(void)
{
    static const float colours[3][3] = {{1, 1, 1}, {0.2f / 0.2126f, 0, 0}, {0, 0, 0.2f / 0.0722f}};
    const pupil_config config = eye();
    const pupil_curve curve = {.size_bytes = sizeof curve, .scale = 0.1f, .rods = 1.0f};
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown);
    double y[3];
    pupil_t pupil;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < SAMPLES; i++)
            light[i] = colours[c][i % 3];
        CHECK(pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
        y[c] = 0.2126 * (double)shown[0] + 0.7152 * (double)shown[1] + 0.0722 * (double)shown[2];
        CHECK(shown[2] > shown[1] || c == 1);
    }
    CHECK_MSG(fabs(y[0] - 0.1 / 1.1) < 1e-4, "%g", y[0]);
    CHECK_MSG(y[1] < 1e-6 && y[2] > 0.08, "red %g, blue %g", y[1], y[2]);
    paint();
}

static void same_bits(void)
{
    static float again[SAMPLES];
    static pupil_stats stats, plain;
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown), to = picture(again);
    pupil_config config = eye();
    pupil_curve curve = {
        .size_bytes = sizeof curve, .scale = 3.0f, .inverse_white_squared = 0.1f, .gamut = 5.0f, .rods = 0.61f};
    for (int wide = 0; wide < 2; wide++) {
        pupil_t pupil;
        config = eye();
        config.output_primaries = wide ? PUPIL_OUTPUT_BT2020 : PUPIL_OUTPUT_AS_INPUT;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
        for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++) {
            pupil_t other;
            config.levels = 1u << level;
            CHECK(pupil_init(&other, &config) == PUPIL_OK);
            memset(again, 0, sizeof again);
            for (uint32_t y = 0; y < HEIGHT; y += 5) {
                const uint32_t rows = HEIGHT - y < 5 ? HEIGHT - y : 5;
                const pupil_image_const part = pupil_image_rows(in, y, rows);
                const pupil_image part_to = pupil_image_out_rows(to, y, rows);
                CHECK(pupil_map_rows(&other, &curve, &part, &part_to) == PUPIL_OK);
            }
            CHECK_MSG(memcmp(again, shown, sizeof again) == 0, "level %u, %d", level, wide);
            pupil_stats_clear(&stats);
            pupil_stats_clear(&plain);
            memset(again, 0, sizeof again);
            CHECK(pupil_fused_rows(&other, &curve, &in, 0, HEIGHT, &to, &stats) == PUPIL_OK);
            CHECK_MSG(memcmp(again, shown, sizeof again) == 0, "fused, level %u, %d", level, wide);
            CHECK(pupil_meter_rows(&other, &in, 0, HEIGHT, &plain) == PUPIL_OK);
            CHECK_MSG(memcmp(&stats, &plain, sizeof stats) == 0, "level %u, %d: rods change the statistics", level,
                      wide);
        }
    }
}

/* An object of another law has no rods; and by day an eye's curve leaves them out. */
static void others_have_none(void)
{
    static float again[SAMPLES];
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown), to = picture(again);
    pupil_curve curve = {.size_bytes = sizeof curve, .scale = 0.4f};
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
    curve.rods = 0.9f;
    CHECK(pupil_map_rows(&pupil, &curve, &in, &to) == PUPIL_OK && memcmp(again, shown, sizeof again) == 0);
    CHECK(pupil_meter(&pupil, &in, NULL) == PUPIL_OK && pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK);
    CHECK(curve.rods == 0.0f);
    float before = 1.0f;
    for (double unit = 1e-5; unit < 1e6; unit *= 10.0) {
        config = eye();
        config.eye_unit_cd_m2 = unit;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_meter(&pupil, &in, NULL) == PUPIL_OK);
        CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK);
        CHECK(curve.rods <= before && (unit > 1e-3 || curve.rods > 0.99f) && (unit < 1e3 || curve.rods == 0.0f));
        before = curve.rods;
    }
}

static void refusals(void)
{
    static const double units[] = {0.0, -1.0, 1e-7, 1e10, NAN, INFINITY};
    static const float rods[] = {-0.1f, 1.1f, NAN, INFINITY};
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown);
    pupil_config config = eye();
    pupil_t pupil;
    const char *why = "";
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int i = 0; i < 4; i++) {
        const pupil_curve curve = {.size_bytes = sizeof curve, .scale = 1.0f, .rods = rods[i]};
        CHECK(pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_ERR_VALUE);
    }
    for (int i = 0; i < 6; i++) {
        config.eye_unit_cd_m2 = units[i];
        CHECK(pupil_config_check(&config, &why) == PUPIL_ERR_CONFIG && strstr(why, "eye_unit_cd_m2"));
        CHECK(pupil_retune(&pupil, &config) == PUPIL_ERR_CONFIG);
    }
    config = eye();
    config.law = PUPIL_LAW_COUNT;
    CHECK(pupil_config_check(&config, &why) == PUPIL_ERR_CONFIG && strstr(why, "law"));
}

/* x with m x = y, by Cramer's rule. */
static void solve(const double m[9], const double y[3], double x[3])
{
    double whole = 0.0;
    for (int i = -1; i < 3; i++) {
        double c[9];
        for (int k = 0; k < 9; k++)
            c[k] = k % 3 == i ? y[k / 3] : m[k];
        const double determinant = c[0] * (c[4] * c[8] - c[5] * c[7]) - c[1] * (c[3] * c[8] - c[5] * c[6]) +
                                   c[2] * (c[3] * c[7] - c[4] * c[6]);
        if (i < 0)
            whole = determinant;
        else
            x[i] = determinant / whole;
    }
}

/* The user's own primaries: the usual ones in another order; those of which rods see a negative amount, which count as
 * their luminance; and those of which only the luminance is known, which are seen as those of BT.709. */
static void other_primaries(void)
{
    static const double rods_of_xyz[3] = {-0.702, 1.039, 0.433}, blue_xyz[3] = {1, 1, 2};
    static const float rows[3][9] = {{0.36f, 0.41f, 0.18f, 0.715f, 0.213f, 0.072f, 0.12f, 0.02f, 0.95f},
                                     {3, 2, 2, 0.25f, 0.5f, 0.25f, 0, 0.1f, 0.2f},
                                     {0, 0, 0, 0.25f, 0.5f, 0.25f, 0, 0, 0}};
    const pupil_image_const in = frame();
    const pupil_image out = picture(shown);
    for (int n = 0; n < 3; n++) {
        pupil_config config = eye();
        pupil_t pupil;
        double own[9], blue[3], see[3], all = 0.0, worst = 0.0;
        config.primaries = PUPIL_PRIMARIES_MATRIX;
        memcpy(config.rgb_to_xyz, rows[n], sizeof rows[n]);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        for (int k = 0; k < 9; k++)
            own[k] = n == 2 ? xyz_of_bt709[k] : (double)rows[n][k];
        solve(own, blue_xyz, blue);
        for (int k = 0; k < 3; k++) {
            see[k] = fmax(0.0, rods_of_xyz[0] * own[k] + rods_of_xyz[1] * own[3 + k] + rods_of_xyz[2] * own[6 + k]);
            see[k] = n == 1 ? (double)rows[n][3 + k] : see[k];
            all += see[k];
        }
        CHECK(n != 1 || blue[0] < 0.0 || blue[1] < 0.0 || blue[2] < 0.0); /* shown as none */
        const pupil_curve curve = {.size_bytes = sizeof curve, .scale = 0.01f, .rods = 1.0f, .gamut = 6.0f};
        CHECK(pupil_map_rows(&pupil, &curve, &in, &out) == PUPIL_OK);
        for (int i = 0; i < SAMPLES; i += 3) {
            double grey = 0.0, y = 0.0, v[3];
            for (int k = 0; k < 3; k++)
                grey += see[k] / all * (double)light[i + k];
            for (int k = 0; k < 3; k++) {
                v[k] = grey * fmax(blue[k], 0.0);
                y += (double)rows[n][3 + k] * v[k];
            }
            for (int k = 0; k < 3; k++)
                worst = fmax(worst, fabs((double)shown[i + k] - 0.01 * v[k] / (1.0 + 0.01 * y)));
        }
        CHECK_MSG(worst < 1e-6, "primaries %d: %g", n, worst);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    paint();
    against_the_formula();
    red_is_dark_at_night();
    same_bits();
    others_have_none();
    refusals();
    other_primaries();
    return check_end();
}
