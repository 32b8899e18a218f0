#include "display_stats.h"

#include <math.h>

static void make_decoder(double linear[256])
{
    for (int i = 0; i < 256; i++) {
        double c = i / 255.0;
        linear[i] = c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
    }
}

display_stats display_stats_measure(const pupil_image_const *image)
{
    double linear[256], sum = 0.0, pixels = (double)image->width * image->height;
    uint64_t black = 0, white = 0;
    make_decoder(linear);
    for (uint32_t y = 0; y < image->height; y++) {
        const uint8_t *p = pupil_image_rows(*image, y, 1).data;
        for (uint32_t x = 0; x < image->width; x++, p += 3) {
            double luminance = 0.2126 * linear[p[0]] + 0.7152 * linear[p[1]] + 0.0722 * linear[p[2]];
            sum += log2(luminance > DISPLAY_STATS_LOWEST ? luminance : DISPLAY_STATS_LOWEST);
            for (int c = 0; c < 3; c++) {
                black += p[c] == 0;
                white += p[c] == 255;
            }
        }
    }
    return (display_stats){exp2(sum / pixels), (double)black / (3.0 * pixels), (double)white / (3.0 * pixels)};
}
