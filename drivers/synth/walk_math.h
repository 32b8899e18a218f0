/* drivers/synth/walk_math.h: the arithmetic of the synthetic scene. Only + - * / and sqrtf on binary32, all of which
 * IEEE 754 rounds in one way: so that every machine renders the same bits (compile with -ffp-contract=off).
 */
#ifndef PUPIL_DRIVERS_SYNTH_WALK_MATH_H
#define PUPIL_DRIVERS_SYNTH_WALK_MATH_H

#include <math.h>
#include <stdint.h>

typedef struct v3 {
    float x, y, z;
} v3;

static inline v3 vec(float x, float y, float z)
{
    v3 v = {x, y, z};
    return v;
}

static inline v3 add(v3 a, v3 b)
{
    return vec(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline v3 sub(v3 a, v3 b)
{
    return vec(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline v3 mul(v3 a, v3 b)
{
    return vec(a.x * b.x, a.y * b.y, a.z * b.z);
}

static inline v3 times(v3 a, float s)
{
    return vec(a.x * s, a.y * s, a.z * s);
}

static inline float dot(v3 a, v3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float clamp01(float x)
{
    return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f;
}

static inline float lerp(float a, float b, float t)
{
    return a + (b - a) * t;
}

static inline v3 mix(v3 a, v3 b, float t)
{
    return vec(lerp(a.x, b.x, t), lerp(a.y, b.y, t), lerp(a.z, b.z, t));
}

/* From 0 at a to 1 at b with level ends. */
static inline float ramp(float a, float b, float x)
{
    float t = clamp01((x - a) / (b - a));
    return t * t * (3.0f - 2.0f * t);
}

/* 1 inside [a, b], 0 outside, with edges `soft` wide on either side. */
static inline float band(float a, float b, float soft, float x)
{
    return ramp(a - soft, a + soft, x) * (1.0f - ramp(b - soft, b + soft, x));
}

/* Rounds down. |x| stays far below 2^31 in this scene. */
static inline int32_t floor_int(float x)
{
    int32_t i = (int32_t)x;
    return i - (x < (float)i);
}

/* A wave of period 1 made of parabolas: 0 at 0, 1 at 1/4, -1 at 3/4, within 0.06 of sin(2 pi x). */
static inline float wave(float x)
{
    float f = x - (float)floor_int(x);
    return f < 0.5f ? 8.0f * f * (1.0f - 2.0f * f) : -8.0f * (f - 0.5f) * (2.0f - 2.0f * f);
}

/* A random number in [0, 1) for a point of the integer lattice: the mixing steps of MurmurHash3 (Appleby). */
static inline float lattice(int32_t x, int32_t y)
{
    uint32_t h = (uint32_t)x * UINT32_C(0x9e3779b1) ^ (uint32_t)y * UINT32_C(0x85ebca77);
    h ^= h >> 16;
    h *= UINT32_C(0x85ebca6b);
    h ^= h >> 13;
    h *= UINT32_C(0xc2b2ae35);
    h ^= h >> 16;
    return (float)(h >> 8) * 0x1p-24f;
}

/* Smooth noise in [0, 1): the lattice, interpolated. */
static inline float noise(float x, float y)
{
    int32_t ix = floor_int(x), iy = floor_int(y);
    float fx = x - (float)ix, fy = y - (float)iy;
    float sx = fx * fx * (3.0f - 2.0f * fx), sy = fy * fy * (3.0f - 2.0f * fy);
    return lerp(lerp(lattice(ix, iy), lattice(ix + 1, iy), sx), lerp(lattice(ix, iy + 1), lattice(ix + 1, iy + 1), sx),
                sy);
}

#endif
