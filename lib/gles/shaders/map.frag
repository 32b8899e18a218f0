// Reinhard's operator by luminance, fitted to the display's gamut, encoded to 8 bits (pupil/pupil.h: pupil_curve). The
// same steps as lib/kernels/scalar.c: tone and encode.

uniform float inverse_white_squared;
uniform highp usampler2D encoder; // lib/kernels/kernels.h: pupil_encoder, 256 cells a row
uniform uint encoder_base;
uniform ivec2 picture_size;
#ifdef VEIL
uniform highp sampler2D veil; // pupil/veil.h: 65 x 65 nodes
uniform float direct;
#endif
#ifdef SCALED
uniform vec4 turn; // from the target's pixels to the picture's: rows of a matrix, and a shift
uniform vec2 shift;
#else
uniform ivec4 turn;
uniform ivec2 shift;
#endif

uniform float knot_scale;  // pupil/pupil.h: pupil_curve; below 0: Reinhard's
uniform float knot_levels; // 0: all
uniform vec4 knots[32];

flat in float scale;
layout(location = 0) out vec4 display;

float knot_at(uint k)
{
    return knots[k >> 2][k & 3u];
}

// What a pixel of luminance y is multiplied by.
float gain_of(float y)
{
    float u = scale * y;
    if (knot_scale < 0.0)
        return scale * ((1.0 + u * inverse_white_squared) / (1.0 + u));
    float t = max(knot_scale * y, 1.0);
    uint bits = min(floatBitsToUint(t), 0x476fffffu), k = (bits >> 20) - 0x3f8u; // lib/kernels/kernels.h: KNOT_LAST
    float root = knot_at(k) + float(bits & 0xfffffu) * (1.0 / 1048576.0) * (knot_at(k + 1u) - knot_at(k));
    if (knot_levels > 0.0)
        root = min(floor(root * knot_levels), knot_levels - 1.0) * (1.0 / (knot_levels - 1.0));
    return knot_scale * (root * root / t);
}

vec3 tone(vec3 rgb)
{
    float l = luminance(rgb), y = l > 0.0 ? min(l, CEILING) : 0.0, s = gain_of(y);
    if (is_nan(l))
        return vec3(0.0);
    rgb = min(mix(vec3(0.0), rgb, greaterThan(rgb, vec3(0.0))), vec3(BRIGHTEST)) * s;
    float grey = y * s, m = largest(rgb), knee = gamut > 0.0 ? GAMUT_KNEE : 1.0;
    if (!(m > knee + (1.0 - knee) * grey))
        return rgb;
    return grey < 1.0 ? fit_colour(rgb, grey) : vec3(1.0);
}

#ifdef VEIL
// Bilinear between the nodes around a pixel: lib/veil/veil_map.c, find_row and find_ramps.
vec3 veiled(vec3 rgb, ivec2 at)
{
    vec2 place = vec2(2 * at + 1) * 64.0 / vec2(2 * picture_size);
    ivec2 cell = ivec2(place);
    vec2 part = place - vec2(cell);
    vec3 upper = mix(texelFetch(veil, cell, 0).rgb, texelFetch(veil, cell + ivec2(1, 0), 0).rgb, part.x);
    vec3 lower = mix(texelFetch(veil, cell + ivec2(0, 1), 0).rgb, texelFetch(veil, cell + 1, 0).rgb, part.x);
    return direct * rgb + mix(upper, lower, part.y);
}
#endif

float encode(float x)
{
    float lowest = uintBitsToFloat(encoder_base);
    uint bits = floatBitsToUint(x > lowest ? min(x, 1.0) : lowest);
    int i = int((bits - encoder_base) >> 16);
    return float((texelFetch(encoder, ivec2(i & 255, i >> 8), 0).r + (bits & 0xffffu)) >> 16);
}

// The picture's pixel as codes. Those that are interpolated are not dithered.
vec4 codes_at(ivec2 at)
{
    vec3 rgb = load(at);
#ifdef VEIL
    rgb = veiled(rgb, at);
#endif
    rgb = tone(has_to_picture ? in_picture(rgb) : rgb);
#ifndef SCALED
    if (dither)
        rgb = dithered(rgb, at);
#endif
    vec4 codes = vec4(encode(rgb.r), encode(rgb.g), encode(rgb.b), 255.0);
#ifdef ALPHA
    codes.a = opacity(at);
#endif
    return codes;
}

void main()
{
#ifdef SCALED
    vec2 place = vec2(dot(turn.xy, gl_FragCoord.xy), dot(turn.zw, gl_FragCoord.xy)) + shift - 0.5;
    ivec2 first = ivec2(floor(place)), last = picture_size - 1;
    vec2 part = place - floor(place);
    ivec2 low = clamp(first, ivec2(0), last), high = clamp(first + 1, ivec2(0), last);
    vec4 upper = mix(codes_at(low), codes_at(ivec2(high.x, low.y)), part.x);
    vec4 lower = mix(codes_at(ivec2(low.x, high.y)), codes_at(high), part.x);
    display = mix(upper, lower, part.y) * (1.0 / 255.0);
#else
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 at = ivec2(turn.x * here.x + turn.y * here.y, turn.z * here.x + turn.w * here.y) + shift;
    display = codes_at(at) * (1.0 / 255.0);
#endif
}
