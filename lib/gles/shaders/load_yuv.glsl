// Y'CbCr as linear light (load.glsl goes before).

#if defined(LOAD_YUYV) || defined(LOAD_PLANES)
uniform vec3 yuv_luma;   // y_zero, y_unit, and the code of no colour
uniform vec4 yuv_chroma; // red_v, green_u, green_v, blue_u

vec3 load_yuv(float luma, vec2 uv)
{
    float y = (luma - yuv_luma.x) * yuv_luma.y, u = uv.x - yuv_luma.z, v = uv.y - yuv_luma.z;
    return light_of_codes(vec3(y + yuv_chroma.x * v, y + yuv_chroma.y * u + yuv_chroma.z * v, y + yuv_chroma.w * u));
}

#ifdef SAMPLES_8
#define PLANE sampler2D
vec2 codes_at(sampler2D plane, ivec2 at)
{
    return floor(texelFetch(plane, at, 0).rg * 255.0 + 0.5);
}
#endif

#ifdef SAMPLES_16
#define PLANE usampler2D
uniform int sample_shift;

vec2 codes_at(usampler2D plane, ivec2 at)
{
    return vec2(texelFetch(plane, at, 0).rg >> sample_shift);
}
#endif

#ifdef SAMPLES_NORMALIZED_16
#define PLANE sampler2D
uniform int sample_shift;

vec2 codes_at(sampler2D plane, ivec2 at)
{
    return vec2(uvec2(texelFetch(plane, at, 0).rg * 65535.0 + 0.5) >> sample_shift);
}
#endif
#endif

#ifdef LOAD_YUYV
// A texel is (Y', Cb) in even columns and (Y', Cr) in odd ones.
vec3 load(ivec2 at)
{
    ivec2 pair = ivec2(at.x & ~1, at.y);
    vec2 uv = vec2(codes_at(frame, pair).g, codes_at(frame, pair + ivec2(1, 0)).g);
    return load_yuv(codes_at(frame, at).r, uv);
}
#endif

#ifdef LOAD_PLANES
uniform ivec2 chroma_shift; // from a pixel to its texel of the chroma
uniform PLANE chroma;
#ifdef CR_PLANE
uniform PLANE cr;
#endif

vec3 load(ivec2 at)
{
    ivec2 of_pair = at >> chroma_shift;
    vec2 uv = codes_at(chroma, of_pair);
#ifdef CR_PLANE
    uv.y = codes_at(cr, of_pair).r;
#endif
    return load_yuv(codes_at(frame, at).r, uv);
}
#endif
