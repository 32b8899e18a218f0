/* How a frame is cut into regions for metering, and statistics from the regions' sums. */
#include "gles_private.h"

uint32_t pupil_gles_regions_make(uint32_t units_y, gles_region_row rows[GLES_REGION_ROWS])
{
    uint32_t count = 0;
    for (uint32_t y = 0; y < units_y; y++) {
        const int32_t grid_row = (int32_t)pupil_grid_cell_of(y, units_y), band = (int32_t)(y * PUPIL_BANDS / units_y);
        if (!count || rows[count - 1].grid_row != grid_row || rows[count - 1].band != band)
            rows[count++] = (gles_region_row){.first = (int32_t)y, .grid_row = grid_row, .band = band};
        rows[count - 1].end = (int32_t)y + 1;
    }
    return count;
}

uint32_t pupil_gles_regions_together(const gles_object *o)
{
    /* Groups of a compute shader end with a sum and a histogram of their own, so fewer are better, as long as they fill
     * a GPU: 316 of 128 do. A region's counts have 20 bits. ES 3.0 has neither groups nor their ends. */
    if (o->variant.version != PUPIL_GLES_ES31 || o->config.width / o->unit > 8192)
        return 1;
    for (int y = 0; y < PUPIL_GRID_SIDE; y++)
        for (int x = 0; x < PUPIL_GRID_SIDE; x++)
            if (o->settings.weight[y][x] != o->settings.weight[y][x & ~3])
                return 1;
    return 4;
}

/* One region, by the rules of lib/kernels/run.c: stats_add_run. */
static void add_region(const uint32_t words[4], uint32_t pixels, uint32_t weight, uint32_t band, pupil_stats *stats)
{
    const int64_t whole = (int64_t)(int32_t)words[0] + (words[1] >> 24);
    const uint64_t frac_q24 = words[1] & 0xffffff, low = stats->log2_frac + (frac_q24 << 16) * weight;
    stats->log2_sum += whole * (int64_t)weight + (int64_t)(low >> 40);
    stats->log2_frac = low & ((UINT64_C(1) << 40) - 1);
    stats->pixels += pixels;
    stats->weight += (uint64_t)pixels * weight;
    stats->black += words[2] & 0xfffff;
    stats->black_weight += (uint64_t)(words[2] & 0xfffff) * weight;
    stats->clipped += words[3] & 0xfffff;
    stats->bad += words[2] >> 20 | words[3] >> 20 << 12;
    stats->band_log2_sum[band] += whole * (1 << 24) + (int64_t)frac_q24;
    stats->band_pixels[band] += pixels;
}

void pupil_gles_regions_add_up(const gles_object *o, const gles_statistics *from, pupil_stats *stats)
{
    const uint32_t units_x = o->config.width / o->unit, together = o->cells_together;
    pupil_stats_clear(stats);
    for (uint32_t y = 0; y < o->region_rows; y++) {
        const gles_region_row *row = &o->region_row[y];
        for (uint32_t x = 0; x < GLES_REGION_COLUMNS / together; x++) {
            const uint32_t first = x * together, end = first + together;
            const uint32_t width = pupil_grid_first_in_cell(end, units_x) - pupil_grid_first_in_cell(first, units_x);
            const uint32_t pixels = width * (uint32_t)(row->end - row->first);
            const uint32_t weight = o->settings.weight[row->grid_row][first];
            if (pixels && weight)
                add_region(from->region[y][x], pixels, weight, (uint32_t)row->band, stats);
        }
    }
    stats->rows = stats->frame_height = o->config.height;
    stats->has_histogram = o->histogram;
    stats->code_light = o->code_light;
    if (!o->histogram)
        return;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
        stats->bin[i] = (uint64_t)from->bin[i][1] << 32 | from->bin[i][0];
    for (int i = 0; i < PUPIL_PEAK_BINS; i++) {
        const uint32_t *bin = from->bin[PUPIL_HISTOGRAM_BINS + i];
        stats->peak_bin[i] = (uint64_t)bin[1] << 32 | bin[0];
    }
    union {
        uint32_t bits;
        float value;
    } peak = {.bits = from->peak[0]};
    for (int i = 0; i < GLES_REGION_COLUMNS && o->variant.version == PUPIL_GLES_ES30; i++)
        peak.bits = from->peaks[i][0] > peak.bits ? from->peaks[i][0] : peak.bits; /* in the order of their bits */
    stats->peak = peak.value;
    if (o->variant.version == PUPIL_GLES_ES30)
        pupil_gles_bins_scale(stats);
}
