/* Scales the histogram of some rows (gles_bins.c) to one of all. */
#include "gles_private.h"

#include "base/numeric.h"

/* The running sums of the bins are scaled, so that the total is exact. If the rows had no weight, one bin gets all of
 * it. */
static void scale_bins(uint64_t *bin, int count, uint64_t wanted, int otherwise)
{
    uint64_t total = 0, sum = 0, before = 0;
    for (int i = 0; i < count; i++)
        total += bin[i];
    if (total == wanted)
        return;
    if (!total) {
        bin[otherwise] = wanted;
        return;
    }
    for (int i = 0; i < count; i++) {
        sum += bin[i];
        const uint64_t scaled = (uint64_t)((double)sum * ((double)wanted / (double)total));
        const uint64_t now = sum == total || scaled > wanted ? wanted : scaled;
        bin[i] = now - before;
        before = now;
    }
}

static int bin_of(double light, int bins_per_stop)
{
    const int bits = bins_per_stop == PUPIL_HISTOGRAM_BINS_PER_STOP ? 20 : 21;
    return (int)(pupil_bits_of_float((float)light) >> bits) - (127 + PUPIL_HISTOGRAM_MIN_EV) * bins_per_stop;
}

void pupil_gles_bins_scale(pupil_stats *stats)
{
    if (!stats->weight)
        return;
    const double mean = ((double)stats->log2_sum + (double)stats->log2_frac * 0x1p-40) / (double)stats->weight;
    scale_bins(stats->bin, PUPIL_HISTOGRAM_BINS, stats->weight,
               bin_of(pupil_exp2(mean), PUPIL_HISTOGRAM_BINS_PER_STOP));
    scale_bins(stats->peak_bin, PUPIL_PEAK_BINS, stats->weight, bin_of((double)stats->peak, PUPIL_PEAK_BINS_PER_STOP));
}
