/* pupil_gles_balance: from then on statistics and pictures are those of an object made with this balance; an invalid
 * balance is refused, and nothing changes. */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "same.h"

static void test_pixel(gl_test *test, uint32_t pixel, same_figures *figures)
{
    static const float balances[][3] = {{1.9f, 1, 1.6f}, {1, 1, 1}, {0.7f, 1.3f, 3}, {0, 0, 0}};
    static const float wrong[][3] = {{1, 0, 1}, {1, -1, 1}, {2048, 1, 1}, {NAN, 1, 1}};
    static pupil_gles gles;
    static pupil_t pupil;
    pupil_coding coding = {.bayer = PUPIL_BAYER_GRBG, .black = 16};
    pupil_config config;
    pupil_gles_config with;
    pupil_why why = {""};
    frame f = frame_make(64, 32, pixel, 0, 0);
    frame_lognormal(&f, 0.2, 1.0, check_uniform);
    f.image.coding = &coding;
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_FIXED;
    config.white = 4;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_gles_config_default(&with);
    with.pixel = pixel;
    with.width = 64;
    with.height = 32;
    with.coding = &coding;
    const int error = pupil_gles_init(&gles, &with, &pupil, pupil_egl_get_proc, &why);
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
    CHECK(error == PUPIL_OK && pupil_gles_upload(&gles, &f.image) == PUPIL_OK);
    for (size_t i = 0; i < sizeof balances / sizeof balances[0] && !error; i++) {
        pupil_stats gpu, cpu;
        pupil_frame_info info = {.sequence = i};
        memcpy(coding.balance, balances[i], sizeof coding.balance);
        CHECK(pupil_gles_balance(&gles, balances[i]) == PUPIL_OK);
        for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++)
            CHECK(pupil_gles_balance(&gles, wrong[k]) == PUPIL_ERR_CODING);
        pupil_stats_clear(&cpu);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 32, &cpu) == PUPIL_OK);
        CHECK(pupil_gles_meter(&gles, &info) == PUPIL_OK);
        CHECK(pupil_gles_collect(&gles, 10 * SECOND_NS, &gpu, &info) == PUPIL_OK);
        compare_stats(&gpu, &cpu, figures, "balance");
        compare_pictures(test, &gles, &pupil, &f.image, figures, "balance");
    }
    CHECK(pupil_gles_balance(NULL, balances[0]) == PUPIL_ERR_NULL && pupil_gles_balance(&gles, NULL) == PUPIL_ERR_NULL);
    memcpy(coding.balance, balances[0], sizeof coding.balance);
    CHECK(same_frame(test, &f.image, &config, figures, "made so"));
    pupil_gles_close(&gles);
    CHECK(pupil_gles_balance(&gles, balances[0]) != PUPIL_OK);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_BAYER8, PUPIL_PIXEL_BAYER10, PUPIL_PIXEL_BAYER12P,
                                      PUPIL_PIXEL_BAYER16};
    static gl_test test;
    same_figures figures = {0};
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    for (size_t i = 0; i < sizeof pixels / sizeof pixels[0]; i++)
        test_pixel(&test, pixels[i], &figures);
    same_judge(&figures, "balance");
    gl_test_close(&test);
    return check_end();
}
