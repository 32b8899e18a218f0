// What a pixel counts as (pupil/stats.h).

#define CEILING   1073741824.0 // 2^30
#define BRIGHTEST 2147483648.0 // 2^31

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

uniform bool has_to_picture;
uniform mat3 to_picture; // from the input's primaries to the picture's

// As lib/kernels/pixels_to_linear.h: to_picture.
vec3 in_picture(vec3 rgb)
{
    bool bad = is_nan(rgb.r) || is_nan(rgb.g) || is_nan(rgb.b);
    rgb = to_picture * clamp(rgb, vec3(-BRIGHTEST), vec3(BRIGHTEST));
    return bad ? vec3(0.0) : max(rgb, vec3(0.0));
}
