/* c_process PIXEL WIDTH HEIGHT OUT_PIXEL OUT_WIDTH OUT_HEIGHT: frames of a format (pupil_pixel's number) from stdin, as
 * a program in C maps them: each picture to stdout, and after the last one the exposure, the statistics and the curve.
 * The frames have no padding. They are 1/60 s apart, their exposure is 1/200 s and their gain 2. */
#include "pupil/pupil.h"

#include <stdio.h>
#include <stdlib.h>

static uint32_t number(const char *text)
{
    return (uint32_t)strtoul(text, NULL, 10);
}

int main(int argc, char **argv)
{
    if (argc != 7)
        return 2;
    const uint32_t pixel = number(argv[1]), width = number(argv[2]), height = number(argv[3]);
    const size_t bytes = pupil_image_bytes(pixel, width, height);
    const size_t out_bytes = pupil_image_bytes(number(argv[4]), number(argv[5]), number(argv[6]));
    void *frame = malloc(bytes), *picture = malloc(out_bytes);
    if (!frame || !picture)
        return 1;
    const pupil_image_const in = pupil_image_const_of(frame, width, height, pixel);
    const pupil_image out = pupil_image_of(picture, number(argv[5]), number(argv[6]), number(argv[4]));
    static pupil_t pupil;
    static pupil_stats stats;
    pupil_config config;
    pupil_exposure exposure;
    pupil_curve curve;
    pupil_config_default(&config);
    int error = pupil_init(&pupil, &config);
    for (int i = 1; !error && fread(frame, 1, bytes, stdin) == bytes; i++) {
        const pupil_frame_info info = {
            .timestamp_ns = i * 16666667LL, .sequence = (uint64_t)i, .exposure_s = 0.005, .gain = 2};
        error = pupil_process(&pupil, &in, &info, &out);
        fwrite(picture, 1, out_bytes, stdout);
    }
    error = error || pupil_get_exposure(&pupil, &exposure) || pupil_get_stats(&pupil, &stats) ||
            pupil_get_curve(&pupil, NULL, &curve);
    fwrite(&exposure, sizeof exposure, 1, stdout);
    fwrite(&stats, sizeof stats, 1, stdout);
    fwrite(&curve, sizeof curve, 1, stdout);
    free(frame);
    free(picture);
    return error != 0;
}
