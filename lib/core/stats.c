#include "object.h"

#include "base/numeric.h"
#include "base/versioned.h"
#include "core/read.h"

/* Highlights and the white point are those of at least this share of a frame: of less, only a few pixels of a sampled
 * histogram would decide, and a small object that moves would flicker. */
#define LEAST_SEEN 0.125

#define FIRST_BYTES PUPIL_FIRST_BYTES(pupil_stats, band_pixels)

static size_t bytes_of(const pupil_stats *stats)
{
    return stats->size_bytes ? stats->size_bytes : FIRST_BYTES;
}

static uint64_t black_weight_of(const pupil_stats *stats)
{
    return bytes_of(stats) >= sizeof *stats ? stats->black_weight : 0;
}

int pupil_stats_check_bytes(const pupil_stats *stats)
{
    const char *fault = pupil_versioned_fault(stats, bytes_of(stats), sizeof *stats, FIRST_BYTES);
    return fault ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK;
}

void pupil_stats_clear_sized(pupil_stats *stats, size_t stats_bytes)
{
    if (!stats || stats_bytes < sizeof stats->size_bytes)
        return;
    __builtin_memset(stats, 0, stats_bytes);
    stats->size_bytes = (uint32_t)stats_bytes;
}

int pupil_stats_add(pupil_stats *sum, const pupil_stats *more)
{
    if (!sum || !more)
        return PUPIL_ERR_NULL;
    int error = pupil_stats_check(sum);
    if (!error)
        error = pupil_stats_check(more);
    if (error)
        return error;
    if (bytes_of(more) > bytes_of(sum) && pupil_versioned_fault(more, bytes_of(more), bytes_of(sum), FIRST_BYTES))
        return PUPIL_ERR_SIZE_BYTES; /* more has a field set that sum has no room for */
    if (sum->rows && more->rows &&
        (sum->frame_height != more->frame_height || sum->has_histogram != more->has_histogram ||
         sum->rows > sum->frame_height - more->rows))
        return PUPIL_ERR_STATS;
    if (!more->rows)
        return PUPIL_OK;

    uint64_t frac = sum->log2_frac + more->log2_frac;
    sum->log2_sum += more->log2_sum + (int64_t)(frac >> 40);
    sum->log2_frac = frac & (PUPIL_Q40_ONE - 1);
    sum->pixels += more->pixels;
    sum->weight += more->weight;
    sum->black += more->black;
    sum->clipped += more->clipped;
    sum->bad += more->bad;
    sum->rows += more->rows;
    sum->frame_height = more->frame_height;
    sum->has_histogram = more->has_histogram;
    sum->code_light = more->code_light > sum->code_light ? more->code_light : sum->code_light;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
        sum->bin[i] += more->bin[i];
    for (int i = 0; i < PUPIL_PEAK_BINS; i++)
        sum->peak_bin[i] += more->peak_bin[i];
    sum->peak = more->peak > sum->peak ? more->peak : sum->peak;
    for (int i = 0; i < 3; i++)
        sum->channel_sum[i] += more->channel_sum[i];
    sum->channel_quads += more->channel_quads;
    for (int i = 0; i < PUPIL_BANDS; i++) {
        sum->band_log2_sum[i] += more->band_log2_sum[i];
        sum->band_pixels[i] += more->band_pixels[i];
    }
    if (bytes_of(sum) >= sizeof *sum)
        sum->black_weight += black_weight_of(more);
    return PUPIL_OK;
}

/* Without a branch, so that it becomes vectors: high, the sum of the upper halves, shows that total did not
 * overflow. */
static int bins_add_up(const uint64_t *bin, int count, uint64_t wanted)
{
    uint64_t total = 0, high = 0;
    for (int i = 0; i < count; i++) {
        total += bin[i];
        high += bin[i] >> 32;
    }
    return total == wanted && high <= wanted >> 32;
}

static uint64_t counted_weight(const pupil_stats *s)
{
    uint64_t total = 0;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
        total += s->bin[i];
    return total;
}

int pupil_stats_are_counted(const pupil_stats *s)
{
    return s->has_histogram && counted_weight(s) > 0;
}

/* Bins that add up to the weight (or none at all), bands that hold what their pixels can: no later sum overflows.
 * Statistics of some of a frame's rows may have a counted row that represents rows elsewhere, or no counted row. */
static int bins_and_bands_fit(const pupil_stats *s)
{
    const uint64_t limit = s->weight * PUPIL_MOST_STEP; /* no overflow: counts_fit */
    uint64_t wanted = s->has_histogram ? s->weight : 0, pixels = 0;
    if (s->has_histogram && s->rows < s->frame_height) {
        wanted = counted_weight(s);
        wanted = wanted < limit ? wanted : limit;
        if ((wanted > 0) != (s->peak > 0.0f))
            return 0;
    }
    for (int i = 0; i < PUPIL_BANDS; i++) {
        const int64_t most = (int64_t)s->band_pixels[i] * (32 * (INT64_C(1) << 24));
        if (s->band_log2_sum[i] > most || s->band_log2_sum[i] < -most)
            return 0;
        pixels += s->band_pixels[i];
    }
    return pixels <= s->pixels && bins_add_up(s->bin, PUPIL_HISTOGRAM_BINS, wanted) &&
           bins_add_up(s->peak_bin, PUPIL_PEAK_BINS, wanted);
}

/* Counts that are no larger than what they are counted from. */
static int counts_fit(const pupil_stats *s)
{
    const uint64_t limit = UINT64_C(1) << 56; /* far above any frame (2^36), far below overflow */
    return s->weight <= limit && s->pixels <= s->weight && s->black <= s->pixels && black_weight_of(s) <= s->weight &&
           s->clipped <= s->pixels && s->bad <= s->pixels && s->channel_quads <= s->pixels &&
           s->rows <= s->frame_height && s->frame_height <= PUPIL_MAX_SIDE_PX && (s->rows || !s->pixels) &&
           s->has_histogram <= 1;
}

/* A sum of log2 that pixels between 2^-32 and 2^32 can have; 0 where nothing was weighed. */
static int log2_fits(const pupil_stats *s)
{
    const int64_t most = (int64_t)s->weight * 32; /* no overflow: counts_fit */
    return s->log2_frac < (uint64_t)PUPIL_Q40_ONE && s->log2_sum <= most && s->log2_sum >= -most &&
           (s->weight || !s->log2_frac);
}

static int channels_fit(const pupil_stats *s)
{
    const int64_t most = (int64_t)(s->channel_quads << 18); /* four samples of 16 bits */
    if (s->channel_quads >> 44)                             /* 2^62 and more: its negative, too, has room */
        return 0;
    for (int i = 0; i < 3; i++)
        if (s->channel_sum[i] > most || s->channel_sum[i] < -most)
            return 0;
    return 1;
}

/* There is a brightest channel wherever there are bins. False for NaN. */
static int peak_fits(const pupil_stats *s)
{
    if (!s->has_histogram || !s->weight || (s->rows < s->frame_height && s->peak == 0.0f))
        return s->peak == 0.0f;
    return s->peak >= 0x1p-32f && s->peak <= PUPIL_CEILING;
}

int pupil_stats_check_sums(const pupil_stats *s)
{
    if (pupil_stats_check_bytes(s))
        return PUPIL_ERR_SIZE_BYTES;
    const int code_fits = s->code_light >= 0.0f && s->code_light <= 1.0f; /* false for NaN */
    return counts_fit(s) && log2_fits(s) && channels_fit(s) && peak_fits(s) && code_fits ? PUPIL_OK : PUPIL_ERR_STATS;
}

int pupil_stats_check(const pupil_stats *s)
{
    const int error = pupil_stats_check_sums(s);
    return error || bins_and_bands_fit(s) ? error : PUPIL_ERR_STATS;
}

/* The light at the share t (0..1) of bin i: bins are equally wide in light within their stop. */
static double log2_within_bin(int i, double t, int bins_per_stop)
{
    int stop = i / bins_per_stop;
    int step = i % bins_per_stop;
    return stop + PUPIL_HISTOGRAM_MIN_EV + pupil_log2(1.0 + (step + t) / bins_per_stop);
}

/* The light below which each share q of the weight, the bins' sum, is. The search goes from one share's bin to the next
 * one's. */
static void quantiles_of_bins(const uint64_t *bin, int bins_per_stop, uint64_t weight, const double *q, int count,
                              double *log2_light)
{
    uint64_t below = 0;
    PUPIL_ASSERT(weight > 0);
    for (int k = 0, i = 0; k < count; k++) {
        const double target = q[k] * (double)weight;
        uint64_t wanted = (uint64_t)target;
        wanted += (double)wanted < target || !wanted;
        wanted = wanted < weight ? wanted : weight; /* a weight beyond 2^53 may have been rounded up */
        while (below >= wanted)
            below -= bin[--i];
        while (below + bin[i] < wanted)
            below += bin[i++];
        log2_light[k] = log2_within_bin(i, (target - (double)below) / (double)bin[i], bins_per_stop);
    }
}

void pupil_stats_quantiles(const pupil_stats *stats, const double *q, int count, double *log2_luminance)
{
    quantiles_of_bins(stats->bin, PUPIL_HISTOGRAM_BINS_PER_STOP, counted_weight(stats), q, count, log2_luminance);
}

static int check_quantile(const pupil_stats *stats, double q, const double *result)
{
    if (!stats || !result)
        return PUPIL_ERR_NULL;
    if (!(q >= 0.0 && q <= 1.0))
        return PUPIL_ERR_VALUE;
    if (!stats->has_histogram)
        return PUPIL_ERR_NO_HISTOGRAM;
    const int error = pupil_stats_check(stats);
    if (error || !stats->weight)
        return error ? error : PUPIL_ERR_NO_LIGHT;
    return pupil_stats_are_counted(stats) ? PUPIL_OK : PUPIL_ERR_STATS;
}

int pupil_stats_quantile(const pupil_stats *stats, double q, double *log2_luminance)
{
    int error = check_quantile(stats, q, log2_luminance);
    if (!error)
        pupil_stats_quantiles(stats, &q, 1, log2_luminance);
    return error;
}

int pupil_stats_peak_quantile(const pupil_stats *stats, double q, double *log2_peak)
{
    int error = check_quantile(stats, q, log2_peak);
    if (error)
        return error;
    /* a frame that is clipped at 1 has its quantile at 1, not somewhere in the bin that begins there */
    const double most = pupil_log2((double)stats->peak);
    double inside;
    quantiles_of_bins(stats->peak_bin, PUPIL_PEAK_BINS_PER_STOP, counted_weight(stats), &q, 1, &inside);
    *log2_peak = inside < most ? inside : most;
    return PUPIL_OK;
}

/* Mean of the bins' middles over the weight between two amounts. */
static double middle_between(const pupil_stats *stats, double from, double to)
{
    double below = 0.0, sum = 0.0;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++) {
        if (!stats->bin[i])
            continue;
        const double end = below + (double)stats->bin[i], high = end < to ? end : to;
        const double low = below > from ? below : from;
        const double middle = log2_within_bin(i, 0.5, PUPIL_HISTOGRAM_BINS_PER_STOP);
        sum += high > low ? (high - low) * middle : 0.0;
        below = end;
    }
    return sum / (to - from);
}

double pupil_stats_excess(const pupil_stats *stats, double low, double high, double from_log2, double most)
{
    const double total = (double)counted_weight(stats), from = low * total, to = high * total;
    double end = 0.0, sum = 0.0;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++) {
        const double begin = end;
        end += (double)stats->bin[i];
        const double a = begin > from ? begin : from, b = end < to ? end : to;
        if (b > a) {
            const double middle = (0.5 * (a + b) - begin) / (end - begin);
            sum += (b - a) * clamp(log2_within_bin(i, middle, PUPIL_HISTOGRAM_BINS_PER_STOP) - from_log2, 0.0, most);
        }
    }
    return sum / (to - from);
}

/* The mean without some weight at the floor, trimmed to the shares low to high of the rest. */
static int mean_without(const pupil_stats *stats, uint64_t left_out, double floor_log2, double low, double high,
                        double *log2_luminance)
{
    const double sum = (double)stats->log2_sum + (double)stats->log2_frac * 0x1p-40;
    double mean = (sum - (double)left_out * floor_log2) / (double)(stats->weight - left_out);
    if (low > 0.0 || high < 1.0) {
        if (!pupil_stats_are_counted(stats))
            return stats->has_histogram ? PUPIL_ERR_STATS : PUPIL_ERR_NO_HISTOGRAM;
        const double total = (double)counted_weight(stats);
        const double first = total * ((double)left_out / (double)stats->weight), rest = total - first;
        /* The bins' middles are corrected by the exact mean, so the error vanishes with the trim. */
        mean += middle_between(stats, first + low * rest, first + high * rest) - middle_between(stats, first, total);
    }
    *log2_luminance = mean;
    return PUPIL_OK;
}

int pupil_stats_mean(const pupil_stats *stats, double low, double high, double *log2_luminance)
{
    if (!stats || !log2_luminance)
        return PUPIL_ERR_NULL;
    if (!(low >= 0.0 && high > low && high <= 1.0))
        return PUPIL_ERR_VALUE;
    const int error = pupil_stats_check(stats);
    if (error || !stats->weight)
        return error ? error : PUPIL_ERR_NO_LIGHT;
    return mean_without(stats, 0, 0.0, low, high, log2_luminance);
}

uint64_t pupil_least_light(uint64_t weight)
{
    return weight / 64 + (weight % 64 > 0);
}

/* The weight at the floor that does not count for the level. */
static uint64_t left_out(const pupil_stats *stats)
{
    const uint64_t black = stats->code_light > 0.0f ? 0 : black_weight_of(stats);
    const uint64_t most = stats->weight - pupil_least_light(stats->weight);
    return black < most ? black : most;
}

int pupil_stats_light_mean(const pupil_stats *stats, double floor_log2, double low, double high, double *log2_luminance)
{
    return mean_without(stats, left_out(stats), floor_log2, low, high, log2_luminance);
}

double pupil_stats_share_of_light(const pupil_stats *stats, double q)
{
    const double all_out = (double)left_out(stats) / (double)stats->weight, most = 1.0 - LEAST_SEEN;
    const double out = all_out < most ? all_out : most;
    return out + q * (1.0 - out);
}

int pupil_stats_grey_world(const pupil_stats *stats, float balance[3])
{
    if (!stats || !balance)
        return PUPIL_ERR_NULL;
    const int error = pupil_stats_check(stats);
    if (error || !stats->channel_quads)
        return error ? error : PUPIL_ERR_NO_LIGHT;
    int64_t most = 0;
    for (int i = 0; i < 3; i++) {
        if (stats->channel_sum[i] <= 0)
            return PUPIL_ERR_NO_LIGHT;
        most = stats->channel_sum[i] > most ? stats->channel_sum[i] : most;
    }
    for (int i = 0; i < 3; i++) {
        const double factor = (double)most / (double)stats->channel_sum[i];
        balance[i] = (float)(factor < 0x1p10 ? factor : 0x1p10); /* the largest that a coding takes */
    }
    return PUPIL_OK;
}
