// A point for each pixel of the rows that are counted, twice: at the bin of its luminance, and of its brightest channel.

#define FIRST_STOP 95u // 127 - 32

void main()
{
    int pixel = gl_VertexID >> 1, group = pixel / metered_size.x, x = pixel - group * metered_size.x;
    int cell = (2 * x + 1) * 16 / (2 * metered_size.x), part = cell / (16 / plan.x);
    run r = run(1.0, 0, 0u, 0u, 0u);
    uvec2 bits = floatBitsToUint(meter_pixel(load_metered(ivec2(x, row_of(group))), r));
    uint bin = (gl_VertexID & 1) == 0 ? (bits.x >> 20) - FIRST_STOP * 8u
                                      : uint(BINS) + (bits.y >> 21) - FIRST_STOP * 4u;
    vec2 place = (vec2(float(bin), float(group * plan.x + part)) + 0.5) / vec2(BINS + PEAK_BINS, plan.z * plan.x);
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
