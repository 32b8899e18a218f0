// A column of regions: the sums that adapt.frag adds up.

uniform usampler2D regions;
uniform int region_rows;
layout(location = 0) out uvec4 column_sums;

void main()
{
    int column = int(gl_FragCoord.x);
    uvec2 log2_sum = uvec2(0u), weight_sum = uvec2(0u);
    for (int y = 0; y < region_rows; y++)
        weigh_region(ivec2(column, y), texelFetch(regions, ivec2(column, y), 0), log2_sum, weight_sum);
    column_sums = uvec4(log2_sum, weight_sum);
}
