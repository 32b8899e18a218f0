/* The five bells of the list of known lights, at 600 x 600 with a radius of 150 pixels and a period of 750, against the
 * sum of the bells at each pixel: the table of docs/look.md. Also invalid lists.
 */
#include "check.h"

#include <math.h>

#include "pupil/veil.h"

enum { SIDE = 600, RADIUS = 150, MOST = 100 };
#define PI 3.14159265358979323846

static const char *const names[PUPIL_VEIL_BELL_COUNT] = {"band", "quadratic", "cosine", "disc", "Gaussian"};
static pupil_veil veil;
static pupil_veil_spot spots[MOST];
static double exact[SIDE][SIDE];

static double profile(uint32_t bell, double u) /* of x / R */
{
    if (bell == PUPIL_VEIL_GAUSSIAN)
        return exp(-8 * u * u);
    if (fabs(u) >= 1)
        return 0;
    return bell == PUPIL_VEIL_COSINE ? pow(cos(PI * u / 2), 2) : 1 - u * u;
}

static double bell_at(uint32_t bell, double x, double y)
{
    const double u = x / RADIUS, v = y / RADIUS;
    if (bell == PUPIL_VEIL_BAND)
        return profile(bell, u);
    if (bell == PUPIL_VEIL_DISC)
        return fmax(0, 1 - u * u - v * v);
    return profile(bell, u) * profile(bell, v);
}

static void sum_exactly(uint32_t bell, int count, double *peak)
{
    *peak = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            double sum = 0;
            for (int i = 0; i < count; i++)
                sum += bell_at(bell, x + 0.5 - spots[i].x_px, y + 0.5 - spots[i].y_px) * (double)spots[i].rgb[1];
            exact[y][x] = sum;
            *peak = fmax(*peak, sum);
        }
}

static void begin(double period, uint32_t harmonics)
{
    pupil_veil_config config;
    pupil_veil_config_default(&config);
    config.width = config.height = SIDE;
    config.psf = PUPIL_VEIL_GAUSSIANS; /* and none of them */
    config.period = period;
    config.harmonics = harmonics;
    CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
}

/* The largest error in % of the peak, and the lowest value. */
static double error_of(uint32_t bell, int count, uint32_t harmonics, double peak, double *lowest)
{
    static float picture[SIDE][3 * SIDE];
    double most = 0;
    begin(1.25, harmonics);
    CHECK(pupil_veil_add_bells(&veil, bell, RADIUS, spots, (size_t)count) == PUPIL_OK);
    *lowest = 0;
    CHECK(pupil_veil_evaluate_rows(&veil, 0, SIDE, picture[0]) == PUPIL_OK);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const double value = (double)picture[y][3 * x + 1];
            const double error = fabs(value - exact[y][x]);
            most = error > most ? error : most; /* with fmax, gcc 12 for AArch64 crashes at -O3 */
            *lowest = value < *lowest ? value : *lowest;
        }
    *lowest *= 100 / peak;
    return 100 * most / peak;
}

static void check_bell(uint32_t bell, int count)
{
    static const uint32_t harmonics[] = {4, 8, 12, 16, 24, 32};
    double peak, lowest, last = 1e9;
    sum_exactly(bell, count, &peak);
    printf("%-10s %3d lights, %% of the peak:", names[bell], count);
    for (size_t i = 0; i < sizeof harmonics / sizeof harmonics[0]; i++) {
        const uint32_t n = harmonics[i];
        const double error = error_of(bell, count, n, peak, &lowest);
        printf("  N=%u %.3f (lowest %.2f)", n, error, lowest);
        CHECK_MSG(error < last * 1.05 || error < 0.03, "%s: more harmonics are no better",
                  names[bell]); /* 0.03 %: its truncation */
        last = error;
        if (n == 12 && bell == PUPIL_VEIL_GAUSSIAN)
            CHECK_MSG(error <= 0.05, "Gaussian %g %%", error);
        if (n == 16 && bell == PUPIL_VEIL_DISC)
            CHECK_MSG(error <= 3.5, "disc %g %%", error);
    }
    printf("\n");
    CHECK_MSG(last < (bell == PUPIL_VEIL_GAUSSIAN || bell == PUPIL_VEIL_COSINE ? 0.06 : 2.0), "%s: %g", names[bell],
              last);
}

static void place(double from, double to)
{
    for (int i = 0; i < MOST; i++)
        spots[i] = (pupil_veil_spot){.x_px = from + (to - from) * check_uniform(),
                                     .y_px = from + (to - from) * check_uniform(),
                                     .rgb = {0, (float)(1 + check_uniform()), 1}};
}

/* A bell near one edge does not appear at the other. */
static void check_edge(void)
{
    static float row[3 * SIDE];
    const pupil_veil_spot lamp = {.x_px = 10, .y_px = 300, .rgb = {1, 1, 1}};
    float most = 0;
    begin(1.25, 12);
    CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_GAUSSIAN, RADIUS, &lamp, 1) == PUPIL_OK);
    for (uint32_t y = 0; y < SIDE; y++) {
        CHECK(pupil_veil_evaluate_rows(&veil, y, 1, row) == PUPIL_OK);
        most = fmaxf(most, fabsf(row[3 * (SIDE - 1)]));
    }
    printf("a lamp 10 px from the left edge: %.4f %% of its peak at the right one\n", 100 * (double)most);
    CHECK(most < 0.001f);
}

static void check_refusals(void)
{
    static float before[3 * SIDE], after[3 * SIDE];
    const float bad[] = {NAN, INFINITY, -1, 0x1p31f};
    begin(1.25, 12);
    CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, spots, 3) == PUPIL_OK);
    CHECK(pupil_veil_evaluate_rows(&veil, 7, 1, before) == PUPIL_OK);
    for (int i = 0; i < 4; i++) {
        pupil_veil_spot s[2] = {spots[0], spots[1]};
        s[1].rgb[2] = bad[i];
        CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, s, 2) == PUPIL_ERR_VALUE);
        s[1] = spots[1];
        s[1].x_px = i < 2 ? (double)bad[i] : i == 2 ? -1 : 601; /* it would wrap around */
        CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, s, 2) == PUPIL_ERR_VALUE);
        s[1] = spots[1];
        s[1].y_px = i < 2 ? (double)bad[i] : i == 2 ? -1 : 601;
        CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, s, 2) == PUPIL_ERR_VALUE);
        CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, i == 3 ? 0.0 : (double)bad[i], s, 1) == PUPIL_ERR_VALUE);
    }
    CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_BELL_COUNT, RADIUS, spots, 1) == PUPIL_ERR_VALUE);
    CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, NULL, 1) == PUPIL_ERR_NULL);
    CHECK(pupil_veil_add_bells(NULL, PUPIL_VEIL_DISC, RADIUS, spots, 1) == PUPIL_ERR_NULL);
    CHECK(pupil_veil_evaluate_rows(&veil, 7, 1, after) == PUPIL_OK);
    CHECK(memcmp(before, after, sizeof before) == 0);
    CHECK(pupil_veil_add_bells(&veil, PUPIL_VEIL_DISC, RADIUS, NULL, 0) == PUPIL_OK);
    CHECK(pupil_veil_evaluate_rows(&veil, SIDE, 1, after) == PUPIL_ERR_ROWS);
    CHECK(pupil_veil_evaluate_rows(&veil, 1, SIDE, after) == PUPIL_ERR_ROWS);
    CHECK(pupil_veil_evaluate_rows(&veil, SIDE, 0, NULL) == PUPIL_OK);
    CHECK(pupil_veil_evaluate_rows(&veil, 0, 1, NULL) == PUPIL_ERR_NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t bell = 0; bell < PUPIL_VEIL_BELL_COUNT; bell++) {
        place(RADIUS, SIDE - RADIUS);
        check_bell(bell, 1);
        place(0, SIDE);
        check_bell(bell, MOST);
    }
    check_edge();
    check_refusals();
    return check_end();
}
