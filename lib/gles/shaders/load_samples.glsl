// Grey and mosaics, one sample a pixel, as linear light (load.glsl goes before).

#if defined(LOAD_GREY) || defined(LOAD_MOSAIC)
#ifdef SAMPLES_8
uint sample_at(ivec2 at)
{
    return uint(texelFetch(frame, at, 0).r * 255.0 + 0.5);
}
#endif

#ifdef SAMPLES_16
uniform int sample_shift;

uint sample_at(ivec2 at)
{
    return texelFetch(frame, at, 0).r >> sample_shift;
}
#endif

#ifdef SAMPLES_NORMALIZED_16
uniform int sample_shift;

uint sample_at(ivec2 at)
{
    return uint(texelFetch(frame, at, 0).r * 65535.0 + 0.5) >> sample_shift;
}
#endif

#if defined(SAMPLES_10P) || defined(SAMPLES_12P)
uint byte_at(ivec2 at)
{
    return uint(texelFetch(frame, at, 0).r * 255.0 + 0.5);
}
#endif

// MIPI CSI-2: the upper eight bits of each sample of a group, then a byte of what they lack, the first one lowest.
#ifdef SAMPLES_10P
uint sample_at(ivec2 at)
{
    int group = at.x / 4 * 5, which = at.x & 3;
    uint low = byte_at(ivec2(group + 4, at.y)) >> (2 * which) & 3u;
    return byte_at(ivec2(group + which, at.y)) << 2 | low;
}
#endif

#ifdef SAMPLES_12P
uint sample_at(ivec2 at)
{
    int group = at.x / 2 * 3, which = at.x & 1;
    uint low = byte_at(ivec2(group + 2, at.y)) >> (4 * which) & 15u;
    return byte_at(ivec2(group + which, at.y)) << 4 | low;
}
#endif
#endif

// Added up, four a pixel: codes, or the light of companded ones.
#ifdef KNEES
uniform int lines;
uniform vec3 line[9]; // lib/kernels/kernels.h: pupil_line

#define VALUE  float
#define VALUES vec3

float value_at(ivec2 at)
{
    float code = float(sample_at(at));
    vec3 on = line[0];
    for (int k = 1; k < lines; k++)
        on = code >= line[k].x ? line[k] : on;
    return on.y + (code - on.x) * on.z;
}
#elif defined(LOAD_GREY) || defined(LOAD_MOSAIC)
#define VALUE  uint
#define VALUES uvec3
#define value_at sample_at
#endif

#ifdef LOAD_GREY
uniform vec2 grey; // zero, unit

vec3 load(ivec2 at)
{
    float v = (float(value_at(at)) - grey.x) * grey.y;
#ifdef GREY_LIGHT
    v = light_of(v * light_top);
#endif
    return vec3(v);
}
#endif

#ifdef LOAD_MOSAIC
uniform vec2 mosaic;  // zero4, most
uniform vec3 unit4;
uniform ivec2 red_at; // which pixel of a quad is red
#ifdef MATRIX
uniform mat3 camera_matrix;
#endif

// Four times each channel's sample, or the sum of four, to balanced light.
vec3 develop(VALUES sum4)
{
    vec3 v = (vec3(sum4) - mosaic.x) * unit4;
    return min(v, vec3(mosaic.y));
}

vec3 load_quad(ivec2 quad)
{
    ivec2 at = 2 * quad, blue_at = 1 - red_at;
    VALUE greens = value_at(at + ivec2(blue_at.x, red_at.y)) + value_at(at + ivec2(red_at.x, blue_at.y));
    return develop(VALUES(VALUE(4) * value_at(at + red_at), VALUE(2) * greens, VALUE(4) * value_at(at + blue_at)));
}

// Beyond the frame's edges the picture is mirrored.
VALUE mirrored(ivec2 at)
{
    at = abs(at);
    return value_at(min(at, 2 * (frame_size - 1) - at));
}

// Bilinear: the mean of the neighbours of a colour, two or four.
vec3 load_bilinear(ivec2 at)
{
    ivec2 own = (at & 1) ^ red_at; // 0: a column, a row, of red samples
    VALUE here = VALUE(4) * value_at(at);
    VALUE beside = mirrored(at - ivec2(1, 0)) + mirrored(at + ivec2(1, 0));
    VALUE above_below = mirrored(at - ivec2(0, 1)) + mirrored(at + ivec2(0, 1));
    if (own.x != own.y) // green
        return develop(own.y == 0 ? VALUES(VALUE(2) * beside, here, VALUE(2) * above_below)
                                  : VALUES(VALUE(2) * above_below, here, VALUE(2) * beside));
    VALUE corners = mirrored(at + ivec2(-1, -1)) + mirrored(at + ivec2(1, -1)) + mirrored(at + ivec2(-1, 1)) +
                   mirrored(at + ivec2(1, 1));
    VALUE cross4 = beside + above_below;
    return develop(own.x == 0 ? VALUES(here, cross4, corners) : VALUES(corners, cross4, here));
}

vec3 load(ivec2 at)
{
#ifdef QUADS
    vec3 rgb = load_quad(at);
#else
    vec3 rgb = load_bilinear(at);
#endif
#ifdef MATRIX
    rgb = camera_matrix * rgb;
#endif
    return rgb;
}
#endif
