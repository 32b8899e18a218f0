// Sums the 8 x 4 parts of each region that meter.frag wrote.

uniform usampler2D parts;
layout(location = 0) out uvec4 region_sums;

void main()
{
    ivec2 first = ivec2(gl_FragCoord.xy) * ivec2(8, 4);
    int exponent = 0;
    uint fraction = 0u, black = 0u, clipped = 0u, bad = 0u;
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 8; x++) {
            uvec4 sums = texelFetch(parts, first + ivec2(x, y), 0);
            exponent += int(sums.x) >> 10;
            fraction += sums.y;
            black += sums.z & 0x3fffu;
            clipped += sums.z >> 14 & 0x3fffu;
            bad += (sums.x & 1023u) << 4 | sums.z >> 28;
        }
    region_sums = pack_sums(exponent, fraction, black, clipped, bad);
}
