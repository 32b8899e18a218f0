// Ordered dither: the same operations as lib/kernels/dither.h.

uniform bool dither;
uniform vec3 code_light; // lib/kernels/kernels.h: pupil_code_width, power, scale and least
uniform uint code_light_offset;

vec3 dithered(vec3 x, ivec2 at)
{
    int y = at.y, q = at.x ^ y;
    int order = (q & 1) << 5 | (y & 1) << 4 | (q & 2) << 2 | (y & 2) << 1 | (q & 4) >> 1 | (y & 4) >> 2;
    float threshold = (float(order) - 31.5) * (0.94 / 64.0);
    uvec3 bits = uvec3(vec3(floatBitsToUint(x)) * code_light.x) + code_light_offset;
    return max(x + threshold * max(uintBitsToFloat(bits) * code_light.y, vec3(code_light.z)), vec3(0.0));
}
