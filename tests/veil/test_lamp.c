/* A lamp of 1 to 8 pixels that moves in fractional steps: its veil moves with it, without steps, and does not wrap
 * around from the other edge. With the veil's narrowest lobe, whose error is the largest.
 */
#include "check.h"

#include <math.h>

#include "pupil/veil.h"

enum { SIDE = 600, STEPS = 40 };

static float frame[SIDE][SIDE][3];
static float nodes[PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3];
static pupil_veil veil;
static pupil_veil_light light;
static pupil_t pupil;
static double sigma_px;

static void init(void)
{
    pupil_config config;
    pupil_veil_config of;
    pupil_veil_result result;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_veil_config_default(&of);
    of.width = of.height = SIDE;
    CHECK(pupil_veil_init(&veil, &of) == PUPIL_OK);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    of.psf = PUPIL_VEIL_GAUSSIANS;
    of.gaussians = 1;
    of.gaussian[0].sigma = result.narrowest_px * result.degrees_per_px * (1 + 1e-12);
    of.gaussian[0].weight = 1;
    CHECK(pupil_veil_init(&veil, &of) == PUPIL_OK);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    CHECK(result.lobes == 0 && fabs(result.direct) < 1e-12);
    sigma_px = result.narrowest_px;
}

/* How much of a box from `at` on, `size` long, is in pixel x. */
static double covered(int x, double at, double size)
{
    return fmax(0, fmin(x + 1, at + size) - fmax(x, at));
}

/* A square lamp of luminance 1, its left upper corner at (x, y). */
static void draw(double x, double y, double size)
{
    memset(frame, 0, sizeof frame);
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            frame[j][i][0] = frame[j][i][1] = frame[j][i][2] = (float)(covered(i, x, size) * covered(j, y, size));
}

static void solve(void)
{
    const pupil_image_const image = {
        .data = frame, .stride_bytes = sizeof frame[0], .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGB32F};
    CHECK(pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&veil, &pupil, &image, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
    CHECK(pupil_veil_add_light(&veil, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK);
    CHECK(pupil_veil_get_nodes(&veil, nodes) == PUPIL_OK);
}

static double node(int i, int j)
{
    return (double)nodes[3 * (j * (int)PUPIL_VEIL_NODES + i)];
}

/* The veil at the middle of pixel (x, y), as it is mapped. */
static double veil_at(int x, int y)
{
    const double u = (x + 0.5) * 64 / SIDE, v = (y + 0.5) * 64 / SIDE;
    const int i = (int)u, j = (int)v;
    const double upper = node(i, j) + (u - i) * (node(i + 1, j) - node(i, j));
    const double lower = node(i, j + 1) + (u - i) * (node(i + 1, j + 1) - node(i, j + 1));
    return upper + (v - j) * (lower - upper);
}

static double exact_at(int x, int y, double lamp_x, double lamp_y, double size)
{
    double along_x = 0, along_y = 0;
    for (int i = (int)lamp_x; i < lamp_x + size; i++)
        along_x += covered(i, lamp_x, size) * exp(-0.5 * pow((x - i) / sigma_px, 2));
    for (int i = (int)lamp_y; i < lamp_y + size; i++)
        along_y += covered(i, lamp_y, size) * exp(-0.5 * pow((y - i) / sigma_px, 2));
    return along_x * along_y / (2 * 3.14159265358979 * sigma_px * sigma_px);
}

static void check_moving(double size)
{
    double least[4] = {9, 9, 9, 9}, most[4] = {0}, worst = 0;
    for (int step = 0; step < STEPS; step++) {
        const double x = 251.3 + step * 0.47, y = 290.1 + step * 0.31;
        draw(x, y, size);
        solve();
        for (int k = 0; k < 4; k++) {
            const int at_x = (int)x + (k == 0 ? 60 : k == 1 ? -40 : k == 2 ? 20 : -75);
            const int at_y = (int)y + (k == 0 ? 0 : k == 1 ? 45 : k == 2 ? -50 : -30);
            const double part = veil_at(at_x, at_y) / exact_at(at_x, at_y, x, y, size);
            least[k] = fmin(least[k], part);
            most[k] = fmax(most[k], part);
        }
    }
    for (int k = 0; k < 4; k++)
        worst = fmax(worst, most[k] - least[k]);
    printf("a lamp of %g px that moves by 0.47, 0.31 px: flicker %.2f %%, error %.2f %%\n", size, 100 * worst,
           100 * fmax(most[0] - 1, 1 - least[0]));
    CHECK_MSG(worst <= 0.02, "%g px: %g", size, worst);
}

int main(int argc, char **argv)
{
    static float before[sizeof nodes / sizeof nodes[0]];
    check_begin(argc, argv);
    init();
    static const double sizes[] = {1, 2, 3.5, 8};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        check_moving(sizes[i]);
    memcpy(before, nodes, sizeof nodes);
    solve(); /* it stands */
    CHECK(memcmp(before, nodes, sizeof nodes) == 0);

    draw(10, 300, 2);
    solve();
    const double peak = veil_at(11, 300), other_side = veil_at(SIDE - 1, 300);
    printf("a lamp 10 px from the left edge: %.4f %% of its peak at the right one\n", 100 * other_side / peak);
    CHECK(other_side < 0.001 * peak);
    return check_end();
}
