// The rows of bins, each times its weight, as one: two bins of 64 bits a texel. In the second row the brightest channel of
// all, by parts (meter.frag).

uniform sampler2D bins;
uniform usampler2D parts;
layout(location = 0) out uvec4 counts;

uint weight_at(int y, int part)
{
    int cell = part * (16 / plan.x);
    uvec4 row = weights[(2 * y + 1) * 16 / (2 * metered_size.y)];
    return row[cell >> 2] >> (8 * (cell & 3)) & 255u;
}

uvec2 count_of(int bin)
{
    uvec2 sum = uvec2(0u);
    for (int group = 0; group < plan.z; group++)
        for (int part = 0; part < plan.x; part++) {
            float count = texelFetch(bins, ivec2(bin, group * plan.x + part), 0).r;
            if (count > 0.0)
                sum = add(sum, uvec2(uint(count) * weight_at(row_of(group), part), 0u));
        }
    return sum;
}

uint peak_of(int column)
{
    uint peak = 0u;
    for (int y = 0; y < plan.w * 4; y++)
        for (int x = 0; x < 8; x++)
            peak = max(peak, texelFetch(parts, ivec2(column * 8 + x, y), 0).w);
    return peak;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    if (at.y == 0)
        counts = uvec4(count_of(2 * at.x), count_of(2 * at.x + 1));
    else
        counts = uvec4(at.x < 16 ? peak_of(at.x) : 0u, 0u, 0u, 0u);
}
