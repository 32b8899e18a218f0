#include "yuv_rows.h"

/* The formula's factors times 2^18, rounded so that luma's sum is that of 219/255 and chroma's sums are 0 (grey stays
 * grey). Each is within 0.9 of the exact one, which for three samples of 255 is 0.003 of a code. The largest sum, of
 * eight samples in 4:2:0, is below 2^30. */
#define SHIFT 18
static const struct {
    int32_t offset, r, g, b;
} factors[][3] = {
    [PUPIL_YUV_709] = {{16, 47864, 161016, 16255}, {128, -26383, -88755, 115138}, {128, 115138, -104580, -10558}},
    [PUPIL_YUV_601] = {{16, 67315, 132155, 25665}, {128, -38856, -76282, 115138}, {128, 115138, -96414, -18724}},
};

void pupil_yuv_row(pupil_yuv_matrix matrix, pupil_yuv_plane plane, const uint8_t *rgb, uint32_t width, uint8_t *out)
{
    const int32_t r = factors[matrix][plane].r, g = factors[matrix][plane].g, b = factors[matrix][plane].b;
    const int32_t offset = (factors[matrix][plane].offset << SHIFT) + (1 << (SHIFT - 1));
    for (uint32_t x = 0; x < width; x++, rgb += 3)
        out[x] = (uint8_t)((offset + r * rgb[0] + g * rgb[1] + b * rgb[2]) >> SHIFT);
}

/* Eight times a channel's mean around column x, from both rows. */
static int32_t sum_of_eight(const uint8_t *top, const uint8_t *bottom, uint32_t left, uint32_t x, uint32_t right)
{
    return top[3 * left] + 2 * top[3 * x] + top[3 * right] + bottom[3 * left] + 2 * bottom[3 * x] + bottom[3 * right];
}

void pupil_yuv709_chroma420_row(pupil_yuv_plane plane, const uint8_t *top, const uint8_t *bottom, uint32_t width,
                                uint8_t *out)
{
    const int32_t red = factors[PUPIL_YUV_709][plane].r, green = factors[PUPIL_YUV_709][plane].g;
    const int32_t blue = factors[PUPIL_YUV_709][plane].b;
    const int32_t offset = (factors[PUPIL_YUV_709][plane].offset << (SHIFT + 3)) + (1 << (SHIFT + 2));
    for (uint32_t x = 0; x < width; x += 2) {
        const uint32_t left = x ? x - 1 : x, right = x + 1 < width ? x + 1 : x;
        const int32_t r = sum_of_eight(top, bottom, left, x, right);
        const int32_t g = sum_of_eight(top + 1, bottom + 1, left, x, right);
        const int32_t b = sum_of_eight(top + 2, bottom + 2, left, x, right);
        out[x / 2] = (uint8_t)((offset + red * r + green * g + blue * b) >> (SHIFT + 3));
    }
}
