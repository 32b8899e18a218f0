/* The published eyes at 600 x 600, 54 degrees, 100 lamps: the veil, with the narrow lobes (bloom) summed exactly here,
 * against the sum of the formula over all lamps at each pixel. Every pixel within 2 %, rms 0.5 %, energy 1e-3.
 */
#include "check.h"
#include "eye.h"
#include "lamp.h"

enum { SIDE = 600, LAMPS = 100 };

static lamp lamps[LAMPS];
static float frame[SIDE][SIDE][3], nodes[PUPIL_VEIL_NODES][PUPIL_VEIL_NODES][3];
static double formula[SIDE][SIDE], bloom[SIDE][SIDE]; /* of one lamp, by distance */
static pupil_veil veil;
static pupil_veil_light light;

static void place_lamps(void)
{
    memset(frame, 0, sizeof frame);
    for (int i = 0; i < LAMPS; i++) {
        const lamp l = lamps[i] = lamp_anywhere(SIDE);
        for (int c = 0; c < 3; c++)
            frame[l.y][l.x][c] += l.rgb[c];
    }
}

static void fill_tables(const eye *e, const pupil_veil_result *r)
{
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            formula[y][x] = eye_pixel(e, r->degrees_per_px, x, y);
            bloom[y][x] = 0;
            for (uint32_t k = 0; k < r->lobes; k++)
                bloom[y][x] += r->lobe[k].weight * eye_gaussian(r->lobe[k].sigma, x, y);
        }
}

/* The veil of a pixel, bilinear between nodes. */
static double veil_at(int x, int y, int c)
{
    const double u = (x + 0.5) * 64 / SIDE, v = (y + 0.5) * 64 / SIDE;
    const int i = (int)u, j = (int)v;
    const double upper = nodes[j][i][c] + (u - i) * (nodes[j][i + 1][c] - nodes[j][i][c]);
    const double lower = nodes[j + 1][i][c] + (u - i) * (nodes[j + 1][i + 1][c] - nodes[j + 1][i][c]);
    return upper + (v - j) * (lower - upper);
}

static void gather(const pupil_veil_config *config)
{
    pupil_config settings;
    pupil_t pupil;
    const pupil_image_const image = {
        .data = frame, .stride_bytes = sizeof frame[0], .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_config_default(&settings);
    CHECK(pupil_init(&pupil, &settings) == PUPIL_OK);
    CHECK(pupil_veil_init(&veil, config) == PUPIL_OK);
    CHECK(pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&veil, &pupil, &image, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
    CHECK(pupil_veil_add_light(&veil, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK);
    CHECK(pupil_veil_get_nodes(&veil, &nodes[0][0][0]) == PUPIL_OK);
}

static void check_eye(const char *name, uint32_t psf, double age)
{
    pupil_veil_config config;
    pupil_veil_result result;
    pupil_veil_config_default(&config);
    config.psf = psf;
    config.width = config.height = SIDE;
    config.age_years = age;
    const eye e = eye_of(psf, age, config.pigment);
    place_lamps();
    gather(&config);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    fill_tables(&e, &result);
    double core = result.direct, most = 0, squares = 0, ours_in_all = 0, exact_in_all = 0, veil_in_all = 0;
    for (uint32_t k = 0; k < result.lobes; k++)
        core -= result.lobe[k].weight;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            for (int c = 0; c < 3; c++) {
                double exact = 0, ours = veil_at(x, y, c) + core * (double)frame[y][x][c];
                veil_in_all += veil_at(x, y, c);
                for (int i = 0; i < LAMPS; i++) {
                    const int dx = abs(x - lamps[i].x), dy = abs(y - lamps[i].y);
                    exact += formula[dy][dx] * (double)lamps[i].rgb[c];
                    ours += bloom[dy][dx] * (double)lamps[i].rgb[c];
                }
                const double error = fabs(ours / exact - 1);
                most = error > most ? error : most;
                squares += error * error;
                ours_in_all += ours;
                exact_in_all += exact;
            }
    const double rms = sqrt(squares / (3.0 * SIDE * SIDE)), energy = ours_in_all / exact_in_all - 1;
    printf("%-14s worst pixel %.2f %%, rms %.3f %%, energy %+.2e; veil %.1f %% of the light, direct %.4f\n", name,
           100 * most, 100 * rms, energy, 100 * veil_in_all / exact_in_all, result.direct);
    CHECK_MSG(most <= 0.02, "%s: worst pixel %g", name, most);
    CHECK_MSG(rms <= 0.005, "%s: rms %g", name, rms);
    CHECK_MSG(fabs(energy) <= 1e-3, "%s: energy %g", name, energy);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_eye("Spencer 1995", PUPIL_VEIL_SPENCER, 25);
    check_eye("CIE, age 25", PUPIL_VEIL_CIE, 25);
    check_eye("CIE, age 70", PUPIL_VEIL_CIE, 70);
    return check_end();
}
