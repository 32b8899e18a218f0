/* A veil moves light and makes none: no evenly lit picture of any shape and angle becomes brighter, and a bloom accepts
 * the lobes of each. At wide angles a flat picture has more area than the solid angle around an eye; with a few pixels
 * a narrow lobe is higher in their middles than on average.
 */
#include "check.h"

#include <string.h>

#include "pupil/bloom.h"
#include "pupil/veil.h"

enum { MOST_PIXELS = 2400 };

static float frame[MOST_PIXELS][3], nodes[PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3];
static pupil_t pupil;
static pupil_veil veil;
static pupil_veil_light light;

/* The brightest node's. */
static double veil_of_even_light(const pupil_veil_config *c)
{
    const pupil_image_const image = pupil_image_const_of(frame, c->width, c->height, PUPIL_PIXEL_RGB32F);
    double most = 0;
    CHECK(pupil_veil_init(&veil, c) == PUPIL_OK);
    CHECK(pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&veil, &pupil, &image, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
    CHECK(pupil_veil_add_light(&veil, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK);
    CHECK(pupil_veil_get_nodes(&veil, nodes) == PUPIL_OK);
    for (size_t i = 0; i < sizeof nodes / sizeof nodes[0]; i++)
        most = (double)nodes[i] > most ? (double)nodes[i] : most;
    return most;
}

static void check_picture(uint32_t width, uint32_t height, double fov_deg, uint32_t psf, double age_years)
{
    pupil_veil_config config;
    pupil_veil_result result;
    pupil_bloom_config bloom;
    const char *fault = "";
    pupil_veil_config_default(&config);
    config.psf = psf;
    config.width = width;
    config.height = height;
    config.fov_deg = fov_deg;
    config.age_years = age_years;
    const double brightest = veil_of_even_light(&config);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    CHECK_MSG(result.direct + brightest <= 1.005, "%u x %u, %g degrees, eye %u of %g years: %g + %g of 1", width,
              height, fov_deg, psf, age_years, result.direct, brightest);
    pupil_bloom_config_default(&bloom);
    bloom.width = width;
    bloom.height = height;
    bloom.lobes = result.lobes;
    memcpy(bloom.lobe, result.lobe, sizeof bloom.lobe);
    CHECK_MSG(pupil_bloom_config_check(&bloom, &fault) == PUPIL_OK, "%u x %u, %g degrees: %s", width, height, fov_deg,
              fault);
}

int main(int argc, char **argv)
{
    static const uint32_t size[][2] = {{1, 1}, {2, 3}, {7, 1}, {1, 7}, {60, 34}, {34, 60}, {1, 2400}};
    static const double angle[] = {0.1, 54, 120, 150};
    pupil_config config;
    check_begin(argc, argv);
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int i = 0; i < MOST_PIXELS; i++)
        frame[i][0] = frame[i][1] = frame[i][2] = 1.0f;
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++)
        for (size_t j = 0; j < sizeof angle / sizeof angle[0]; j++) {
            check_picture(size[i][0], size[i][1], angle[j], PUPIL_VEIL_SPENCER, 25);
            check_picture(size[i][0], size[i][1], angle[j], PUPIL_VEIL_CIE, 25);
            check_picture(size[i][0], size[i][1], angle[j], PUPIL_VEIL_CIE, 70);
        }
    return check_end();
}
