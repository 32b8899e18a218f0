// Each region in 8 x 4 parts, a texel for each: every eighth pixel of every fourth row. reduce.frag sums the parts up.

layout(location = 0) out uvec4 part_sums;

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy), region = texel / ivec2(8, 4), part = texel - region * ivec2(8, 4);
    ivec4 row = region_row[region.y];
    int end_x = weight_of(region) > 0u ? first_column(region.x + 1) : 0;
    run r = run(1.0, 0, 0u, 0u, 0u);
    for (int y = row.x + part.y; y < row.y; y += 4)
        for (int x = first_column(region.x) + part.x; x < end_x; x += 8)
            meter_pixel(load_metered(ivec2(x, y)), r);
    // a part has fewer than 2^14 pixels
    part_sums = uvec4(uint(r.exponent), fraction_of(r), r.black | r.clipped << 16, r.bad);
}
