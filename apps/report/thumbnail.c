#include "thumbnail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* IEC 61966-2-1 */
static float decode(int code)
{
    float v = (float)code / 255.0f;
    return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

static unsigned char encode(double light)
{
    double v = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
    return (unsigned char)(255.0 * (v < 1.0 ? v : 1.0) + 0.5);
}

/* The share of source pixel i that [from, to) covers. */
static double cover(uint32_t i, double from, double to)
{
    double low = from > i ? from : i, high = to < i + 1.0 ? to : i + 1.0;
    return high > low ? high - low : 0.0;
}

/* One pixel: the mean over the box of source pixels under it. */
static void box(const pupil_image_const *in, const float light[256], double x0, double x1, double y0, double y1,
                unsigned char *out)
{
    double sum[3] = {0.0, 0.0, 0.0}, weight = 0.0;
    for (uint32_t y = (uint32_t)y0; y < in->height && y < y1; y++) {
        const unsigned char *row = (const unsigned char *)in->data + (ptrdiff_t)y * in->stride_bytes;
        double down = cover(y, y0, y1);
        for (uint32_t x = (uint32_t)x0; x < in->width && x < x1; x++) {
            double w = down * cover(x, x0, x1);
            for (int c = 0; c < 3; c++)
                sum[c] += w * (double)light[row[3 * (size_t)x + c]];
            weight += w;
        }
    }
    for (int c = 0; c < 3; c++)
        out[c] = encode(sum[c] / weight);
}

static uint32_t shrunk(uint32_t side, double scale)
{
    uint32_t s = (uint32_t)((double)side / scale + 0.5);
    return s ? s : 1;
}

int thumbnail_make(thumbnail *small, const pupil_image_const *in)
{
    uint32_t longest = in->width > in->height ? in->width : in->height;
    double scale = longest > THUMBNAIL_MOST_PX ? (double)longest / THUMBNAIL_MOST_PX : 1.0;
    float light[256];
    small->width = shrunk(in->width, scale);
    small->height = shrunk(in->height, scale);
    size_t row = (size_t)small->width * 3;
    small->rgb = malloc(row * small->height);
    if (!small->rgb)
        return -1;
    for (int i = 0; i < 256; i++)
        light[i] = decode(i);
    double across = (double)in->width / small->width, down = (double)in->height / small->height;
    for (uint32_t y = 0; y < small->height; y++) {
        if (scale == 1.0)
            memcpy(small->rgb + y * row, (const unsigned char *)in->data + (ptrdiff_t)y * in->stride_bytes, row);
        for (uint32_t x = 0; scale > 1.0 && x < small->width; x++)
            box(in, light, x * across, (x + 1) * across, y * down, (y + 1) * down,
                small->rgb + y * row + 3 * (size_t)x);
    }
    return 0;
}

void thumbnail_free(thumbnail *small)
{
    free(small->rgb);
    memset(small, 0, sizeof *small);
}

pupil_image_const thumbnail_image(const thumbnail *small)
{
    pupil_image_const image = {.data = small->rgb,
                               .stride_bytes = (ptrdiff_t)small->width * 3,
                               .width = small->width,
                               .height = small->height,
                               .pixel = PUPIL_PIXEL_RGB8};
    return image;
}
