/* lib/kernels/veil_loops.h: what the veil does with each pixel (pupil/veil.h). Plain loops, compiled for each level;
 * eight fixed lanes, so that the bits are the same. */
#ifndef PUPIL_KERNELS_VEIL_LOOPS_H
#define PUPIL_KERNELS_VEIL_LOOPS_H

#include "kernels.h"

#if defined(__AVX__)
#include <immintrin.h>
#endif

enum { VEIL_LANES = 8 };

/* Vector types of GCC and clang, on any CPU; the compiler splits them where registers are shorter. */
typedef float veil_lanes __attribute__((vector_size(4 * VEIL_LANES)));
typedef int32_t veil_masks __attribute__((vector_size(4 * VEIL_LANES)));
typedef float veil_pixel __attribute__((vector_size(16)));

/* 0 where it is negative or NaN, and at most PUPIL_CEILING. */
static inline void veil_bound(veil_lanes *v)
{
    const veil_lanes ceiling = {PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING,
                                PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING, PUPIL_CEILING};
#if defined(__AVX__)
    *v = (veil_lanes)_mm256_min_ps(_mm256_max_ps((__m256)*v, _mm256_setzero_ps()), (__m256)ceiling);
#else
    const veil_lanes positive = (veil_lanes)((veil_masks)*v & (*v > 0.0f));
    const veil_masks below = positive < ceiling;
    *v = (veil_lanes)(((veil_masks)positive & below) | ((veil_masks)ceiling & ~below));
#endif
}

static inline float veil_sum(const veil_lanes *lane)
{
    veil_pixel half[2];
    __builtin_memcpy(half, lane, sizeof half);
    half[0] += half[1];
    return (half[0][0] + half[0][2]) + (half[0][1] + half[0][3]);
}

/* Of a channel: the light, and the light times its place. */
typedef struct veil_pair {
    veil_lanes sum, moment;
} veil_pair;

static inline void veil_add(const float *v, const veil_lanes *at, veil_pair *to)
{
    veil_lanes light;
    __builtin_memcpy(&light, v, sizeof light);
    veil_bound(&light);
    to->sum += light;
    to->moment += light * *at;
}

static inline void veil_add_some(const float *v, const veil_lanes *at, const veil_masks *some, veil_pair *to)
{
    veil_lanes light;
    __builtin_memcpy(&light, v, sizeof light);
    veil_bound(&light);
    light = (veil_lanes)((veil_masks)light & *some);
    to->sum += light;
    to->moment += light * *at;
}

/* Of n pixels. Lanes beyond n are read, and count as 0. */
static inline void veil_gather_run(const float *r, const float *g, const float *b, uint32_t n, pupil_veil_sums *to)
{
    veil_pair red = {{0}, {0}}, green = {{0}, {0}}, blue = {{0}, {0}};
    veil_lanes at = {0, 1, 2, 3, 4, 5, 6, 7};
    uint32_t i = 0;
    for (; i + VEIL_LANES <= n; i += VEIL_LANES) {
        veil_add(r + i, &at, &red);
        veil_add(g + i, &at, &green);
        veil_add(b + i, &at, &blue);
        at += (float)VEIL_LANES;
    }
    if (i < n) {
        const veil_masks some = at < (float)(int32_t)n;
        veil_add_some(r + i, &at, &some, &red);
        veil_add_some(g + i, &at, &some, &green);
        veil_add_some(b + i, &at, &some, &blue);
    }
    *to = (pupil_veil_sums){.sum = {veil_sum(&red.sum), veil_sum(&green.sum), veil_sum(&blue.sum)},
                            .moment = {veil_sum(&red.moment), veil_sum(&green.moment), veil_sum(&blue.moment)}};
}

static void veil_gather(const pupil_planes *planes, const uint32_t *n, uint32_t count, pupil_veil_sums *sums)
{
    for (uint32_t c = 0, at = 0; c < count; at += n[c], c++)
        veil_gather_run(planes->r + at, planes->g + at, planes->b + at, n[c], &sums[c]);
}

/* The same of pixels of four floats, whose last is not used. Eight lanes hold two pixels, and each of eight pixels has
 * its own lanes, so that the sums have the same terms in the same order. */
static inline void veil_add_two(veil_lanes *light, veil_lanes *at, veil_pair *to)
{
    veil_bound(light);
    to->sum += *light;
    to->moment += *light * *at;
    *at += (float)VEIL_LANES;
}

static inline void veil_add_pixels(const float *v, veil_lanes *at, veil_pair *to)
{
    veil_lanes light;
    __builtin_memcpy(&light, v, sizeof light);
    veil_add_two(&light, at, to);
}

static inline void veil_add_pixel(const float *v, veil_lanes *at, veil_pair *to)
{
    veil_lanes light = {v[0], v[1], v[2], v[3]};
    veil_add_two(&light, at, to);
}

static inline void veil_sum_pixels(const veil_lanes *a, const veil_lanes *b, const veil_lanes *c, const veil_lanes *d,
                                   float to[3])
{
    const veil_lanes all = (*a + *c) + (*b + *d);
    for (int channel = 0; channel < 3; channel++)
        to[channel] = all[channel] + all[4 + channel];
}

static inline void veil_gather_pixels(const float *v, ptrdiff_t next_row, uint32_t n, pupil_veil_sums *to)
{
    veil_pair a = {{0}, {0}}, b = {{0}, {0}}, c = {{0}, {0}}, d = {{0}, {0}};
    veil_lanes at_a = {0, 0, 0, 0, 1, 1, 1, 1}, at_b = at_a + 2.0f, at_c = at_a + 4.0f, at_d = at_a + 6.0f;
    for (; n >= VEIL_LANES; n -= VEIL_LANES, v += 4 * VEIL_LANES) {
        __builtin_prefetch((const uint8_t *)v + next_row, 0, 2);
        __builtin_prefetch((const uint8_t *)v + next_row + 64, 0, 2);
        veil_add_pixels(v, &at_a, &a);
        veil_add_pixels(v + 8, &at_b, &b);
        veil_add_pixels(v + 16, &at_c, &c);
        veil_add_pixels(v + 24, &at_d, &d);
    }
    __builtin_prefetch((const uint8_t *)v + next_row, 0, 2);
    __builtin_prefetch((const uint8_t *)v + next_row + 64, 0, 2);
    if (n >= 2)
        veil_add_pixels(v, &at_a, &a);
    else if (n)
        veil_add_pixel(v, &at_a, &a);
    if (n >= 4)
        veil_add_pixels(v + 8, &at_b, &b);
    else if (n == 3)
        veil_add_pixel(v + 8, &at_b, &b);
    if (n >= 6)
        veil_add_pixels(v + 16, &at_c, &c);
    else if (n == 5)
        veil_add_pixel(v + 16, &at_c, &c);
    if (n == 7)
        veil_add_pixel(v + 24, &at_d, &d);
    veil_sum_pixels(&a.sum, &b.sum, &c.sum, &d.sum, to->sum);
    veil_sum_pixels(&a.moment, &b.moment, &c.moment, &d.moment, to->moment);
}

static void veil_gather_rgba32f(const void *source, ptrdiff_t next_row, const uint32_t *n, uint32_t count,
                                pupil_veil_sums *sums)
{
    const float *v = source;
    for (uint32_t c = 0; c < count; v += 4 * (size_t)n[c], c++)
        veil_gather_pixels(v, next_row, n[c], &sums[c]);
}

static inline void scatter_channel(float *restrict v, uint32_t n, float direct, const float *restrict from,
                                   const float *restrict more, float part)
{
    for (uint32_t i = 0; i < n; i++)
        v[i] = direct * v[i] + (from[i] + part * more[i]);
}

static void scatter(pupil_planes *planes, uint32_t n, float direct, const pupil_scattered *s, float part)
{
    n = (n + 15) / 16 * 16; /* planes have room */
    scatter_channel(planes->r, n, direct, s->from[0], s->more[0], part);
    scatter_channel(planes->g, n, direct, s->from[1], s->more[1], part);
    scatter_channel(planes->b, n, direct, s->from[2], s->more[2], part);
}

#define VEIL_PIECES .veil_gather = veil_gather, .veil_gather_rgba32f = veil_gather_rgba32f, .scatter = scatter

#endif
