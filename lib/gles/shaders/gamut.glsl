// Moves a colour beyond the display's gamut into it: the same operations as lib/kernels/gamut.h.

#define GAMUT_KNEE 0.85

uniform float gamut;
uniform mat3 cones_of_rgb, rgb_of_cones; // lib/kernels/kernels.h: pupil_cones

vec3 cube_root(vec3 x)
{
    uvec3 third = uvec3(vec3(floatBitsToUint(x)) * 0.333333343);
    vec3 y = uintBitsToFloat(0x548e0000u - third), c = x * y * y * y;
    y *= 1.73338342 - c * (1.19775796 - 0.472088337 * c);
    vec3 root = x * y * y;
    return root * (5.0 / 3.0 - 2.0 / 3.0 * (root * y));
}

vec3 fit_colour(vec3 rgb, float grey)
{
    float knee = gamut > 0.0 ? GAMUT_KNEE : 1.0, room = 1.0 - grey, limit = knee + (1.0 - knee) * grey;
    float m = largest(rgb), most = min(limit + (m - limit) * room / (room + gamut * (m - knee * room)), 1.0);
    float excess = (m - most) / (most * max(m - grey, 5.96046448e-8)); // 2^-24
    float part = min(grey * grey * grey * excess, 1.0);

    vec3 cone = cones_of_rgb * rgb, root = cube_root(cone / cone.g);
    root += part * (1.0 - root);
    rgb = rgb_of_cones * (root * root * root);
    return max(rgb * (most / largest(rgb)), vec3(0.0));
}
