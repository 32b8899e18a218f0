/* The usual metering patterns as weights of the grid. */
#include "pupil/config.h"

#define SIDE PUPIL_GRID_SIDE

int pupil_metering_uniform(pupil_config *config)
{
    if (!config)
        return PUPIL_ERR_NULL;
    for (int i = 0; i < SIDE * SIDE; i++)
        config->weight[i / SIDE][i % SIDE] = 1;
    return PUPIL_OK;
}

/* The square of the distance from the middle, in half cells. */
static int distance_squared(int row, int column)
{
    int dx = 2 * column + 1 - SIDE;
    int dy = 2 * row + 1 - SIDE;
    return dx * dx + dy * dy;
}

int pupil_metering_centre(pupil_config *config)
{
    if (!config)
        return PUPIL_ERR_NULL;
    /* (1 - r^2)^2 between the innermost cells (r = 0) and the corners (r = 1): a bell without a transcendental */
    const double nearest = distance_squared(SIDE / 2, SIDE / 2);
    const double farthest = distance_squared(0, 0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double r2 = (distance_squared(i / SIDE, i % SIDE) - nearest) / (farthest - nearest);
        config->weight[i / SIDE][i % SIDE] = (uint8_t)(16.5 + 239.0 * (1.0 - r2) * (1.0 - r2));
    }
    return PUPIL_OK;
}

int pupil_metering_spot(pupil_config *config)
{
    enum { FINE = 16 }; /* samples a side in each cell, to weigh the cells that the rim cuts */
    if (!config)
        return PUPIL_ERR_NULL;
    for (int i = 0; i < SIDE * SIDE; i++) {
        int inside = 0;
        for (int k = 0; k < FINE * FINE; k++) {
            double dx = i % SIDE + (k % FINE + 0.5) / FINE - SIDE / 2;
            double dy = i / SIDE + (k / FINE + 0.5) / FINE - SIDE / 2;
            inside += dx * dx + dy * dy <= 0.05 * SIDE * SIDE / 3.14159265358979; /* pi r^2 = 5 % of the area */
        }
        config->weight[i / SIDE][i % SIDE] = (uint8_t)(inside * 255 / (FINE * FINE));
    }
    return PUPIL_OK;
}

/* How much of cell `i` the interval [from, to) in cells covers. */
static double covered(int i, double from, double to)
{
    double low = from > i ? from : i;
    double high = to < i + 1 ? to : i + 1;
    return high > low ? high - low : 0.0;
}

int pupil_metering_roi(pupil_config *config, double x, double y, double width, double height)
{
    if (!config)
        return PUPIL_ERR_NULL;
    /* a hair of tolerance, so that 0.7 + 0.3 is not outside */
    if (!(x >= 0.0 && y >= 0.0 && x < 1.0 && y < 1.0 && width > 0.0 && height > 0.0 && x + width <= 1.0 + 1e-9 &&
          y + height <= 1.0 + 1e-9))
        return PUPIL_ERR_VALUE;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double share =
            covered(i % SIDE, x * SIDE, (x + width) * SIDE) * covered(i / SIDE, y * SIDE, (y + height) * SIDE);
        /* a region smaller than a cell still counts: its cells get at least 1 */
        config->weight[i / SIDE][i % SIDE] = (uint8_t)(share > 0.0 ? 1.0 + 254.0 * share : 0.0);
    }
    return PUPIL_OK;
}
