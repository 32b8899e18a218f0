// The level, from the columns' sums and the level before.

uniform usampler2D columns, state_before;
layout(location = 0) out uvec4 state;

void main()
{
    uvec2 log2_sum = uvec2(0u), weight_sum = uvec2(0u);
    for (int i = 0; i < REGION_COLUMNS; i++) {
        uvec4 sums = texelFetch(columns, ivec2(i, 0), 0);
        log2_sum = add(log2_sum, sums.xy);
        weight_sum = add(weight_sum, sums.zw);
    }
    state = adapt(texelFetch(state_before, ivec2(0), 0), log2_sum, weight_sum);
}
