// A frame's texels as linear light. Which of the parts below is compiled is said by one of
//     LOAD_FLOAT, LOAD_RGB16, LOAD_RGB_CODES, LOAD_CODED_RGB, LOAD_YUYV, LOAD_PLANES, LOAD_GREY, LOAD_MOSAIC
// and for Y'CbCr, grey and mosaics by one of SAMPLES_8, SAMPLES_16, SAMPLES_NORMALIZED_16, SAMPLES_10P, SAMPLES_12P.
// Every factor is the CPU's own (lib/kernels/kernels.h: pupil_coder, by the same names), and so are the tables of
// light. Formats that differ only in the order of channels are put in order by the texture's swizzle.

#if defined(LOAD_RGB16) || defined(SAMPLES_16)
uniform usampler2D frame;
#elif defined(LOAD_CODED_RGB)
uniform samplerExternalOES frame;
#else
uniform sampler2D frame;
#endif
uniform ivec2 frame_size; // pixels

#if defined(LOAD_RGB_CODES) || defined(LOAD_CODED_RGB) || defined(LOAD_YUYV) || defined(LOAD_PLANES) || \
    defined(GREY_LIGHT)
#ifdef LIGHT_LINEAR
const float light_top = 255.0;

float light_of(float code)
{
    return (code > 0.0 ? min(code, light_top) : 0.0) * (1.0 / 255.0);
}
#else
uniform float light_top; // the last code
uniform sampler2D light; // of a code, and how much more the next one's is; 256 codes a row

float light_of(float code)
{
    code = code > 0.0 ? min(code, light_top) : 0.0;
    float whole = floor(code);
    int i = int(whole);
    vec2 cell = texelFetch(light, ivec2(i & 255, i >> 8), 0).rg;
    return cell.x + (code - whole) * cell.y;
}
#endif

vec3 light_of_codes(vec3 codes)
{
    return vec3(light_of(codes.r), light_of(codes.g), light_of(codes.b));
}
#endif

// ---- RGB

#ifdef LOAD_FLOAT
vec3 load(ivec2 at)
{
    return texelFetch(frame, at, 0).rgb;
}
#ifdef ALPHA
float opacity(ivec2 at) // a code, 0..255
{
    float a = texelFetch(frame, at, 0).a;
    a = (floatBitsToUint(a) & 0x7fffffffu) > 0x7f800000u ? 0.0 : a; // NaN
    return floor((a > 0.0 ? min(a, 1.0) : 0.0) * 255.0 + 0.5);
}
#endif
#endif

#ifdef LOAD_RGB16
vec3 load(ivec2 at)
{
    return vec3(texelFetch(frame, at, 0).rgb) * (1.0 / 65535.0);
}
#ifdef ALPHA
float opacity(ivec2 at)
{
    return float((texelFetch(frame, at, 0).a + 128u) / 257u);
}
#endif
#endif

// A normalised texel is its code / 255 or / 1023, rounded.
#ifdef LOAD_RGB_CODES
uniform vec2 rgb_codes; // the largest code, and from a code to one of the table

vec3 load(ivec2 at)
{
    return light_of_codes(floor(texelFetch(frame, at, 0).rgb * rgb_codes.x + 0.5) * rgb_codes.y);
}
#ifdef ALPHA
float opacity(ivec2 at)
{
    return floor(texelFetch(frame, at, 0).a * 255.0 + 0.5);
}
#endif
#endif

// An external texture's colour may be finer than its 8 bits.
#ifdef LOAD_CODED_RGB
vec3 load(ivec2 at)
{
    return light_of_codes(texelFetch(frame, at, 0).rgb * light_top);
}
#endif
