/* Statistics: pupil_stats_add adds each number once and keeps the larger peak and code; the largest weight; rows of a
 * frame that counts other pixels. */
#include "check.h"
#include "pupil/pupil.h"

#include <string.h>

/* Statistics of k tenths of a frame of 100 rows; no number is 0, and the fractions of log2 add up to more than a
 * stop. */
static pupil_stats some_rows(uint64_t k)
{
    pupil_stats s;
    pupil_stats_clear(&s);
    for (uint64_t i = 0; i < PUPIL_HISTOGRAM_BINS; i++) {
        s.bin[i] = k * (1 + i % 5);
        s.peak_bin[i / 2] += s.bin[i];
        s.weight += s.bin[i];
    }
    s.pixels = s.weight;
    s.black = 3 * k;
    s.clipped = 5 * k;
    s.bad = 7 * k;
    s.log2_sum = -11 * (int64_t)k;
    s.log2_frac = (UINT64_C(1) << 40) - k;
    s.rows = 10 * (uint32_t)k;
    s.frame_height = 100;
    s.has_histogram = 1;
    s.peak = (float)(int64_t)k;
    s.code_light = 0.125f * (float)(int64_t)k;
    s.channel_quads = 13 * k;
    for (int64_t i = 0; i < 3; i++)
        s.channel_sum[i] = (i - 1) * 17 * (int64_t)k + 1;
    for (uint32_t i = 0; i < PUPIL_BANDS; i++) {
        s.band_pixels[i] = (uint32_t)k * (1 + i % 3);
        s.band_log2_sum[i] = (int64_t)k * (100 + (int64_t)i);
    }
    return s;
}

static void check_sum(uint64_t a, uint64_t b)
{
    const pupil_stats more = some_rows(b), larger = some_rows(a > b ? a : b);
    pupil_stats sum = some_rows(a), expected = some_rows(a + b);
    CHECK(pupil_stats_add(&sum, &more) == PUPIL_OK);
    /* 2^40 - a + 2^40 - b is one stop plus 2^40 - (a + b) */
    expected.log2_sum += 1;
    for (int i = 0; i < 3; i++)
        expected.channel_sum[i] += 1;
    expected.peak = larger.peak;
    expected.code_light = larger.code_light;
    for (int i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
        CHECK_MSG(sum.bin[i] == expected.bin[i], "bin %d", i);
    for (int i = 0; i < PUPIL_PEAK_BINS; i++)
        CHECK_MSG(sum.peak_bin[i] == expected.peak_bin[i], "bin of the brightest channel %d", i);
    for (int i = 0; i < PUPIL_BANDS; i++)
        CHECK_MSG(sum.band_pixels[i] == expected.band_pixels[i] && sum.band_log2_sum[i] == expected.band_log2_sum[i],
                  "band %d", i);
    CHECK(memcmp(&sum, &expected, sizeof sum) == 0);
}

static void check_limits(void)
{
    double value = 0.0;
    pupil_stats s;
    pupil_stats_clear(&s);
    s.pixels = s.rows = s.frame_height = 1;
    s.weight = UINT64_C(1) << 56;
    CHECK(pupil_stats_mean(&s, 0.0, 1.0, &value) == PUPIL_OK);
    s.weight++;
    CHECK(pupil_stats_mean(&s, 0.0, 1.0, &value) == PUPIL_ERR_STATS);
    s.weight = 1;
    s.frame_height = 2;
    s.has_histogram = 1;
    CHECK(pupil_stats_mean(&s, 0.0, 1.0, &value) == PUPIL_OK);
    CHECK(pupil_stats_quantile(&s, 0.5, &value) == PUPIL_ERR_STATS);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_limits();
    check_sum(1, 2);
    check_sum(4, 3);
    check_sum(5, 5); /* all rows */
    pupil_stats sum = some_rows(6);
    const pupil_stats before = sum, more = some_rows(5); /* a row too many */
    CHECK(pupil_stats_add(&sum, &more) == PUPIL_ERR_STATS && memcmp(&sum, &before, sizeof sum) == 0);
    return check_end();
}
