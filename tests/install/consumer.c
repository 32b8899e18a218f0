/* Another project's program, in the common subset of C and C++. */
#include <pupil/pupil.h>

#include <stdio.h>
#include <string.h>

int main(void)
{
    float in[4 * 4 * 3];
    unsigned char out[4 * 4 * 3];
    pupil_config config;
    pupil_t pupil;
    pupil_image_const from;
    pupil_image to;
    int i;
    for (i = 0; i < 4 * 4 * 3; i++)
        in[i] = 40.0f; /* an even grey frame comes out at the key, 0.18, for any light */
    memset(&from, 0, sizeof from);
    memset(&to, 0, sizeof to);
    from.data = in;
    from.stride_bytes = 4 * 3 * (ptrdiff_t)sizeof(float);
    to.data = out;
    to.stride_bytes = 4 * 3;
    from.width = to.width = from.height = to.height = 4;
    from.pixel = PUPIL_PIXEL_RGB32F;
    to.pixel = PUPIL_PIXEL_RGB8;

    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    if (strcmp(pupil_version(), "0.2.0") != 0 || pupil_init(&pupil, &config) != PUPIL_OK ||
        pupil_process(&pupil, &from, NULL, &to) != PUPIL_OK)
        return 1;
    /* 0.18 / 1.18 = 0.1525 of full light is the sRGB code 108.9 (IEC 61966-2-1). */
    printf("pupil %s maps grey to %d\n", pupil_version(), out[0]);
    return out[0] == 109 && out[0] == out[1] && out[0] == out[47] ? 0 : 1;
}
