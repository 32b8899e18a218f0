// Each region in 8 x 4 parts, a texel for each: every eighth pixel of every fourth row. reduce.frag sums the parts up.

layout(location = 0) out uvec4 part_sums;

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy), region = texel / ivec2(8, 4), part = texel - region * ivec2(8, 4);
    ivec4 row = region_row[region.y];
    int end_x = weight_of(region) > 0u ? first_column(region.x + 1) : 0;
    run r = run(1.0, 0, 0u, 0u, 0u);
    float peak = 0.0;
    for (int y = row.x + part.y; y < row.y; y += 4)
        for (int x = first_column(region.x) + part.x; x < end_x; x += 8)
            peak = max(peak, meter_pixel(load_metered(ivec2(x, y)), r).y);
    // a part has fewer than 2^14 pixels: counts have 14 bits, the exponents 21
    part_sums = uvec4(uint(r.exponent) << 10 | r.bad >> 4, fraction_of(r), r.black | r.clipped << 14 | r.bad << 28,
                      floatBitsToUint(peak));
}
