// A frame's texels as linear light. Which of the parts below is compiled is said by one of
//     LOAD_FLOAT, LOAD_RGB16, LOAD_RGB8, LOAD_CODED_RGB, LOAD_YUYV, LOAD_NV12, LOAD_GREY, LOAD_MOSAIC
// and for grey and mosaics by one of SAMPLES_8, SAMPLES_16, SAMPLES_NORMALIZED_16, SAMPLES_10P, SAMPLES_12P. Every
// factor is the CPU's own (lib/kernels/kernels.h: pupil_coder, by the same names), and so are the tables of light.

#if defined(LOAD_RGB16) || defined(SAMPLES_16)
uniform usampler2D frame;
#elif defined(LOAD_CODED_RGB)
uniform samplerExternalOES frame;
#else
uniform sampler2D frame;
#endif
uniform ivec2 frame_size; // pixels

#if defined(LOAD_RGB8) || defined(LOAD_CODED_RGB) || defined(LOAD_YUYV) || defined(LOAD_NV12) || defined(GREY_LIGHT)
#define LIGHT
#ifdef LIGHT_LINEAR
float light_of(float code) // 0..255
{
    return (code > 0.0 ? min(code, 255.0) : 0.0) * (1.0 / 255.0);
}
#else
uniform sampler2D light; // of a code, and how much more the next one's is

float light_of(float code)
{
    code = code > 0.0 ? min(code, 255.0) : 0.0;
    float whole = floor(code);
    vec2 cell = texelFetch(light, ivec2(int(whole), 0), 0).rg;
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

// A normalised texel is its code / 255, rounded.
#if defined(LOAD_RGB8)
vec3 load(ivec2 at)
{
    return light_of_codes(floor(texelFetch(frame, at, 0).rgb * 255.0 + 0.5));
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
    return light_of_codes(texelFetch(frame, at, 0).rgb * 255.0);
}
#endif

// ---- Y'CbCr

#if defined(LOAD_YUYV) || defined(LOAD_NV12)
uniform vec2 yuv_luma;   // y_zero, y_unit
uniform vec4 yuv_chroma; // red_v, green_u, green_v, blue_u

vec3 load_yuv(vec3 texel)
{
    vec3 code = floor(texel * 255.0 + 0.5);
    float y = (code.x - yuv_luma.x) * yuv_luma.y, u = code.y - 128.0, v = code.z - 128.0;
    return light_of_codes(vec3(y + yuv_chroma.x * v, y + yuv_chroma.y * u + yuv_chroma.z * v, y + yuv_chroma.w * u));
}
#endif

#ifdef LOAD_YUYV
// A texel is (Y', Cb) in even columns and (Y', Cr) in odd ones.
vec3 load(ivec2 at)
{
    float y = texelFetch(frame, at, 0).r;
    ivec2 pair = ivec2(at.x & ~1, at.y);
    return load_yuv(vec3(y, texelFetch(frame, pair, 0).g, texelFetch(frame, pair + ivec2(1, 0), 0).g));
}
#endif

#ifdef LOAD_NV12
uniform sampler2D chroma;

vec3 load(ivec2 at)
{
    return load_yuv(vec3(texelFetch(frame, at, 0).r, texelFetch(chroma, at / 2, 0).rg));
}
#endif
