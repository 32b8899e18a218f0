// The frame is cut into regions, each in one column of the metering grid, in one of its rows and in one band: sixteen
// columns of up to REGION_ROWS rows of them. A region has one weight, which is applied by whoever sums regions up.

#define REGION_COLUMNS 16
#define REGION_ROWS 80

uniform ivec2 metered_size;           // pixels, or quads of a mosaic
uniform ivec4 region_row[REGION_ROWS]; // first row, the row after the last, row of the grid, band
uniform uvec4 weights[REGION_COLUMNS]; // by row of the grid: sixteen bytes

int first_column(int cell) // lib/core/rows.c: first_in_cell
{
    return (cell * metered_size.x + 7) / 16;
}

uint weight_of(ivec2 region)
{
    uvec4 row = weights[region_row[region.y].z];
    uint word = row[region.x >> 2];
    return word >> (8 * (region.x & 3)) & 255u;
}

// A region's sums in four words: the exponents, the fractions, and three counts below 2^20.
uvec4 pack_sums(int exponent, uint fraction, uint black, uint clipped, uint bad)
{
    return uvec4(uint(exponent), fraction, black | bad << 20, clipped | bad >> 12 << 20);
}
