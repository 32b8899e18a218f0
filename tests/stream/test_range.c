/* Light beyond what metering can distinguish has a reason: at or below the floor, or at the largest luminance. */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>

#define PIXELS 1000

/* The result of one frame in which so many pixels are `dark` and the others `light`. */
static pupil_exposure look(float floor, int dark_pixels, float dark, float light)
{
    static float rgb[PIXELS * 3];
    pupil_t pupil;
    pupil_config config;
    pupil_exposure e = {0};
    for (int i = 0; i < 3 * PIXELS; i++)
        rgb[i] = i / 3 < dark_pixels ? dark : light;
    const pupil_image_const in = {
        .data = rgb, .stride_bytes = sizeof rgb, .width = PIXELS, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    pupil_config_default(&config);
    config.floor = floor;
    config.highlight_ev = 0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_meter(&pupil, &in, NULL) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
    return e;
}

int main(int argc, char **argv)
{
    static const float dark[] = {0.0f, -1.0f, 1e-9f, 0x1p-14f};
    check_begin(argc, argv);
    for (int i = 0; i < 4; i++) {
        CHECK(look(0x1p-14f, 501, dark[i], 0.18f).reason == PUPIL_REASON_RANGE);
        CHECK(look(0x1p-14f, 500, dark[i], 0.18f).reason == PUPIL_REASON_NONE);
        CHECK(look(0x1p-14f, 1000, dark[i], 0.18f).state == PUPIL_STATE_SETTLED);
    }
    CHECK(look(0x1p-14f, 1000, 1e-6f, 0.18f).reason == PUPIL_REASON_RANGE);
    pupil_exposure e = look(0x1p-30f, 1000, 1e-6f, 0.18f); /* with a lower floor it is metered */
    CHECK(e.reason == PUPIL_REASON_NONE && fabs(e.adapted_ev - log2(1e-6)) < 1e-5);
    CHECK(look(0x1p-14f, 400, 0.18f, 1e30f).reason == PUPIL_REASON_NONE);
    CHECK(look(0x1p-14f, 20, 0.18f, 1e30f).reason == PUPIL_REASON_RANGE);
    e = look(0x1p-14f, 0, 0.18f, 1e30f);
    CHECK(e.reason == PUPIL_REASON_RANGE && e.adapted_ev == 30.0);
    return check_end();
}
