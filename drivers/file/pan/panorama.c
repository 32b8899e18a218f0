/* drivers/file/pan/panorama.c: an equirectangular panorama and the pictures a pinhole camera takes in it. */
#include "panorama.h"

#include "refuse.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* The value of infinite texels: far above any light, but differences and sums of such values stay finite. */
#define INFINITE_LIGHT 1e37f

/* Most points along one side of a pixel: more would only help where a pixel holds more than 65536 texels. */
#define MAX_POINTS 256

static float *texel(const pupil_panorama *p, ptrdiff_t x, ptrdiff_t y)
{
    return p->texels + (size_t)(y + 1) * p->row_floats + (size_t)(x + 1) * 3;
}

static float bounded(float value)
{
    value = value > INFINITE_LIGHT ? INFINITE_LIGHT : value;
    return value < -INFINITE_LIGHT ? -INFINITE_LIGHT : value;
}

/* One row into place, each texel the mean over `wide` texels around it (the outermost two count in part). As it is a
 * mean of differences, a constant row stays as it is. */
static void filter_row(const pupil_panorama *p, const float *row, uint32_t y, double wide)
{
    ptrdiff_t width = p->width, whole = (ptrdiff_t)((wide - 1) / 2), reach = wide > 1 ? whole + 1 : 0;
    double part = (wide - 1) / 2 - (double)whole;
    for (ptrdiff_t x = 0; x < width; x++) {
        for (int c = 0; c < 3; c++) {
            float centre = bounded(row[3 * x + c]);
            double sum = 0;
            for (ptrdiff_t i = -reach; i <= reach; i++) {
                double weight = i < -whole || i > whole ? part : 1;
                if (weight > 0)
                    sum += weight * ((double)bounded(row[3 * ((x + i + width) % width) + c]) - (double)centre);
            }
            texel(p, x, y)[c] = (float)(centre + sum / wide);
        }
    }
}

/* Fills the border: beyond the poles with the rows next to them, turned by half a turn, then the columns beyond the
 * seam. */
static void fill_border(const pupil_panorama *p)
{
    ptrdiff_t width = p->width, height = p->height;
    for (ptrdiff_t x = 0; x < width; x++) {
        memcpy(texel(p, x, -1), texel(p, (x + width / 2) % width, 0), 3 * sizeof(float));
        memcpy(texel(p, x, height), texel(p, (x + width / 2) % width, height - 1), 3 * sizeof(float));
    }
    for (ptrdiff_t y = -1; y <= height; y++) {
        memcpy(texel(p, -1, y), texel(p, width - 1, y), 3 * sizeof(float));
        memcpy(texel(p, width, y), texel(p, 0, y), 3 * sizeof(float));
    }
}

int pupil_panorama_make(pupil_panorama *p, const pupil_still *still, pupil_why *why)
{
    memset(p, 0, sizeof *p);
    if (fabs(still->width - 2.0 * still->height) > 0.01 * still->width)
        return pupil_refuse(why,
                            "%u x %u pixels; an equirectangular panorama is twice as wide as it is high (here %u x %u)",
                            still->width, still->height, still->width, still->width / 2);
    if (still->pixel != PUPIL_PIXEL_RGB32F)
        return pupil_refuse(why, "its pixels are coded for a display; a panorama of linear light (.hdr, .exr, .pfm, "
                                 "16-bit .png) was expected");
    p->width = still->width;
    p->height = still->height;
    p->row_floats = ((size_t)p->width + 2) * 3;
    p->texels = malloc(p->row_floats * ((size_t)p->height + 2) * sizeof(float));
    if (!p->texels)
        return pupil_refuse(why, "not enough memory for a panorama of %u x %u", p->width, p->height);
    for (uint32_t y = 0; y < p->height; y++) {
        double crowding = 0.5 / sin(PI * (y + 0.5) / p->height);
        double widest = p->width > 2 ? p->width - 2.0 : 1;
        crowding = crowding > widest ? widest : crowding;
        filter_row(p, (const float *)still->pixels + (size_t)y * p->width * 3, y, crowding > 1 ? crowding : 1);
    }
    fill_border(p);
    return 0;
}

void pupil_panorama_free(pupil_panorama *p)
{
    free(p->texels);
    memset(p, 0, sizeof *p);
}

/* atan2(y, x), within 4e-7: in a fifth of the C library's time, with the same bits on every machine. The polynomial is
 * the Chebyshev expansion of atan(sqrt(t)) / sqrt(t) over 0..1, cut after the 7th degree. */
static inline float angle(float y, float x)
{
    float flat = fabsf(x), high = fabsf(y), less = flat < high ? flat : high, more = flat < high ? high : flat;
    float a = more > 0 ? less / more : 0, t = a * a;
    float r = 0.0241661895f + t * -0.00466877331f;
    r = 0.099060969f + t * (-0.0593671008f + t * r);
    r = 0.199692354f + t * (-0.14016585f + t * r);
    r = a * (0.999999898f + t * (-0.333319597f + t * r));
    r = high > flat ? (float)(PI / 2) - r : r;
    r = x < 0 ? (float)PI - r : r;
    return y < 0 ? -r : r;
}

static inline void sample(const pupil_panorama *p, const float d[3], float rgb[3])
{
    /* Latitude by atan2, because asin loses its precision near the poles. The border adds 1 to the texel's -0.5. */
    float longitude = angle(d[0], d[2]), latitude = angle(d[1], sqrtf(d[0] * d[0] + d[2] * d[2]));
    float u = (longitude * (float)(0.5 / PI) + 0.5f) * (float)p->width + 0.5f;
    float v = (0.5f - latitude * (float)(1 / PI)) * (float)p->height + 0.5f;
    uint32_t x = (uint32_t)u, y = (uint32_t)v;
    x = x > p->width ? p->width : x;
    y = y > p->height ? p->height : y;
    float s = u - (float)x, t = v - (float)y;
    const float *a = p->texels + y * p->row_floats + x * (size_t)3, *b = a + p->row_floats;
    for (int c = 0; c < 3; c++) {
        float top = a[c] + s * (a[c + 3] - a[c]), bottom = b[c] + s * (b[c + 3] - b[c]);
        rgb[c] = top + t * (bottom - top);
    }
}

void pupil_panorama_sample(const pupil_panorama *p, const float direction[3], float rgb[3])
{
    sample(p, direction, rgb);
}

typedef struct camera {
    float right[3], up[3], forward[3]; /* one pixel to the right, one up, and to the picture's centre */
    double focal_px, texels_per_px;    /* at the picture's centre, at the equator */
} camera;

static camera aim(const pupil_panorama *p, pupil_view view, uint32_t width)
{
    double yaw = view.yaw * PI / 180, pitch = view.pitch * PI / 180;
    double focal = 0.5 * width / tan(view.fov * PI / 360);
    camera c = {
        {(float)cos(yaw), 0, (float)-sin(yaw)},
        {(float)(-sin(yaw) * sin(pitch)), (float)cos(pitch), (float)(-cos(yaw) * sin(pitch))},
        {(float)(focal * sin(yaw) * cos(pitch)), (float)(focal * sin(pitch)), (float)(focal * cos(yaw) * cos(pitch))},
        focal,
        p->width / (2 * PI * focal)};
    return c;
}

static inline void look(const camera *c, float x, float y, float d[3])
{
    for (int i = 0; i < 3; i++)
        d[i] = c->forward[i] + c->right[i] * x + c->up[i] * y;
}

/* Points along a side of the pixel around direction d. Away from the picture's centre a pixel covers a smaller angle
 * (by the cosine at least). The texels crowd by 1 / cos(latitude); filter_row reduces that to a factor of 2. */
static int points(const camera *c, const float d[3])
{
    float flat = d[0] * d[0] + d[2] * d[2], length = sqrtf(flat + d[1] * d[1]);
    float crowding = sqrtf(flat) / length;
    double scale = c->texels_per_px * c->focal_px / (double)length / (crowding > 0.5f ? (double)crowding : 0.5);
    return scale <= 1 ? 1 : scale >= MAX_POINTS ? MAX_POINTS : (int)ceil(scale);
}

/* The mean of n x n points of the pixel around (x, y). */
static void mean_of_points(const pupil_panorama *p, const camera *c, float x, float y, int n, float mean[3])
{
    double sum[3] = {0, 0, 0};
    float d[3], rgb[3], step = 1 / (float)n, first = 0.5f * step - 0.5f;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            look(c, x + first + (float)i * step, y + first + (float)j * step, d);
            sample(p, d, rgb);
            for (int channel = 0; channel < 3; channel++)
                sum[channel] += (double)rgb[channel];
        }
    for (int channel = 0; channel < 3; channel++)
        mean[channel] = (float)(sum[channel] / (n * n));
}

void pupil_panorama_render(const pupil_panorama *p, pupil_view view, float *pixels, uint32_t width, uint32_t height)
{
    camera c = aim(p, view, width);
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i++, pixels += 3) {
            float x = (float)(i + 0.5 - 0.5 * width), y = (float)(0.5 * height - (j + 0.5)), d[3];
            look(&c, x, y, d);
            int n = points(&c, d);
            if (n == 1)
                sample(p, d, pixels);
            else
                mean_of_points(p, &c, x, y, n, pixels);
        }
}

/* --- where the light is --- */

#define CELLS_WIDE  48
#define CELLS_HIGH  (CELLS_WIDE / 2)
#define CELL_POINTS 8 /* a side */

/* Mean log2 luminance (Rec.709) of one cell; bounded, so that no single sun or dead texel decides. */
static double cell_level(const pupil_panorama *p, int column, int row)
{
    double sum = 0;
    for (int k = 0; k < CELL_POINTS * CELL_POINTS; k++) {
        uint32_t x = (uint32_t)((column + (k % CELL_POINTS + 0.5) / CELL_POINTS) / CELLS_WIDE * p->width);
        uint32_t y = (uint32_t)((row + (k / CELL_POINTS + 0.5) / CELL_POINTS) / CELLS_HIGH * p->height);
        const float *t = texel(p, x, y);
        double level = 0.2126 * (double)t[0] + 0.7152 * (double)t[1] + 0.0722 * (double)t[2];
        level = level > 0x1p-20 ? level : 0x1p-20;
        sum += log2(level < 0x1p20 ? level : 0x1p20);
    }
    return sum / (CELL_POINTS * CELL_POINTS);
}

static void cell_direction(int column, int row, double d[3])
{
    double yaw = ((column + 0.5) / CELLS_WIDE - 0.5) * 2 * PI, pitch = (0.5 - (row + 0.5) / CELLS_HIGH) * PI;
    d[0] = sin(yaw) * cos(pitch);
    d[1] = sin(pitch);
    d[2] = cos(yaw) * cos(pitch);
}

/* Mean of the cells within 25 degrees, weighted by their solid angle. */
static double level_around(double level[CELLS_HIGH][CELLS_WIDE], int column, int row)
{
    double to[3], d[3], sum = 0, weights = 0;
    cell_direction(column, row, to);
    for (int r = 0; r < CELLS_HIGH; r++)
        for (int c = 0; c < CELLS_WIDE; c++) {
            cell_direction(c, r, d);
            if (d[0] * to[0] + d[1] * to[1] + d[2] * to[2] < cos(25 * PI / 180))
                continue;
            double weight = sqrt(d[0] * d[0] + d[2] * d[2]);
            sum += weight * level[r][c];
            weights += weight;
        }
    return sum / weights;
}

void pupil_panorama_extremes(const pupil_panorama *p, pupil_view *brightest, pupil_view *darkest)
{
    double level[CELLS_HIGH][CELLS_WIDE], most = -INFINITY, least = INFINITY;
    for (int r = 0; r < CELLS_HIGH; r++)
        for (int c = 0; c < CELLS_WIDE; c++)
            level[r][c] = cell_level(p, c, r);
    for (int r = CELLS_HIGH / 6; r < CELLS_HIGH - CELLS_HIGH / 6; r++)
        for (int c = 0; c < CELLS_WIDE; c++) {
            double around = level_around(level, c, r), yaw = ((c + 0.5) / CELLS_WIDE - 0.5) * 360,
                   pitch = (0.5 - (r + 0.5) / CELLS_HIGH) * 180;
            if (around > most) {
                most = around;
                brightest->yaw = yaw;
                brightest->pitch = pitch;
            }
            if (around < least) {
                least = around;
                darkest->yaw = yaw;
                darkest->pitch = pitch;
            }
        }
}
