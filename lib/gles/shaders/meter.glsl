// Metering: the sums of a region's pixels. Sums are integers, so that the order in which a GPU works cannot matter.

uniform float floor_luminance, clip_value;

float clamp_luminance(float l)
{
    return l > floor_luminance ? min(l, CEILING) : floor_luminance;
}

// The sum of log2 of some pixels = exponent + log2 product.
struct run {
    float product; // 1..2
    int exponent;
    uint black, clipped, bad;
};

// The brightest channel, which a white point follows: in the picture's primaries, except of mosaics.
float brightest(vec3 rgb)
{
#if defined(HISTOGRAM) && !defined(LOAD_MOSAIC)
    rgb = has_to_picture ? in_picture(rgb) : rgb;
#endif
    return largest(rgb);
}

// L of a pixel, clamped, and its brightest channel, clamped, for the histogram.
vec2 meter_pixel(vec3 rgb, inout run r)
{
    float l = luminance(rgb);
    bool nan = is_nan(l), finite = (floatBitsToUint(l) & 0x7f800000u) != 0x7f800000u;
    float counted = nan ? floor_luminance : clamp_luminance(l);
    r.bad += uint(!finite);
    r.black += uint(finite && l <= floor_luminance);
    r.clipped += uint(finite && (rgb.r >= clip_value || rgb.g >= clip_value || rgb.b >= clip_value));

    uint bits = floatBitsToUint(r.product * counted);
    r.exponent += int(bits >> 23) - 127;
    r.product = uintBitsToFloat((bits & 0x007fffffu) | 0x3f800000u);
    return vec2(counted, nan ? floor_luminance : clamp_luminance(brightest(rgb)));
}

// log2 of the product in 2^-24. That of 1 may come out below 0 (by 2^-21, says GLSL), of which there is no uint.
uint fraction_of(run r)
{
    return uint(max(log2(r.product), 0.0) * 16777216.0 + 0.5);
}

vec3 load_metered(ivec2 at)
{
#ifdef LOAD_MOSAIC
    return load_quad(at);
#else
    return load(at);
#endif
}
