// One group of sixteen: a column of regions each, then the level.

layout(local_size_x = 16) in;

layout(std430, binding = 1) buffer State {
    uvec4 state;
};
uniform int region_rows;

shared uvec4 column_sums[REGION_COLUMNS];

void main()
{
    int column = int(gl_LocalInvocationIndex);
    uvec2 log2_sum = uvec2(0u), weight_sum = uvec2(0u);
    for (int y = 0; y < region_rows && column * cells_together < REGION_COLUMNS; y++)
        weigh_region(ivec2(column, y), statistics.region[y * REGION_COLUMNS + column], log2_sum, weight_sum);
    column_sums[column] = uvec4(log2_sum, weight_sum);
    memoryBarrierShared();
    barrier();
    if (column != 0)
        return;
    for (int i = 1; i < REGION_COLUMNS; i++) {
        log2_sum = add(log2_sum, column_sums[i].xy);
        weight_sum = add(weight_sum, column_sums[i].zw);
    }
    state = adapt(state, log2_sum, weight_sum);
    statistics.level = state;
}
