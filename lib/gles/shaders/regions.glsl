// The frame is cut into regions, each in one row of the metering grid, in one band, and in one of its columns, or in
// four of them where their weights are the same. A region has one weight, which is applied when regions are summed up.

#define REGION_COLUMNS 16
#define REGION_ROWS    80

uniform ivec2 metered_size;           // pixels, or quads of a mosaic
uniform int cells_together;            // columns of the grid in one of regions: 1, 4
uniform ivec4 region_row[REGION_ROWS]; // first row, the row after the last, row of the grid, band
uniform uvec4 weights[REGION_COLUMNS]; // by row of the grid: sixteen bytes

int first_column(int region_x) // lib/core/rows.c: pupil_grid_first_in_cell
{
    return (region_x * cells_together * metered_size.x + 7) / 16;
}

uint weight_of(ivec2 region)
{
    int cell = region.x * cells_together;
    uvec4 row = weights[region_row[region.y].z];
    return row[cell >> 2] >> (8 * (cell & 3)) & 255u;
}

// A region's sums in four words: the exponents, the fractions, and three counts below 2^20.
uvec4 pack_sums(int exponent, uint fraction, uint black, uint clipped, uint bad)
{
    return uvec4(uint(exponent), fraction, black | bad << 20, clipped | bad >> 12 << 20);
}
