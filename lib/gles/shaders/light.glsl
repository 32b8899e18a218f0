// What a pixel counts as (pupil/stats.h).

#define CEILING 1073741824.0 // 2^30

uniform vec3 luma;

float luminance(vec3 rgb)
{
    return luma.r * rgb.r + luma.g * rgb.g + luma.b * rgb.b;
}

// By its bits: a compiler may take x != x for false.
bool is_nan(float x)
{
    return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u;
}

float largest(vec3 v)
{
    return max(max(v.r, v.g), v.b);
}
