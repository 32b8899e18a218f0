#include "veil_rivals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 8 };

/* --- light by light --- */

typedef struct span {
    int first, end;
} span;

static span reached(const veil_lights *l, double at)
{
    const int first = (int)ceil(at - 4 * l->sigma_px - 0.5), end = (int)floor(at + 4 * l->sigma_px - 0.5) + 1;
    return (span){first > 0 ? first : 0, end < (int)l->side ? end : (int)l->side};
}

static void fill_profile(const veil_lights *l, span s, double at, float *profile)
{
    for (int i = s.first; i < s.end; i++)
        profile[i] = (float)exp(-0.5 * pow((i + 0.5 - at) / l->sigma_px, 2));
}

void veil_direct(const veil_lights *l, float *rgb)
{
    float across[4096], down[4096];
    memset(rgb, 0, (size_t)l->side * l->side * 3 * sizeof *rgb);
    for (size_t n = 0; n < l->count; n++) {
        const pupil_veil_spot *spot = &l->spot[n];
        const span x = reached(l, spot->x_px), y = reached(l, spot->y_px);
        fill_profile(l, x, spot->x_px, across);
        fill_profile(l, y, spot->y_px, down);
        for (int j = y.first; j < y.end; j++) {
            const float r = spot->rgb[0] * down[j], g = spot->rgb[1] * down[j], b = spot->rgb[2] * down[j];
            float *restrict row = rgb + (size_t)j * l->side * 3;
            for (int i = x.first; i < x.end; i++) {
                row[3 * i] += r * across[i];
                row[3 * i + 1] += g * across[i];
                row[3 * i + 2] += b * across[i];
            }
        }
    }
}

void veil_exact(const veil_lights *l, int channel, double *sum)
{
    double across[4096];
    memset(sum, 0, (size_t)l->side * l->side * sizeof *sum);
    for (size_t n = 0; n < l->count; n++) {
        const pupil_veil_spot *spot = &l->spot[n];
        const span x = reached(l, spot->x_px), y = reached(l, spot->y_px);
        for (int i = x.first; i < x.end; i++)
            across[i] = exp(-0.5 * pow((i + 0.5 - spot->x_px) / l->sigma_px, 2)) * (double)spot->rgb[channel];
        for (int j = y.first; j < y.end; j++) {
            const double down = exp(-0.5 * pow((j + 0.5 - spot->y_px) / l->sigma_px, 2));
            double *row = sum + (size_t)j * l->side;
            for (int i = x.first; i < x.end; i++)
                row[i] += down * across[i];
        }
    }
}

/* --- the pyramid --- */

struct veil_pyramid {
    uint32_t side[LEVELS];
    float weight[LEVELS];
    float *level[LEVELS], *above; /* RGB */
};

static size_t floats(uint32_t side)
{
    return (size_t)side * side * 3;
}

static uint32_t at_edge(int64_t i, uint32_t side)
{
    return i < 0 ? 0 : i >= (int64_t)side ? side - 1 : (uint32_t)i;
}

static void halve(const float *from, uint32_t side, float *to, uint32_t half)
{
    static const float tent[4] = {0.125f, 0.375f, 0.375f, 0.125f};
    for (uint32_t y = 0; y < half; y++)
        for (uint32_t x = 0; x < half; x++) {
            float sum[3] = {0};
            for (int j = 0; j < 4; j++)
                for (int i = 0; i < 4; i++) {
                    const int64_t u = 2 * (int64_t)x + i - 1, v = 2 * (int64_t)y + j - 1;
                    if (u < 0 || v < 0 || u >= side || v >= side)
                        continue; /* outside is dark */
                    const float *p = from + 3 * ((size_t)v * side + (size_t)u);
                    for (int c = 0; c < 3; c++)
                        sum[c] += tent[i] * tent[j] * p[c];
                }
            memcpy(to + 3 * ((size_t)y * half + x), sum, sizeof sum);
        }
}

/* to = scale * to + from, enlarged bilinearly. */
static void enlarge(const float *from, uint32_t half, float *to, uint32_t side, float scale)
{
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            const int64_t i = ((int64_t)x - 1) >> 1, j = ((int64_t)y - 1) >> 1;
            const float u = x & 1 ? 0.25f : 0.75f, v = y & 1 ? 0.25f : 0.75f;
            const float *a = from + 3 * ((size_t)at_edge(j, half) * half),
                        *b = from + 3 * ((size_t)at_edge(j + 1, half) * half);
            const size_t l = 3 * (size_t)at_edge(i, half), r = 3 * (size_t)at_edge(i + 1, half);
            float *p = to + 3 * ((size_t)y * side + x);
            for (int c = 0; c < 3; c++)
                p[c] = scale * p[c] + (1 - v) * ((1 - u) * a[l + (size_t)c] + u * a[r + (size_t)c]) +
                       v * ((1 - u) * b[l + (size_t)c] + u * b[r + (size_t)c]);
        }
}

static void splat(const veil_lights *l, float *rgb)
{
    memset(rgb, 0, floats(l->side) * sizeof *rgb);
    for (size_t n = 0; n < l->count; n++)
        for (int c = 0; c < 3; c++)
            rgb[3 * ((size_t)l->spot[n].y_px * l->side + (size_t)l->spot[n].x_px) + (size_t)c] += l->spot[n].rgb[c];
}

static void go_down(veil_pyramid *p)
{
    for (int k = 1; k < LEVELS; k++)
        halve(p->level[k - 1], p->side[k - 1], p->level[k], p->side[k]);
}

static void go_up(veil_pyramid *p)
{
    for (size_t i = 0; i < floats(p->side[LEVELS - 1]); i++)
        p->level[LEVELS - 1][i] *= p->weight[LEVELS - 1];
    for (int k = LEVELS - 1; k > 0; k--)
        enlarge(p->level[k], p->side[k], p->level[k - 1], p->side[k - 1], p->weight[k - 1]);
}

/* Gauss without pivots: normal equations. */
static void solve(double a[LEVELS][LEVELS + 1])
{
    for (int i = 0; i < LEVELS; i++)
        for (int j = 0; j < LEVELS; j++) {
            const double factor = i == j ? 0 : a[j][i] / a[i][i];
            for (int k = i; k <= LEVELS && i != j; k++)
                a[j][k] -= factor * a[i][k];
        }
}

/* Fits the weights to the pictures that each level alone makes of one light in the middle. */
static int fit(veil_pyramid *p, double sigma)
{
    const uint32_t side = p->side[0];
    const size_t pixels = (size_t)side * side;
    const pupil_veil_spot spot = {side / 2 + 0.5, side / 2 + 0.5, {1, 1, 1}, 0};
    const veil_lights one = {side, sigma, &spot, 1};
    double normal[LEVELS][LEVELS + 1] = {{0}}, *exact = malloc(pixels * sizeof *exact);
    float *alone = malloc(pixels * LEVELS * sizeof *alone);
    if (exact && alone) {
        veil_exact(&one, 0, exact);
        for (int k = 0; k < LEVELS; k++) {
            for (int i = 0; i < LEVELS; i++)
                p->weight[i] = i == k;
            veil_pyramid_run(p, &one, p->above);
            for (size_t i = 0; i < pixels; i++)
                alone[i * LEVELS + (size_t)k] = p->above[3 * i];
        }
        for (size_t i = 0; i < pixels; i++)
            for (int k = 0; k < LEVELS; k++) {
                const double a = (double)alone[i * LEVELS + (size_t)k];
                for (int m = 0; m < LEVELS; m++)
                    normal[k][m] += a * (double)alone[i * LEVELS + (size_t)m];
                normal[k][LEVELS] += a * exact[i];
            }
        for (int k = 0; k < LEVELS; k++)
            normal[k][k] *= 1 + 1e-9;
        solve(normal);
        for (int k = 0; k < LEVELS; k++)
            p->weight[k] = (float)(normal[k][LEVELS] / normal[k][k]);
    }
    const int failed = !exact || !alone;
    free(exact);
    free(alone);
    return failed;
}

veil_pyramid *veil_pyramid_open(uint32_t side, double sigma_px)
{
    veil_pyramid *p = calloc(1, sizeof *p);
    int failed = !p;
    for (int k = 0; !failed && k < LEVELS; k++) {
        p->side[k] = k ? (p->side[k - 1] + 1) / 2 : side;
        p->level[k] = malloc(floats(p->side[k]) * sizeof(float));
        failed = !p->level[k];
    }
    if (!failed)
        p->above = malloc(floats(side) * sizeof(float));
    if (!failed && p->above && fit(p, sigma_px) == 0)
        return p;
    veil_pyramid_close(p);
    return NULL;
}

void veil_pyramid_run(veil_pyramid *p, const veil_lights *lights, float *rgb)
{
    splat(lights, p->level[0]);
    go_down(p);
    go_up(p);
    memcpy(rgb, p->level[0], floats(p->side[0]) * sizeof *rgb);
}

void veil_pyramid_close(veil_pyramid *p)
{
    for (int k = 0; p && k < LEVELS; k++)
        free(p->level[k]);
    if (p)
        free(p->above);
    free(p);
}
