// Which rows the histogram of ES 3.0 counts: one of each `plan.y`, always the same, and not every n-th, so that no
// stripe meets them every time. A row of bins for each, or for each of its parts (lib/gles/gles_bins.c).

#define BINS      512
#define PEAK_BINS 256

uniform ivec4 plan; // parts of a row, rows for one that is counted, how many are counted, rows of regions

// Appleby's MurmurHash3: fmix32.
uint mixed(uint z)
{
    z *= 0x9e3779b9u;
    z = (z ^ (z >> 16)) * 0x85ebca6bu;
    z = (z ^ (z >> 13)) * 0xc2b2ae35u;
    return z ^ (z >> 16);
}

int row_of(int group)
{
    int first = group * plan.y, rows = min(plan.y, metered_size.y - first);
    return first + int(mixed(uint(group)) % uint(rows));
}
