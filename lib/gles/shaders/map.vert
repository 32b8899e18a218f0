// One triangle that covers the viewport; and the scale, once a frame.

flat out float scale;

#ifdef LEVEL_HERE
uniform int scale_base; // log2 of the key, the compensation and the frame's exposure, in 2^-24
#ifdef STATE_IN_BUFFER
layout(std140, binding = 0) uniform State {
    uvec4 state;
};
#else
uniform usampler2D adapted;
#endif

float scale_of_level()
{
#ifndef STATE_IN_BUFFER
    uvec4 state = texelFetch(adapted, ivec2(0), 0);
#endif
    if (state.z == 0u)
        return 1.0; // the key itself, before any light
    float about = (float(scale_base) - float(int(state.y))) * exp2(-24.0);
    if (abs(about) >= 60.0)
        return exp2(clamp(about, -60.0, 60.0));
    int exact = scale_base - int(state.y);
    return uintBitsToFloat(uint((exact >> 24) + 127) << 23) * exp2(float(exact & 0xffffff) * exp2(-24.0));
}
#else
uniform float given_scale;
#endif

void main()
{
#ifdef LEVEL_HERE
    scale = scale_of_level();
#else
    scale = given_scale;
#endif
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
